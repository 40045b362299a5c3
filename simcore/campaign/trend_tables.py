"""Trends of size, form and orientation of the grains over the height: a table per study, and its means.

Rettinger et al. (2022) report no segregation by size and an isotropic mixing of size and shape.

Packings with the same seed draw the same sizes and, in a mixture, the same forms in the same order. Their random trends
of these quantities are therefore the same: the trends of size in 63 packings of one seed scatter by only 0.4 times
their own errors, and another seed gives another trend. For these quantities only seeds are independent samples. The
orientations of the grains are independent in each packing.
"""

import json

import numpy as np
import pandas as pd

from simcore.campaign.study_tables import OWN_CURVE

COLUMNS = [
    "study", "packing", "seed", "case", "kind", "quantity", "grains", "mean", "mean_std_error", "spearman_r", "p_value",
    "relative_change", "relative_change_std_error",
]  # fmt: skip
SUMMARY = [
    "study", "case", "kind", "quantity", "packings", "seeds", "grains", "spearman_r", "spearman_z", "relative_change",
    "relative_change_std_error", "mean", "mean_std_error", "isotropic",
]  # fmt: skip
ISOTROPIC_ANGLE = 1.0  # mean angle between a random line and the vertical [rad]
# Quantities that are drawn with the seed.
DRAWN = ("D", "EL", "FL")


def tabulate_trends(study, rows, evaluations):
    """Return a DataFrame with one row per packing and quantity (see simcore.evaluation.height_trends.QUANTITIES).

    study: its name. rows: dicts {packing, varied} as in simcore.campaign.studies. evaluations: their datasets from
    simcore.evaluation.evaluate. Columns: study, packing, seed, case, kind, quantity, grains (that have it, in the
    evaluated height), mean and its standard error in the quantity's unit, spearman_r, p_value, relative_change over the
    height and its standard error. A packing that is too low for trends has no row. A quantity equal for all grains has
    no trend (nan).
    """
    table = []
    for row, data in zip(rows, evaluations, strict=True):
        if "spearman_r" not in data:
            continue
        scene = json.loads(data.attrs["scene"])
        for quantity in data["quantity"].values:
            layers, errors = (data[f"{quantity}_{name}"].values for name in ("mean", "std_error"))
            # Evaluations of before 2026-11-29 have one number for all quantities.
            count = data.get(f"{quantity}_count", data["grain_count"]).values
            usable = count > 1  # one grain has no standard error
            share = count[usable] / count[usable].sum()
            trend = data.sel(quantity=quantity)
            table.append(
                {
                    "study": study,
                    "packing": row["packing"],
                    "seed": scene["seed"],
                    "case": scene["sizes"]["case"] or OWN_CURVE,
                    "kind": scene["shapes"]["kind"],
                    "quantity": str(quantity),
                    "grains": int(count.sum()),
                    "mean": float(share @ layers[usable]),
                    "mean_std_error": float(np.sqrt(share**2 @ errors[usable] ** 2)),
                    "spearman_r": float(trend["spearman_r"]),
                    "p_value": float(trend["p_value"]),
                    "relative_change": float(trend["relative_change"]),
                    "relative_change_std_error": float(trend["relative_change_std_error"]),
                }
            )
    return pd.DataFrame(table, columns=COLUMNS)


def summarise_trends(trends):
    """Return means over the packings: a DataFrame with one row for each study, case, kind of grain and quantity.

    trends: from tabulate_trends. spearman_r: mean over the packings, weighted by their number of grains less one, the
    inverse variance of a rank correlation without a trend. spearman_z: this mean over its standard error; without a
    trend it has a normal distribution. relative_change and mean, with standard errors: plain means. For the quantities
    in DRAWN the means are over the means of the seeds, each with the uncertainty of a single packing. isotropic: mean
    angle of randomly oriented long axes [rad], empty for the other quantities. Packings with an equal quantity for all
    grains do not count.
    """
    defined = trends[trends["spearman_r"].notna()]
    if defined.empty:
        return pd.DataFrame(columns=SUMMARY)
    keys = ["study", "case", "kind", "quantity"]
    groups = defined.groupby(keys, sort=False)
    table = pd.DataFrame([dict(zip(keys, group, strict=True)) | _combine(rows) for group, rows in groups])
    table["isotropic"] = np.where(table["quantity"] == "angle", ISOTROPIC_ANGLE, np.nan)
    return table[SUMMARY]


def _combine(rows):
    """Return the summary of one group of packings and one quantity as a dict."""
    drawn = rows["quantity"].iloc[0] in DRAWN
    sample = rows["seed"].to_numpy() if drawn else np.arange(len(rows))
    squared = {f"{name}_std_error": rows[f"{name}_std_error"] ** 2 for name in ("relative_change", "mean")}
    weight = rows["grains"] - 1.0
    weighted = rows.assign(weight=weight, weighted=weight * rows["spearman_r"], **squared)
    samples = weighted.groupby(sample)[["weight", "weighted", "relative_change", "mean", *squared]].mean()
    errors = np.sqrt(samples[list(squared)].sum()) / len(samples)
    return {
        "packings": len(rows),
        "seeds": rows["seed"].nunique(),
        "grains": rows["grains"].sum(),
        "spearman_r": samples["weighted"].sum() / samples["weight"].sum(),
        "spearman_z": samples["weighted"].sum() / np.sqrt(samples["weight"].sum()),
        **samples[["relative_change", "mean"]].mean(),
        **errors,
    }
