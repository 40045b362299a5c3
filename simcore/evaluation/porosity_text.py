"""The bulk porosity of a packing as text, as JSON, and its profile as a table."""

import json

import numpy as np
import pandas as pd
from tabulate import tabulate

from simcore.evaluation.porosity import porosity_profile, warnings_of
from simcore.evaluation.rounding import heights_in_mm

METHODS = {"spheres": "spheres of equal volume, as in Rettinger et al. (2022)", "exact": "the grains themselves"}


def porosity_text(bulk, packing) -> str:
    """Return the result of simcore.evaluation.porosity.bulk_porosity as a table to read.

    packing: the Dataset that it was computed from, for the number of its grains.
    """
    low, high, top = heights_in_mm(*(float(bulk[name]) for name in ("z_lower", "z_upper", "bed_top")))
    n, error = float(bulk["n"]), float(bulk["n_std_error"])
    rows = [
        ("porosity n", f"{n:.4f} ± {error:.4f}"),
        ("evaluated", f"{low} to {high} mm above the floor"),
        ("surface of the bed", f"{top} mm above the floor"),
        ("grains in the bed", f"{packing.sizes['grain']}"),
        ("sliced", METHODS[bulk.attrs["method"]]),
    ]
    # With k contrasts the error is accurate to 1/sqrt(2 k), see simcore.evaluation.sampling_error.
    own_error = 100.0 / np.sqrt(2.0 * float(bulk["n_contrasts"]))
    notes = [
        "± is the sampling error: the expected scatter over seeds of a bed of this size. It is itself known to about "
        f"{own_error:.0f} %."
    ]
    notes += [f"warning: {line}" for line in warnings_of(packing)]
    return "\n".join([tabulate(rows, tablefmt="plain", disable_numparse=True), "", *notes])


def porosity_json(bulk, packing) -> str:
    """Return the scalars of bulk_porosity with their method, and the warnings, as JSON; lengths in metres."""
    scalars = {name: float(value) for name, value in bulk.data_vars.items() if value.ndim == 0}
    return json.dumps({"method": bulk.attrs["method"], **scalars, "warnings": warnings_of(packing)}, indent=1)


def profile_table(packing, bulk) -> pd.DataFrame:
    """Return n(z) by both methods, one row per slice, floor first.

    Columns: z, z_lower, z_upper [m]; n, n_exact: porosity with spheres of equal volume, and with the grains themselves;
    evaluated: share of the slice's height in the evaluated interval of `bulk`.
    """
    height = bulk.attrs["slice_height"]
    spheres, exact = (porosity_profile(packing, height, method) for method in ("spheres", "exact"))
    longer = max(spheres, exact, key=lambda profile: profile.sizes["z"])
    low, high = longer["z_bounds"].values.T
    columns = {"z": longer["z"].values, "z_lower": low, "z_upper": high}
    for name, profile in (("n", spheres), ("n_exact", exact)):
        missing = len(low) - profile.sizes["z"]  # the other method reaches higher; there is nothing above
        columns[name] = np.append(profile["porosity"].values, np.ones(missing))
    inside = np.minimum(high, float(bulk["z_upper"])) - np.maximum(low, float(bulk["z_lower"]))
    columns["evaluated"] = np.clip(inside / height, 0.0, 1.0).round(9)
    return pd.DataFrame(columns)
