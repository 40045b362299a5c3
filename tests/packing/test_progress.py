"""Progress lines: the rate between two of them, also if no step lies between them."""

from types import SimpleNamespace

import pytest

from simcore.packing.outlook import parse_progress
from simcore.packing.packed import GENERATING, SHAKING
from simcore.packing.progress import Progress


def test_a_line_needs_a_step_since_the_last_one():
    scene = SimpleNamespace(
        name="bed", numerics=SimpleNamespace(progress_interval=0.0), shaking=SimpleNamespace(duration=1.0)
    )
    observed = SimpleNamespace(kinetic_energy=0.1, mean_overlap=1e-6)
    lines = []
    progress = Progress(scene, lines.append)
    progress.resume(100)
    for step in (100, 200, 200, 300):
        progress.line(SHAKING, step, 1e-4, 50, observed, end=1000)
    assert [line.split(", ")[1] for line in lines] == ["t = 0.020 s", "t = 0.030 s"]
    assert "50 grains" in lines[0] and "left in this phase" in lines[0]


def test_while_grains_are_inserted_the_time_left_is_at_least_that_of_the_shaking():
    """The end of the insertion is not known; 1 s of shaking has 10 000 steps, at 100 steps per second."""
    lines = []
    numerics, shaking = SimpleNamespace(progress_interval=0.0), SimpleNamespace(duration=1.0)
    progress = Progress(SimpleNamespace(name="bed", numerics=numerics, shaking=shaking), lines.append)
    progress.resume(0)
    progress.last_time -= 1.0  # as if the 100 steps had taken a second
    progress.line(GENERATING, 100, 1e-4, 50, SimpleNamespace(kinetic_energy=0.1, mean_overlap=1e-6), end=None)
    line = parse_progress(lines[0])
    assert lines[0].endswith("s left, including the shaking") and "> " in lines[0]
    assert line.phase == GENERATING and line.left == pytest.approx(100.0, abs=2.0)
