"""Hertzian normal force with a viscous term: F = k (ξ^1.5 + τ √ξ ξ'), an alternative to the linear spring-dashpot.

The formula is missing from the text of Baram & Lind (arXiv:1110.2792). The text describes a Hertzian force k ξ^1.5 with
a viscous term whose coefficient is large, so that grains come to rest quickly. We use γ √ξ ξ' with γ = τ k, after
Kuwabara and Kono, not γ ξ', for three reasons. Viscoelastic spheres have this term (Brilliantov et al. 1996). It
vanishes where a contact begins, so that the force has no jump there. Its dashpot grows as the spring does, so that one
limit of the time step applies to both.

At its present overlap a Hertzian contact equals one of the linear law with the stiffness k √ξ and the damping τ k √ξ.
All functions of the linear law are therefore used unchanged, with the coefficients of that overlap. The tangential
stiffness is that of Mindlin without slip, 2 (1 - ν) / (2 - ν) times dF/dξ = 1.5 k √ξ.

k = B √R with the effective radius R of spheres of the grains' masses; B = (4/3) E*; see simcore.scene.impact.
"""

from typing import NamedTuple

import numpy as np

from simcore.compilation import leaf
from simcore.dem.forces.spring_dashpot import ContactLaw
from simcore.scene.impact import Hertzian

TANGENT = 1.5  # ratio of the slope dF/dξ to F/ξ
STORED = 0.8  # ratio of the elastic energy (2/5) k ξ^2.5 to half of stiffness times overlap squared


class HertzLaw(NamedTuple):
    """Coefficients of all contacts of a scene."""

    modulus: float  # [Pa], B
    damping_time: float  # [s], τ
    tangential: float  # ratio of the stiffness of the tangential spring to k √ξ
    root_tangential: float  # ratio of the tangential to the normal dashpot
    friction: float
    sliding: float  # [1/s], see simcore.dem.forces.viscous_friction
    size: float  # [m/kg^(1/3)], ratio of the radius of a sphere to the cube root of its mass


def hertz_law(hertzian: Hertzian, poisson_ratio, friction, density, sliding=0.0) -> HertzLaw:
    """Return the law for grains of this density [kg/m³]; sliding [1/s]: rate of the dynamic friction."""
    ratio = 2.0 * (1.0 - poisson_ratio) / (2.0 - poisson_ratio)
    size = float(np.cbrt(3.0 / (4.0 * np.pi * density)))
    return HertzLaw(
        hertzian.modulus, hertzian.damping_time, TANGENT * ratio, float(np.sqrt(ratio)), friction, sliding, size
    )


@leaf
def law_at(law, mass, partner_mass, overlap):
    """Return the linear law, per effective mass, equal to this one at an overlap [m]. partner_mass: inf for walls."""
    effective = mass / (1.0 + mass / partner_mass)
    radius, partner_radius = law.size * np.cbrt(mass), law.size * np.cbrt(partner_mass)
    radius = radius / (1.0 + radius / partner_radius)
    stiffness = law.modulus * np.sqrt(radius * overlap) / effective
    return ContactLaw(
        stiffness, law.damping_time * stiffness, law.tangential, law.root_tangential, law.friction, 0.0, law.sliding
    )


@leaf
def contact_law_at(law, bodies, contacts, p, overlap):
    """Return the linear law of touching contact p at its overlap [m]."""
    return law_at(law, bodies.mass[contacts.body_a[p]], bodies.mass[contacts.body_b[p]], overlap)


@leaf
def wall_law_at(law, bodies, walls, w):
    """Return the linear law of touching wall w."""
    return law_at(law, bodies.mass[walls.body[w]], np.inf, walls.overlap[w])


def linear_law(law: HertzLaw, mass, partner_mass, overlap) -> ContactLaw:
    """Return the linear law for small motions about an overlap [m]; arguments and fields may be arrays."""
    at = law_at.py_func(law, mass, partner_mass, overlap)
    return at._replace(stiffness=TANGENT * at.stiffness, tangential=at.tangential / TANGENT)


def local_law(law, mass, partner_mass, overlap) -> tuple[ContactLaw, float]:
    """Return (linear law of contacts at their overlaps, share of ½ stiffness overlap² that is elastic energy).

    mass, partner_mass, overlap: (k,) arrays. law: of either kind; a linear law is returned unchanged.
    """
    if isinstance(law, HertzLaw):
        return law_at.py_func(law, mass, partner_mass, overlap), STORED
    return law, 1.0
