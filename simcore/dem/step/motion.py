"""Motion of a body in one step: semi-implicit Euler for the centre, torque-free rotation for the orientation.

The rotational state is the orientation and the angular momentum in world axes, which stays the same to the last bit
for a free body. The orientation is advanced by a symmetric splitting of the kinetic energy into rotations about the
principal axes (Dullweber, Leimkuhler & McLachlan 1997). It is of second order, includes ω × Iω, and its energy does not
drift.
"""

from typing import NamedTuple

import numpy as np

from simcore.compilation import leaf
from simcore.dem.vectors import Vec, minus, plus, read, write


class StepWorkspace(NamedTuple):
    """Working memory of a step, and how it passes on the forces of contacts."""

    sums: np.ndarray  # (n, 6), with `adding`: force [N] and torque [N m] on each body by its weight and its contacts
    moved: np.ndarray  # (k,) bool: whether each body of this rank has moved by more than its margin
    adding: bool  # each force is added to the sums as soon as it is known; otherwise forces are stored and then added
    storing: bool  # forces of contacts and net forces are stored
    first: int  # index in Bodies.own of the first body whose contacts end with the present block
    last: int  # and the index after the last one


class Quaternion(NamedTuple):
    """An orientation, body to world; a quaternion of length 1."""

    w: float
    x: float
    y: float
    z: float


@leaf
def _cos_sin(angle):
    """Return cosine and sine; a short Taylor series suffices for the angles of a step in a bed, about 1e-3.

    The first neglected terms are at most 0.05¹⁰ / 10! = 3e-20 and 0.05¹¹ / 11!.
    """
    if abs(angle) < 0.05:
        a = angle * angle
        cos = 1.0 + a * (-1.0 / 2.0 + a * (1.0 / 24.0 + a * (-1.0 / 720.0 + a * (1.0 / 40320.0))))
        sin = 1.0 + a * (-1.0 / 6.0 + a * (1.0 / 120.0 + a * (-1.0 / 5040.0 + a * (1.0 / 362880.0))))
        return cos, angle * sin
    return np.cos(angle), np.sin(angle)


@leaf
def _turned(q, axis, c, s):
    """Return quaternion q times the rotation about a body axis; c and s: cosine and sine of half its angle."""
    w, x, y, z = q
    if axis == 0:
        return Quaternion(c * w - s * x, c * x + s * w, c * y + s * z, c * z - s * y)
    if axis == 1:
        return Quaternion(c * w - s * y, c * x - s * z, c * y + s * w, c * z + s * x)
    return Quaternion(c * w - s * z, c * x + s * y, c * y - s * x, c * z + s * w)


