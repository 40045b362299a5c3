"""Batches wait for whole checks, for the specified time and not for a step more."""

import pytest

from simcore.packing.insertion.waiting import check_steps, steps_of_wait
from simcore.packing.process import Process
from tests.helpers.few_spheres import set_up_few_spheres


@pytest.mark.parametrize(
    ("interval", "dt", "checks"),
    [
        (0.02, 1e-3 / 40, 2),
        (0.02, 3e-3 / 40, 2),  # two checks have 266 steps, and 0.02 s have 267
        (0.1, 3e-3 / 40, 10),
        (0.03, 0.7e-3 / 14, 3),
        (0.0201, 1e-3 / 40, 3),
        (0.01, 1e-3 / 40, 1),
        (0.0, 1e-3 / 40, 0),
        (1.0, 0.2, 5),  # a step is longer than a check
        (0.07, 7e-3, 10),  # a check is a step here, so that seven of them would be too short
    ],
)
def test_an_interval_is_rounded_up_to_whole_checks(interval, dt, checks):
    assert steps_of_wait(interval, 0.01, dt) == checks * check_steps(0.01, dt)


def test_batches_come_at_the_specified_interval():
    setup = set_up_few_spheres(
        generation={"placement": "random", "batch_grains": 10, "batch_interval": "20 ms"},
        numerics={"contact_time": "3 ms"},
    )
    process, steps = Process(setup.scene, setup.bases, setup.draw, lambda line: None), []
    insert = process.insert_batch

    def noted():
        steps.append(process.state.step)
        insert()

    process.insert_batch = noted
    process.generate()
    assert steps == [0, 266, 532, 798] and process.dt == pytest.approx(3e-3 / 40)
