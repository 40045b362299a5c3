"""Friction without springs: it resists sliding in proportion to the speed, and no contact sticks at rest.

Baram & Lind (arXiv:1110.2792) write "-(coefficient) v_t": dynamic friction only and no static spring. Taken literally
(VISCOUS) the force is F_t = -c m v_t with the effective mass m and a rate c, so that light and heavy grains slow down
alike and one limit of the time step applies to all. A grain that grazes another is then slowed down more strongly than
by any real friction. Our law (CAPPED) therefore limits the force to Coulomb's µ F_n, as Haff and Werner (1986) do. With
either law a grain on a slope creeps, at g sin θ / c where the limit is not reached, and a bed settles towards one
without friction, more slowly the larger c is.

The friction is added to the normal force of either contact law and needs no array of its own.
"""

import numpy as np

from simcore.compilation import leaf
from simcore.dem.forces.pressing import contact_velocity, wall_velocity
from simcore.dem.state.touches import partner_offset
from simcore.dem.vectors import across, cross, dot, length, minus, plus, read, scaled, write

NONE, CAPPED, VISCOUS = 0, 1, 2


@leaf
def sliding_force(law, mass, limit, normal, velocity):
    """Return the tangential force [N], a vector, against a velocity. mass: effective. limit [N]: largest force."""
    velocity = across(velocity, normal)
    rate = law.sliding * mass
    force = rate * length(velocity)
    if force > limit:
        rate *= limit / force
    return scaled(-rate, velocity)


@leaf
def add_viscous_friction(touches, k, normal, velocity, law, mass, has):
    """Add the viscous friction to the force [N] of row k of contacts or walls; return the friction."""
    pressed = read(touches.force, k)
    limit = np.inf
    if has.sliding == CAPPED:
        limit = law.friction * max(dot(pressed, normal), 0.0)
    friction = sliding_force(law, mass, limit, normal, velocity)
    write(touches.force, k, plus(pressed, friction))
    return friction


@leaf
def viscous_friction_at_contact(bodies, contacts, law, drive, p, has):
    """Add the viscous friction of touching contact p to its force and torques. has: features of the scene."""
    i, j = contacts.body_a[p], contacts.body_b[p]
    arm_a = read(contacts.point, p)
    arm_b = minus(arm_a, partner_offset(bodies, contacts, p, drive.width, has.periodic))
    mass = bodies.mass[i] * bodies.mass[j] / (bodies.mass[i] + bodies.mass[j])
    velocity = contact_velocity(bodies, i, j, arm_a, arm_b)
    friction = add_viscous_friction(contacts, p, read(contacts.direction, p), velocity, law, mass, has)
    write(contacts.torque_a, p, minus(read(contacts.torque_a, p), cross(arm_a, friction)))
    write(contacts.torque_b, p, plus(read(contacts.torque_b, p), cross(arm_b, friction)))


@leaf
def viscous_friction_at_wall(bodies, walls, law, w, has):
    """Add the viscous friction of touching wall w to its force and torque. has: features of the scene."""
    i, arm = walls.body[w], read(walls.point, w)
    friction = add_viscous_friction(
        walls, w, read(walls.normal, w), wall_velocity(bodies, i, arm), law, bodies.mass[i], has
    )
    write(walls.torque, w, plus(read(walls.torque, w), cross(arm, friction)))
