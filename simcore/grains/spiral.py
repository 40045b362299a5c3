"""Nearly uniform directions on the sphere."""

import numpy as np


def spiral_directions(n):
    """Return n unit vectors (n, 3) of nearly equal solid angle on the golden-angle spiral."""
    z = 1 - (2 * np.arange(n) + 1) / n
    azimuth = np.pi * (1 + np.sqrt(5)) * np.arange(n)
    radius = np.sqrt(1 - z**2)
    return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=1)
