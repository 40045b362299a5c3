"""Rules of rest: each measure alone can reject a bed."""

from dataclasses import replace

import numpy as np
import pytest

from simcore.packing.observation import Observation
from simcore.packing.rest import judge_settled, judge_still
from tests.helpers.few_spheres import set_up_few_spheres

STILL = Observation(1e-12, 1e-4, 0.05, 1e-6, 2e-6, 1e-3, 5.0)
CREEPING = set_up_few_spheres(convergence={"rule": "settled"}).scene
GOAL, MATERIAL = CREEPING.convergence, CREEPING.material


def test_still_asks_for_height_speed_and_force():
    assert judge_still(GOAL, STILL, 0.05 + 0.9e-5).at_rest
    for observed, before in (
        (STILL, 0.05 + 1.1e-5),
        (STILL._replace(max_speed=6e-3), 0.05),
        (STILL._replace(unbalanced_force=0.03), 0.05),
    ):
        verdict = judge_still(GOAL, observed, before)
        assert not verdict.at_rest and "mean height changed by" in verdict.reason


def looks(rate, energy=0.0, seconds=0.5):
    """Return checks every 10 ms from 1 s on, in which the mean height falls by the share `rate` per second."""
    times = 1.0 + 0.01 * np.arange(round(100 * seconds) + 1)
    heights = 0.05 * np.exp(-rate * (times - 1.0))
    return [
        (time, "damping", STILL._replace(kinetic_energy=energy, mean_height=height))
        for time, height in zip(times, heights, strict=True)
    ]


def judge(checks, since=1.0):
    return judge_settled(GOAL, MATERIAL, checks[-1][2], checks, since, mass=0.02, grains=40)


def test_settled_asks_for_a_rate_of_compaction():
    """The limit of 5e-4 in 0.1 s is 5e-3 per second; the window is complete to the rounding of the times."""
    assert judge(looks(4.95e-3)).at_rest
    verdict = judge(looks(5.05e-3))
    assert not verdict.at_rest and "solid fraction changed by 0.00051 (relative) in 0.1 s" in verdict.reason


def test_settled_waits_for_its_window():
    assert not judge(looks(0.0, seconds=0.09)).at_rest
    assert judge(looks(0.0, seconds=0.10)).at_rest
    assert not judge(looks(0.0), since=1.45).at_rest


@pytest.mark.parametrize("interval", [0.05, 0.15, 0.2, 0.5])
def test_settled_compares_with_an_earlier_check_for_any_interval(interval):
    """With an interval of two windows the current check is within half an interval of the window's begin."""
    checks = looks(0.1, seconds=2.0)[:: round(100 * interval)]
    goal = replace(GOAL, interval=interval)
    verdict = judge_settled(goal, MATERIAL, checks[-1][2], checks, 1.0, mass=0.02, grains=40)
    assert not verdict.at_rest


def test_settled_asks_for_kinetic_energy_as_a_share_of_m_g_d():
    size = 2.0 * np.cbrt(3.0 * 0.5e-3 / (4.0 * np.pi * MATERIAL.density))
    unit = 0.02 * MATERIAL.effective_gravity * size
    assert judge(looks(0.0, 0.99e-5 * unit)).at_rest
    verdict = judge(looks(0.0, 2e-5 * unit))
    assert not verdict.at_rest and "kinetic energy 2e-05 m g d per grain" in verdict.reason


@pytest.mark.parametrize("missing", ["window", "compaction", "kinetic_energy"])
def test_measures_are_keys_with_defaults(missing):
    assert getattr(GOAL, missing) == {"window": 0.1, "compaction": 5e-4, "kinetic_energy": 1e-5}[missing]
