"""The steps of packings are compiled ahead of time, once, and only then announced."""

import os
import subprocess
import sys

import pytest

from simcore.dem.shapes.polyhedra import POLYHEDRON, SPHERE
from simcore.dem.state.features import Features
from simcore.packing.announcement import announcement
from simcore.paths import ROOT

SPHERES = """
domain: {type: periodic, width: 30 mm, height: 0.1 m}
shapes: {kind: sphere}
sizes: {bounds: [7 mm, 7.001 mm], mass_fractions: [1]}
amount: {grains: 6}
shaking: {duration: 0.01 s}
numerics: {contact_time: 1 ms}
"""


@pytest.fixture
def simcore(tmp_path):
    """Return a function that runs a command of simcore with a cache of its own and returns stdout and stderr."""

    def run(*words):
        environment = {**os.environ, "SCREE_CACHE": str(tmp_path / "cache"), "PYTHONPATH": str(ROOT)}
        done = subprocess.run(
            [sys.executable, "-m", "simcore", *words], capture_output=True, text=True, env=environment, cwd=tmp_path
        )
        assert done.returncode == 0, done.stderr
        return done.stdout, done.stderr

    return run


def test_a_step_is_compiled_once_ahead_of_its_packings(simcore, tmp_path):
    for name in ("one", "two"):
        (tmp_path / f"{name}.yaml").write_text(f"name: {name}\nseed: 1\n{SPHERES}")
    said, announced = simcore("compile", "one.yaml", "two.yaml")
    assert "The step is compiled" in said
    assert announced.count("Compiling the step for spheres with friction, once; this takes about") == 1
    assert "one: Compiling" in announced
    files = sorted((tmp_path / "cache").rglob("*.nbc"))
    said, announced = simcore("compile", "one.yaml")
    assert "took 0 s of CPU time" in said
    assert announced == ""
    _, lines = simcore("pack", "two.yaml", "two.nc", "--force")
    assert "Compiling" not in lines
    assert "converged" in lines
    # The packing compiles other functions itself, but not the step.
    new = set((tmp_path / "cache").rglob("*.nbc")) - set(files)
    assert not any("/dem/" in path.as_posix() for path in new)


def test_an_announcement_names_shapes_and_friction():
    assert announcement(Features(POLYHEDRON, True)).startswith(
        "Compiling the step for convex polyhedra with friction, "
    )
    assert " spheres without friction, " in announcement(Features(SPHERE, False))
    assert " spheres with friction, " in announcement(Features(SPHERE, False, sliding=1))
