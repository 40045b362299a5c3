"""Coulomb friction with memory: a tangential spring and dashpot at each contact, cut back to µ |F_n| where it slips."""

from typing import NamedTuple

import numpy as np

from simcore.compilation import leaf
from simcore.dem.vectors import across, minus, negative, over, plus, scaled, squared


class Tangent(NamedTuple):
    """Coefficients of one contact along its tangent plane."""

    stiffness: float  # [N/m]
    damping: float  # [N s/m]
    limit: float  # [N], of Coulomb friction


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
