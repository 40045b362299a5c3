"""Differences in porosity between packings of polyhedra and of their mass-equivalent ellipsoids."""

import numpy as np
import pandas as pd

from simcore.evaluation.confidence import error_of_mean
from simcore.models.tables import join_r22


def pair_shape_kinds(meshes, ellipsoids):
    """Return one row per case and grain that both tables have: case, grain, EQ, n_mesh, n_ellipsoid (means).

    meshes, ellipsoids: tables of the packings of polyhedra and of ellipsoids. n_mesh_error, n_ellipsoid_error: standard
    errors of the means, from the sampling errors of the packings.
    """
    keys = ["case", "grain"]

    def mean(table):
        groups = table.groupby(keys, sort=False)
        return groups[["EQ", "n"]].mean().assign(error=groups["n_std_error"].agg(error_of_mean))

    mesh = mean(meshes).rename(columns={"n": "n_mesh", "error": "n_mesh_error"})
    ellipsoid = mean(ellipsoids)[["n", "error"]].rename(columns={"n": "n_ellipsoid", "error": "n_ellipsoid_error"})
    paired = mesh.join(ellipsoid, how="inner").reset_index()
    return paired[["case", "grain", "EQ", "n_mesh", "n_ellipsoid", "n_mesh_error", "n_ellipsoid_error"]]


def shape_kind_table(packings, r22=None):
    """Return the differences in porosity between polyhedra and their equivalent ellipsoids, one row per case.

    packings: columns case, n_mesh, n_ellipsoid, one row per form. r22: columns case, rms_difference, the values of
    Rettinger et al. (2022).
    """
    difference = packings["n_mesh"] - packings["n_ellipsoid"]
    groups = difference.groupby(packings["case"], sort=False)
    table = pd.DataFrame(
        {
            "rms_difference": groups.apply(lambda d: np.sqrt(np.mean(d**2))),
            "mean_difference": groups.mean(),
            "forms": groups.size(),
        }
    ).reset_index()
    return table if r22 is None else join_r22(table, r22, ["case"], {"rms_difference": "r22_rms_difference"})
