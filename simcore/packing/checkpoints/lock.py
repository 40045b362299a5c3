"""A lock file that one process locks and that names this process."""

import os
from collections.abc import Callable
from contextlib import suppress

from filelock import lock_descriptor

HOLDER_LENGTH = 200  # bytes


def take_lock(path, holder: str, busy: Callable, no_locks: Callable = lambda error: None):
    """Return (open file, whether it is locked); the lock lasts until the file is closed or its process ends.

    holder: text to write into the file, such as the number of this process. busy(holder of the lock) is called as long
    as another process has the lock; it raises an error, or returns to try again. no_locks(error) is called if the file
    system has no locks; the file is then returned unlocked. OSError if the file cannot be opened.
    """
    while True:
        file, locked = open(path, "a+b", buffering=0), True
        try:
            free = lock_descriptor(file.fileno(), blocking=False)
        except OSError as error:
            no_locks(error)
            free, locked = True, False
        if not free:
            other = _read_holder(file)
            file.close()
            busy(other)
            continue
        # Between opening and locking, its holder may have removed the file and another process made a new one.
        with suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(file.fileno()), os.stat(path)):
                with suppress(OSError):  # the name is only information, so a full disk does not matter here
                    file.truncate(0)
                    file.write(holder.encode()[:HOLDER_LENGTH])
                return file, locked
        file.close()


def _read_holder(file):
    """Return what the holder of a lock wrote into the file; "" where, as on Windows, a locked file cannot be read."""
    try:
        file.seek(0)
        return file.read(HOLDER_LENGTH).decode(errors="replace").strip()
    except OSError:
        return ""