@leaf
def _matrix(q):
    """Return the rows (3 Vec) of the rotation matrix of q."""
    w, x, y, z = q
    return (
        Vec(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
        Vec(2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
        Vec(2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
    )


@leaf
def _to_body(rows, v):
    """Return the components in body axes of the world vector v: the transposed matrix times v."""
    a, b, c = rows
    return Vec(a.x * v.x + b.x * v.y + c.x * v.z, a.y * v.x + b.y * v.y + c.y * v.z, a.z * v.x + b.z * v.y + c.z * v.z)


@leaf
def rotate_free(orientation, momentum, inertia, dt):
    """Return the orientation of a free body after dt.

    momentum [kg m²/s]: angular, world axes; inertia [kg m²]: principal. The body turns by half steps about the first
    and second axis, by a full step about the third, and by half steps about the second and first. In each of them the
    momentum in body axes turns the other way.
    """
    o = orientation
    p, q, r = _to_body(_matrix(o), momentum)

    ch, sh = _cos_sin(0.5 * (0.5 * dt * p / inertia.x))
    o = _turned(o, 0, ch, sh)
    c, s = ch * ch - sh * sh, 2.0 * ch * sh
    q, r = c * q + s * r, c * r - s * q

    ch, sh = _cos_sin(0.5 * (0.5 * dt * q / inertia.y))
    o = _turned(o, 1, ch, sh)
    c, s = ch * ch - sh * sh, 2.0 * ch * sh
    p, r = c * p - s * r, c * r + s * p

    ch, sh = _cos_sin(0.5 * (dt * r / inertia.z))
    o = _turned(o, 2, ch, sh)
    c, s = ch * ch - sh * sh, 2.0 * ch * sh
    p, q = c * p + s * q, c * q - s * p

    ch, sh = _cos_sin(0.5 * (0.5 * dt * q / inertia.y))
    o = _turned(o, 1, ch, sh)
    c, s = ch * ch - sh * sh, 2.0 * ch * sh
    p, r = c * p - s * r, c * r + s * p

    ch, sh = _cos_sin(0.5 * (0.5 * dt * p / inertia.x))
    o = _turned(o, 0, ch, sh)

    norm = np.sqrt(o.w * o.w + o.x * o.x + o.y * o.y + o.z * o.z)
    return Quaternion(o.w / norm, o.x / norm, o.y / norm, o.z / norm)


@leaf
def read_orientation(bodies, i):
    """Return the orientation of body i."""
    o = bodies.orientation
    return Quaternion(o[i, 0], o[i, 1], o[i, 2], o[i, 3])


@leaf
def derive_rotation(bodies, i):
    """Update rotation matrix and angular velocity of body i from its orientation and angular momentum."""
    rows = _matrix(read_orientation(bodies, i))
    # All values are read before the first is written, because the compiler cannot know that the arrays do not overlap.
    momentum, inertia = _to_body(rows, read(bodies.angular_momentum, i)), read(bodies.inertia, i)
    p, q, s = momentum.x / inertia.x, momentum.y / inertia.y, momentum.z / inertia.z
    a, b, c = rows
    spin = Vec(a.x * p + a.y * q + a.z * s, b.x * p + b.y * q + b.z * s, c.x * p + c.y * q + c.z * s)
    r = bodies.rotation
    r[i, 0, 0], r[i, 0, 1], r[i, 0, 2] = a.x, a.y, a.z
    r[i, 1, 0], r[i, 1, 1], r[i, 1, 2] = b.x, b.y, b.z
    r[i, 2, 0], r[i, 2, 1], r[i, 2, 2] = c.x, c.y, c.z
    write(bodies.angular_velocity, i, spin)


@leaf
def derive_form_matrix(bodies, i):
    """Update the form matrix R diag(s²) Rᵀ of body i."""
    r, s, m = bodies.rotation, bodies.scale, bodies.form_matrix
    # All values are read before the first is written, because the compiler cannot know that the arrays do not overlap.
    x, y = Vec(r[i, 0, 0], r[i, 0, 1], r[i, 0, 2]), Vec(r[i, 1, 0], r[i, 1, 1], r[i, 1, 2])
    z = Vec(r[i, 2, 0], r[i, 2, 1], r[i, 2, 2])
    a, b, c = s[i, 0] ** 2, s[i, 1] ** 2, s[i, 2] ** 2
    xx, yy, zz = (
        a * x.x * x.x + b * x.y * x.y + c * x.z * x.z,
        a * y.x * y.x + b * y.y * y.y + c * y.z * y.z,
        a * z.x * z.x + b * z.y * z.y + c * z.z * z.z,
    )
    xy, xz, yz = (
        a * x.x * y.x + b * x.y * y.y + c * x.z * y.z,
        a * x.x * z.x + b * x.y * z.y + c * x.z * z.z,
        a * y.x * z.x + b * y.y * z.y + c * y.z * z.z,
    )
    m[i, 0], m[i, 1], m[i, 2], m[i, 3], m[i, 4], m[i, 5] = xx, yy, zz, xy, xz, yz


@leaf
def add_forces(bodies, contacts, walls, gravity, i, walled):
    """Return force [N] and torque [N m] on body i: weight, contacts in order of (partner, image), then walls."""
    force, torque = _add_contacts(bodies, contacts, gravity, i)
    if walled:
        wall_force, wall_torque = _add_walls(walls, i)
        return plus(force, wall_force), plus(torque, wall_torque)
    return force, torque


@leaf
def _add_contacts(bodies, contacts, gravity, i):
    force, torque = Vec(0.0, 0.0, -bodies.mass[i] * gravity), Vec(0.0, 0.0, 0.0)
    for k in range(contacts.incident_start[i], contacts.incident_start[i + 1]):
        p = contacts.incident[k] >> 1
        if contacts.touching[p] == 0:
            continue
        if contacts.incident[k] & 1:
            force, torque = plus(force, read(contacts.force, p)), plus(torque, read(contacts.torque_b, p))
        else:
            force, torque = minus(force, read(contacts.force, p)), plus(torque, read(contacts.torque_a, p))
    return force, torque


@leaf
def _add_walls(walls, i):
    force, torque = Vec(0.0, 0.0, 0.0), Vec(0.0, 0.0, 0.0)
    for w in range(walls.start[i], walls.start[i + 1]):
        if walls.touching[w] != 0:
            force, torque = plus(force, read(walls.force, w)), plus(torque, read(walls.torque, w))
    return force, torque


@leaf
def begin_sums(bodies, sums, i, gravity):
    """Begin the sums of force and torque on body i with its weight, as add_forces does."""
    sums[i, 0], sums[i, 1], sums[i, 2] = 0.0, 0.0, -bodies.mass[i] * gravity
    sums[i, 3], sums[i, 4], sums[i, 5] = 0.0, 0.0, 0.0


@leaf
def add_push(contacts, sums, p, push):
    """Add force and torques of contact p to the sums of its bodies; see add_forces."""
    a, b = contacts.body_a[p], contacts.body_b[p]
    sums[a, 0] -= push.force.x
    sums[a, 1] -= push.force.y
    sums[a, 2] -= push.force.z
    sums[a, 3] += push.torque_a.x
    sums[a, 4] += push.torque_a.y
    sums[a, 5] += push.torque_a.z
    sums[b, 0] += push.force.x
    sums[b, 1] += push.force.y
    sums[b, 2] += push.force.z
    sums[b, 3] += push.torque_b.x
    sums[b, 4] += push.torque_b.y
    sums[b, 5] += push.torque_b.z


@leaf
def take_sums(walls, sums, i, walled):
    """Return force [N] and torque [N m] on body i: the sums over its contacts, then the walls; see add_forces."""
    force, torque = Vec(sums[i, 0], sums[i, 1], sums[i, 2]), Vec(sums[i, 3], sums[i, 4], sums[i, 5])
    if walled:
        wall_force, wall_torque = _add_walls(walls, i)
        return plus(force, wall_force), plus(torque, wall_torque)
    return force, torque


@leaf
def note_moved(work, k, moved):
    """Store whether the k-th body of this rank has moved; this is a leaf for the reason given in note_net_force."""
    work.moved[k] = moved


@leaf
def note_net_force(bodies, i, force):
    """Store the net force of body i.

    This is a leaf because numba drops the writes of a parallel loop to an array of a tuple that the kernel never reads.
    """
    write(bodies.net_force, i, force)


@leaf
def count_effective_contacts(bodies, contacts, walls, i, walled):
    """Store the effective contacts of body i: the sum of its contacts, weighted by how much each moves this body.

    The relative motion u_a − u_b of a pair is bounded by the motion of its bodies, m_a w_a u_a² + m_b w_b u_b², with
    the weights w_a = m_b / (m_a + m_b) / p, w_b = m_a / (m_a + m_b) / (1 − p) and any p within (0, 1). The weights of
    the contacts of a body therefore add up to a bound for the modes in which the body takes part. With
    p = R_b / (R_a + R_b) a contact of equal grains has the weight 1 for both; a contact of a small and a large grain
    has the weight 1 for the small one and little for the large one. A wall has the weight 1.
    """
    effective_contacts = 0.0
    mass, radius = bodies.mass[i], bodies.radius[i]
    for k in range(contacts.incident_start[i], contacts.incident_start[i + 1]):
        p = contacts.incident[k] >> 1
        if contacts.touching[p] != 0:
            j = contacts.body_a[p] if contacts.incident[k] & 1 else contacts.body_b[p]
            effective_contacts += (
                bodies.mass[j] * (radius + bodies.radius[j]) / ((mass + bodies.mass[j]) * bodies.radius[j])
            )
    if walled:
        for w in range(walls.start[i], walls.start[i + 1]):
            if walls.touching[w] != 0:
                effective_contacts += 1.0
    bodies.effective_contacts[i] = effective_contacts


@leaf
def move(bodies, i, force, torque, push, dt, damping):
    """Advance body i by semi-implicit Euler: velocity and momentum first, then the position by the new velocity.

    push: acceleration by shaking [m/s²], along x. damping: factor on velocity and angular momentum, applied after the
    position has been advanced.
    """
    step = dt / bodies.mass[i]
    vx = bodies.velocity[i, 0] + step * force.x + dt * push
    vy = bodies.velocity[i, 1] + step * force.y
    vz = bodies.velocity[i, 2] + step * force.z
    bodies.position[i, 0] += dt * vx
    bodies.position[i, 1] += dt * vy
    bodies.position[i, 2] += dt * vz
    bodies.velocity[i, 0], bodies.velocity[i, 1], bodies.velocity[i, 2] = damping * vx, damping * vy, damping * vz
    bodies.angular_momentum[i, 0] = damping * (bodies.angular_momentum[i, 0] + dt * torque.x)
    bodies.angular_momentum[i, 1] = damping * (bodies.angular_momentum[i, 1] + dt * torque.y)
    bodies.angular_momentum[i, 2] = damping * (bodies.angular_momentum[i, 2] + dt * torque.z)


@leaf
def spin_sphere(bodies, i):
    """Update the angular velocity of a sphere; its orientation has no effect."""
    inverse = 1.0 / bodies.inertia[i, 0]
    bodies.angular_velocity[i, 0] = inverse * bodies.angular_momentum[i, 0]
    bodies.angular_velocity[i, 1] = inverse * bodies.angular_momentum[i, 1]
    bodies.angular_velocity[i, 2] = inverse * bodies.angular_momentum[i, 2]


@leaf
def turn(bodies, i, dt, damping):
    """Update orientation, rotation matrix and angular velocity of body i, and add to `turned` the path of its points.

    damping: factor that `move` has applied to the momentum; the rotation of this step uses the momentum without it.
    """
    inverse = 1.0 / damping
    momentum = Vec(
        inverse * bodies.angular_momentum[i, 0],
        inverse * bodies.angular_momentum[i, 1],
        inverse * bodies.angular_momentum[i, 2],
    )
    old = read_orientation(bodies, i)
    w, x, y, z = rotate_free(old, momentum, read(bodies.inertia, i), dt)
    # The vector part of the rotation has the length sin(angle / 2); a point at R moves by 2 R sin(angle / 2).
    ow, ox, oy, oz = old
    dx, dy, dz = (
        ow * x - w * ox - (oy * z - oz * y), ow * y - w * oy - (oz * x - ox * z), ow * z - w * oz - (ox * y - oy * x)
    )  # fmt: skip
    bodies.turned[i] += 2.002 * bodies.radius[i] * np.sqrt(dx * dx + dy * dy + dz * dz)
    o = bodies.orientation
    o[i, 0], o[i, 1], o[i, 2], o[i, 3] = w, x, y, z
    derive_rotation(bodies, i)


@leaf
def has_left(bodies, i, turning):
    """Return whether a point of body i may have moved by more than the margin since the listing, or is nan."""
    margin = bodies.margin[i]
    dx = bodies.position[i, 0] - bodies.listed_position[i, 0]
    dy = bodies.position[i, 1] - bodies.listed_position[i, 1]
    dz = bodies.position[i, 2] - bodies.listed_position[i, 2]
    if turning:
        margin -= bodies.turned[i] - bodies.listed_turned[i]
    return not (margin > 0.0 and dx * dx + dy * dy + dz * dz <= margin * margin)
