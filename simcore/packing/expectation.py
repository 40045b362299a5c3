"""Estimates before the first step of a packing: steps per contact time, depth of impacts, and fit into the domain."""

from typing import NamedTuple

import numpy as np
from scipy.linalg import expm

from simcore.dem.forces.hertz import linear_law
from simcore.dem.forces.spring_dashpot import ContactLaw
from simcore.dem.from_scene import compose, stiffening_advice
from simcore.dem.random_contacts import estimate_implicit_steps
from simcore.dem.spread_contacts import Estimate, estimate_steps
from simcore.dem.stability import contact_time
from simcore.scene.impact import fall_speed as speed_after
from simcore.scene.impact import impact_depth, sphere_radius
from simcore.scene.scene import GRAINS, Scene
from simcore.scene.shapes import Base, grain_volumes

# ASSUME: ratio of the force on a grain at the floor to the pressure of the whole bed on its cross-section. Forces are
# distributed about exponentially: few of a grain's contacts carry more than four times the mean.
UNEVEN_FORCES = 4.0
DEEP_IMPACT = 0.5  # share of the thinnest grain's half thickness: a second grain that falls on top doubles the overlap

EXTREMES = 20_000  # grains of which the longest and the thinnest one are found
BACKING_STEPS = 400  # steps per contact time of the integration in `backing`


class Expectation(NamedTuple):
    """Estimates for a scene with its grains."""

    stability: Estimate
    fall_speed: float  # [m/s], of a grain that has fallen through the whole domain
    impact_depth: float  # [m], overlap when a grain hits at that speed
    half_thickness: float  # [m], of the thinnest grain
    longest: float  # [m], largest axis of a grain


def expect(scene: Scene, bases: list[Base], draw) -> Expectation:
    """Return the Expectation from the first grains of the packing. draw: as for `pack`."""
    drawn = draw(np.arange(min(GRAINS, scene.amount_grains or GRAINS)))
    stability = _estimate_stability(scene, bases, drawn)
    # Extreme grains are rare: the coarse ones of a wide sieve curve may not be among the first thousand.
    drawn = draw(np.arange(min(EXTREMES, scene.amount_grains or EXTREMES)))
    moments = np.array([base.second_moments for base in bases])[drawn.shape] * drawn.scale**2
    speed = fall_speed(scene)
    half_thickness, half_length = (float(np.sqrt(5.0 * moment)) for moment in (moments.min(), moments.max()))
    least = scene.hertzian.least_mass if scene.hertzian is not None else None
    depth = float(depth_of_impact(scene, speed, least))
    return Expectation(stability, speed, depth, half_thickness, 2.0 * half_length)


def _estimate_stability(scene, bases, drawn) -> Estimate:
    """Return the Estimate of the steps per contact time.

    With law hertz, `expected` uses the contacts of a bed at rest, and `cautious` assumes that all contacts are as deep
    as the deepest impact.
    """
    composition = compose(scene)
    grains = composition.features.friction, bases, drawn.shape, drawn.scale
    law = composition.continuous_law
    if scene.implicit:
        estimate = estimate_implicit_steps(law, *grains, _number_of_grains(scene, bases, drawn))
        return Estimate(*(max(steps, composition.least_steps) for steps in estimate))
    if scene.hertzian is None:
        return estimate_steps(law, *grains)
    time, least = scene.numerics.contact_time, scene.hertzian.least_mass
    at_rest = linear_law(composition.law, least, least, overlap_at_rest(scene, bases, drawn))
    expected = max(estimate_steps(at_rest, *grains, time=time).expected, composition.least_steps)
    return Estimate(expected, max(estimate_steps(law, *grains, time=time).cautious, expected))


def _number_of_grains(scene, bases, drawn) -> float:
    """Return the number of grains of the packing; where their mass is given, the number follows from the mean grain."""
    if scene.amount_grains is not None:
        return scene.amount_grains
    return max(scene.amount_mass / (scene.material.density * float(grain_volumes(bases, drawn).mean())), 1.0)


def overlap_at_rest(scene: Scene, bases: list[Base], drawn) -> float:
    """Return the largest overlap [m] of a contact of law hertz between two of the smallest grains at the floor."""
    material, least = scene.material, scene.hertzian.least_mass
    mass = scene.amount_mass or scene.amount_grains * material.density * float(grain_volumes(bases, drawn).mean())
    radius = sphere_radius(least, material.density)
    force = UNEVEN_FORCES * mass * material.effective_gravity / scene.domain.area * np.pi * radius**2
    return float((force / (scene.hertzian.modulus * np.sqrt(0.5 * radius))) ** (2.0 / 3.0))


