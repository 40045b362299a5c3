"""Size, form and orientation of the grains over height, with a test for trends."""

import numpy as np
import xarray as xr
from scipy.stats import linregress, spearmanr

from simcore.evaluation.axis_statistics import DISTINCT, check_order_of_axes
from simcore.evaluation.porosity import describe, evaluation_interval, largest_sieve_size, porosity_profile
from simcore.evaluation.slicing import vertical_axes

FEWEST = 4  # grains, of which a trend is tested
# name: (units, long_name)
QUANTITIES = {
    "D": ("m", "sieve size"),
    "FL": ("1", "flatness S/I"),
    "EL": ("1", "elongation I/L"),
    "angle": ("rad", "angle of the long axis against the vertical"),
}


def height_trends(packing, interval=None, n_layers=5):
    """Return number-based means of D, FL, EL and the long axis' angle in layers, with a test for trends, Dataset.

    packing: Dataset of read_packing; interval: heights (low, high) [m] of the centres of the grains that are included;
    None cuts the largest sieve size from both ends of the bed in both kinds of domain, because the centres of large
    grains on a floor are higher than those of small ones. n_layers: number of equal layers of the profile, which does
    not affect the test.

    The test is Spearman's rank correlation of the quantity with height over single grains: spearman_r and p_value (two
    sided; four quantities are tested, so compare p with 0.05/4). relative_change is the change from the lower to the
    upper end of the interval by linear regression, divided by the mean. These are nan for a quantity that is the same
    for all grains. Isotropic long axes have a mean angle of 1 rad; grains without a long axis, such as spheres, do not
    count in it. ValueError if there are too few grains.
    """
    if interval is None:
        profile = porosity_profile(packing)
        interval = evaluation_interval(packing, profile, cut=largest_sieve_size(packing))
    low, high = interval
    z = packing["position"].values[:, 2]
    inside = (z >= low) & (z <= high)
    if inside.sum() < FEWEST:
        raise ValueError(
            f"height_trends: only {inside.sum()} grains have their centre between {low:.4g} m and {high:.4g} m, too "
            "few for a trend; widen the interval or use more grains"
        )
    z = z[inside]
    edges = np.linspace(low, high, n_layers + 1)
    layer = np.minimum(np.searchsorted(edges, z, side="right") - 1, n_layers - 1)
    count = np.bincount(layer, minlength=n_layers)

    data = {
        "grain_count": ("z", count, {"units": "1", "long_name": "number of grains in the layer"}),
        "z_bounds": (("z", "bound"), np.stack([edges[:-1], edges[1:]], axis=1)),
    }
    trends = []
    for name, values in _grain_quantities(packing).items():
        values = values[inside]
        known = np.isfinite(values)
        values, of_layer = values[known], layer[known]
        units, text = QUANTITIES[name]
        of_quantity = np.bincount(of_layer, minlength=n_layers)
        mean, error = _layer_means(values, of_layer, of_quantity)
        data[f"{name}_count"] = ("z", of_quantity, {"units": "1", "long_name": f"number of grains in the mean {text}"})
        data[f"{name}_mean"] = ("z", mean, {"units": units, "long_name": f"mean {text}"})
        data[f"{name}_std_error"] = ("z", error, {"units": units, "long_name": f"standard error of the mean {text}"})
        trends.append(_trend(z[known], values, high - low))
    columns = zip(
        ("spearman_r", "p_value", "relative_change", "relative_change_std_error"),
        (
            "Spearman's rank correlation with height",
            "two-sided p-value of no trend over height",
            "change from the lower to the upper end by linear regression, divided by the mean",
            "standard error of the relative change",
        ),
        np.transpose(trends),
        strict=True,
    )
    for name, text, values in columns:
        data[name] = ("quantity", values, {"units": "1", "long_name": text})
    height = {"units": "m", "long_name": "height above the floor", "axis": "Z", "positive": "up", "bounds": "z_bounds"}
    return xr.Dataset(
        data,
        coords={"z": ("z", 0.5 * (edges[1:] + edges[:-1]), height), "quantity": list(QUANTITIES)},
        attrs=describe(packing, "Size, form and orientation of the grains over height")
        | {"n_grains": int(inside.sum())},
    )


def long_axis_angle(orientation):
    """Return the angle of each grain's long axis (its own z) with the vertical, 0 to pi/2, (n,) [rad].

    orientation: quaternions (n, 4).
    """
    return np.arccos(np.clip(np.abs(vertical_axes(np.asarray(orientation))[:, 2]), 0.0, 1.0))


def _grain_quantities(packing):
    """Return the quantities of QUANTITIES for every grain, dict of (n,)."""
    long_axis, middle, short = (packing[name].values for name in ("L", "I", "S"))
    return {
        "D": packing["D"].values,
        "FL": short / middle,
        "EL": middle / long_axis,
        "angle": _angles(packing),
    }


def _angles(packing):
    """Return the angle of each grain's long axis with the vertical (n,) [rad]; nan for a grain that has none."""
    has_one = packing["L"].values > (1.0 + DISTINCT) * packing["I"].values
    check_order_of_axes(packing)
    return np.where(has_one, long_axis_angle(packing["orientation"].values), np.nan)


def _layer_means(values, layer, count):
    """Return the mean and its standard error in each layer; they are nan if a layer has too few grains."""
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = np.bincount(layer, values, len(count)) / count
        squares = np.bincount(layer, (values - mean[layer]) ** 2, len(count))
        return mean, np.sqrt(squares / (count - 1) / count)


def _trend(z, values, height):
    """Return Spearman's r, its p-value, the relative change by linear regression, and its standard error."""
    if len(values) < FEWEST:
        return np.full(4, np.nan)
    if np.ptp(values) <= 1e-9 * np.abs(values).max():  # all grains have the same value, up to round-off
        return np.full(4, np.nan)
    rank = spearmanr(z, values)
    line = linregress(z, values)
    return rank.statistic, rank.pvalue, line.slope * height / values.mean(), line.stderr * height / values.mean()
