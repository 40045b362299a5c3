"""How far a running packing is: read from its progress lines (progress.py) and its estimated cost (cost.py)."""

import re
from typing import NamedTuple

from simcore.packing.cost import PackingCost
from simcore.packing.packed import DAMPING, GENERATING, SHAKING

_LINE = re.compile(
    rf"(?P<name>.*): (?P<phase>{GENERATING}|{SHAKING}|{DAMPING}), t = (?P<time>\S+) s, (?P<grains>\d+) grains, "
    r".*?, (?P<rate>\S+) steps/s, \S+ (?P<left>\S+) s left.*"
)


class ProgressLine(NamedTuple):
    """What a progress line of a packing reports."""

    name: str  # of the packing
    phase: str
    time: float  # [s], simulated
    grains: int  # inserted so far
    rate: float  # steps per second of wall-clock time
    left: float  # [s], wall-clock time to the end of the shaking, or to the limit of damping


class Outlook(NamedTuple):
    """How far a packing is."""

    share: float  # of its steps that are done, 0 to 1; nan if its cost is not known
    left: float  # [s], wall-clock time until it is expected to rest; nan if not known


def parse_progress(line: str) -> ProgressLine | None:
    """Return what a line of a packing's log reports, or None if it is no progress line."""
    match = _LINE.fullmatch(line.strip())
    if match is None:
        return None
    time, rate, left = (float(match[name]) for name in ("time", "rate", "left"))
    return ProgressLine(match["name"], match["phase"], time, int(match["grains"]), rate, left)


def outlook(line: ProgressLine, cost: PackingCost | None) -> Outlook:
    """Return the Outlook of a packing from its last progress line and its estimated cost.

    cost: None, if it cannot be estimated; the Outlook is then nan. The cost of a step is assumed to be proportional to
    the number of grains. While grains are inserted, the remaining steps are those of the
    estimate with, on average, the mean of the present and the final number of grains. The end of shaking is known. The
    end of damping is only expected, so that less than nothing may be left: then the share is 1 and the time 0.
    """
    if cost is None or not line.rate > 0.0:
        return Outlook(float("nan"), float("nan"))
    done = line.time / cost.time_step
    later = cost.shaking + cost.damping
    grains, final = max(line.grains, 1), max(cost.grains, line.grains, 1)
    if line.phase == GENERATING:
        inserting = max(cost.generating - done, 0.0)
        steps, weighted = inserting + later, inserting * 0.5 * (grains + final) + later * final
    elif line.phase == SHAKING:
        steps = line.left * line.rate + cost.damping
        weighted = steps * grains
    else:
        damped = cost.longest_damping - line.left * line.rate
        steps = max(cost.damping - damped, 0.0)
        weighted = steps * grains
    return Outlook(done / max(done + steps, 1.0), weighted / (line.rate * grains))


def duration_text(seconds: float) -> str:
    """Return a duration as text with two digits, "-" if it is not a number."""
    if not seconds < float("inf"):
        return "-"
    for unit, length in (("d", 86400.0), ("h", 3600.0), ("min", 60.0)):
        if seconds >= 1.5 * length:
            return f"{seconds / length:.2g} {unit}" if seconds < 100.0 * length else f"{seconds / length:.0f} {unit}"
    return f"{seconds:.0f} s"
