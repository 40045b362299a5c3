"""The limit of the models towards the sphere: smooth grains that are nearly round are looser than the models predict.

The models are fitted to scanned and synthetic pebbles, which are polyhedra. Below a ratio L/S of 1.25 they rest on two
synthetic pebbles, and ellipsoids of the same axes make looser beds (docs/appendices/one_form.md).
"""

from functools import cache
from pathlib import Path

import pandas as pd

from simcore.paths import REFERENCE

LEAST_RATIO = 1.25  # L/S of the roundest scanned grain, rounded down
_COMPARED = 0.9129  # FL and EL in near_spheres.csv, for which L/S is 1.2


def is_nearly_round(sample) -> bool:
    """Return whether the mean equancy of a Sample is that of grains with L/S below LEAST_RATIO."""
    return sample.mu_EQ > 1.0 / LEAST_RATIO


def nearly_round_caveats(samples) -> list[str]:
    """Return a line on the Samples whose grains are nearly round."""
    names = dict.fromkeys(str(sample.name) for sample in samples if is_nearly_round(sample))
    return [f"{describe_nearly_round()}: {', '.join(names)}."] if names else []


@cache
def describe_nearly_round(folder=REFERENCE) -> str:
    """Return the sentence on such grains, with the porosities of spheres and ellipsoids in near_spheres.csv."""
    rows = pd.read_csv(Path(folder) / "near_spheres.csv").query("case == 'U1'")
    n = rows.groupby(["shape_kind", "flatness"])["n"].mean()
    ellipsoids, spheres = n["ellipsoid", _COMPARED], n["sphere", 1.0]
    return (
        "Smooth grains that are nearly round make looser beds than the models predict, which are fitted to pebbles: in "
        f"one sieve class, our packings of ellipsoids with L/S = 1.2 have {ellipsoids:.3f}, and those of spheres "
        f"{spheres:.3f}"
    )
