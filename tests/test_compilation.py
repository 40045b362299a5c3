"""What the compiled code is known by: changes of what is compiled, or compiled in, and of nothing else."""

import shutil

import pytest

from simcore import compilation


@pytest.fixture
def sources(tmp_path, monkeypatch):
    """A copy of simcore; changed(path) appends a line to a file and returns whether the digest is another."""
    copy = tmp_path / "simcore"
    shutil.copytree(compilation._SOURCES, copy)
    monkeypatch.setattr(compilation, "_SOURCES", copy)
    monkeypatch.setattr(compilation, "__file__", str(copy / "compilation.py"))

    def changed(path):
        before = compilation.source_digest.__wrapped__()
        with (copy / path).open("a") as file:
            file.write("CHANGED = 1\n")
        return compilation.source_digest.__wrapped__() != before

    return changed


@pytest.mark.parametrize(
    "path",
    [
        "compilation.py",
        "evaluation/slicing.py",
        "dem/step/step.py",
        "dem/contact/search/epa.py",
        "dem/contact/search/scratch.py",
        "dem/state/features.py",
        "dem/state/bodies.py",
    ],
)
def test_what_is_compiled_or_compiled_in_counts(sources, path):
    assert sources(path)


@pytest.mark.parametrize(
    "path",
    [
        "packing/process.py",
        "dem/ranks/many_ranks.py",
        "packing/watch.py",
        "packing/checkpoints/file.py",
        "grains/mesh.py",
    ],
)
def test_what_is_not_does_not(sources, path):
    assert not sources(path)
