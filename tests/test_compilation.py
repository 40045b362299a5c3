"""The digest of compiled code changes with the code that is compiled or compiled in, and with nothing else."""

import contextlib
import os
import re
import shutil
import subprocess
import sys
import threading
from types import SimpleNamespace

import pytest

from simcore import compilation, paths
from simcore.dem.step import motion
from simcore.packing.checkpoints.key import checkpoint_code
from simcore.paths import ROOT
from simcore.provenance import digest

COMPILED = ["compilation.py", "evaluation/slicing.py", "dem/step/step.py", "dem/contact/search/epa.py"]
COMPILED_IN = ["dem/contact/search/scratch.py", "dem/state/features.py", "dem/state/bodies.py"]
NEITHER = [
    "packing/process.py",
    "dem/ranks/many_ranks.py",
    "packing/watch.py",
    "packing/checkpoints/file.py",
    "grains/mesh.py",
]


@pytest.fixture
def sources(tmp_path, monkeypatch):
    """Yield changed(path, text, code): add text to a file of a copy of simcore and return whether the code changed."""
    shutil.copytree(ROOT / "simcore", tmp_path / "simcore", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(ROOT / "config", tmp_path / "config")
    monkeypatch.setattr(compilation, "ROOT", tmp_path)
    monkeypatch.setattr(digest, "ROOT", tmp_path)
    monkeypatch.setattr(paths, "ROOT", tmp_path)
    monkeypatch.setattr(paths, "DATA", tmp_path)

    def changed(path, text="CHANGED = 1\n", code=compilation.source_digest.__wrapped__):
        digest.read_source.cache_clear()
        compilation.source_digest.cache_clear()
        before = code()
        file = tmp_path / "simcore" / path
        file.write_text(text + file.read_text())
        digest.read_source.cache_clear()
        compilation.source_digest.cache_clear()
        return code() != before

    yield changed
    digest.read_source.cache_clear()
    compilation.source_digest.cache_clear()


@pytest.mark.parametrize("path", COMPILED + COMPILED_IN)
def test_what_is_compiled_or_compiled_in_counts(sources, path):
    assert sources(path)


@pytest.mark.parametrize("path", NEITHER)
def test_what_is_not_does_not(sources, path):
    assert not sources(path)


@pytest.mark.parametrize("path", ["dem/step/step.py", "packing/process.py"])
def test_a_comment_refuses_no_checkpoint(sources, path):
    assert not sources(path, "# A remark.\n\n", checkpoint_code)
    assert sources(path, "CHANGED = 1\n", checkpoint_code)


@pytest.fixture
def project(tmp_path):
    """Return run() -> (value, hits, misses, files kept); a kernel of the project inlines a leaf of another file."""
    provenance = ("provenance/__init__.py", "provenance/digest.py", "provenance/version.py", "provenance/version.txt")
    for path in ("__init__.py", "paths.py", "compilation.py", *provenance):
        (tmp_path / "simcore" / path).parent.mkdir(exist_ok=True, parents=True)
        shutil.copy(ROOT / "simcore" / path, tmp_path / "simcore" / path)
    (tmp_path / "simcore/leaves.py").write_text(LEAVES)
    (tmp_path / "simcore/kernels.py").write_text(KERNELS)

    def run(threads=1):
        done = subprocess.run(
            [sys.executable, "-c", RUN.format(threads=threads)],
            cwd=tmp_path,
            env={
                **os.environ,
                "SCREE_CACHE": str(tmp_path / "cache"),
                "PYTHONPATH": str(tmp_path),
                "NUMBA_NUM_THREADS": "2",
            },
            capture_output=True,
            text=True,
            timeout=300,
        )
        assert done.returncode == 0, done.stderr
        value, hits, misses = done.stdout.split()
        return float(value), int(hits), int(misses), len(list((tmp_path / "cache").rglob("*.nbc")))

    def edit(name, pattern, text):
        path = tmp_path / "simcore" / name
        edited, count = re.subn(pattern, text, path.read_text())
        assert count == 1
        path.write_text(edited)

    run.edit = edit
    return run


LEAVES = '''"""Leaves."""

from simcore.compilation import leaf

FACTOR = 2.0


@leaf
def scaled(x):
    """A text."""
    return FACTOR * x
'''
KERNELS = '''"""Kernels."""

import numpy as np
from numba import get_num_threads, prange

from simcore.compilation import kernel, loops, parallel_kernel
from simcore.leaves import scaled


@loops
def fill(array):
    for k in prange(len(array)):
        array[k] = scaled(1.0 + k)


def make(offset):
    @(parallel_kernel if get_num_threads() > 1 else kernel)
    def total(n):
        """A text."""
        array = np.empty(n)
        fill(array)
        for k in prange(n):
            array[k] += offset
        return array.sum()

    return total
'''
RUN = """
from simcore.compilation import set_threads
set_threads({threads})
from simcore.kernels import make
total = make(0.5)
value = total(10)
print(value, sum(total.stats.cache_hits.values()), sum(total.stats.cache_misses.values()))
"""


def test_editing_a_comment_compiles_nothing_anew_and_editing_code_does(project):
    value, hits, misses, kept = project()
    assert (value, hits, misses) == (115.0, 0, 1)
    assert project() == (value, 1, 0, kept)
    project.edit("leaves.py", "^", "# A remark that moves all lines.\n\n")
    project.edit("kernels.py", "^", "# Another.\n")
    project.edit("kernels.py", '"""A text."""', '"""Another text,\n\n    longer."""')
    assert project() == (value, 1, 0, kept)
    project.edit("leaves.py", "FACTOR = 2.0", "FACTOR = 3.0")
    value, hits, misses, more = project()
    assert (value, hits, misses) == (170.0, 0, 1)
    assert more > kept


def test_versions_for_one_thread_and_for_two_are_kept_beside_each_other(project):
    one, two = project(1), project(2)
    assert one[0] == two[0] == 115.0
    assert two[1:3] == (0, 1)
    assert two[3] > one[3]
    assert project(1)[1:3] == project(2)[1:3] == (1, 0)


def test_what_only_compiled_code_calls_can_be_called_from_python_too():
    from simcore.dem.vectors import Vec, dot

    assert dot(Vec(1.0, 2.0, 3.0), Vec(1.0, 1.0, 1.0)) == 6.0


def test_too_many_threads_are_refused():
    with pytest.raises(ValueError, match="change --threads"):
        compilation.set_threads(10_000)


def test_two_writers_of_one_file_do_not_share_a_place(tmp_path, monkeypatch):
    """Without a lock both read the index before either writes it, and then one would load the code of the other."""
    monkeypatch.setenv("SCREE_CACHE", str(tmp_path))
    meeting = threading.Barrier(2)

    def cache_of(key):
        cache = compilation._Cache(motion._cos_sin.py_func, {})
        monkeypatch.setattr(cache, "_index_key", lambda sig, codegen: key)
        monkeypatch.setattr(cache, "_impl", SimpleNamespace(
            locator=cache._impl.locator, check_cachable=lambda data: True, reduce=lambda data: data.code,
        ))  # fmt: skip
        read = cache._cache_file._load_index

        def read_and_wait():
            index = read()
            with contextlib.suppress(threading.BrokenBarrierError):
                meeting.wait(1.0)
            return index

        monkeypatch.setattr(cache._cache_file, "_load_index", read_and_wait)
        return cache

    caches = {key: cache_of(key) for key in ("one", "two")}
    threads = [
        threading.Thread(target=cache.save_overload, args=(None, SimpleNamespace(codegen=None, code=key)))
        for key, cache in caches.items()
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert {key: cache._cache_file.load(key) for key, cache in caches.items()} == {"one": "one", "two": "two"}
