"""When a packing is at rest: rules from which a scene chooses one.

"still": every grain is at rest, since static friction holds it. "settled": for beds that creep because their friction
has no static spring. Such a bed counts as settled when the motion of fall and impact is gone (the kinetic energy of a
mean grain is a small share of m g d, the energy by which it could climb another) and when its solid fraction has ceased
to change by more than a stated share within a stated time. The solid fraction of a given mass goes with the inverse of
its mean height. Why no fixed time instead: docs/constants_packing.md.
"""

from typing import NamedTuple

import numpy as np

from simcore.packing.observation import Observation
from simcore.scene.impact import sphere_radius
from simcore.scene.scene import Convergence, Material


class Verdict(NamedTuple):
    """Whether a packing is at rest, and by how much of each measure, for messages."""

    at_rest: bool
    told: str


def judge_still(goal: Convergence, seen: Observation, before: float) -> Verdict:
    """By rule "still". before [m]: mean height one interval ago."""
    change = abs(seen.mean_height - before)
    return Verdict(
        change < goal.height_change
        and seen.max_speed < goal.max_speed
        and seen.unbalanced_force < goal.max_unbalanced_force,
        f"mean height changed by {change:.2g} m in {goal.interval:g} s (allowed {goal.height_change:g}), unbalanced "
        f"force {seen.unbalanced_force:.2g} (allowed {goal.max_unbalanced_force:g})",
    )


def judge_settled(goal: Convergence, material: Material, seen: Observation, checks, since, mass, grains) -> Verdict:
    """By rule "settled".

    checks: (time [s], phase, Observation) of all checks, the last being now. since [s]: the earliest time that counts.
    mass [kg], grains: of the packing.
    """
    now = checks[-1][0]
    size = 2.0 * float(sphere_radius(mass / grains, material.density))
    share = seen.kinetic_energy / (mass * material.effective_gravity * size)
    begin = now - goal.window
    # Half an interval for the rounding of times that are whole numbers of steps.
    earlier = [look.mean_height for time, _, look in checks if since <= time <= begin + 0.5 * goal.interval]
    compaction = abs(earlier[-1] / seen.mean_height - 1.0) if earlier else np.inf
    return Verdict(
        share < goal.kinetic_energy and compaction < goal.compaction,
        f"kinetic energy {share:.2g} m g d per grain (allowed {goal.kinetic_energy:g}), solid fraction changed by "
        f"{compaction:.2g} of itself in {goal.window:g} s (allowed {goal.compaction:g})",
    )
