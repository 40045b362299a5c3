"""How numba compiles: every option stands here, and the cache is named after the sources.

numba's on-disk cache notices changes of a function's own file only. Kernels here call leaves of other files,
so the cache folder carries a digest of all compiled modules: change one, and everything is compiled anew.
"""

import functools
import hashlib
import os
from pathlib import Path

import numba
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

_SOURCES = Path(__file__).parent


@functools.cache
def source_digest() -> str:
    """Hexadecimal digest (12 digits) of the sources that end in compiled code, as they were when it was loaded."""
    digest = hashlib.sha256(numba.__version__.encode())
    for path in [Path(__file__), *sorted((_SOURCES / "dem").rglob("*.py")), _SOURCES / "slicing.py"]:
        if path.exists():
            digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()[:12]


def _cache_folder() -> Path:
    root = Path(os.environ.get("SCREE_CACHE", Path.home() / ".cache" / "scree"))
    return root / f"numba-{source_digest()}"


numba.config.CACHE_DIR = str(_cache_folder())

# Division by zero gives inf or nan as in C, without a branch and an exception per division. No fastmath flag:
# it may round a loop's vector body and its remainder differently, and results would depend on the thread count.
#
# Leaves are inlined and count no references: each call would otherwise count every array of Bodies and Contacts up
# and down, atomically, which cost 6.3 µs of a step's 6.6 µs per polyhedron. So a leaf may allocate nothing and may
# call leaves only.
leaf = numba.njit(error_model="numpy", cache=True, forceinline=True, _nrt=False)
# A long leaf that stays a call: it counts no references either; its arrays lie on the stack (contact/scratch.py).
routine = numba.njit(error_model="numpy", cache=True, _nrt=False)
kernel = numba.njit(error_model="numpy", cache=True)
parallel_kernel = numba.njit(error_model="numpy", cache=True, parallel=True)


@intrinsic
def cycles(typing_context):
    """Cycle counter of the processor (int64): differences time parts of a step."""

    def generate(context, builder, signature, arguments):
        counter = builder.module.declare_intrinsic("llvm.readcyclecounter", (), ir.FunctionType(ir.IntType(64), ()))
        return builder.call(counter, ())

    return types.int64(), generate


def set_threads(n_threads: int) -> None:
    """Number of threads of the parallel kernels. ValueError if the machine's limit is exceeded."""
    limit = numba.config.NUMBA_NUM_THREADS
    if not 1 <= n_threads <= limit:
        raise ValueError(
            f"threads: {n_threads} asked for, but numba can use 1 to {limit} here; "
            f"lower --threads, or set NUMBA_NUM_THREADS before the start"
        )
    numba.set_num_threads(n_threads)
