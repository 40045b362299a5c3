"""The force law applied to one touching contact or to one touching wall.

A wall is a partner of infinite mass that does not move. Contacts and walls differ in the relative motion and in the
bodies on which the torques act; they share the force law, `press`.
"""

from typing import NamedTuple

from simcore.compilation import leaf
from simcore.dem.forces.coulomb_friction import preload, tangent_of, tangential_force
from simcore.dem.forces.patch_torque import patch_torque
from simcore.dem.forces.spring_dashpot import explicit_dashpot, implicit_dashpot, normal_force
from simcore.dem.vectors import ZERO, Vec, cross, dot, minus, negative, plus, read, scaled, write


class Motion(NamedTuple):
    """Motion of body b, or of the body at a wall, relative to its partner."""

    mass: float  # [kg], effective
    # The larger value of the two bodies, at least 1 (simcore.dem.forces.spring_dashpot); for implicit dashpots
    effective_contacts: float
    velocity: Vec  # [m/s], at the contact point
    spin: Vec  # [1/s], difference of the angular velocities


class Push(NamedTuple):
    """What a touching contact does to its bodies."""

    force: Vec  # [N], on b; a gets the opposite
    torque_a: Vec  # [N m]
    torque_b: Vec  # [N m]


@leaf
def contact_velocity(bodies, i, j, arm_a, arm_b):
    """Return the velocity [m/s] of body j relative to body i at the contact point. arms [m]: from the centres to it."""
    spin = bodies.angular_velocity
    centres = minus(read(bodies.velocity, j), read(bodies.velocity, i))
    return plus(centres, minus(cross(read(spin, j), arm_b), cross(read(spin, i), arm_a)))


@leaf
def wall_velocity(bodies, i, arm):
    """Return the velocity [m/s] of body i where it touches a wall. arm [m]: from its centre to that point."""
    v, w = read(bodies.velocity, i), read(bodies.angular_velocity, i)
    # The sums run from left to right; forming the cross product first, as in contact_velocity, would round differently.
    return Vec(
        v.x + w.y * arm.z - w.z * arm.y,
        v.y + w.z * arm.x - w.x * arm.z,
        v.z + w.x * arm.y - w.y * arm.x,
    )


@leaf
def press(touches, k, overlap, normal, motion, law, dt, has):
    """Apply the force law at row k of contacts or walls; return (force [N] on b, torque [N m] of a patch on b).

    overlap [m]. normal: from a, or from the wall, to b. has: features of the scene. The springs of row k are updated.
    """
    if has.implicit:
        damping, tangential_damping = implicit_dashpot(law, motion.effective_contacts)
    else:
        damping, tangential_damping = explicit_dashpot(law)
    push = normal_force(law, damping, motion.mass, overlap, dot(motion.velocity, normal), has.attractive)
    force, torque = scaled(push, normal), ZERO
    tangent = tangent_of(law, tangential_damping, motion.mass, push)
    if has.friction:
        friction, spring = tangential_force(tangent, dt, normal, motion.velocity, read(touches.spring, k))
        if has.preloaded:
            spring = preload(tangent, normal, motion.velocity, friction, spring, touches.stuck, k)
        write(touches.spring, k, spring)
        force = plus(force, friction)
    if has.patch:
        torque = patch_torque(damping * motion.mass, tangent, dt, normal, motion.spin, touches, k, has.friction)
    return force, torque


@leaf
def press_contact(bodies, contacts, contact, offset, law, drive, p, has):
    """Return the Push of touching contact p, and update its springs.

    contact: its Contact. offset [m]: from the centre of a to that of its partner. law: the ContactLaw at this contact.
    drive: Drive of the step. has: features of the scene.
    """
    i, j = contacts.body_a[p], contacts.body_b[p]
    arm_a = contact.point
    arm_b = minus(arm_a, offset)
    effective_contacts = 1.0
    if has.implicit:
        effective_contacts = max(1.0, bodies.effective_contacts[i], bodies.effective_contacts[j])
    motion = Motion(
        bodies.mass[i] * bodies.mass[j] / (bodies.mass[i] + bodies.mass[j]),
        effective_contacts,
        contact_velocity(bodies, i, j, arm_a, arm_b),
        minus(read(bodies.angular_velocity, j), read(bodies.angular_velocity, i)),
    )
    force, torque = press(contacts, p, contact.overlap, contact.normal, motion, law, drive.dt, has)
    return Push(force, minus(negative(cross(arm_a, force)), torque), plus(cross(arm_b, force), torque))


@leaf
def press_wall(bodies, walls, law, drive, w, has):
    """Update the force and the torque of touching wall w on its body, and the springs; see press_contact."""
    i, arm = walls.body[w], read(walls.point, w)
    effective_contacts = 1.0
    if has.implicit:
        effective_contacts = max(1.0, bodies.effective_contacts[i])
    motion = Motion(bodies.mass[i], effective_contacts, wall_velocity(bodies, i, arm), read(bodies.angular_velocity, i))
    force, torque = press(walls, w, walls.overlap[w], read(walls.normal, w), motion, law, drive.dt, has)
    write(walls.force, w, force)
    write(walls.torque, w, plus(cross(arm, force), torque))
