"""Linear spring-dashpot with Coulomb friction.

Stiffness and damping follow from the restitution e_n and the contact time T_c of a pair of effective mass m:
k_n = m (π² + ln² e_n) / T_c², d_n = −2 m ln e_n / T_c, k_t = κ k_n, d_t = √κ d_n, κ = 2 (1 − ν) / (2 − ν).
With the attractive law the contact lasts T_c and e_n is its restitution. Clamped at F_n >= 0 the same stiffness and
damping give a higher restitution (0.2527 for e_n = 0.1; Schwager & Pöschel 2007).
"""

from typing import NamedTuple

import numpy as np

from simcore.compilation import leaf


class ContactLaw(NamedTuple):
    """Coefficients per effective mass: stiffness [1/s²], damping [1/s]; ratio of tangential to normal, and its root."""

    stiffness: float
    damping: float
    tangential: float
    root_tangential: float
    friction: float


def contact_law(restitution: float, contact_time: float, poisson_ratio: float, friction: float) -> ContactLaw:
    """Coefficients from restitution (0, 1], contact time [s], Poisson's ratio and friction coefficient."""
    logarithm = np.log(restitution)
    ratio = 2.0 * (1.0 - poisson_ratio) / (2.0 - poisson_ratio)
    return ContactLaw(
        stiffness=(np.pi**2 + logarithm**2) / contact_time**2,
        damping=-2.0 * logarithm / contact_time,
        tangential=ratio,
        root_tangential=np.sqrt(ratio),
        friction=friction,
    )


@leaf
def tangential_force(law, mass, limit, dt, nx, ny, nz, ux, uy, uz, sx, sy, sz):
    """Tangential force on b [N] and new tangential spring [m]: (F (3), spring (3)).

    mass: effective. limit: of the Coulomb law. u: relative velocity of b against a at the contact point. The spring
    is turned into the new tangent plane keeping its length, grows by the tangential velocity, and is cut back to
    what the limit can hold where the contact slips.
    """
    un = ux * nx + uy * ny + uz * nz
    ux, uy, uz = ux - un * nx, uy - un * ny, uz - un * nz
    length2 = sx * sx + sy * sy + sz * sz
    if length2 > 0.0:
        sn = sx * nx + sy * ny + sz * nz
        sx, sy, sz = sx - sn * nx, sy - sn * ny, sz - sn * nz
        left2 = sx * sx + sy * sy + sz * sz
        if left2 > 0.0:
            stretch = np.sqrt(length2 / left2)
            sx, sy, sz = stretch * sx, stretch * sy, stretch * sz
    sx, sy, sz = sx + ux * dt, sy + uy * dt, sz + uz * dt
    stiffness = law.tangential * law.stiffness * mass
    damping = law.root_tangential * law.damping * mass
    fx = -stiffness * sx - damping * ux
    fy = -stiffness * sy - damping * uy
    fz = -stiffness * sz - damping * uz
    trial2 = fx * fx + fy * fy + fz * fz
    if trial2 > limit * limit:
        cut = limit / np.sqrt(trial2)
        fx, fy, fz = cut * fx, cut * fy, cut * fz
        sx = -(fx + damping * ux) / stiffness
        sy = -(fy + damping * uy) / stiffness
        sz = -(fz + damping * uz) / stiffness
    return fx, fy, fz, sx, sy, sz


@leaf
def normal_force(law, mass, overlap, un, attractive):
    """Normal force on b [N], positive where it pushes. un: velocity of b against a along the normal."""
    push = mass * (law.stiffness * overlap - law.damping * un)
    if not attractive:
        push = max(push, 0.0)
    return push


@leaf
def patch_torque(law, mass, push, dt, nx, ny, nz, wx, wy, wz, spread, twists, k, friction):
    """Torque on b [N m] of a patch about its centroid, and its new twist; zero for a point.

    The springs and dashpots of the contact law, thought spread over the patch by depth, also resist what turns about
    the centroid: with second moments C of the patch, rocking at g = n × ω meets −d_n (C g) × n, and twisting a
    torsional spring k_t tr C with its dashpot, held by friction up to µ |F_n| √(tr C).
    # ASSUME: slip and twist do not weaken each other, and the gyration radius stands for the mean lever arm (for a
    # disc 0.707 R against 0.667 R). w: angular velocity of b against a.
    """
    xx, yy, zz = spread[k, 0], spread[k, 1], spread[k, 2]
    xy, xz, yz = spread[k, 3], spread[k, 4], spread[k, 5]
    gx, gy, gz = ny * wz - nz * wy, nz * wx - nx * wz, nx * wy - ny * wx
    hx = xx * gx + xy * gy + xz * gz
    hy = xy * gx + yy * gy + yz * gz
    hz = xz * gx + yz * gy + zz * gz
    d = -law.damping * mass
    mx, my, mz = d * (hy * nz - hz * ny), d * (hz * nx - hx * nz), d * (hx * ny - hy * nx)
    if friction:
        moment = xx + yy + zz
        rate = nx * wx + ny * wy + nz * wz
        stiffness = law.tangential * law.stiffness * mass * moment
        damping = law.root_tangential * law.damping * mass * moment
        twist = twists[k] + rate * dt
        torque = -stiffness * twist - damping * rate
        limit = law.friction * abs(push) * np.sqrt(moment)
        if abs(torque) > limit:
            torque = limit if torque > 0.0 else -limit
            twist = -(torque + damping * rate) / stiffness if stiffness > 0.0 else 0.0
        twists[k] = twist
        mx, my, mz = mx + torque * nx, my + torque * ny, mz + torque * nz
    return mx, my, mz
