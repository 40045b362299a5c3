"""CPU time of this process without what the compiler took, which a second run of the same scene would not need."""

import time

from numba.core import event


class _Compiler(event.Listener):
    """CPU time within the outermost compilation."""

    def __init__(self):
        self.depth, self.began, self.spent = 0, 0.0, 0.0

    def on_start(self, event):
        if self.depth == 0:
            self.began = time.process_time()
        self.depth += 1

    def on_end(self, event):
        self.depth -= 1
        if self.depth == 0:
            self.spent += time.process_time() - self.began


_compiler = _Compiler()
event.register("numba:compile", _compiler)


def cpu_time() -> float:
    """CPU time [s] of this process, all threads, since it began, less what compiling took since this was imported."""
    return time.process_time() - _compiler.spent


def compile_time() -> float:
    """CPU time [s] that compiling took since this was imported; 0 where all came from the cache on disk."""
    return _compiler.spent
