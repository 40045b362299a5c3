"""Writes checkpoints of a packing at intervals of wall-clock time, and before a signal ends it."""

import signal
import time

from simcore.packing.checkpoints.file import CheckpointError, read_checkpoint
from simcore.packing.checkpoints.store import Store
from simcore.packing.heartbeat import beat
from simcore.packing.keeping import KEEP, KEEP_AND_STOP, Keeper
from simcore.provenance.cpu_time import cpu_time

STOPPING = (signal.SIGTERM, signal.SIGINT)


class CheckpointKeeper(Keeper):
    """Writes checkpoints to a folder. Rank 0 decides when; a signal to any rank stops the packing."""

    def __init__(self, folder, key: str, code: str, interval: float, report, ranks):
        """folder: None for no checkpoints. interval [s]: of wall-clock time. CheckpointError is raised on all ranks."""
        self.key, self.code, self.interval, self.report, self.ranks = key, code, interval, report, ranks
        self.kept, self.stopped, self.spent = time.monotonic(), False, 0.0
        self.store = None
        self.keeps = folder is not None
        if self.keeps:
            self.store = ranks.on_first(lambda: Store(folder, key, code, report), CheckpointError)
            for number in STOPPING:
                signal.signal(number, self._stop)

    def _stop(self, number, frame):
        self.stopped = True

    def wish(self, step) -> int:
        """Return KEEP if a checkpoint is due, KEEP_AND_STOP after a signal, otherwise 0."""
        if self.ranks.rank == 0:
            beat()
        if self.stopped:
            return KEEP_AND_STOP
        due = self.store is not None and time.monotonic() > self.kept + self.interval
        return KEEP if due else 0

    def latest(self):
        """Return the state and sections of the newest valid checkpoint, or None."""
        if not self.keeps:
            return None
        latest = self.ranks.on_first(self.store.latest if self.store else None, CheckpointError)
        path = self.ranks.all([latest and str(latest[1].path)])[0]
        if path is None:
            return None
        failure = None
        try:
            header, sections = latest or read_checkpoint(path, self.key, self.code)
        except CheckpointError as error:  # a rank on another machine may not see the folder
            failure = error
        for failed in filter(None, self.ranks.all([failure])):
            raise failed
        self.spent = header["cpu_seconds"]
        return header, lambda: sections

    def keep(self, state, parts):
        """Write a checkpoint on rank 0, and return whether it is written; if not, report why and go on."""
        spent = self.cpu_seconds()
        parts = _with_beats(parts)
        if self.ranks.rank > 0:
            for _ in parts:
                pass
            return False
        stored = True
        try:
            self.store.save({**state, "cpu_seconds": spent}, parts)
        except CheckpointError as error:
            self.report(str(error))
            stored = False
        self.kept = time.monotonic()
        return stored

    def stepped(self) -> None:
        """Ignore signals after the last step: the rest is short, and an interruption would only lose it."""
        if self.keeps:
            for number in STOPPING:
                signal.signal(number, signal.SIG_IGN)

    def cpu_seconds(self) -> float:
        """Return the CPU time [s] of all ranks and earlier runs, without compiling; all ranks must call this."""
        return self.spent + self.ranks.totals([cpu_time()])[0]

    def done(self) -> None:
        """Remove the checkpoints after the final file is written."""
        if self.store is not None:
            self.store.clear()

    def close(self) -> None:
        """Release the folder for another process."""
        if self.store is not None:
            self.store.close()


def _with_beats(parts):
    for part in parts:
        beat()
        yield part