def fall_speed(scene: Scene) -> float:
    """Return the speed [m/s] of a grain that has fallen through the domain since its insertion."""
    return speed_after(scene.generation, scene.domain.height, scene.material.effective_gravity)


def depth_of_impact(scene: Scene, speed, mass):
    """Return the overlap [m] of a grain that hits the floor at `speed` [m/s]. mass [kg]: not used by the linear law."""
    if scene.hertzian is None:
        return speed * relative_depth(compose(scene).continuous_law)
    return impact_depth(scene.hertzian.modulus, mass, sphere_radius(mass, scene.material.density), speed)


def relative_depth(law: ContactLaw) -> float:
    """Return the largest overlap of an impact over its speed [s]: exp(-β t) sin(ω t) / ω at tan(ω t) = ω / β."""
    rate, beta = np.pi / contact_time(law), 0.5 * law.damping
    phase = np.arctan2(rate, beta)
    return float(np.exp(-beta / rate * phase) * np.sin(phase) / rate)


def backing(scene: Scene) -> float:
    """Return the ratio of two overlaps: impact on an equally heavy grain on the floor, and `depth_of_impact`.

    With law hertz the ratio is 1: `depth_of_impact` is an impact on the floor, which is 2^(1/5) times deeper than one
    between two such grains.
    """
    if scene.hertzian is not None:
        return 1.0
    law = compose(scene).continuous_law
    stiffness, damping = law.stiffness, law.damping
    # State: downward displacements of the upper and the lower grain, then their speeds. The effective mass between the
    # two grains is half a grain's mass.
    rates = np.zeros((4, 4))
    rates[:2, 2:] = np.eye(2)
    rates[2:, :2] = stiffness * np.array([[-0.5, 0.5], [0.5, -1.5]])
    rates[2:, 2:] = damping * np.array([[-0.5, 0.5], [0.5, -1.5]])
    advance = expm(rates * contact_time(law) / BACKING_STEPS)
    state, deepest = np.array([0.0, 0.0, 1.0, 0.0]), 0.0
    for _ in range(2 * BACKING_STEPS):
        state = advance @ state
        deepest = max(deepest, state[0] - state[1])
    return float(deepest / relative_depth(law))


def _will_fail(scene, expected) -> str:
    """Return a sentence on an impact at which a packing stops with an error, or ""."""
    if expected.impact_depth * backing(scene) <= expected.half_thickness:
        return ""
    return "A packing stops with an error if such an impact is deeper than half of a grain's thickness. "


def _slower(scene):
    """Return a clause on the settings that make grains arrive more slowly; the larger part of their energy decides."""
    thrown = scene.generation.velocity_z
    if thrown**2 > 2.0 * scene.material.effective_gravity * scene.domain.height:
        return f"grains are inserted more slowly: raise generation.velocity_z, which is {thrown:g} m/s, towards 0"
    return "grains fall less far: lower domain.height or generation.drop_height"


def warnings(scene: Scene, expected: Expectation) -> list[str]:
    """Return a warning of one or two sentences for each thing that may go wrong."""
    lines = []
    steps, needed = scene.numerics.steps_per_contact_time, expected.stability
    if needed.expected > steps:
        digits = 1 if round(needed.expected, 1) > steps else 2
        lines.append(
            f"{steps:g} steps per contact time are fewer than the {needed.expected:.{digits}f} that a bed of such "
            f"grains is expected to need. The stiffest grains would vibrate and gain energy until their contacts slip "
            f"or open; the bed may not come to rest, or a grain may be thrown. Raise numerics.steps_per_contact_time "
            f"to at least {np.ceil(needed.expected):.0f}."
        )
    if expected.impact_depth > DEEP_IMPACT * expected.half_thickness:
        lines.append(
            f"A grain that falls through the domain arrives at {expected.fall_speed:.2g} m/s and overlaps another by "
            f"{expected.impact_depth * 1e3:.2g} mm, while the thinnest grain is "
            f"{2e3 * expected.half_thickness:.2g} mm thick. {_will_fail(scene, expected)}"
            f"{stiffening_advice(scene, DEEP_IMPACT * expected.half_thickness / expected.impact_depth)} "
            f"Impacts also become shallower if {_slower(scene)}."
        )
    width = scene.domain.width
    if expected.longest > width:
        periodic = scene.domain.type == "periodic"
        effect = "can touch its own periodic image" if periodic else "cannot lie flat, and may not come to rest"
        lines.append(
            f"The longest grain, {expected.longest * 1e3:.3g} mm, is longer than the domain is wide, "
            f"{width * 1e3:.3g} mm, and {effect}. Raise domain.width."
        )
    return lines
