"""Hertzian normal force with a viscous term: F = k (ξ^1.5 + τ √ξ ξ'), beside the linear spring-dashpot.

The text of Baram & Lind (arXiv:1110.2792) lacks the formula. Its words describe a Hertzian force k ξ^1.5 with a viscous
term whose coefficient is large, so that grains come to rest quickly. We take γ √ξ ξ' with γ = τ k, after Kuwabara and
Kono, not γ ξ'. Viscoelastic spheres behave so (Brilliantov et al. 1996); the term vanishes where a contact begins, so
that the force has no jump there; and its dashpot grows as the spring does, so that one limit of the time step holds for
both.

At its present overlap a Hertzian contact is one of the linear law with the stiffness k √ξ and the damping τ k √ξ. So
all functions of the linear law are used unchanged, with the coefficients of that overlap. Along the tangent a spring is
as stiff as Mindlin's without slip, 2 (1 - ν) / (2 - ν) of dF/dξ = 1.5 k √ξ.

k = B √R with the effective radius R of spheres of the grains' masses; B = (4/3) E*; see simcore.scene.impact.
"""

from typing import NamedTuple

import numpy as np

from simcore.compilation import leaf
from simcore.dem.forces.spring_dashpot import ContactLaw
from simcore.scene.impact import Hertzian

TANGENT = 1.5  # slope of the force over its ratio to the overlap
STORED = 0.8  # energy of the normal force, (2/5) k ξ^2.5, over half of stiffness times overlap squared


class HertzLaw(NamedTuple):
    """Coefficients of all contacts of a scene."""

    modulus: float  # [Pa], B
    damping_time: float  # [s], τ
    tangential: float  # stiffness of the tangential spring over k √ξ
    root_tangential: float  # of the dashpots
    friction: float
    sliding: float  # [1/s], see simcore.dem.forces.sliding_friction
    size: float  # [m/kg^(1/3)], radius of a sphere over the cube root of its mass


def hertz_law(hertzian: Hertzian, poisson_ratio, friction, density, sliding=0.0) -> HertzLaw:
    """The law of grains of that density [kg/m³]; sliding [1/s]: rate of the dynamic friction."""
    ratio = 2.0 * (1.0 - poisson_ratio) / (2.0 - poisson_ratio)
    size = float(np.cbrt(3.0 / (4.0 * np.pi * density)))
    return HertzLaw(
        hertzian.modulus, hertzian.damping_time, TANGENT * ratio, float(np.sqrt(ratio)), friction, sliding, size
    )


@leaf
def law_at(law, mass, partner_mass, overlap):
    """The linear law that equals this one at that overlap [m], per effective mass. partner_mass: inf for a wall."""
    effective = mass / (1.0 + mass / partner_mass)
    radius, partner_radius = law.size * np.cbrt(mass), law.size * np.cbrt(partner_mass)
    radius = radius / (1.0 + radius / partner_radius)
    stiffness = law.modulus * np.sqrt(radius * overlap) / effective
    return ContactLaw(
        stiffness, law.damping_time * stiffness, law.tangential, law.root_tangential, law.friction, 0.0, law.sliding
    )


@leaf
def contact_law_at(law, bodies, contacts, p):
    """The linear law of touching contact p."""
    return law_at(law, bodies.mass[contacts.body_a[p]], bodies.mass[contacts.body_b[p]], contacts.overlap[p])


@leaf
def wall_law_at(law, bodies, walls, w):
    """The linear law of touching wall w."""
    return law_at(law, bodies.mass[walls.body[w]], np.inf, walls.overlap[w])


def linear_law(law: HertzLaw, mass, partner_mass, overlap) -> ContactLaw:
    """The linear law whose small motions are those about that overlap; arguments and its fields may be arrays."""
    at = law_at.py_func(law, mass, partner_mass, overlap)
    return at._replace(stiffness=TANGENT * at.stiffness, tangential=at.tangential / TANGENT)


def local_law(law, mass, partner_mass, overlap) -> tuple[ContactLaw, float]:
    """(linear law of contacts at their overlaps, share of ½ stiffness overlap² that their springs store); (k,) arrays.

    law: of either kind; a linear law is returned as it is.
    """
    if isinstance(law, HertzLaw):
        return law_at.py_func(law, mass, partner_mass, overlap), STORED
    return law, 1.0
