"""Coulomb friction with history: a tangential spring and dashpot at each contact; slip limits the force to µ |F_n|."""

from typing import NamedTuple

import numpy as np

from simcore.compilation import leaf
from simcore.dem.vectors import across, minus, negative, over, plus, scaled, squared


class Tangent(NamedTuple):
    """Coefficients of one contact in its tangent plane."""

    stiffness: float  # [N/m]
    damping: float  # [N s/m]
    limit: float  # [N], of Coulomb friction


@leaf
def tangent_of(law, damping, mass, push):
    """Return the Tangent for the normal force `push` [N]. damping: tangential, per effective mass. mass: effective."""
    return Tangent(law.tangential * law.stiffness * mass, damping * mass, law.friction * abs(push))


@leaf
def tangential_force(tangent, dt, normal, velocity, spring):
    """Return the tangential force on b [N] and the new tangential spring [m], both vectors.

    velocity: of b relative to a at the contact point. The spring is turned into the new tangent plane at constant
    length and extended by the tangential velocity. If the contact slips, it is shortened to the limit of friction.
    # ASSUME: it is not turned if both bodies spin about the normal together.
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
    """Return the spring [m] of contact k by the preloaded law: it is loaded to the limit where sticking begins.

    The program of Rettinger et al. (2022) does this at the first touch and at the end of slip. The tangential force of
    that step is not changed, but from the next step on the spring pushes with the limit of friction, even after a small
    displacement. A contact without tangential force sticks at rest. This is not a law of friction (a sphere with an
    almost normal impact is thrown aside); it serves to measure the effect on packings. force, spring: results of
    `tangential_force`, which also takes the other arguments. stuck: (m,) uint8, whether each contact stuck in the step
    before; the value of k is updated.
    """
    size = np.sqrt(squared(force))
    sticks = size < (1.0 - 1e-12) * tangent.limit  # a slipping contact has the limit as its force, to rounding
    if sticks and stuck[k] == 0 and size > 0.0:
        drag = scaled(tangent.damping, across(velocity, normal))
        spring = over(negative(plus(scaled(tangent.limit / size, force), drag)), tangent.stiffness)
    stuck[k] = sticks
    return spring
