"""CPU time excludes compilation, and only that."""

import time

import numba
import numpy as np

from simcore.provenance.cpu_time import before_compiling, compile_time, cpu_time, working_clock


def test_compiling_is_not_counted():
    @numba.njit
    def inner(x):
        return x * x + 1.0

    @numba.njit
    def outer(x):
        total = 0.0
        for k in range(10):
            total += inner(x + k)
        return total

    began, compiled, all_ = cpu_time(), compile_time(), time.process_time()
    outer(1.0)
    took = compile_time() - compiled
    assert took > 0.02
    # What remains is the call and the compiler's frame, not the nested compilation counted twice or not at all.
    assert 0.0 <= cpu_time() - began < 0.5 * took
    assert abs((time.process_time() - all_) - (cpu_time() - began) - took) < 0.01
    compiled = compile_time()
    outer(2.0)
    assert compile_time() == compiled


def test_work_is_counted():
    began, end = cpu_time(), time.process_time() + 0.2
    while time.process_time() < end:
        pass
    assert cpu_time() - began > 0.19


def test_who_waits_is_called_once_before_a_function_is_compiled():
    @numba.njit
    def function(x):
        return x + 1.0

    calls = []
    before_compiling(function, lambda: calls.append(len(function.signatures)))
    assert calls == []
    function(1.0)
    function(1)
    assert calls == [0]


def test_the_working_clock_stops_while_compiling():
    @numba.njit
    def function(x):
        total = 0.0
        for k in range(10):
            total += np.sin(x + k) * np.cos(x - k)
        return total

    wall, working = time.monotonic(), working_clock()
    function(1.0)
    time.sleep(0.05)
    wall, working = time.monotonic() - wall, working_clock() - working
    assert 0.05 <= working < 0.05 + 0.5 * (wall - 0.05)
