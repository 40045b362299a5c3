"""Impacts of viscoelastic spheres after Hertz, Kuwabara and Kono: how long, how deep, how elastic; no numba.

Two spheres of effective mass m and radius R push with F = k (ξ^1.5 + τ √ξ ξ'), k = B √R, B = (4/3) E*,
1/E* = (1 - ν²)/E + (1 - ν²)/E, at the overlap ξ. In units of the length (m v² / k)^0.4 and of the time it takes at the
speed v the impact is x'' = -√x (x + β x'), x(0) = 0, x'(0) = 1, with the one number β = τ v / (m v² / k)^0.4. So
the restitution depends on β alone, and 1 - e = 1.1534 β - ... falls with v^(1/5).

Without τ the duration is 2.9433 of largest overlap over speed, that is 3.2182 (m² / (k² v))^(1/5) of this k, or 2.94 of
the (4/5) k of Landau & Lifshitz, Theory of Elasticity, § 9.

Sources: Kuwabara & Kono 1987; Ramírez, Pöschel, Brilliantov & Schwager 1999; clamped: Schwager & Pöschel 2008.
"""

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

# 2 ∫ dx / √(1 - x^2.5) from 0 to 1 = (4/5) B(2/5, 1/2)
DURATION = 0.8 * math.gamma(0.4) * math.gamma(0.5) / math.gamma(0.9)
NO_RETURN = 200.0  # in units of the impact; elastic ones are over after 3.2


class Hertzian(NamedTuple):
    """What a specification asks for, as numbers of the force law, and the impact that its time step resolves."""

    modulus: float  # [Pa], B: (4/3) E*
    damping_time: float  # [s], τ
    duration: float  # [s], of the shortest elastic impact that is expected
    least_mass: float  # [kg], of the two grains that meet in it
    deepest: float  # [m], their overlap


def sphere_radius(mass, density):
    """Radius [m] of the sphere of that mass [kg] and density [kg/m³]."""
    return np.cbrt(3.0 * mass / (4.0 * np.pi * density))


def impact_depth(modulus, mass, radius, speed):
    """Largest overlap [m] of an elastic impact; mass [kg], radius [m]: effective. Damping only makes it less."""
    return (1.25 * mass * speed**2 / (modulus * np.sqrt(radius))) ** 0.4


def impact_duration(modulus, mass, radius, speed):
    """Duration [s] of an elastic impact; arguments as of impact_depth."""
    return DURATION * impact_depth(modulus, mass, radius, speed) / speed


def damping_number(damping_time, modulus, mass, radius, speed):
    """β of an impact; arguments as of impact_depth."""
    return damping_time * speed / (mass * speed**2 / (modulus * np.sqrt(radius))) ** 0.4


def restitution(number: float, attractive: bool) -> float:
    """Restitution of an impact of damping number β >= 0.

    attractive: the contact ends where the overlap does and may pull before; else where the force vanishes. 0 where
    the spheres stick, as attractive ones do from some β on.
    """
    from scipy.integrate import solve_ivp  # here: slow to load, and linear contacts need none of it

    def motion(_, state):
        x, v = state
        return v, -math.sqrt(max(x, 0.0)) * (x + number * v)

    def end(_, state):
        return state[0] if attractive else state[0] + number * state[1]

    end.terminal, end.direction = True, -1.0
    if not attractive and number == 0.0:
        return 1.0
    found = solve_ivp(motion, (0.0, NO_RETURN), (0.0, 1.0), "DOP853", events=end, rtol=1e-10, atol=1e-12)
    return max(-float(found.y_events[0][0][1]), 0.0) if len(found.y_events[0]) else 0.0


@cache
def number_of_restitution(wanted: float, attractive: bool) -> float:
    """The damping number β whose restitution is `wanted`, in (0, 1]."""
    if wanted == 1.0:
        return 0.0
    many = 1.0
    while restitution(many, attractive) > wanted:
        many *= 2.0
    return float(brentq(lambda number: restitution(number, attractive) - wanted, 0.0, many, rtol=1e-8))


def fall_speed(generation, height, gravity) -> float:
    """Speed [m/s] of a grain that has fallen by `height` [m] from its birth; generation: with its velocities."""
    birth = generation.velocity_z**2 + 2.0 * generation.velocity_horizontal**2
    return float(np.sqrt(birth + 2.0 * gravity * height))


def derive_hertzian(material, mean_mass: float, least_mass: float, speed: float) -> Hertzian:
    """Hertzian of a Material of law "hertz".

    mean_mass, least_mass [kg]: of the packing's grains. speed [m/s]: of the fastest expected impact, of two of the
    least grains against each other: theirs is the shortest. ASSUME: grains that are no spheres, and the floor, are as
    stiff as spheres of the same mass; the curvature at the contact is left out, as in the source's law with one k.
    """
    radius, least = (float(sphere_radius(mass, material.density)) for mass in (mean_mass, least_mass))
    if material.youngs_modulus is not None:
        modulus = 2.0 / 3.0 * material.youngs_modulus / (1.0 - material.poisson_ratio**2)
    else:
        sunk = 2.0 * radius * material.overlap_at_rest
        modulus = mean_mass * material.effective_gravity / (np.sqrt(radius) * sunk**1.5)
    meeting = material.restitution_speed
    number = number_of_restitution(material.restitution, material.end_of_contact == "attractive")
    damping_time = number / damping_number(1.0, modulus, 0.5 * mean_mass, 0.5 * radius, meeting)
    pair = modulus, 0.5 * least_mass, 0.5 * least, speed
    return Hertzian(
        float(modulus), float(damping_time), float(impact_duration(*pair)), least_mass, float(impact_depth(*pair))
    )
