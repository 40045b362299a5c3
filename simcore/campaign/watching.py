"""The state of every packing of a campaign that runs or has run, from the files that its jobs write."""

import time
from pathlib import Path
from typing import NamedTuple

from simcore.packing.cost import estimate
from simcore.packing.outlook import duration_text, outlook, parse_progress
from simcore.scene.specification import read_specification

RUNNING, SILENT, FAILED, INTERRUPTED, WAITING, DONE = "running", "silent", "failed", "interrupted", "waiting", "done"
# In the order in which they are shown: what happens now, and what somebody must look after, comes first.
STATES = (RUNNING, SILENT, FAILED, INTERRUPTED, WAITING, DONE)
SILENCE = 120.0  # [s] without a heartbeat, which comes once a second, or of a log that is written every ten seconds
# How the last line of a packing begins that could not be made; "simcore " is in logs of version 0.1.0.
ENDINGS = ("failed: ", "scree ", "simcore ")
TAIL = 65536  # bytes at the end of a log that are read


class Watched(NamedTuple):
    """One packing of a campaign."""

    name: str
    state: str  # one of STATES
    phase: str  # of its last progress line, or ""
    share: float  # of its steps that are done, nan if not known
    rate: float  # steps per second, nan if not known
    left: float  # [s], nan if not known
    note: str  # the last line of its log where that matters


class Watcher:
    """Reads the state of the packings in a folder, at each call anew; it estimates each specification's cost once.

    folder: results of a campaign (with the folders `packings` and `logs/packing`), or any folder with logs of `pack
    --log`, whose packings have no estimate. ValueError if it is no folder.
    """

    def __init__(self, folder):
        self.folder, self._costs = Path(folder), {}
        if not self.folder.is_dir():
            raise ValueError(f"{folder}: there is no such folder; give the results of a campaign, such as results/wide")

    def look(self) -> list[Watched]:
        """Return the state of every packing, in the order of STATES. ValueError if the folder has no packing."""
        packings = self.folder / "packings"
        if packings.is_dir():
            logs = self.folder / "logs" / "packing"
            watched = [
                self._of_campaign(specification, logs / specification.relative_to(packings).with_suffix(".log"))
                for specification in sorted(packings.rglob("*.yaml"))
            ]
        else:
            watched = [one for path in sorted(self.folder.rglob("*.log")) if (one := self._of_log(path)) is not None]
        if not watched:
            raise ValueError(
                f"{self.folder}: there is no packing in it: neither packings/STUDY/PACKING.yaml nor a log of "
                "`pack --log`; give the results of a campaign, such as results/wide"
            )
        return sorted(watched, key=lambda one: STATES.index(one.state))

    def _of_campaign(self, specification, log):
        name = str(specification.relative_to(self.folder / "packings").with_suffix(""))
        # Names of packings contain dots, so that with_suffix is right for .yaml but not for a second suffix.
        output = specification.with_name(f"{specification.stem}.nc")
        heartbeat, last, line = output.with_name(f"{output.name}.heartbeat"), *_tail(log)
        age = _age(heartbeat)
        if age is not None:
            # There is no heartbeat before the step is compiled, which takes up to a minute.
            if age <= SILENCE:
                return self._progress(name, RUNNING, line, self._cost(specification), "" if line else last)
            return self._progress(
                name, SILENT, line, self._cost(specification),
                f"no heartbeat for {duration_text(age)}: it hangs or was killed",
            )  # fmt: skip
        if output.exists():
            return Watched(name, DONE, "", 1.0, float("nan"), 0.0, "")
        return self._progress(name, _ending(last), line, self._cost(specification), last)

    def _of_log(self, path):
        """Return the state by the log alone, or None if it is the log of something else."""
        last, line = _tail(path)
        name = str(path.relative_to(self.folder).with_suffix(""))
        if " wrote " in last:
            return Watched(name, DONE, "", 1.0, float("nan"), 0.0, "")
        if line is None and not last.startswith(ENDINGS):
            return None
        if _ending(last) == INTERRUPTED or last.startswith(ENDINGS):
            return self._progress(name, _ending(last), line, None, last)
        age = _age(path) or 0.0
        if age <= SILENCE:
            return self._progress(name, RUNNING, line, None, "")
        return self._progress(name, SILENT, line, None, f"no line for {duration_text(age)}: it hangs or was killed")

    def _progress(self, name, state, line, cost, note):
        if line is None:
            return Watched(name, state, "", 0.0 if cost else float("nan"), float("nan"), float("nan"), note)
        ahead = outlook(line, cost)
        left = ahead.left if state == RUNNING else float("nan")
        return Watched(name, state, line.phase, ahead.share, line.rate, left, note)

    def _cost(self, path):
        """Return the estimated PackingCost of a specification, or None if it cannot be read."""
        if path not in self._costs:
            try:
                self._costs[path] = estimate(read_specification(path))
            except (ValueError, OSError):
                self._costs[path] = None
        return self._costs[path]


def _ending(last):
    """Return how a packing that does not run has ended, by the last line of its log; "" without a log."""
    if not last:
        return WAITING
    return INTERRUPTED if "interrupted" in last else FAILED


def _age(path):
    """Return the time since a file was changed [s], or None if there is no such file."""
    try:
        return max(time.time() - path.stat().st_mtime, 0.0)
    except OSError:
        return None


def _tail(log):
    """Return the last line of a log, "" without one, and its last progress line as a ProgressLine, or None."""
    try:
        with log.open("rb") as file:
            file.seek(max(log.stat().st_size - TAIL, 0))
            lines = file.read().decode(errors="replace").splitlines()
    except OSError:
        return "", None
    lines = [line for line in lines if line.strip()]
    progress = next((parsed for line in reversed(lines) if (parsed := parse_progress(line)) is not None), None)
    return (lines[-1].strip() if lines else ""), progress
