"""Description of the machine on which a run time was measured."""

import os
import platform

import numba
import numpy


def describe_host() -> str:
    """Return processor, number of cores and versions in one line."""
    versions = f"Python {platform.python_version()}, numba {numba.__version__}, numpy {numpy.__version__}"
    return f"{_processor()}, {os.cpu_count()} cores, {versions}"


def _processor():
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            return next(line.partition(":")[2].strip() for line in file if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()
