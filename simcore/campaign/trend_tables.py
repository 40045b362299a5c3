"""Whether size, form and orientation of the grains change over height: a table of a study's packings, and its means.

The source study finds no segregation by size and an isotropic mixing of size and shape.

Packings of one seed draw the same sizes and, in a mixture, the same forms in the same order, so that chance leaves
the same trend of these in all of them: 63 beds of one seed have a change of size that scatters by 0.4 times each
one's own error, the same beds of another seed another change. Only seeds are independent here. How grains lie is each
packing's own.
"""

import json

import numpy as np
import pandas as pd

COLUMNS = [
    "study", "packing", "seed", "case", "kind", "quantity", "grains", "mean", "mean_std_error", "spearman_r", "p_value",
    "relative_change", "relative_change_std_error",
]  # fmt: skip
SUMMARY = [
    "study", "case", "kind", "quantity", "packings", "seeds", "grains", "spearman_r", "spearman_z", "relative_change",
    "relative_change_std_error", "mean", "mean_std_error", "isotropic",
]  # fmt: skip
ISOTROPIC_ANGLE = 1.0  # mean angle of a random line against the vertical [rad]
# What is drawn with the seed.
DRAWN = ("D", "EL", "FL")


def tabulate_trends(study, rows, evaluations):
    """DataFrame with one row a packing and quantity (see simcore.evaluation.height_trends.QUANTITIES).

    study: its name; rows: dicts {packing, varied} as simcore.campaign.studies has them; evaluations: their datasets, as
    from simcore.evaluation.evaluate. Columns: study, packing, seed, case, kind, quantity, grains (between the heights
    looked at), mean and its standard error in the quantity's unit, spearman_r, p_value, relative_change over the height
    and its standard error. A packing too low for trends has no row; a quantity that is the same for all grains no trend
    (nan).
    """
    table = []
    for row, data in zip(rows, evaluations, strict=True):
        if "spearman_r" not in data:
            continue
        scene = json.loads(data.attrs["scene"])
        count = data["grain_count"].values
        for quantity in data["quantity"].values:
            layers, errors = (data[f"{quantity}_{name}"].values for name in ("mean", "std_error"))
            some = count > 1  # a single grain tells no scatter, none no mean
            share = count[some] / count[some].sum()
            trend = data.sel(quantity=quantity)
            table.append(
                {
                    "study": study,
                    "packing": row["packing"],
                    "seed": scene["seed"],
                    "case": scene["sizes"]["case"] or "own",
                    "kind": scene["shapes"]["kind"],
                    "quantity": str(quantity),
                    "grains": int(count.sum()),
                    "mean": float(share @ layers[some]),
                    "mean_std_error": float(np.sqrt(share**2 @ errors[some] ** 2)),
                    "spearman_r": float(trend["spearman_r"]),
                    "p_value": float(trend["p_value"]),
                    "relative_change": float(trend["relative_change"]),
                    "relative_change_std_error": float(trend["relative_change_std_error"]),
                }
            )
    return pd.DataFrame(table, columns=COLUMNS)


def summarise_trends(trends):
    """Means over the packings of a study, DataFrame: one row for each study, case, kind of grain and quantity.

    trends: of tabulate_trends. spearman_r: mean of the packings, weighted by their grains less one, which are the
    inverse variances of rank correlations where there is no trend; spearman_z: that mean in its standard errors, of
    normal distribution then. relative_change and mean with standard errors: plain means. Of what is DRAWN all this is
    over the means of the seeds, each as certain as one of its packings. isotropic: the mean angle of long axes that
    point anywhere [rad], empty for the other quantities. Packings whose quantity is the same for all grains do not
    count.
    """
    known = trends[trends["spearman_r"].notna()]
    if known.empty:
        return pd.DataFrame(columns=SUMMARY)
    keys = ["study", "case", "kind", "quantity"]
    groups = known.groupby(keys, sort=False)
    table = pd.DataFrame([dict(zip(keys, group, strict=True)) | _combine(rows) for group, rows in groups])
    table["isotropic"] = np.where(table["quantity"] == "angle", ISOTROPIC_ANGLE, np.nan)
    return table[SUMMARY]


def _combine(rows):
    """The summary of one group of packings of one quantity, dict."""
    drawn = rows["quantity"].iloc[0] in DRAWN
    sample = rows["seed"].to_numpy() if drawn else np.arange(len(rows))
    squared = {f"{name}_std_error": rows[f"{name}_std_error"] ** 2 for name in ("relative_change", "mean")}
    weight = rows["grains"] - 1.0
    each = rows.assign(weight=weight, weighted=weight * rows["spearman_r"], **squared)
    samples = each.groupby(sample)[["weight", "weighted", "relative_change", "mean", *squared]].mean()
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
