"""Measures of the sphericity and flat facets of grains, and their ranges over scanned gravel."""

from pathlib import Path

import numpy as np
import pandas as pd

from simcore.grains.form import ellipsoid_sphericity
from simcore.grains.mesh import decimate, make_grain
from simcore.grains.spiral import spiral_directions

# Number of faces at which shapes are compared: the share in facets depends on it, and the Rhine meshes have <= 300.
COMPARED_FACES = 300


def scan_ranges():
    """Read min, max, mean and std of each shape measure over 65 scanned grains, DataFrame of scan_ranges.csv."""
    return pd.read_csv(Path(__file__).with_name("scan_ranges.csv"), comment="#", index_col="measure")


def shape_measures(grain):
    """Return sphericity and share of surface in the ten largest facets, of the hull and at COMPARED_FACES, Series.

    relative_sphericity is the sphericity of the hull divided by that of its ellipsoid, so it does not depend on form.
    """
    coarse = decimate(grain, COMPARED_FACES)
    return pd.Series(
        {
            "sphericity": grain.sphericity,
            "facet_share": grain.facet_share,
            "relative_sphericity": grain.sphericity / ellipsoid_sphericity(grain.L, grain.I, grain.S),
            "sphericity_300": coarse.sphericity,
            "facet_share_300": coarse.facet_share,
        }
    )


def shape_table(grains):
    """Return shape_measures of each grain, DataFrame (n, 5) indexed by name."""
    return pd.DataFrame([shape_measures(grain) for grain in grains], index=[grain.name for grain in grains])


def ellipsoid_counterparts(grains):
    """Return for each grain a Grain of the same name that is its mass-equivalent ellipsoid with as many faces."""
    spheres = [make_grain(grain.name, spiral_directions(len(grain.vertices))) for grain in grains]
    return [
        sphere.scaled(np.array([grain.S, grain.I, grain.L]) / [sphere.S, sphere.I, sphere.L])
        for grain, sphere in zip(grains, spheres, strict=True)
    ]
