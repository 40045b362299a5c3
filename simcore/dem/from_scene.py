"""From a scene to its time step: the parts of the step, the force laws and the limits of the time step."""

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass

from simcore.dem.forces.hertz import HertzLaw, hertz_law, linear_law
from simcore.dem.forces.spring_dashpot import ContactLaw, contact_law, implicit_law
from simcore.dem.forces.viscous_friction import CAPPED, NONE, VISCOUS
from simcore.dem.stability import longest_stable_step, minimum_steps_per_contact_time
from simcore.dem.state.features import Features
from simcore.scene.quantity import rounded_down, rounded_up
from simcore.scene.scene import SPRUNG, Scene
from simcore.scene.shapes import ELLIPSOID, MIXED, POLYHEDRON

# Steps per contact time with which packings of the default material came to rest: `snakemake work_precision`, rest.csv.
STEPS_FOR_REST = {"explicit": 40, "implicit": 10}


@dataclass(frozen=True, eq=False)
class Composition:
    """The step of a scene: its parts and the laws of its contacts."""

    features: Features
    law: ContactLaw | HertzLaw  # as the time step applies it
    # The limit of `law` for small time steps; for law hertz, the linear law of the stiffest expected contact.
    continuous_law: ContactLaw
    stiffest_law: ContactLaw  # linear law of the stiffest expected contacts
    least_steps: float  # per contact time; with fewer, a grain pinched between two others is unstable
    # Factor on springs and dashpots relative to continuous_law, see stability.stiffest_body; None: all factors are 1.
    stiffness_factor: Callable | None


@functools.lru_cache
def compose(scene: Scene) -> Composition:
    """Return the parts and laws of the step of a scene. ValueError if its time step is unstable in any bed."""
    law, continuous = _laws(scene)
    hertz = scene.hertzian is not None
    composition = Composition(
        features=_features(scene),
        law=law,
        continuous_law=continuous,
        stiffest_law=continuous if hertz else law,
        least_steps=_least_steps(scene, continuous),
        stiffness_factor=_stiffness_factor(law, continuous.stiffness) if hertz else None,
    )
    _check_steps(scene, composition)
    return composition


def _features(scene: Scene) -> Features:
    springs = scene.material.friction > 0.0 and scene.material.friction_law in SPRUNG
    return Features(
        kind=scene.kind,
        friction=springs,
        attractive=scene.material.end_of_contact == "attractive",
        floor=True,
        cylinder=not scene.domain.periodic,
        periodic=scene.domain.periodic,
        shaken=scene.shaking.amplitude > 0.0,
        patch=scene.kind in (POLYHEDRON, MIXED) and scene.numerics.polyhedron_contact == "patch",
        implicit=scene.implicit,
        potential=scene.kind == ELLIPSOID and scene.numerics.ellipsoid_contact == "potential",
        hertz=scene.hertzian is not None,
        sliding=_sliding(scene),
        preloaded=springs and scene.material.friction_law == "preloaded",
        inflated=scene.numerics.polyhedron_contact == "inflated",
    )


def _sliding(scene: Scene) -> int:
    """Return the friction against the sliding velocity, a constant of simcore.dem.forces.viscous_friction."""
    if scene.material.friction_law == "dynamic":
        return CAPPED if scene.material.friction > 0.0 else NONE
    return VISCOUS if scene.material.friction_law == "viscous" else NONE


def _laws(scene: Scene) -> tuple[ContactLaw | HertzLaw, ContactLaw]:
    """Return the law as the time step of the scene applies it, and the continuous one."""
    m, hertzian = scene.material, scene.hertzian
    sliding_rate = 1.0 / m.sliding_time if _sliding(scene) != NONE else 0.0
    if hertzian is not None:
        law = hertz_law(hertzian, m.poisson_ratio, m.friction, m.density, sliding_rate)
        return law, linear_law(law, hertzian.least_mass, hertzian.least_mass, hertzian.deepest)
    law = contact_law(m.restitution, scene.numerics.contact_time, m.poisson_ratio, m.friction, sliding_rate)
    return implicit_law(law, scene.numerics.time_step) if scene.implicit else law, law


def _least_steps(scene: Scene, law: ContactLaw) -> float:
    """Return the minimum steps per contact time of a grain pinched between two others. law: the continuous one."""
    if scene.hertzian is None:
        steps = minimum_steps_per_contact_time(law, scene.implicit)
    else:
        steps = scene.numerics.contact_time / longest_stable_step(law, False)
    return max(steps, _sliding_steps(scene, law))


def _sliding_steps(scene, law):
    """Return the minimum steps per contact time of a sphere that turns between two others, against their friction.

    Its moment of inertia is 2/5 m r², so that two contacts slow its rotation down at five times the rate of sliding. An
    explicit step is stable if it is shorter than two over this rate.
    """
    return 5.0 / 2.0 * law.sliding * scene.numerics.contact_time


def _stiffness_factor(law: HertzLaw, unit: float) -> Callable:
    """Return the function stiffness_factor of Composition. unit [1/s²]: stiffness of the continuous law."""
    return lambda mass, partner, overlap: linear_law(law, mass, partner, overlap).stiffness / unit


def _check_steps(scene: Scene, composition: Composition):
    """Raise ValueError if the scene has fewer steps per contact time than its least_steps."""
    steps, dashpot, needed = scene.numerics.steps_per_contact_time, scene.numerics.dashpot, composition.least_steps
    sliding = _sliding_steps(scene, composition.continuous_law)
    if steps < sliding:
        now = scene.material.sliding_time
        raise ValueError(
            f"material.sliding_time: {now:g} s is too short for {steps:g} steps per contact time, because the friction "
            f"would reverse the rotation of a grain between two others within a step. Give at least "
            f"{rounded_up(now * sliding / steps):g} s, or raise numerics.steps_per_contact_time to at least "
            f"{math.ceil(sliding)}."
        )
    if steps < needed:
        advised = max(STEPS_FOR_REST[dashpot], math.ceil(needed))
        raise ValueError(
            f"numerics.steps_per_contact_time: {steps:g} is unstable for a grain pinched between two others. At "
            f"restitution {scene.material.restitution:g} with an {dashpot} dashpot, at least {needed:.2f} steps are "
            f"needed. Set {advised}, so that grains with many contacts also come to rest."
        )


def stiffening_advice(scene: Scene, factor: float | None = None) -> str:
    """Return a sentence with the setting that makes contacts stiffer and its present value.

    factor: of the depth of impacts that is wanted, in proportion to the contact time; None if it is unknown.
    """
    material = scene.material
    if material.youngs_modulus is not None:
        return f"Raise material.youngs_modulus, which is {material.youngs_modulus:g} Pa, to make contacts stiffer."
    if material.overlap_at_rest is not None:
        return f"Lower material.overlap_at_rest, which is {material.overlap_at_rest:g}, to make contacts stiffer."
    now = scene.numerics.contact_time
    least = "" if factor is None else f" to at most {rounded_down(factor * now):g} s"
    return f"Shorten numerics.contact_time, which is {now:g} s,{least or ' to make contacts stiffer'}."
