"""CPU time of this process without compilation, which a second run of the same scene would not need."""

import time

from numba.core import event


class _Compiler(event.Listener):
    """Sums CPU and wall-clock time of the outermost compilations, and calls callbacks registered for a function."""

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
    """Return the CPU time [s] of all threads of this process, without compilation since this module was imported."""
    return time.process_time() - _compiler.spent


def compile_time() -> float:
    """Return the CPU time [s] of compilation since this module was imported; 0 if all code came from the disk cache."""
    return _compiler.spent


def working_clock() -> float:
    """Return the time [s] of a wall clock that stops while this process compiles."""
    return time.monotonic() - _compiler.wall_spent


def before_compiling(function, call) -> None:
    """Register call() to be called before `function` is compiled; it is not called if the disk cache has the code."""
    _compiler.waiting[function] = call
