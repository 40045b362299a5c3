"""What a run time was measured on."""

import os
import platform

import numba
import numpy

from simcore.compilation import source_digest


def describe_machine() -> str:
    """Processor, cores, versions and the digest of the compiled sources, in one line."""
    return f"{describe_host()}, code {source_digest()}"


def describe_host() -> str:
    """The same without the code: for tables whose rows say the code that made each."""
    versions = f"Python {platform.python_version()}, numba {numba.__version__}, numpy {numpy.__version__}"
    return f"{_processor()}, {os.cpu_count()} cores, {versions}"


def _processor():
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            return next(line.partition(":")[2].strip() for line in file if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()
