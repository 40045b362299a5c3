"""Messages of a packing about a problem: what is wrong, where, and what to change."""

from functools import singledispatch

import numpy as np

from simcore.dem.from_scene import stiffening_advice
from simcore.packing.run_checks import PINCHING, DeepImpact, DeepOverlap, EnergyGain, NotFinite, TooFast
from simcore.scene.height import in_mm

# Steps that a bed needs over the steps that its stiffest grain needs by itself: docs/explanation/constants_packing.md.
BED_STEP_FACTORS = (1.2, 1.35)


def steps_advice(scene) -> str:
    """Return the advice against a time step that is too long."""
    return f"raise numerics.steps_per_contact_time (now {scene.numerics.steps_per_contact_time:g})"


def about_stiffest(watch_state) -> str:
    """Return a clause on the number of steps that the stiffest grain needs. watch_state: WatchState."""
    one = watch_state.contacts == 1
    return (
        f"grain {watch_state.stiffest} with {watch_state.contacts} {'contact' if one else 'contacts'} alone needs "
        f"{watch_state.needed:.1f} steps per contact time, and a bed needs {BED_STEP_FACTORS[0]:g} to "
        f"{BED_STEP_FACTORS[1]:g} times as many"
    )


def hint(scene, watch_state) -> str:
    """Return an addition to a message if the time step may be too long for the stiffest grain, otherwise ""."""
    return f"; {about_stiffest(watch_state)}" if may_jitter(scene, watch_state) else ""


def may_jitter(scene, watch_state) -> bool:
    """Return whether the time step may be too long for the stiffest grain with its contacts in the bed."""
    return BED_STEP_FACTORS[1] * watch_state.needed > scene.numerics.steps_per_contact_time


def advice_on_rest(scene, watch_state) -> str:
    """Return the advice for a bed that does not come to rest."""
    if may_jitter(scene, watch_state):
        needed = int(np.ceil(BED_STEP_FACTORS[1] * watch_state.needed))
        steps = scene.numerics.steps_per_contact_time
        return f"Raise numerics.steps_per_contact_time from {steps:g} to at least {needed}."
    return (
        "Raise damping.max_time: the packing then resumes from its latest checkpoint, if it has one. Or shake longer, "
        "or loosen `convergence`."
    )


def describe_tolerated(scene, watch_state) -> list[str]:
    """Return a sentence for each exceeded limit that was tolerated while the packing ran."""
    lines = []
    if watch_state.warned_of_steps:
        steps = scene.numerics.steps_per_contact_time
        effect = (
            "It came to rest all the same, so that it is valid."
            if scene.convergence.rule == "still"
            else "The rule settled does not notice whether grains vibrate: compare it with a packing of more steps."
        )
        lines.append(f"At the stiffest moment {about_stiffest(watch_state)}; the packing had {steps:g}. {effect}")
    if watch_state.warned_of_pinching:
        lines.append(
            f"While grains fell, a grain at least {PINCHING:g} times lighter than the heaviest one overlapped another "
            f"by more than half of its thickness."
        )
    return lines


def overlapping(problem: DeepOverlap) -> str:
    """Return a clause on which grains overlap, and by how much."""
    partner = "the wall" if problem.partner < 0 else f"grain {problem.partner}"
    return f"grain {problem.grain} and {partner} overlap by {problem.overlap * 1e3:.3g} mm"


def few_steps_warning(scene, watch_state, step) -> str:
    """Return the warning that the stiffest grain needs more steps per contact time than the packing has."""
    return (
        f"{scene.name}: warning: at step {step} {about_stiffest(watch_state)}; this packing has "
        f"{scene.numerics.steps_per_contact_time:g}. Such a grain vibrates and gains energy until its contacts slip or "
        f"open. If the bed gains energy or does not come to rest, the packing stops with an error"
    )


def pinching_warning(scene, problem: DeepOverlap, step) -> str:
    """Return the warning that a pebble under stones overlaps deeply, which is tolerated while grains fall."""
    return (
        f"{scene.name}: warning: {overlapping(problem)} at step {step}, more than half of the grain's thickness. This "
        f"is tolerated only while grains fall, for grains {PINCHING:g} times lighter than the heaviest stone"
    )


def no_space(scene, inserted, top, bed_top, needed, largest) -> str:
    """Return the message that no batch can follow.

    top, bed_top [m]: heights of the highest grain and of the highest one that touches another. needed [m]: height that
    a batch needs above the bed. largest [m]: largest diameter.
    """
    height = scene.domain.height
    begin = f"{scene.name}: after {inserted} grains "
    # Grains are inserted below the top of the domain, so that one far above it was thrown there.
    if top > height + largest:
        return begin + (
            f"one is {in_mm(top)} mm above the floor, far above domain.height = {in_mm(height)} mm: it was "
            f"thrown, and there is no space for another batch. Most likely the time step is too long for its contacts: "
            f"{steps_advice(scene)}"
        )
    return begin + (
        f"the bed reaches {in_mm(bed_top)} mm, and a batch needs {in_mm(needed)} mm above it, but domain.height is "
        f"{in_mm(height)} mm. Make the domain higher or wider, or reduce {_smaller(scene.generation)}"
    )


def _smaller(generation):
    """Return the keys whose smaller values need less space for insertion, in words."""
    if generation.placement == "random":
        return "amount, generation.batch_grains or generation.drop_height"
    return "amount" if generation.fill == "r22" else "amount or generation.drop_height"


@singledispatch
def describe(problem, scene, step, watch_state) -> str:
    """Return the message about a problem of simcore.packing.run_checks.

    watch_state: WatchState, for hints on the step.
    """
    raise TypeError(f"no message describes {problem!r}")


@describe.register
def _(problem: NotFinite, scene, step, watch_state):
    return (
        f"{scene.name}: the position of grain {problem.grain} is not finite at step {step}. Most likely the time step "
        f"is too long: {steps_advice(scene)}"
    )


@describe.register
def _(problem: TooFast, scene, step, watch_state):
    return (
        f"{scene.name}: grain {problem.grain} moves at {problem.speed:.3g} m/s at step {step}, more than fall and "
        f"shaking can cause ({problem.limit:.3g} m/s). The time step is too long for its contacts "
        f"({steps_advice(scene)}), or grains overlapped when they were inserted (raise generation.spacing)"
    )


@describe.register
def _(problem: DeepImpact, scene, step, watch_state):
    return (
        f"{scene.name}: grain {problem.grain} moves at {problem.speed:.3g} m/s at step {step} and would overlap "
        f"what it hits by {problem.depth * 1e3:.3g} mm, more than half of the grain's thickness. "
        f"{stiffening_advice(scene)} Impacts then become shallower, and also if grains fall less far or are inserted "
        f"more slowly"
    )


@describe.register
def _(problem: DeepOverlap, scene, step, watch_state):
    return (
        f"{scene.name}: {overlapping(problem)} at step {step}, more than half of the grain's thickness: contacts are "
        f"too soft for the forces on them. {stiffening_advice(scene)} Overlaps also become smaller if grains fall less "
        f"far. If the grains overlapped from the start, raise generation.spacing"
    )


@describe.register
def _(problem: EnergyGain, scene, step, watch_state):
    return (
        f"{scene.name}: the energy grew by {problem.gained:.3g} J within {problem.time:.3g} s before step {step}, but "
        f"fall, shaking and springs explain at most {problem.allowed:.3g} J; grain {problem.grain} has the most "
        f"energy. The time step is too long for its contacts: {steps_advice(scene)}{hint(scene, watch_state)}"
    )
