"""Leaves of the force law by themselves."""

import numpy as np
import pytest

from simcore.dem.forces.spring_dashpot import contact_law, explicit_dashpot, patch_torque


@pytest.mark.parametrize("moment", [-1.3e-23, 0.0, 1e-8])
def test_a_patch_whose_moments_are_round_off_gives_a_torque(moment):
    """Second moments are differences: where a corner only just presses they came out as −1.3e-23 m², and √ as nan."""
    law = contact_law(0.1, 1e-3, 0.22, 0.5)
    spread, twists = np.array([[moment, 0.0, 0.0, 0.0, 0.0, 0.0]]), np.zeros(1)
    dashpots = explicit_dashpot.py_func(law)
    torque = patch_torque.py_func(
        law, *dashpots, 1e-3, 2.7, 1e-5, 0.0, 0.0, 1.0, 3.0, 1.0, 2.0, spread, twists, 0, True
    )  # fmt: skip
    assert np.isfinite(torque).all() and np.isfinite(twists).all()
    # Friction resists the turn about the normal, within its limit
    assert -0.5 * 2.7 * np.sqrt(max(moment, 0.0)) * (1.0 + 1e-12) <= torque[2] <= 0.0
