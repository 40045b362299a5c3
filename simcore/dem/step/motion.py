"""Semi-implicit Euler for the centre, and rotation that is free of torque over one step.

The state is the angular momentum in world axes, which a free body keeps to the last bit, and the orientation.
The orientation follows by a symmetric splitting of the kinetic energy into rotations about the principal axes
(Dullweber, Leimkuhler & McLachlan 1997): second order, no drift of the energy, ω × Iω included.
"""

import numpy as np

from simcore.compilation import leaf


@leaf
def _cos_sin(angle):
    """Cosine and sine; in a bed a step turns by some 1e-3, where Taylor's series ends early.

    Below 0.05 the first terms left out are 0.05¹⁰ / 10! = 3e-20 and 0.05¹¹ / 11!.
    """
    if abs(angle) < 0.05:
        a = angle * angle
        cos = 1.0 + a * (-1.0 / 2.0 + a * (1.0 / 24.0 + a * (-1.0 / 720.0 + a * (1.0 / 40320.0))))
        sin = 1.0 + a * (-1.0 / 6.0 + a * (1.0 / 120.0 + a * (-1.0 / 5040.0 + a * (1.0 / 362880.0))))
        return cos, angle * sin
    return np.cos(angle), np.sin(angle)


@leaf
def _turn(w, x, y, z, axis, c, s):
    """Quaternion q times the rotation about a body axis, c and s of half its angle."""
    if axis == 0:
        return c * w - s * x, c * x + s * w, c * y + s * z, c * z - s * y
    if axis == 1:
        return c * w - s * y, c * x - s * z, c * y + s * w, c * z + s * x
    return c * w - s * z, c * x + s * y, c * y - s * x, c * z + s * w


@leaf
def _matrix(w, x, y, z):
    return (
        1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y),
        2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x),
        2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y),
    )  # fmt: skip


@leaf
def rotate_free(w, x, y, z, lx, ly, lz, ia, ib, ic, dt):
    """Orientation (4) after dt of a free body of angular momentum L [kg m²/s, world], principal inertia (ia, ib, ic).

    Half steps about the first and second axis, a full one about the third, and back. The momentum in body axes
    turns against the body in each.
    """
    xx, xy, xz, yx, yy, yz, zx, zy, zz = _matrix(w, x, y, z)
    p = xx * lx + yx * ly + zx * lz
    q = xy * lx + yy * ly + zy * lz
    r = xz * lx + yz * ly + zz * lz

    ch, sh = _cos_sin(0.5 * (0.5 * dt * p / ia))
    w, x, y, z = _turn(w, x, y, z, 0, ch, sh)
    c, s = ch * ch - sh * sh, 2.0 * ch * sh
    q, r = c * q + s * r, c * r - s * q

    ch, sh = _cos_sin(0.5 * (0.5 * dt * q / ib))
    w, x, y, z = _turn(w, x, y, z, 1, ch, sh)
    c, s = ch * ch - sh * sh, 2.0 * ch * sh
    p, r = c * p - s * r, c * r + s * p

    ch, sh = _cos_sin(0.5 * (dt * r / ic))
    w, x, y, z = _turn(w, x, y, z, 2, ch, sh)
    c, s = ch * ch - sh * sh, 2.0 * ch * sh
    p, q = c * p + s * q, c * q - s * p

    ch, sh = _cos_sin(0.5 * (0.5 * dt * q / ib))
    w, x, y, z = _turn(w, x, y, z, 1, ch, sh)
    c, s = ch * ch - sh * sh, 2.0 * ch * sh
    p, r = c * p - s * r, c * r + s * p

    ch, sh = _cos_sin(0.5 * (0.5 * dt * p / ia))
    w, x, y, z = _turn(w, x, y, z, 0, ch, sh)

    norm = np.sqrt(w * w + x * x + y * y + z * z)
    return w / norm, x / norm, y / norm, z / norm


@leaf
def derive_rotation(bodies, i):
    """Fill what follows from orientation and angular momentum of body i: matrix and angular velocity."""
    xx, xy, xz, yx, yy, yz, zx, zy, zz = _matrix(
        bodies.orientation[i, 0], bodies.orientation[i, 1], bodies.orientation[i, 2], bodies.orientation[i, 3]
    )
    r = bodies.rotation
    r[i, 0, 0], r[i, 0, 1], r[i, 0, 2] = xx, xy, xz
    r[i, 1, 0], r[i, 1, 1], r[i, 1, 2] = yx, yy, yz
    r[i, 2, 0], r[i, 2, 1], r[i, 2, 2] = zx, zy, zz
    lx, ly, lz = bodies.angular_momentum[i, 0], bodies.angular_momentum[i, 1], bodies.angular_momentum[i, 2]
    p = (xx * lx + yx * ly + zx * lz) / bodies.inertia[i, 0]
    q = (xy * lx + yy * ly + zy * lz) / bodies.inertia[i, 1]
    s = (xz * lx + yz * ly + zz * lz) / bodies.inertia[i, 2]
    bodies.angular_velocity[i, 0] = xx * p + xy * q + xz * s
    bodies.angular_velocity[i, 1] = yx * p + yy * q + yz * s
    bodies.angular_velocity[i, 2] = zx * p + zy * q + zz * s


