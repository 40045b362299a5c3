"""Part of a bed in which bulk porosity is evaluated: the heights left out at the floor and below the surface.

The module works without numba, so that this rule can be applied before a packing is run.
"""

import numpy as np

# Shaking packs the uppermost grains more closely (docs/explanation/porosity.md). At most a third of a low bed is cut,
# so that enough of it remains.
SURFACE_GRAINS, SURFACE_SHARE = 5.0, 1.0 / 3.0


SLICE = 1e-3  # [m], largest height of a slice, as in Rettinger et al. (2022)
GRAINS_OF_A_SLICE = 0.5  # largest height of a slice, in median grains


def slice_height(median):
    """Return the height [m] of the slices of a bed whose median grain is `median` [m]; it is used if none is given."""
    return min(SLICE, GRAINS_OF_A_SLICE * median)


def end_cuts(periodic, top, largest, median, cut=None):
    """Return the heights (at the floor, at the surface) [m] that are left out of a bed whose surface is at `top` [m].

    largest: upper bound of the sieve sizes [m]; median: sieve size below which half of the grains' volume is [m]; cut
    [m]: one height for both ends, or a pair for floor and surface. With None, nothing is left out in a cylinder, as in
    Rettinger et al. (2022). In a periodic box it is then the largest sieve size at the floor, and at the surface
    SURFACE_GRAINS median grains, but at most SURFACE_SHARE of the bed and at least the largest sieve size. ValueError
    if a cut is negative or not finite.
    """
    if cut is None and periodic:
        cut = (largest, max(largest, min(SURFACE_GRAINS * median, SURFACE_SHARE * top)))
    at_floor, at_surface = (float(height) for height in np.broadcast_to(0.0 if cut is None else cut, 2))
    if not (0.0 <= at_floor < np.inf and 0.0 <= at_surface < np.inf):
        raise ValueError(f"cut: {cut} is no height to leave out; give lengths [m] of at least 0, or None")
    return at_floor, at_surface


def campaign_cut(cut, periodic):
    """Return the cut of a campaign for a bed: its `porosity.cut` is for periodic boxes, so it is None in a cylinder."""
    return cut if periodic else None


def median_size(sizes, volumes):
    """Return the sieve size [m] below which half of the grains' volume is; sizes (n,) [m], volumes (n,)."""
    order = np.argsort(sizes)
    passing = np.cumsum(volumes[order])
    return float(sizes[order][np.searchsorted(passing, 0.5 * passing[-1])])
