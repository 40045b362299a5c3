"""How numba compiles: every option stands here, and the cache is named after the sources.

numba's on-disk cache notices changes of a function's own file only. Kernels here call leaves of other files,
so the cache folder carries a digest of all compiled modules: change one, and everything is compiled anew.
"""

import functools
import hashlib
import os
import re
from pathlib import Path

import numba
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

_SOURCES = Path(__file__).parent
_COMPILES = re.compile(r"^from simcore\.compilation import .*(leaf|routine|kernel)", re.MULTILINE)
_IMPORTS = re.compile(r"^from simcore\.([\w.]+) import ", re.MULTILINE)


@functools.cache
def source_digest() -> str:
    """Hexadecimal digest (12 digits) of the sources that end in compiled code, as they were when it was loaded.

    Those that compile, and what they import, directly or not: constants of other modules are compiled in.
    """
    texts = {path: path.read_text(encoding="utf-8") for path in sorted(_SOURCES.rglob("*.py"))}
    found = {path for path, text in texts.items() if _COMPILES.search(text)} | {Path(__file__)}
    todo = list(found)
    while todo:
        imported = {path for path in _imports(texts[todo.pop()]) if path in texts} - found
        found |= imported
        todo += imported
    digest = hashlib.sha256(numba.__version__.encode())
    for path in sorted(found):
        digest.update(path.relative_to(_SOURCES).as_posix().encode() + texts[path].encode())
    return digest.hexdigest()[:12]


def _imports(text):
    """Files of simcore that `text` imports at its top; of a package all of them."""
    for name in _IMPORTS.findall(text):
        path = _SOURCES.joinpath(*name.split("."))
        yield path.with_suffix(".py")
        if path.is_dir():
            yield from path.glob("*.py")


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
