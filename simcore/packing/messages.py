"""What a packing tells its user about a problem, in whole sentences: what is wrong, where, and what to change."""

from functools import singledispatch

import numpy as np

from simcore.dem.from_scene import stiffening_advice
from simcore.packing.run_checks import PINCHING, DeepImpact, DeepOverlap, EnergyGain, NotFinite, TooFast

BED_STEP_FACTORS = (
    1.2,
    1.35,
)  # steps of a bed over those of its stiffest grain by itself; docs/constants_packing.md


def steps_advice(scene) -> str:
    """What to do about a time step that is too long."""
    return f"raise numerics.steps_per_contact_time (now {scene.numerics.steps_per_contact_time:g})"


def about_stiffest(memory) -> str:
    """The steps that the stiffest grain needs. memory: WatchState."""
    return (
        f"grain {memory.stiffest} with {memory.contacts} contacts alone needs {memory.needed:.1f} steps a contact "
        f"time, a bed {BED_STEP_FACTORS[0]:g} to {BED_STEP_FACTORS[1]:g} times that"
    )


def hint(scene, memory) -> str:
    """An addition to a message where the time step may be too long for the stiffest grain, or nothing."""
    return f"; {about_stiffest(memory)}" if may_jitter(scene, memory) else ""


def may_jitter(scene, memory) -> bool:
    """Whether the time step may be too long for the stiffest grain, as it was held in the bed."""
    return BED_STEP_FACTORS[1] * memory.needed > scene.numerics.steps_per_contact_time


def advice_on_rest(scene, memory) -> str:
    """The sentence that says what helps a bed that does not come to rest."""
    if may_jitter(scene, memory):
        enough = int(np.ceil(BED_STEP_FACTORS[1] * memory.needed))
        steps = scene.numerics.steps_per_contact_time
        return f"Raise numerics.steps_per_contact_time from {steps:g} to at least {enough}."
    return "Shake or damp longer, or loosen `convergence`."


def let_pass(scene, memory) -> list[str]:
    """A sentence for each thing that was let pass while the packing ran."""
    lines = []
    if memory.warned_of_steps:
        steps = scene.numerics.steps_per_contact_time
        lines.append(f"At its stiffest {about_stiffest(memory)}, and the packing had {steps:g}.")
    if memory.warned_of_pinching:
        lines.append(
            f"While grains fell, a stone of at least {PINCHING:g} times the mass of a grain pressed it deeper than "
            f"half of its thickness."
        )
    return lines


def overlapping(problem: DeepOverlap) -> str:
    """Which grains overlap, and by how much."""
    partner = "the wall" if problem.partner < 0 else f"grain {problem.partner}"
    return f"grain {problem.grain} and {partner} overlap by {problem.overlap * 1e3:.3g} mm"


def few_steps_warning(scene, memory, step) -> str:
    """The stiffest grain needs more steps than there are."""
    return (
        f"{scene.name}: warning: at step {step} {about_stiffest(memory)}, and this run has "
        f"{scene.numerics.steps_per_contact_time:g}. Such a grain jitters in its contacts and takes up energy until "
        f"they slip or part. If the bed gains energy or does not come to rest, the run stops"
    )


def pinching_warning(scene, problem: DeepOverlap, step) -> str:
    """A stone lands deep in a pebble, which is allowed while grains fall."""
    return (
        f"{scene.name}: warning: {overlapping(problem)} at step {step}, more than half of the grain is thick; let pass "
        f"while grains fall where a stone of {PINCHING:g} times the mass lands on a grain, and only then"
    )


@singledispatch
def describe(problem, scene, step, memory) -> str:
    """The message about a problem of simcore.packing.run_checks. memory: WatchState, for what it says of the step."""
    raise TypeError(f"no message describes {problem!r}")


@describe.register
def _(problem: NotFinite, scene, step, memory):
    return (
        f"{scene.name}: the position of grain {problem.grain} is not finite at step {step}; most likely the time step "
        f"is too long: {steps_advice(scene)}"
    )


@describe.register
def _(problem: TooFast, scene, step, memory):
    return (
        f"{scene.name}: grain {problem.grain} moves at {problem.speed:.3g} m/s at step {step}, more than fall and "
        f"shaking can give ({problem.limit:.3g} m/s). The time step is too long for its contacts "
        f"({steps_advice(scene)}), or grains overlapped when they were inserted (raise generation.spacing)"
    )


@describe.register
def _(problem: DeepImpact, scene, step, memory):
    return (
        f"{scene.name}: grain {problem.grain} moves at {problem.speed:.3g} m/s at step {step} and would sink "
        f"{problem.depth * 1e3:.3g} mm into what it meets, more than half of it is thick. "
        f"{stiffening_advice(scene)} Impacts become shallower then, and also if grains fall less far"
    )


@describe.register
def _(problem: DeepOverlap, scene, step, memory):
    return (
        f"{scene.name}: {overlapping(problem)} at step {step}, more than half of the grain is thick: contacts are too "
        f"soft for what presses on them. {stiffening_advice(scene)} Overlaps also become smaller if grains fall less "
        f"far. If the grains overlapped from the start, raise generation.spacing"
    )


@describe.register
def _(problem: EnergyGain, scene, step, memory):
    return (
        f"{scene.name}: {problem.gained:.3g} J came from nowhere within {problem.time:.3g} s before step {step}, of "
        f"which fall, shaking and springs explain {problem.allowed:.3g} J; grain {problem.grain} has most of all. The "
        f"time step is too long for its contacts: {steps_advice(scene)}{hint(scene, memory)}"
    )
