"""Linear spring-dashpot with Coulomb friction.

Stiffness and damping follow from the restitution e_n and the contact time T_c of a pair of effective mass m:
k_n = m (π² + ln² e_n) / T_c², d_n = −2 m ln e_n / T_c, k_t = κ k_n, d_t = √κ d_n, κ = 2 (1 − ν) / (2 − ν).
With the attractive law the contact lasts T_c and e_n is its restitution. Clamped at F_n >= 0 the same stiffness and
damping give a higher restitution (0.2527 for e_n = 0.1; Schwager & Pöschel 2007).

A dashpot is explicit, on the velocity before the step, or implicit, on the mean of the velocities before and after it
as the contact alone would change them, v' = v + h F / m. With γ = d_n / m and ω² = k_n / m that is
F / m = ω² δ − γ (v + v') / 2, so F / m = (ω² δ − γ v) / (1 + γ h / 2): the central difference, of second order, and for
one contact stable up to h = 2 / ω whatever the damping. Along the tangent the same with γ_t = LEVER d_t / m.

The velocity of a grain is changed by all of its contacts. Its hold counts them, and with c, the larger hold of the two,
the dashpot is divided by 1 + (c − 1/2) γ h: half of its own share, all of the others'. The spring is not, or a bed at
rest would be the softer the more contacts its grains have; as it is, all springs are softer by 1 + γ h / 2.
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
    step: float = 0.0  # [s], over which an implicit dashpot acts; 0 of an explicit one
    sliding: float = 0.0  # [1/s], rate of a friction without springs (simcore.dem.forces.sliding)


# Inverse effective mass along the tangent times the effective mass: 1 + m r² / I with 5/2 of a sphere.
# ASSUME: of other grains too; it only sets how strongly the implicit dashpot is divided.
LEVER = 3.5


def contact_law(
    restitution: float, contact_time: float, poisson_ratio: float, friction: float, sliding: float = 0.0
) -> ContactLaw:
    """Coefficients from restitution (0, 1], contact time [s], Poisson's ratio, friction coefficient, sliding rate."""
    logarithm = np.log(restitution)
    ratio = 2.0 * (1.0 - poisson_ratio) / (2.0 - poisson_ratio)
    return ContactLaw(
        stiffness=(np.pi**2 + logarithm**2) / contact_time**2,
        damping=-2.0 * logarithm / contact_time,
        tangential=ratio,
        root_tangential=np.sqrt(ratio),
        friction=friction,
        sliding=sliding,
    )


def implicit_law(law: ContactLaw, step: float) -> ContactLaw:
    """The law whose implicit dashpot acts over `step` [s]: springs are divided by 1 + γ h / 2, each with its own γ."""
    normal = 1.0 + 0.5 * law.damping * step
    tangential = 1.0 + 0.5 * LEVER * law.root_tangential * law.damping * step
    return law._replace(stiffness=law.stiffness / normal, tangential=law.tangential * normal / tangential, step=step)


@leaf
def explicit_dashpot(law):
    """Normal and tangential damping per effective mass [1/s]."""
    return law.damping, law.root_tangential * law.damping


@leaf
def implicit_dashpot(law, hold):
    """Normal and tangential damping per effective mass [1/s]. hold: the larger of the two grains', at least 1."""
    share = (hold - 0.5) * law.step
    tangential = law.root_tangential * law.damping
    return law.damping / (1.0 + share * law.damping), tangential / (1.0 + LEVER * share * tangential)


@leaf
def tangential_force(law, damping, mass, limit, dt, nx, ny, nz, ux, uy, uz, sx, sy, sz):
    """Tangential force on b [N] and new tangential spring [m]: (F (3), spring (3)).

    damping: tangential, per effective mass. mass: effective. limit: of the Coulomb law. u: relative velocity of b
    against a at the contact point. The spring is turned into the new tangent plane keeping its length, grows by the
    tangential velocity, and is cut back to what the limit can hold where the contact slips.
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
    damping = damping * mass
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
def preload(law, damping, mass, limit, nx, ny, nz, ux, uy, uz, tx, ty, tz, sx, sy, sz, stuck, k):
    """Tangential spring (3) [m] that contact k keeps where what begins to be held is loaded to the limit at once.

    So the source study's program does, at the first touch and where slip ends: the force (t) of that step stands, but
    from the next on the spring pushes as hard as friction may, whatever little moved. What lands with no tangential
    force at all is held and stays so. It is no law of friction (a sphere that lands all but straight is thrown aside)
    and is here to tell what it does to packings. stuck: (m,) uint8, whether each was held in the step before; that of k
    is set. Others: what `tangential_force` takes, and its results.
    """
    force = np.sqrt(tx * tx + ty * ty + tz * tz)
    held = force < (1.0 - 1e-12) * limit  # a force that was cut back is the limit but for rounding
    if held and stuck[k] == 0 and force > 0.0:
        un = ux * nx + uy * ny + uz * nz
        stiffness = law.tangential * law.stiffness * mass
        damping = damping * mass
        full = limit / force
        sx = -(full * tx + damping * (ux - un * nx)) / stiffness
        sy = -(full * ty + damping * (uy - un * ny)) / stiffness
        sz = -(full * tz + damping * (uz - un * nz)) / stiffness
    stuck[k] = held
    return sx, sy, sz


@leaf
def normal_force(law, damping, mass, overlap, un, attractive):
    """Normal force on b [N], positive where it pushes. un: velocity of b against a along the normal."""
    push = mass * (law.stiffness * overlap - damping * un)
    if not attractive:
        push = max(push, 0.0)
    return push


@leaf
def patch_torque(
    law, normal_damping, tangential_damping, mass, push, dt, nx, ny, nz, wx, wy, wz, spread, twists, k, friction
):
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
    d = -normal_damping * mass
    mx, my, mz = d * (hy * nz - hz * ny), d * (hz * nx - hx * nz), d * (hx * ny - hy * nx)
    if friction:
        moment = max(xx + yy + zz, 0.0)  # of a single vertex behind a wall it is zero but for rounding, of either sign
        rate = nx * wx + ny * wy + nz * wz
        stiffness = law.tangential * law.stiffness * mass * moment
        damping = tangential_damping * mass * moment
        twist = twists[k] + rate * dt
        torque = -stiffness * twist - damping * rate
        limit = law.friction * abs(push) * np.sqrt(moment)
        if not abs(torque) < limit:  # also where there is no patch, which holds no twist
            torque = limit if torque > 0.0 else -limit
            twist = -(torque + damping * rate) / stiffness if stiffness > 0.0 else 0.0
        twists[k] = twist
        mx, my, mz = mx + torque * nx, my + torque * ny, mz + torque * nz
    return mx, my, mz
