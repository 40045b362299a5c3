"""Options and disk cache of numba: every compiler option is set here.

numba's own cache compares the file of a function, with its comments, and ignores other files whose leaves are compiled
into it. Here each file has a cache folder named after the digest of its code and of all that it imports, see
simcore.provenance.digest. A change of code recompiles everything that depends on it; a change of a comment or a
docstring recompiles nothing.
"""

import ast
import functools
import gc
from pathlib import Path

import numba
from llvmlite import ir
from numba import types
from numba.core.caching import CompileResultCacheImpl, FunctionCache, UserProvidedCacheLocator
from numba.core.registry import CPUDispatcher
from numba.core.targetconfig import ConfigStack
from numba.extending import intrinsic

from simcore.paths import ROOT, cache_folder
from simcore.provenance.digest import digest

DECORATORS = {"leaf", "routine", "loops", "kernel", "parallel_kernel"}


@functools.cache
def source_digest() -> str:
    """Return a hexadecimal digest (12 digits) of all code that affects compiled functions, and of numba's version.

    This code is the files that import one of DECORATORS, and all files that they import, directly or indirectly, since
    constants of other modules are compiled in. Comments, docstrings and layout do not count.
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
    """Path of the cache for the compiled functions of a file of this project, and the stamp that marks them valid."""

    def __init__(self, py_func, py_file):
        self._py_file = py_file
        path = Path(py_file).resolve()
        self._stamp = _file_digest(path)
        self._cache_path = str(cache_folder() / "numba" / f"{path.relative_to(ROOT).with_suffix('')}-{self._stamp}")

    @classmethod
    def from_function(cls, py_func, py_file):
        """Return a locator, or None for a file of another project, which numba locates itself."""
        if not Path(py_file).resolve().is_relative_to(ROOT):
            return None
        return super(UserProvidedCacheLocator, cls).from_function(py_func, py_file)

    def get_source_stamp(self):
        return self._stamp

    def get_disambiguator(self):
        """Return "" instead of the line number, which comments shift: qualified names are unique within a file."""
        return ""


class _CacheFiles(CompileResultCacheImpl):
    _locator_classes = (_Locator, *CompileResultCacheImpl._locator_classes)


class _Cache(FunctionCache):
    """Cache that separates functions compiled with different options, such as for one thread and for several."""

    _impl_class = _CacheFiles

    def __init__(self, py_func, options):
        super().__init__(py_func)
        self._options = tuple(sorted(options.items()))

    def save_overload(self, sig, data):
        """Save a compiled function while no other process saves one of this file.

        numba reads the index, chooses a file that it does not name, and writes both. Two processes that do so at once
        choose the same file, and one would later run the code of the other.
        """
        from filelock import FileLock  # here, because a command that compiles nothing needs no locks of files

        self._impl.locator.ensure_cache_path()
        with FileLock(Path(self._cache_path) / "saving.lock"):
            super().save_overload(sig, data)

    def _index_key(self, sig, codegen):
        return (*super()._index_key(sig, codegen), self._options)


class _Compiled(CPUDispatcher):
    def __init__(self, py_func, locals=None, targetoptions=None, **settings):
        super().__init__(py_func, locals, targetoptions, **settings)
        self._cache = _Cache(py_func, self.targetoptions)

    def compile(self, sig):
        """Compile without Python's garbage collector, which took a tenth of the compile time and found little."""
        collecting = gc.isenabled()
        gc.disable()
        try:
            return super().compile(sig)
        finally:
            if collecting:
                gc.enable()


class _Inner(_Compiled):
    """Function that only compiled code calls; it lacks the wrapper for Python, a quarter of the compile time."""

    def __call__(self, *arguments):
        """Call from Python, for tests and verification, through a second version that is compiled with the wrapper."""
        return self._outer(*arguments)

    @functools.cached_property
    def _outer(self):
        return _Compiled(self.py_func, targetoptions={**self.targetoptions, "no_cpython_wrapper": False})


class _Loops(_Inner):
    """Function with a version for one thread and one for several; compiled code calls the version of its caller."""

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
    # Division by zero gives inf or nan as in C, without a branch and an exception per division. There is no fastmath
    # flag: it may round a loop's vector body and its remainder differently, so that results depend on the thread count.
    options |= {"nopython": True, "error_model": "numpy", "no_cfunc_wrapper": True}
    return lambda function: kind(function, targetoptions=dict(options))


# Leaves are inlined and compiled without reference counting. Otherwise each call would atomically count every array of
# Bodies and Contacts up and down, which took 6.3 µs of a step's 6.6 µs per polyhedron. A leaf must therefore not
# allocate, and may only call leaves.
leaf = _compiler(_Inner, forceinline=True, _nrt=False, no_cpython_wrapper=True)
# A long leaf that is not inlined, also without reference counting; its arrays are on the stack (contact/scratch.py).
routine = _compiler(_Inner, _nrt=False, no_cpython_wrapper=True)
# Loops over prange that a kernel calls once per step.
loops = _compiler(_Loops, _nrt=False, no_cpython_wrapper=True)
kernel = _compiler(_Compiled)
parallel_kernel = _compiler(_Compiled, parallel=True)


@intrinsic
def cycles(typing_context):
    """Return the cycle counter of the processor (int64); its differences measure the time of parts of a step."""

    def generate(context, builder, signature, arguments):
        counter = builder.module.declare_intrinsic("llvm.readcyclecounter", (), ir.FunctionType(ir.IntType(64), ()))
        return builder.call(counter, ())

    return types.int64(), generate


def thread_limit() -> int:
    """Return the largest number of threads that a parallel kernel can have.

    numba launches as many as it found when it was imported; its `config` follows a later change of NUMBA_NUM_THREADS.
    """
    return max(numba.config.NUMBA_NUM_THREADS, numba.get_num_threads())


def set_threads(n_threads: int) -> None:
    """Set the number of threads of the parallel kernels. ValueError if it exceeds the limit of the machine."""
    limit = numba.config.NUMBA_NUM_THREADS
    if not 1 <= n_threads <= limit:
        raise ValueError(
            f"threads: {n_threads} is not possible, since numba can use 1 to {limit} here; "
            f"change --threads (in Python: threads), or set NUMBA_NUM_THREADS before the start"
        )
    numba.set_num_threads(n_threads)
