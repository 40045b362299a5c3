"""Progress lines: the rate between two of them, also if no step lies between them."""

from types import SimpleNamespace

from simcore.packing.packed import SHAKING
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
