"""A file that one process locks, and that says which process that is."""

import fcntl
import os
from collections.abc import Callable
from contextlib import suppress

HOLDER_LENGTH = 200  # bytes


def take_lock(path, holder: str, busy: Callable, no_locks: Callable = lambda error: None):
    """(open file, whether it is locked): the lock lasts until the file is closed or its process ends.

    holder: text that the file gets, such as the number of this process. busy(holder of the lock) is called as long as
    another process has the lock; it raises, or returns to try again. no_locks(error) is called where the file system
    has no locks: the file is then returned without one. OSError where the file cannot be opened.
    """
    while True:
        file, locked = open(path, "a+b", buffering=0), True
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            file.seek(0)
            other = file.read(HOLDER_LENGTH).decode(errors="replace").strip()
            file.close()
            busy(other)
            continue
        except OSError as error:
            no_locks(error)
            locked = False
        # Its holder may have removed it, and another made it anew, between our opening and locking
        with suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(file.fileno()), os.stat(path)):
                with suppress(OSError):  # who holds it is told as a courtesy, a full disk does not matter here
                    file.truncate(0)
                    file.write(holder.encode()[:HOLDER_LENGTH])
                return file, locked
        file.close()
