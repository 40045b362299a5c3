"""Orientations as quaternions w, x, y, z."""

import numpy as np
from scipy.spatial.transform import Rotation

IDENTITY = (1.0, 0.0, 0.0, 0.0)


def random_orientations(n, rng):
    """Return uniform random quaternions (n, 4); rng: a generator or a seed."""
    return Rotation.random(n, rng=rng).as_quat(scalar_first=True)


def turn_about(direction, angle):
    """Return the quaternion (4,) of a turn about a direction (3,) by an angle [rad]."""
    direction = np.asarray(direction, float)
    return Rotation.from_rotvec(angle * direction / np.linalg.norm(direction)).as_quat(scalar_first=True)


def turn_about_axis(axis, degrees):
    """Return the quaternion (4,) of a turn about "x", "y" or "z" by an angle in degrees."""
    return Rotation.from_euler(axis, degrees, degrees=True).as_quat(scalar_first=True)


X45, Y45, Z45 = (turn_about_axis(axis, 45) for axis in "xyz")
