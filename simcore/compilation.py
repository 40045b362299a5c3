"""How numba compiles: every option is set here, and code on disk is found by what it was compiled from.

numba's own cache compares the file of a function, comments included, and does not see other files whose leaves are
compiled into it. Here each file has a folder named after the digest of its code and of all that it imports, see
simcore.provenance.digest: editing code compiles anew what depends on it, editing a comment or a docstring nothing.
"""

import ast
import functools
import gc
import os
from pathlib import Path

import numba
from llvmlite import ir
from numba import types
from numba.core.caching import CompileResultCacheImpl, FunctionCache, UserProvidedCacheLocator
from numba.core.registry import CPUDispatcher
from numba.core.targetconfig import ConfigStack
from numba.extending import intrinsic

from simcore.paths import ROOT
from simcore.provenance.digest import digest

DECORATORS = {"leaf", "routine", "loops", "kernel", "parallel_kernel"}


@functools.cache
def source_digest() -> str:
    """Hexadecimal digest (12 digits) of all code of simcore that is compiled or compiled in, and of numba's version.

    These are the files that import one of DECORATORS and all that they import, directly or not: constants of other
    modules are compiled in. Comments, docstrings and layout do not count.
    """
    compiled = [path.relative_to(ROOT) for path in sorted((ROOT / "simcore").rglob("*.py")) if _compiles(path)]
    return digest("simcore/compilation.py", *compiled, of=numba.__version__)[:12]


def _compiles(path):
    text = path.read_text(encoding="utf-8")
    return "simcore.compilation" in text and any(
        isinstance(node, ast.ImportFrom)
        and node.module == "simcore.compilation"
        and not DECORATORS.isdisjoint(alias.name for alias in node.names)
        for node in ast.walk(ast.parse(text))
    )


@functools.cache
def _file_digest(path):
    return digest(path, of=numba.__version__)


class _Locator(UserProvidedCacheLocator):
    """Where the compiled functions of a file of this project are kept, and what tells whether they are fresh."""

    def __init__(self, py_func, py_file):
        self._py_file = py_file
        path = Path(py_file).resolve()
        self._stamp = _file_digest(path)
        folder = Path(os.environ.get("SCREE_CACHE", Path.home() / ".cache" / "scree")) / "numba"
        self._cache_path = str(folder / f"{path.relative_to(ROOT).with_suffix('')}-{self._stamp}")

    @classmethod
    def from_function(cls, py_func, py_file):
        """None for a file of another project, which numba locates."""
        if not Path(py_file).resolve().is_relative_to(ROOT):
            return None
        return super(UserProvidedCacheLocator, cls).from_function(py_func, py_file)

    def get_source_stamp(self):
        return self._stamp

    def get_disambiguator(self):
        """Not the line, which a comment above moves: no two functions of a file have one qualified name."""
        return ""


class _CacheFiles(CompileResultCacheImpl):
    _locator_classes = (_Locator, *CompileResultCacheImpl._locator_classes)


class _Cache(FunctionCache):
    """Also tells apart what was compiled with different options: for one thread and for several."""

    _impl_class = _CacheFiles

    def __init__(self, py_func, options):
        super().__init__(py_func)
        self._options = tuple(sorted(options.items()))

    def _index_key(self, sig, codegen):
        return (*super()._index_key(sig, codegen), self._options)


class _Compiled(CPUDispatcher):
    def __init__(self, py_func, locals=None, targetoptions=None, **settings):
        super().__init__(py_func, locals, targetoptions, **settings)
        self._cache = _Cache(py_func, self.targetoptions)

    def compile(self, sig):
        """Without Python's garbage collector, which took a tenth of the time of compiling and found little."""
        collecting = gc.isenabled()
        gc.disable()
        try:
            return super().compile(sig)
        finally:
            if collecting:
                gc.enable()


class _Inner(_Compiled):
    """Called by compiled code, without the wrapper for calls from Python, which took a quarter of compiling."""

    def __call__(self, *arguments):
        """For tests and verification: a twin with the wrapper is compiled."""
        return self._outer(*arguments)

    @functools.cached_property
    def _outer(self):
        return _Compiled(self.py_func, targetoptions={**self.targetoptions, "no_cpython_wrapper": False})


class _Loops(_Inner):
    """Has a version for one thread and one for several; calls in compiled code take the one that their caller is."""

    @functools.cached_property
    def _threaded(self):
        return _Inner(self.py_func, targetoptions={**self.targetoptions, "_nrt": True, "parallel": True})

    def _version(self):
        return self._threaded if ConfigStack().top().auto_parallel.enabled else super()

    def get_call_template(self, args, kws):
        return self._version().get_call_template(args, kws)

    def get_overload(self, sig):
        return self._version().get_overload(sig)


def _compiler(kind, **options):
    # Division by zero gives inf or nan as in C, without a branch and an exception per division. No fastmath flag:
    # it may round a loop's vector body and its remainder differently, and results would depend on the thread count.
    options |= {"nopython": True, "error_model": "numpy", "no_cfunc_wrapper": True}
    return lambda function: kind(function, targetoptions=dict(options))


# Leaves are inlined and count no references: each call would otherwise count every array of Bodies and Contacts up
# and down, atomically, which cost 6.3 µs of a step's 6.6 µs per polyhedron. So a leaf may allocate nothing and may
# call leaves only.
leaf = _compiler(_Inner, forceinline=True, _nrt=False, no_cpython_wrapper=True)
# A long leaf that stays a call: it counts no references either; its arrays lie on the stack (contact/scratch.py).
routine = _compiler(_Inner, _nrt=False, no_cpython_wrapper=True)
# Loops over prange that a kernel calls, once a step.
loops = _compiler(_Loops, _nrt=False, no_cpython_wrapper=True)
kernel = _compiler(_Compiled)
parallel_kernel = _compiler(_Compiled, parallel=True)


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
