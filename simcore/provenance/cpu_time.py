"""Time of this process without what the compiler took, which a second run of the same scene would not need."""

import time

from numba.core import event


class _Compiler(event.Listener):
    """CPU time and wall-clock time within the outermost compilation; calls who waits for that of a function."""

    def __init__(self):
        self.depth, self.began, self.spent, self.wall_began, self.wall_spent = 0, 0.0, 0.0, 0.0, 0.0
        self.waiting = {}

    def on_start(self, event):
        if self.depth == 0:
            self.began, self.wall_began = time.process_time(), time.monotonic()
        self.depth += 1
        call = self.waiting.pop(event.data["dispatcher"], None)
        if call is not None:
            call()

    def on_end(self, event):
        self.depth -= 1
        if self.depth == 0:
            self.spent += time.process_time() - self.began
            self.wall_spent += time.monotonic() - self.wall_began


_compiler = _Compiler()
event.register("numba:compile", _compiler)


def cpu_time() -> float:
    """CPU time [s] of this process, all threads, since it began, less what compiling took since this was imported."""
    return time.process_time() - _compiler.spent


def compile_time() -> float:
    """CPU time [s] that compiling took since this was imported; 0 where all came from the cache on disk."""
    return _compiler.spent


def working_clock() -> float:
    """A wall clock [s] that stops while this process compiles."""
    return time.monotonic() - _compiler.wall_spent


def before_compiling(function, call) -> None:
    """Have call() called before a compiled function is compiled; never where it comes from the cache on disk."""
    _compiler.waiting[function] = call
