"""Heartbeat of a run for the watchdog that started it (launch.py): the modification time of a file."""

import os
import time

VARIABLE = "SCREE_HEARTBEAT"  # path of the file; not set if there is no watchdog
INTERVAL = 1.0  # [s]

_last = -INTERVAL


def beat() -> None:
    """Touch the heartbeat file, at most once a second; do nothing if the run has no watchdog.

    Rank 0 calls this between steps, and between the parts of the work after the last step. It is never called before
    the first step is compiled, because the first beat ends the time allowed for starting up.
    """
    global _last
    path = os.environ.get(VARIABLE)
    if path is None or time.monotonic() - _last < INTERVAL:
        return
    _last = time.monotonic()
    try:
        os.utime(path)
    except OSError:  # if this goes on, the watchdog sees no heartbeat and decides
        pass
