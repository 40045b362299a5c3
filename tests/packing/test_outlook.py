"""Progress lines are read back as they were written; the outlook follows from them and the estimated cost."""

from types import SimpleNamespace

import numpy as np
import pytest

from simcore.packing.cost import PackingCost
from simcore.packing.observation import Observation
from simcore.packing.outlook import duration_text, outlook, parse_progress
from simcore.packing.packed import DAMPING, GENERATING, SHAKING
from simcore.packing.progress import Progress

OBSERVED = Observation(1.3e-4, 0.1, 0.02, 2e-6, 3e-6, 0.1, 4.5)
COST = PackingCost(
    grains=200, batches=2, generating=1000, shaking=2000, damping=500, longest_damping=5000, cpu_seconds=1.0,
    array_bytes=1.0, time_step=1e-3,
)  # fmt: skip


def progress_line(phase, step, grains, end=None, name="bed: of 4 mm"):
    """Return the line that Progress reports at a step, at exactly 100 steps per second."""
    lines = []
    numerics = SimpleNamespace(progress_interval=0.0)
    scene = SimpleNamespace(name=name, numerics=numerics, shaking=SimpleNamespace(duration=2.0))
    progress = Progress(scene, lines.append)
    progress.last_step = step - 1000
    progress.last_time = progress.last_time - 10.0
    progress.line(phase, step, 1e-3, grains, OBSERVED, end)
    return lines[0]


@pytest.mark.parametrize("phase, end", [(GENERATING, None), (SHAKING, 3000), (DAMPING, 8000)])
def test_a_progress_line_is_read_back(phase, end):
    line = parse_progress(progress_line(phase, 2500, 120, end) + "\n")
    assert (line.name, line.phase, line.time, line.grains) == ("bed: of 4 mm", phase, 2.5, 120)
    assert line.rate == pytest.approx(100.0, rel=0.02)
    expected = 20.0 if end is None else (end - 2500) / 100.0
    assert line.left == pytest.approx(expected, abs=1.0)


def test_steps_before_a_checkpoint_do_not_count_in_the_rate():
    lines = []
    scene = SimpleNamespace(
        name="bed", numerics=SimpleNamespace(progress_interval=0.0), shaking=SimpleNamespace(duration=2.0)
    )
    progress = Progress(scene, lines.append)
    progress.resume(2000)
    progress.last_time -= 10.0
    progress.line(SHAKING, 2500, 1e-3, 120, OBSERVED, 3000)
    assert parse_progress(lines[0]).rate == pytest.approx(50.0, rel=0.02)


@pytest.mark.parametrize(
    "text", ["", "bed: 220 grains inserted, 0.05 kg", "failed: bed: shaking too fast", "bed: converged after 10 steps"]
)
def test_other_lines_are_none(text):
    assert parse_progress(text) is None


def test_the_outlook_of_each_phase():
    def look(phase, step, grains, end=None):
        line = parse_progress(progress_line(phase, step, grains, end))
        return outlook(line._replace(rate=100.0), COST)

    # 600 of 3500 steps; 400 more with 150 grains on average, 2500 with 200, at 100 steps of 100 grains a second.
    ahead = look(GENERATING, 600, 100)
    assert ahead.share == pytest.approx(600 / 3500)
    assert ahead.left == pytest.approx((400 * 150 + 2500 * 200) / (100 * 100))
    # Insertion took longer than estimated: its steps do not become negative.
    assert look(GENERATING, 1500, 150).share == pytest.approx(1500 / 4000)
    # Shaking ends at step 3000, whatever the estimate; damping follows.
    ahead = look(SHAKING, 2000, 200, 3000)
    assert ahead.share == pytest.approx(2000 / 3500, rel=0.01) and ahead.left == pytest.approx(15.0, rel=0.05)
    # 200 of 500 expected steps of damping are done, as its limit of 5000 steps ends at 7800.
    ahead = look(DAMPING, 3000, 200, 7800)
    assert ahead.share == pytest.approx(3000 / 3300, rel=0.02) and ahead.left == pytest.approx(3.0, abs=0.6)
    assert look(DAMPING, 4000, 200, 7800) == (1.0, 0.0)


def test_without_a_cost_nothing_is_known():
    line = parse_progress(progress_line(SHAKING, 2000, 200, 3000))
    assert np.isnan(outlook(line, None)).all() and np.isnan(outlook(line._replace(rate=0.0), COST)).all()


@pytest.mark.parametrize(
    "seconds, text",
    [(0.2, "0 s"), (89, "89 s"), (90, "1.5 min"), (3000, "50 min"), (7200, "2 h"), (200000, "2.3 d"), (np.nan, "-")],
)
def test_durations_have_a_unit(seconds, text):
    assert duration_text(seconds) == text