@leaf
def derive_form_matrix(bodies, i):
    """Fill R diag(s²) Rᵀ of body i."""
    r, m = bodies.rotation, bodies.form_matrix
    a, b, c = bodies.scale[i, 0] ** 2, bodies.scale[i, 1] ** 2, bodies.scale[i, 2] ** 2
    m[i, 0] = a * r[i, 0, 0] * r[i, 0, 0] + b * r[i, 0, 1] * r[i, 0, 1] + c * r[i, 0, 2] * r[i, 0, 2]
    m[i, 1] = a * r[i, 1, 0] * r[i, 1, 0] + b * r[i, 1, 1] * r[i, 1, 1] + c * r[i, 1, 2] * r[i, 1, 2]
    m[i, 2] = a * r[i, 2, 0] * r[i, 2, 0] + b * r[i, 2, 1] * r[i, 2, 1] + c * r[i, 2, 2] * r[i, 2, 2]
    m[i, 3] = a * r[i, 0, 0] * r[i, 1, 0] + b * r[i, 0, 1] * r[i, 1, 1] + c * r[i, 0, 2] * r[i, 1, 2]
    m[i, 4] = a * r[i, 0, 0] * r[i, 2, 0] + b * r[i, 0, 1] * r[i, 2, 1] + c * r[i, 0, 2] * r[i, 2, 2]
    m[i, 5] = a * r[i, 1, 0] * r[i, 2, 0] + b * r[i, 1, 1] * r[i, 2, 1] + c * r[i, 1, 2] * r[i, 2, 2]


@leaf
def move(bodies, i, fx, fy, fz, mx, my, mz, push_x, dt, damping):
    """Semi-implicit Euler: velocity and momentum from force and torque, then the position from the new velocity.

    push_x: acceleration by shaking [m/s²]. damping: factor on the velocity once the position is known; `turn` and
    `spin_sphere` see the momentum before it.
    """
    step = dt / bodies.mass[i]
    vx = bodies.velocity[i, 0] + step * fx + dt * push_x
    vy = bodies.velocity[i, 1] + step * fy
    vz = bodies.velocity[i, 2] + step * fz
    bodies.position[i, 0] += dt * vx
    bodies.position[i, 1] += dt * vy
    bodies.position[i, 2] += dt * vz
    bodies.velocity[i, 0], bodies.velocity[i, 1], bodies.velocity[i, 2] = damping * vx, damping * vy, damping * vz
    bodies.angular_momentum[i, 0] = damping * (bodies.angular_momentum[i, 0] + dt * mx)
    bodies.angular_momentum[i, 1] = damping * (bodies.angular_momentum[i, 1] + dt * my)
    bodies.angular_momentum[i, 2] = damping * (bodies.angular_momentum[i, 2] + dt * mz)


@leaf
def spin_sphere(bodies, i):
    """Angular velocity of a sphere; its orientation matters to nothing."""
    inverse = 1.0 / bodies.inertia[i, 0]
    bodies.angular_velocity[i, 0] = inverse * bodies.angular_momentum[i, 0]
    bodies.angular_velocity[i, 1] = inverse * bodies.angular_momentum[i, 1]
    bodies.angular_velocity[i, 2] = inverse * bodies.angular_momentum[i, 2]


@leaf
def turn(bodies, i, dt, damping):
    """New orientation, rotation matrix and angular velocity of body i; adds the way of its farthest point.

    damping: factor that the momentum already carries, taken out again for the step itself.
    """
    inverse = 1.0 / damping
    lx = inverse * bodies.angular_momentum[i, 0]
    ly = inverse * bodies.angular_momentum[i, 1]
    lz = inverse * bodies.angular_momentum[i, 2]
    orientation, inertia = bodies.orientation, bodies.inertia
    w, x, y, z = rotate_free(
        orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3],
        lx, ly, lz, inertia[i, 0], inertia[i, 1], inertia[i, 2], dt,
    )  # fmt: skip
    # Vector part of the turn from the old orientation: sin(angle / 2), and a point at R moves by 2 R sin(angle / 2).
    ow, ox, oy, oz = orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3]
    dx, dy, dz = (
        ow * x - w * ox - (oy * z - oz * y), ow * y - w * oy - (oz * x - ox * z), ow * z - w * oz - (ox * y - oy * x)
    )  # fmt: skip
    bodies.turned[i] += 2.002 * bodies.radius[i] * np.sqrt(dx * dx + dy * dy + dz * dz)
    orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3] = w, x, y, z
    derive_rotation(bodies, i)
