"""The bulk of a packing: which grains are far enough from floor, surface and side wall to stand for the material."""

from typing import NamedTuple

import numpy as np
import xarray as xr

from simcore.evaluation.porosity import bulk_porosity

# ASSUME: the heights left out, in long axes (their mean by volume: one long grain among many does not move the ends).
# Of 900 shaken spheres and as many ellipsoids (S/I 0.55, I/L 0.6) P2 of the contact normals in layers of a quarter axis
# was off by up to 0.2 at the floor and within its scatter from two axes up; below the surface contacts are
# fewer over three quarters of an axis. Deposits of four long axes keep one of them.
FLOOR_LAYER, SURFACE_LAYER = 2.0, 1.0
# The cylinder's wall orders the grains beside it as the floor does.
WALL_LAYER = FLOOR_LAYER
# Slices in which the surface is looked for are thin against a grain of whatever size.
SLICES_PER_GRAIN = 8


class Bulk(NamedTuple):
    grains: np.ndarray  # (n,) bool, the grains whose centre lies in the bulk
    porosity: xr.Dataset  # of simcore.evaluation.porosity.bulk_porosity, exact slices, between z_lower and z_upper


def bulk(packing, cut=None):
    """Bulk of a packing: its grains, and its porosity with the heights between which it lies.

    packing: Dataset as in packing_io; cut [m]: what is left out above the floor and below the surface (the height at
    which the bed is half solid), and in a cylinder beside its wall; None: FLOOR_LAYER, SURFACE_LAYER and WALL_LAYER
    long axes. A grain is in the bulk if its centre is. The porosity is that of the whole section, in a cylinder up
    to its wall. ValueError if nothing is left.
    """
    if not packing.sizes["grain"]:
        raise ValueError("bulk: the packing holds no grain; check its amount and its log")
    long_axis = np.average(packing["L"].values, weights=packing["volume"].values)
    ends = (FLOOR_LAYER * long_axis, SURFACE_LAYER * long_axis) if cut is None else (cut, cut)
    at_wall = WALL_LAYER * long_axis if cut is None else cut
    diameter = np.cbrt(6.0 / np.pi * float(packing["volume"].mean()))
    porosity = bulk_porosity(packing, "exact", ends, diameter / SLICES_PER_GRAIN)
    x, y, z = packing["position"].values.T
    grains = (z >= float(porosity["z_lower"])) & (z <= float(porosity["z_upper"]))
    if packing.attrs["domain_shape"] == "cylinder":
        grains &= np.hypot(x, y) <= 0.5 * packing.attrs["domain_width"] - at_wall
    if not grains.any():
        beside = f" and {1e3 * at_wall:.1f} mm beside the wall" if packing.attrs["domain_shape"] == "cylinder" else ""
        raise ValueError(
            f"bulk: no grain is left between {1e3 * float(porosity['z_lower']):.1f} mm and "
            f"{1e3 * float(porosity['z_upper']):.1f} mm{beside}; use more grains, a wider domain, or set a smaller cut"
        )
    return Bulk(grains, porosity)
