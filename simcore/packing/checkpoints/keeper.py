"""When a packing is kept, and where: at intervals of wall-clock time, and before a signal ends it."""

import signal
import time

from simcore.packing.checkpoints.file import CheckpointError, read_checkpoint
from simcore.packing.checkpoints.store import Store
from simcore.packing.heartbeat import beat
from simcore.packing.keeping import KEEP, KEEP_AND_STOP, Keeper
from simcore.provenance.cpu_time import cpu_time

STOPPING = (signal.SIGTERM, signal.SIGINT)


class CheckpointKeeper(Keeper):
    """Keeps a packing in a folder; rank 0 decides when, any rank that gets a signal has it stop."""

    def __init__(self, folder, key: str, code: str, interval: float, report, ranks):
        """folder: None to keep nothing. interval [s]: of wall-clock time. CheckpointError on all ranks alike."""
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
        if self.ranks.rank == 0:
            beat()
        if self.stopped:
            return KEEP_AND_STOP
        due = self.store is not None and time.monotonic() > self.kept + self.interval
        return KEEP if due else 0

    def latest(self):
        if not self.keeps:
            return None
        found = self.ranks.on_first(self.store.latest if self.store else None, CheckpointError)
        path = self.ranks.all([found and str(found[1].path)])[0]
        if path is None:
            return None
        header, sections = found or read_checkpoint(path, self.key, self.code)
        self.spent = header["cpu_seconds"]
        return header, lambda: sections

    def keep(self, state, parts):
        spent = self.cpu_seconds()
        parts = _with_beats(parts)
        if self.ranks.rank > 0:
            for _ in parts:
                pass
            return
        try:
            self.store.save({**state, "cpu_seconds": spent}, parts)
        except CheckpointError as error:
            self.report(str(error))
        self.kept = time.monotonic()

    def stepped(self) -> None:
        """No step is left: what remains is not to be interrupted, since nothing would be gained."""
        if self.keeps:
            for number in STOPPING:
                signal.signal(number, signal.SIG_IGN)

    def cpu_seconds(self) -> float:
        """CPU time [s] of all ranks on this packing, of runs before too, less compiling; all ranks must ask."""
        return self.spent + self.ranks.totals([cpu_time()])[0]

    def done(self) -> None:
        """The final file is written: no checkpoint is needed any more."""
        if self.store is not None:
            self.store.clear()

    def close(self) -> None:
        """Leave the checkpoints to another."""
        if self.store is not None:
            self.store.close()


def _with_beats(parts):
    for part in parts:
        beat()
        yield part
