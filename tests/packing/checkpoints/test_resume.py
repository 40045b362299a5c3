"""A packing that was saved, stopped and resumed ends in the same bits, wherever it was stopped."""

import json
import shutil

import numpy as np
import pytest

from simcore.dem.ranks.one_rank import ONE_RANK
from simcore.packing.checkpoints.keeper import CheckpointKeeper
from simcore.packing.keeping import KEEP, KEEP_AND_STOP, Keeper
from simcore.packing.packed import DAMPING, Interrupted, PackingError
from simcore.packing.process import Process, pack
from tests.helpers.few_spheres import set_up_few_spheres
from tests.helpers.same_bits import arrays_of, assert_same_bits


class Memory(Keeper):
    """A Keeper that stores the latest state in memory, as JSON and arrays, and requests checkpoints at given steps."""

    def __init__(self, keeps=(), stops=()):
        self.wishes = sorted([(step, KEEP) for step in keeps] + [(step, KEEP_AND_STOP) for step in stops])
        self.kept, self.times = None, 0

    def wish(self, step):
        if self.wishes and step >= self.wishes[0][0]:
            return self.wishes.pop(0)[1]
        return 0

    def keep(self, state, parts):
        text = json.dumps(state, default=lambda value: value.item())
        self.kept = text, [{name: array.copy() for name, array in part.items()} for part in parts]
        self.times += 1
        return True

    def latest(self):
        return self.kept and (json.loads(self.kept[0]), lambda: self.kept[1])


CHANGES = {"numerics": {"steps_per_contact_time": 20, "dashpot": "implicit"}, "amount": {"grains": 30}}


@pytest.fixture(scope="module")
def made():
    return set_up_few_spheres(**CHANGES)


@pytest.fixture(scope="module")
def whole(made):
    return pack(made.scene, made.bases, made.draw)


def assert_packed_alike(first, second):
    assert_same_bits(arrays_of(first.bodies, first.candidates), arrays_of(second.bodies, second.candidates))
    for name in ("observation", "steps", "time", "last_insertion", "checks", "stability"):
        assert getattr(first, name) == getattr(second, name), name


def test_keeping_changes_nothing(made, whole):
    keeper = Memory(keeps=range(0, whole.steps, 97))
    kept = pack(made.scene, made.bases, made.draw, keeper=keeper)
    assert keeper.times > 10
    assert_packed_alike(whole, kept)


def test_it_goes_on_from_any_step(made, whole):
    rng = np.random.default_rng(8)
    stops = np.sort(rng.integers(1, whole.steps, 12))
    keeper = Memory(stops=[int(stop) for stop in stops])
    phases = []
    while True:
        try:
            resumed = pack(made.scene, made.bases, made.draw, keeper=keeper)
            break
        except Interrupted as interrupted:
            assert "Run the same command again to resume from there" in str(interrupted)
            phases.append(json.loads(keeper.kept[0])["phase"])
    assert len(phases) >= 8 and len(set(phases)) >= 2
    assert_packed_alike(whole, resumed)


def test_its_progress_lines_do_not_count_the_steps_before_the_checkpoint(made, whole):
    keeper = Memory(stops=[whole.steps // 2])
    with pytest.raises(Interrupted):
        pack(made.scene, made.bases, made.draw, keeper=keeper)
    process = Process(made.scene, made.bases, made.draw, lambda line: None, keeper=keeper)
    process.resume()
    assert process.progress.last_step == process.step >= whole.steps // 2


def test_the_last_stretch_of_damping_is_gone_on_with(made, whole):
    """The packing is stopped within the last interval of 200 steps, after which it converges."""
    keeper = Memory(stops=[whole.steps - 120])
    with pytest.raises(Interrupted):
        pack(made.scene, made.bases, made.draw, keeper=keeper)
    assert_packed_alike(whole, pack(made.scene, made.bases, made.draw, keeper=keeper))


def test_a_longer_time_of_damping_goes_on_from_the_checkpoint_of_a_failed_packing(made, whole):
    """The packing fails 300 steps before it converges, because its time of damping is over."""
    dt = made.scene.numerics.time_step
    damping = sum(phase == DAMPING for _, phase, _ in whole.checks) * round(made.scene.convergence.interval / dt)
    short = set_up_few_spheres(**CHANGES, damping={"max_time": f"{(damping - 300) * dt!r} s"})
    keeper = Memory(keeps=[whole.steps - 310])
    with pytest.raises(PackingError, match="not at rest.*Raise damping.max_time: the packing then resumes"):
        pack(short.scene, short.bases, short.draw, keeper=keeper)
    assert keeper.times == 1
    assert_packed_alike(whole, pack(made.scene, made.bases, made.draw, keeper=keeper))


def test_a_state_that_could_not_be_stored_is_not_promised(made, tmp_path):
    lines, keeper = [], CheckpointKeeper(tmp_path / "kept", "key", "code", 600.0, print, ONE_RANK)
    keeper.report = lines.append
    shutil.rmtree(tmp_path / "kept")
    keeper.stopped = True
    with pytest.raises(Interrupted, match="again to start from its last checkpoint, or anew without one"):
        pack(made.scene, made.bases, made.draw, keeper=keeper)
    assert "No such file or directory" in lines[0] and lines[0].endswith("there is none of this step")
