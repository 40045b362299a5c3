"""Linear spring-dashpot with Coulomb friction.

Stiffness and damping follow from the restitution e_n and the contact time T_c of a pair of effective mass m:
k_n = m (π² + ln² e_n) / T_c², d_n = −2 m ln e_n / T_c, k_t = κ k_n, d_t = √κ d_n, κ = 2 (1 − ν) / (2 − ν).
With the attractive law the contact lasts T_c and its restitution is e_n. If forces are limited to F_n >= 0, the same
stiffness and damping give a higher restitution (0.2527 for e_n = 0.1; Schwager & Pöschel 2007).

An explicit dashpot acts on the velocity before the step. An implicit dashpot acts on the mean of the velocities before
and after the step, where the contact alone changes the velocity: v' = v + h F / m. With γ = d_n / m and ω² = k_n / m
that is F / m = ω² δ − γ (v + v') / 2, so F / m = (ω² δ − γ v) / (1 + γ h / 2). This is the central difference, of
second order, and for one contact it is stable up to h = 2 / ω for any damping. The same applies along the tangent with
γ_t = LEVER d_t / m.

All contacts of a grain change its velocity; `effective_contacts` is their weighted number. With c, the larger value of
the two grains, the dashpot is divided by 1 + (c − 1/2) γ h: half of its own share and all of the shares of the others.
The spring is not divided by this, because a bed at rest would become softer with each contact of a grain; all springs
are softer by 1 + γ h / 2.
"""

from typing import NamedTuple

import numpy as np

from simcore.compilation import leaf


class ContactLaw(NamedTuple):
    """Coefficients per effective mass: stiffness [1/s²], damping [1/s], ratio of tangential to normal, and its root."""

    stiffness: float
    damping: float
    tangential: float
    root_tangential: float
    friction: float
    step: float = 0.0  # [s], over which an implicit dashpot acts; 0 for an explicit one
    sliding: float = 0.0  # [1/s], rate of a friction without springs (simcore.dem.forces.viscous_friction)


LEVER = 3.5  # 1 + m r² / I of a sphere. ASSUME: used for all grains. Why: docs/explanation/constants.md#lever


def contact_law(
    restitution: float, contact_time: float, poisson_ratio: float, friction: float, sliding: float = 0.0
) -> ContactLaw:
    """Return the law of restitution (0, 1], contact time [s], Poisson's ratio, friction coefficient, sliding rate."""
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
    """Return the law with implicit dashpots over `step` [s]. Springs are divided by 1 + γ h / 2, each by its γ."""
    normal = 1.0 + 0.5 * law.damping * step
    tangential = 1.0 + 0.5 * LEVER * law.root_tangential * law.damping * step
    return law._replace(stiffness=law.stiffness / normal, tangential=law.tangential * normal / tangential, step=step)


@leaf
def explicit_dashpot(law):
    """Return normal and tangential damping per effective mass [1/s]."""
    return law.damping, law.root_tangential * law.damping


@leaf
def implicit_dashpot(law, effective_contacts):
    """Return normal and tangential damping per effective mass [1/s].

    effective_contacts: the larger value of the two grains, at least 1.
    """
    share = (effective_contacts - 0.5) * law.step
    tangential = law.root_tangential * law.damping
    return law.damping / (1.0 + share * law.damping), tangential / (1.0 + LEVER * share * tangential)


@leaf
def normal_force(law, damping, mass, overlap, un, attractive):
    """Return the normal force on b [N], positive if repulsive. un: velocity of b relative to a along the normal."""
    push = mass * (law.stiffness * overlap - damping * un)
    if not attractive:
        push = max(push, 0.0)
    return push
