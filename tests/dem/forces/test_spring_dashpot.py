"""Single functions of the force law."""

import numpy as np
import pytest

from simcore.dem.forces.coulomb_friction import tangent_of
from simcore.dem.forces.patch_torque import patch_torque
from simcore.dem.forces.spring_dashpot import contact_law, explicit_dashpot
from simcore.dem.vectors import Vec
from tests.helpers.patch import Patch


@pytest.mark.parametrize("moment", [-1.3e-23, 0.0, 1e-8])
def test_a_patch_whose_moments_are_round_off_gives_a_torque(moment):
    """Second moments are differences: for a corner that barely touched, one was −1.3e-23 m², and its root nan."""
    law, mass = contact_law(0.1, 1e-3, 0.22, 0.5), 1e-3
    patch = Patch(spread=np.array([[moment, 0.0, 0.0, 0.0, 0.0, 0.0]]), twist=np.zeros(1))
    damping, tangential = explicit_dashpot.py_func(law)
    tangent = tangent_of.py_func(law, tangential, mass, 2.7)
    torque = patch_torque.py_func(damping * mass, tangent, 1e-5, Vec(0.0, 0.0, 1.0), Vec(3.0, 1.0, 2.0), patch, 0, True)
    assert np.isfinite(torque).all() and np.isfinite(patch.twist).all()
    # Friction resists the rotation about the normal, within its limit.
    assert -0.5 * 2.7 * np.sqrt(max(moment, 0.0)) * (1.0 + 1e-12) <= torque[2] <= 0.0
