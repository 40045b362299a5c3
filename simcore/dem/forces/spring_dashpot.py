"""Linear spring-dashpot with Coulomb friction.

Stiffness and damping follow from the restitution e_n and the contact time T_c of a pair of effective mass m:
k_n = m (π² + ln² e_n) / T_c², d_n = −2 m ln e_n / T_c, k_t = κ k_n, d_t = √κ d_n, κ = 2 (1 − ν) / (2 − ν).
With the attractive law the contact lasts T_c and e_n is its restitution. Clamped at F_n >= 0 the same stiffness and
damping give a higher restitution (0.2527 for e_n = 0.1; Schwager & Pöschel 2007).

A dashpot is explicit, on the velocity before the step, or implicit, on the mean of the velocities before and after it
as the contact alone would change them: v' = v + h F / m. With γ = d_n / m and ω² = k_n / m that is
F / m = ω² δ − γ (v + v') / 2, so F / m = (ω² δ − γ v) / (1 + γ h / 2): the central difference, of second order, and for
one contact stable up to h = 2 / ω whatever the damping. Along the tangent the same with γ_t = LEVER d_t / m.

The velocity of a grain is changed by all of its contacts. Its hold counts them, and with c, the larger hold of the two,
the dashpot is divided by 1 + (c − 1/2) γ h: half of its own share, all of the others'. The spring is not, or a bed at
rest would be the softer the more contacts its grains have; as it is, all springs are softer by 1 + γ h / 2.
"""

from typing import NamedTuple

import numpy as np

from simcore.compilation import leaf
from simcore.dem.vectors import Vec, across, cross, dot, minus, negative, over, plus, scaled, squared


class ContactLaw(NamedTuple):
    """Coefficients per effective mass: stiffness [1/s²], damping [1/s]; ratio of tangential to normal, and its root."""

    stiffness: float
    damping: float
    tangential: float
    root_tangential: float
    friction: float
    step: float = 0.0  # [s], over which an implicit dashpot acts; 0 of an explicit one
    sliding: float = 0.0  # [1/s], rate of a friction without springs (simcore.dem.forces.sliding)


class Tangent(NamedTuple):
    """Coefficients of one contact along its tangent plane."""

    stiffness: float  # [N/m]
    damping: float  # [N s/m]
    limit: float  # [N], of Coulomb friction


LEVER = 3.5  # 1 + m r² / I of a sphere. ASSUME: of all grains. Why: docs/constants.md#lever


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
def tangent_of(law, damping, mass, push):
    """Tangent for the normal force `push` [N]. damping: tangential, per effective mass. mass: effective."""
    return Tangent(law.tangential * law.stiffness * mass, damping * mass, law.friction * abs(push))


@leaf
def tangential_force(tangent, dt, normal, velocity, spring):
    """Tangential force on b [N] and the new tangential spring [m], both vectors.

    velocity: of b against a at the contact point. The spring is turned into the new tangent plane keeping its length,
    grows by the tangential velocity, and is cut back to what the limit can hold where the contact slips.
    """
    velocity = across(velocity, normal)
    length2 = squared(spring)
    if length2 > 0.0:
        spring = across(spring, normal)
        left2 = squared(spring)
        if left2 > 0.0:
            spring = scaled(np.sqrt(length2 / left2), spring)
    spring = plus(spring, scaled(dt, velocity))
    drag = scaled(tangent.damping, velocity)
    force = minus(scaled(-tangent.stiffness, spring), drag)
    trial2 = squared(force)
    if trial2 > tangent.limit * tangent.limit:
        force = scaled(tangent.limit / np.sqrt(trial2), force)
        spring = over(negative(plus(force, drag)), tangent.stiffness)
    return force, spring


@leaf
def preload(tangent, normal, velocity, force, spring, stuck, k):
    """Tangential spring [m] of contact k by the preloaded law: a contact that starts to stick is loaded to the limit.

    The program of Rettinger et al. does so at the first touch and where slip ends: the tangential force of that step
    stays as it is, but from the next step on the spring pushes as hard as friction allows, however little it moved. A
    contact without any tangential force sticks at rest. This is no law of friction (a sphere that lands almost straight
    is thrown aside); it is here to measure what it does to packings. force, spring: of `tangential_force`, which also
    takes the others. stuck: (m,) uint8, whether each contact stuck in the step before; that of k is set.
    """
    size = np.sqrt(squared(force))
    sticks = size < (1.0 - 1e-12) * tangent.limit  # a force that was cut back is the limit but for rounding
    if sticks and stuck[k] == 0 and size > 0.0:
        drag = scaled(tangent.damping, across(velocity, normal))
        spring = over(negative(plus(scaled(tangent.limit / size, force), drag)), tangent.stiffness)
    stuck[k] = sticks
    return spring


@leaf
def normal_force(law, damping, mass, overlap, un, attractive):
    """Normal force on b [N], positive where it pushes. un: velocity of b against a along the normal."""
    push = mass * (law.stiffness * overlap - damping * un)
    if not attractive:
        push = max(push, 0.0)
    return push


@leaf
def moments_times(spread, k, v):
    """Product of the second moments in row k, xx yy zz xy xz yz, with a vector."""
    xx, yy, zz = spread[k, 0], spread[k, 1], spread[k, 2]
    xy, xz, yz = spread[k, 3], spread[k, 4], spread[k, 5]
    return Vec(
        xx * v.x + xy * v.y + xz * v.z,
        xy * v.x + yy * v.y + yz * v.z,
        xz * v.x + yz * v.y + zz * v.z,
    )


@leaf
def patch_torque(damping, tangent, dt, normal, spin, touches, k, friction):
    """Torque on b [N m] of patch k about its centroid, zero for a point; its twist is updated.

    The springs and dashpots of the contact law, thought spread over the patch by depth, also resist what turns about
    the centroid: with second moments C of the patch, rocking at g = n × ω meets −d_n (C g) × n, and twisting a
    torsional spring k_t tr C with its dashpot, held by friction up to µ |F_n| √(tr C).
    # ASSUME: slip and twist do not weaken each other, and the gyration radius stands for the mean lever arm (for a
    # disc 0.707 R against 0.667 R).
    damping [N s/m]: d_n. spin [1/s]: angular velocity of b against a. touches: contacts or walls.
    """
    rocking = moments_times(touches.spread, k, cross(normal, spin))
    torque = scaled(-damping, cross(rocking, normal))
    if friction:
        return plus(torque, scaled(twisting_torque(tangent, dt, dot(normal, spin), touches, k), normal))
    return torque


@leaf
def twisting_torque(tangent, dt, rate, touches, k):
    """Torque [N m] about the normal against a patch that twists at `rate` [1/s]; the twist of row k is updated."""
    spread = touches.spread
    # Of a single vertex behind a wall the trace is zero but for rounding, of either sign.
    moment = max(spread[k, 0] + spread[k, 1] + spread[k, 2], 0.0)
    stiffness, damping = tangent.stiffness * moment, tangent.damping * moment
    twist = touches.twist[k] + rate * dt
    torque = -stiffness * twist - damping * rate
    limit = tangent.limit * np.sqrt(moment)
    if not abs(torque) < limit:  # also where there is no patch, which holds no twist
        torque = limit if torque > 0.0 else -limit
        twist = -(torque + damping * rate) / stiffness if stiffness > 0.0 else 0.0
    touches.twist[k] = twist
    return torque
