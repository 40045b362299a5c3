"""Shares of patches that a step could reuse, from the relative motion of two bodies since the last measurement."""

import numpy as np
import pytest

from benchmarks.speed.patches import kept_shares


def contact(shift, angle=0.0, overlap=1e-6, lever=0.01):
    turn = np.array([[np.cos(angle), -np.sin(angle), 0.0], [np.sin(angle), np.cos(angle), 0.0], [0.0, 0.0, 1.0]])
    return np.array([0.01 + shift, 0.0, 0.0]), turn, lever, overlap


def test_a_contact_that_does_not_move_is_measured_once():
    assert kept_shares([{(0, 1): contact(0.0)}] * 10, [0.1]) == {0.1: pytest.approx(0.9)}


def test_motion_adds_up_until_the_patch_is_measured_again():
    # Each step moves by 0.04 of the overlap: measured, kept, kept, measured, ...
    steps = [{(0, 1): contact(0.04e-6 * k)} for k in range(9)]
    assert kept_shares(steps, [0.1, 0.03]) == {0.1: pytest.approx(6 / 9), 0.03: 0.0}


def test_rotation_counts_with_its_lever_and_an_ended_contact_is_forgotten():
    turning = [{(0, 1): contact(0.0, angle=k * 3e-5)} for k in range(4)]  # 0.3 of the overlap a step
    assert kept_shares(turning, [0.2]) == {0.2: 0.0}
    assert kept_shares(turning, [0.5]) == {0.5: pytest.approx(0.5)}
    again = [{(0, 1): contact(0.0)}, {}, {(0, 1): contact(0.0)}]
    assert kept_shares(again, [0.5]) == {0.5: 0.0}
