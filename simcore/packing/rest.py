"""Rules for when a packing is at rest; a scene selects one of them.

Rule "still": every grain is at rest, held by static friction. Rule "settled" is for beds that creep because their
friction has no static spring. Such a bed is settled when the motion of fall and impact has died out (the kinetic energy
of a mean grain is a small share of m g d, the energy to climb over another grain), and when its solid fraction changes
by less than a given share within a given time. The solid fraction of a given mass is proportional to the inverse of its
mean height. docs/explanation/constants_packing.md explains why the rule is not a fixed time.
"""

from typing import NamedTuple

import numpy as np

from simcore.packing.observation import Observation
from simcore.scene.impact import sphere_radius
from simcore.scene.scene import Convergence, Material


class Verdict(NamedTuple):
    """Whether a packing is at rest, and the values of the measures in words, for messages."""

    at_rest: bool
    reason: str


def judge_still(goal: Convergence, observed: Observation, previous: float) -> Verdict:
    """Return the Verdict by rule "still". previous [m]: mean height one interval ago."""
    change = abs(observed.mean_height - previous)
    return Verdict(
        change < goal.height_change
        and observed.max_speed < goal.max_speed
        and observed.unbalanced_force < goal.max_unbalanced_force,
        f"mean height changed by {change:.2g} m in {goal.interval:g} s (allowed {goal.height_change:g}), unbalanced "
        f"force {observed.unbalanced_force:.2g} (allowed {goal.max_unbalanced_force:g})",
    )


def judge_settled(goal: Convergence, material: Material, observed: Observation, checks, since, mass, grains) -> Verdict:
    """Return the Verdict by rule "settled".

    checks: (time [s], phase, Observation) of all checks; the last one is the current one. since [s]: earliest time that
    counts. mass [kg] and number of grains: of the packing.
    """
    now = checks[-1][0]
    size = 2.0 * float(sphere_radius(mass / grains, material.density))
    share = observed.kinetic_energy / (mass * material.effective_gravity * size)
    begin = now - goal.window
    # Half an interval is added because the times of checks are rounded to whole steps.
    # If the interval is longer than the window, the previous check is the latest that is earlier.
    limit = begin + 0.5 * goal.interval
    earlier = [check.mean_height for time, _, check in checks[:-1] if since <= time <= limit]
    compaction = abs(earlier[-1] / observed.mean_height - 1.0) if earlier else np.inf
    return Verdict(
        share < goal.kinetic_energy and compaction < goal.compaction,
        f"kinetic energy {share:.2g} m g d per grain (allowed {goal.kinetic_energy:g}), solid fraction changed by "
        f"{compaction:.2g} (relative) in {goal.window:g} s (allowed {goal.compaction:g})",
    )
