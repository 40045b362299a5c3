"""Duration, overlap and restitution of impacts of viscoelastic spheres after Hertz, Kuwabara and Kono, without numba.

Two spheres of effective mass m and effective radius R with the overlap ξ repel each other by F = k (ξ^1.5 + τ √ξ ξ')
with k = B √R, B = (4/3) E*, 1/E* = (1 - ν²)/E + (1 - ν²)/E. With the unit of length (m v² / k)^0.4, and as unit of time
the time in which the speed v covers this length, the impact is x'' = -√x (x + β x'), x(0) = 0, x'(0) = 1. It has a
single parameter, β = τ v / (m v² / k)^0.4. So the restitution depends only on β, and 1 - e = 1.1534 β - ... is
proportional to v^(1/5) at leading order.

Without τ the duration is 2.9433 times the largest overlap over the speed, which is 3.2182 (m² / (k² v))^(1/5) with this
k, or 2.94 (m² / (k'² v))^(1/5) with k' = (4/5) k of Landau & Lifshitz, Theory of Elasticity, § 9.

Sources: Kuwabara & Kono 1987; Ramírez, Pöschel, Brilliantov & Schwager 1999; clamped: Schwager & Pöschel 2008.
"""

import math
from functools import cache
from typing import NamedTuple

import numpy as np

# 2 ∫ dx / √(1 - x^2.5) from 0 to 1 = (4/5) B(2/5, 1/2)
DURATION = 0.8 * math.gamma(0.4) * math.gamma(0.5) / math.gamma(0.9)
NO_RETURN = 200.0  # time after which spheres are regarded as stuck, in units of the impact; elastic ones last 3.2


class Hertzian(NamedTuple):
    """Parameters of the force law, and the shortest expected impact, which the time step resolves."""

    modulus: float  # [Pa], B = (4/3) E*
    damping_time: float  # [s], τ
    duration: float  # [s], of the shortest elastic impact that is expected
    least_mass: float  # [kg], of each of the two grains that collide in it
    deepest: float  # [m], largest overlap in it


def sphere_radius(mass, density):
    """Return the radius [m] of the sphere of this mass [kg] and density [kg/m³]."""
    return np.cbrt(3.0 * mass / (4.0 * np.pi * density))


def impact_depth(modulus, mass, radius, speed):
    """Return the largest overlap [m] of an elastic impact; damping only reduces it.

    modulus: B [Pa]; mass [kg] and radius [m]: effective; speed [m/s].
    """
    return (1.25 * mass * speed**2 / (modulus * np.sqrt(radius))) ** 0.4


def impact_duration(modulus, mass, radius, speed):
    """Return the duration [s] of an elastic impact; arguments as in impact_depth."""
    return DURATION * impact_depth(modulus, mass, radius, speed) / speed


def damping_number(damping_time, modulus, mass, radius, speed):
    """Return β of an impact; damping_time: τ [s], other arguments as in impact_depth."""
    return damping_time * speed / (mass * speed**2 / (modulus * np.sqrt(radius))) ** 0.4


def restitution(number: float, attractive: bool) -> float:
    """Return the coefficient of restitution of an impact with the damping number β = `number` >= 0.

    attractive: whether the contact ends when the overlap vanishes, so that the force may pull before; otherwise it ends
    when the force vanishes. The result is 0 if the spheres stick, as attractive ones do above some β.
    """
    from scipy.integrate import solve_ivp  # imported here because it loads slowly and linear contacts do not need it

    def motion(_, state):
        x, v = state
        return v, -math.sqrt(max(x, 0.0)) * (x + number * v)

    def end(_, state):
        return state[0] if attractive else state[0] + number * state[1]

    end.terminal, end.direction = True, -1.0
    if not attractive and number == 0.0:
        return 1.0
    solution = solve_ivp(motion, (0.0, NO_RETURN), (0.0, 1.0), "DOP853", events=end, rtol=1e-10, atol=1e-12)
    return max(-float(solution.y_events[0][0][1]), 0.0) if len(solution.y_events[0]) else 0.0


@cache
def number_of_restitution(wanted: float, attractive: bool) -> float:
    """Return the damping number β whose restitution is `wanted`, in (0, 1]."""
    from scipy.optimize import brentq  # imported here because it loads slowly and linear contacts do not need it

    if wanted == 1.0:
        return 0.0
    upper = 1.0
    while restitution(upper, attractive) > wanted:
        upper *= 2.0
    return float(brentq(lambda number: restitution(number, attractive) - wanted, 0.0, upper, rtol=1e-8))


def fall_speed(generation, height, gravity) -> float:
    """Return the speed [m/s] of a grain that has fallen by `height` [m] since its insertion.

    generation: group with the velocities at insertion [m/s]; gravity [m/s²].
    """
    squared_at_insertion = generation.velocity_z**2 + 2.0 * generation.velocity_horizontal**2
    return float(np.sqrt(squared_at_insertion + 2.0 * gravity * height))


def derive_hertzian(material, mean_mass: float, least_mass: float, speed: float) -> Hertzian:
    """Return the Hertzian of a Material of law "hertz".

    mean_mass, least_mass: of the packing's grains [kg]. speed: of the fastest expected impact [m/s]; the shortest
    impact is that of two of the lightest grains at this speed. ASSUME: grains that are not spheres, and the floor, are
    as stiff as spheres of the same mass; the curvature at the contact is neglected, as in the law of the source with
    one k.
    """
    radius, least = (float(sphere_radius(mass, material.density)) for mass in (mean_mass, least_mass))
    if material.youngs_modulus is not None:
        modulus = 2.0 / 3.0 * material.youngs_modulus / (1.0 - material.poisson_ratio**2)
    else:
        overlap = 2.0 * radius * material.overlap_at_rest
        modulus = mean_mass * material.effective_gravity / (np.sqrt(radius) * overlap**1.5)
    impact_speed = material.restitution_speed
    number = number_of_restitution(material.restitution, material.end_of_contact == "attractive")
    damping_time = number / damping_number(1.0, modulus, 0.5 * mean_mass, 0.5 * radius, impact_speed)
    pair = modulus, 0.5 * least_mass, 0.5 * least, speed
    return Hertzian(
        float(modulus), float(damping_time), float(impact_duration(*pair)), least_mass, float(impact_depth(*pair))
    )
