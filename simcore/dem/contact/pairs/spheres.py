"""Sphere against sphere, in closed form."""

import numpy as np

from simcore.compilation import leaf


@leaf
def touch(bodies, i, j, rx, ry, rz):
    """(overlap [m], normal a to b (3), contact point relative to a (3)); apart where the overlap is not positive.

    Concentric spheres separate along x: the direction is not unique there.
    """
    radius_a, radius_b = bodies.scale[i, 0], bodies.scale[j, 0]
    distance = np.sqrt(rx * rx + ry * ry + rz * rz)
    overlap = radius_a + radius_b - distance
    if distance > 0.0:
        nx, ny, nz = rx / distance, ry / distance, rz / distance
    else:
        nx, ny, nz = 1.0, 0.0, 0.0
    arm = radius_a - 0.5 * overlap
    return overlap, nx, ny, nz, arm * nx, arm * ny, arm * nz
