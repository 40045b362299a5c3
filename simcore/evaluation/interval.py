"""Which part of a bed its bulk porosity is taken from: the heights left out at the floor and below the surface.

No numba is needed, so that a packing can be judged by this rule before it is run.
"""

import numpy as np

# Shaking packs the uppermost grains closer: 46 single forms of U1 by up to 0.026 next to the surface, by 0.003 and less
# five grains below; at the floor by 0.004 (results/reference/height.csv). The study cuts 31.5 mm from both ends, in U1
# as much. Of a low bed a third is cut: what is left would be too little.
SURFACE_GRAINS, SURFACE_SHARE = 5.0, 1.0 / 3.0


def end_cuts(periodic, top, largest, median, cut=None):
    """Return the heights (at the floor, at the surface) [m] that are left out of a bed whose surface is at `top` [m].

    largest: upper bound of the sieve sizes [m]; median: sieve size that half of the grains' volume stays below [m].
    cut [m]: one height for both ends, or a pair for floor and surface. None is nothing in a cylinder, as in Rettinger
    et al. (2022); in a periodic box the largest sieve size at the floor, and at the surface SURFACE_GRAINS median
    grains, at most SURFACE_SHARE of the bed and at least the largest sieve size.
    """
    if cut is None and periodic:
        cut = (largest, max(largest, min(SURFACE_GRAINS * median, SURFACE_SHARE * top)))
    at_floor, at_surface = (float(height) for height in np.broadcast_to(0.0 if cut is None else cut, 2))
    return at_floor, at_surface


def median_size(sizes, volumes):
    """Return the sieve size [m] that half of the volume of grains of these sizes (n,) [m], volumes (n,) stays below."""
    order = np.argsort(sizes)
    passing = np.cumsum(volumes[order])
    return float(sizes[order][np.searchsorted(passing, 0.5 * passing[-1])])
