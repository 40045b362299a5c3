"""Distribution of pore sizes by local thickness.

The local thickness at a point of the pore space is the diameter of the largest sphere that contains the point and no
grain (Hildebrand and Rüegsegger 1997). PoreSpy computes it on voxels, for spheres whose radius is a whole number of
voxels.
"""

import numpy as np

from simcore.pores.network import extended

PERCENTILES = (10, 50, 90)


def pore_sizes(image, margin):
    """Return the diameters [m], increasing, and the shares of the pore volume that they have, two arrays.

    image: PoreImage with layers below and above those that count; margin [m]: width of the copies at periodic sides.
    Pores narrower than two voxels count to the smallest diameter.
    """
    import porespy

    pores, pad = extended(image.pores, image, margin)
    porespy.settings.tqdm["disable"] = True
    radius = porespy.filters.local_thickness(pores)
    nx, ny = image.pores.shape[:2]
    radius = radius[pad : pad + nx, pad : pad + ny, image.lowest : image.end][image.inside]
    values, counts = np.unique(np.maximum(radius, 1.0), return_counts=True)
    return 2.0 * values * float(np.cbrt(image.spacing.prod())), counts / counts.sum()


def percentile(diameters, shares, percent):
    """Return the diameter [m] below which this percentage of the pore volume is, between the steps linearly."""
    return float(np.interp(0.01 * percent, np.cumsum(shares) - 0.5 * shares, diameters))
