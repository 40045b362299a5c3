"""Sign of life of a run, for the watchdog that started it (launch.py): the time of a file."""

import os
import time

VARIABLE = "SCREE_HEARTBEAT"  # path of the file; not set where nobody watches
INTERVAL = 1.0  # [s]

_last = -INTERVAL


def beat() -> None:
    """Touch the heartbeat file, at most once a second; nothing where the run is not watched.

    To be called by rank 0 at each look of the stepping and between the parts of what comes after, never before the
    first step is compiled: the first beat ends the allowance for starting up.
    """
    global _last
    path = os.environ.get(VARIABLE)
    if path is None or time.monotonic() - _last < INTERVAL:
        return
    _last = time.monotonic()
    try:
        os.utime(path)
    except OSError:  # a file that cannot be touched for long is silence, and the watchdog's to judge
        pass
