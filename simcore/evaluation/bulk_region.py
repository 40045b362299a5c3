"""Bulk of a packing: the grains that are far enough from floor, surface and side wall to represent the material."""

from typing import NamedTuple

import numpy as np
import xarray as xr

from simcore.evaluation.porosity import bulk_porosity
from simcore.grains.form import equal_volume_diameter

# ASSUME: heights left out, in long axes (mean weighted by volume, so that one long grain does not change them).
# Measurements: docs/explanation/constants_packing.md, "Bulk of a bed".
FLOOR_LAYER, SURFACE_LAYER = 2.0, 1.0
# The wall of a cylinder orders the grains next to it like the floor.
WALL_LAYER = FLOOR_LAYER
# The slices in which the surface is searched are thin compared with a grain.
SLICES_PER_GRAIN = 8


class Bulk(NamedTuple):
    """The part of a bed that is evaluated."""

    grains: np.ndarray  # (n,) bool, the grains whose centre is in the bulk
    porosity: xr.Dataset  # of simcore.evaluation.porosity.bulk_porosity, exact slices, between z_lower and z_upper


def bulk(packing, cut=None):
    """Return the bulk of a packing: its grains, and its porosity with its lower and upper end.

    packing: Dataset of read_packing; cut [m]: thickness that is left out above the floor, below the surface (the
    height at which the bed is half solid), and in a cylinder next to its wall; None means FLOOR_LAYER, SURFACE_LAYER
    and WALL_LAYER long axes. A grain is in the bulk if its centre is. The porosity is that of the whole cross-section,
    in a cylinder up to its wall. ValueError if no grain is left.
    """
    if not packing.sizes["grain"]:
        raise ValueError("bulk: the packing contains no grain; check its amount and its log")
    long_axis = np.average(packing["L"].values, weights=packing["volume"].values)
    ends = (FLOOR_LAYER * long_axis, SURFACE_LAYER * long_axis) if cut is None else (cut, cut)
    at_wall = WALL_LAYER * long_axis if cut is None else cut
    diameter = equal_volume_diameter(float(packing["volume"].mean()))
    porosity = bulk_porosity(packing, "exact", ends, diameter / SLICES_PER_GRAIN)
    x, y, z = packing["position"].values.T
    grains = (z >= float(porosity["z_lower"])) & (z <= float(porosity["z_upper"]))
    if packing.attrs["domain_shape"] == "cylinder":
        grains &= np.hypot(x, y) <= 0.5 * packing.attrs["domain_width"] - at_wall
    if not grains.any():
        inner = f", {1e3 * at_wall:.1f} mm from the wall" if packing.attrs["domain_shape"] == "cylinder" else ""
        raise ValueError(
            f"bulk: no grain is left between {1e3 * float(porosity['z_lower']):.1f} mm and "
            f"{1e3 * float(porosity['z_upper']):.1f} mm{inner}; use more grains, a wider domain, or set a smaller cut"
        )
    return Bulk(grains, porosity)
