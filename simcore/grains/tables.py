"""Tables about a set of grains: statistics of form as in Rettinger et al. (2022), form factors, decimation."""

import numpy as np
import pandas as pd
from scipy.stats import shapiro
from sklearn.decomposition import PCA
from sklearn.preprocessing import StandardScaler

from simcore.grains.form import FORM_FACTORS, form_factors
from simcore.grains.mesh import coarsen
from simcore.grains.scan_shapes import scan_ranges

FACE_TARGETS = (300, 200, 100, 50)


def form_table(grains):
    """Return a DataFrame with one row per grain, indexed by its name.

    Columns: L, I, S, D [mm], volume [mm³], faces, sphericity, hull_ratio (as in Grain) and the 13 form factors.
    """
    table = pd.DataFrame(
        {
            "L_mm": [grain.L * 1e3 for grain in grains],
            "I_mm": [grain.I * 1e3 for grain in grains],
            "S_mm": [grain.S * 1e3 for grain in grains],
            "D_mm": [grain.sieve_size * 1e3 for grain in grains],
            "volume_mm3": [grain.volume * 1e9 for grain in grains],
            "faces": [len(grain.faces) for grain in grains],
            "sphericity": [grain.sphericity for grain in grains],
            "hull_ratio": [grain.hull_ratio for grain in grains],
        },
    )
    table = pd.concat([table, form_factors(table.L_mm, table.I_mm, table.S_mm)], axis=1)
    return table.set_index(pd.Index([grain.name for grain in grains], name="grain"))


FEWEST_GRAINS = 3  # for correlations and tests of a distribution


def form_statistics(table):
    """Return the statistics of form of a set, DataFrame with one row; they include those of Table 2 of Rettinger et al.

    table: from form_table. Standard deviations are those of a sample (n - 1). shapiro_*: W and p of the Shapiro-Wilk
    test; Rettinger et al. (2022) regard a factor as normal if p > 0.05. r_*: Pearson correlations; those with size use
    its logarithm. What needs three grains is nan for a smaller set.
    """
    enough = len(table) >= FEWEST_GRAINS
    row = {"size_min_mm": table.D_mm.min(), "size_max_mm": table.D_mm.max(), "n_samples": len(table)}
    for factor in ("FL", "EL"):
        row |= {f"mu_{factor}": table[factor].mean(), f"sigma_{factor}": table[factor].std(ddof=1)}
    for factor in ("FL", "EL"):
        W, p = shapiro(table[factor]) if enough else (np.nan, np.nan)
        row |= {f"shapiro_W_{factor}": W, f"shapiro_p_{factor}": p}
    columns = table[["FL", "EL"]].assign(size=np.log(table.D_mm)).corr(min_periods=FEWEST_GRAINS)
    row |= {"r_FL_EL": columns.loc["FL", "EL"]}
    row |= {f"r_size_{factor}": columns.loc["size", factor] for factor in ("FL", "EL")}
    return pd.DataFrame([row])


def factor_correlations(table):
    """Return the Pearson correlations of the 13 form factors, DataFrame (13, 13), over grains with finite factors.

    They are nan for fewer than three such grains.
    """
    return _finite_factors(table).corr(min_periods=FEWEST_GRAINS)


def principal_components(table):
    """Return the principal components of the standardised form factors, DataFrame with one row per component.

    Columns: explained (share of the variance), cumulative, then the 13 loadings, of which the largest is positive. Only
    grains with finite factors are used; with fewer than three, there are no rows.
    """
    factors = _finite_factors(table)
    if len(factors) < FEWEST_GRAINS:
        return pd.DataFrame(columns=["explained", "cumulative", *factors.columns]).rename_axis("component")
    pca = PCA().fit(StandardScaler().fit_transform(factors))
    loadings = pca.components_
    largest = loadings[np.arange(len(loadings)), np.abs(loadings).argmax(axis=1)]
    shares = pca.explained_variance_ratio_
    result = pd.DataFrame(loadings * np.sign(largest)[:, None], columns=factors.columns)
    result.insert(0, "explained", shares)
    result.insert(1, "cumulative", np.cumsum(shares))
    return result.set_index(pd.Index([f"PC{i + 1}" for i in range(len(result))], name="component"))


def _finite_factors(table):
    return table[list(FORM_FACTORS)].replace([np.inf, -np.inf], np.nan).dropna()


def decimation_table(grains, targets=FACE_TARGETS):
    """Return the changes by decimation, DataFrame with one row per grain and target number of faces.

    Columns: grain, target, faces, and the changes [%] of volume (before it is restored), flatness, elongation and
    sphericity, relative to the grain's own. A grain with no more faces than the target has changes of zero, which count
    in averages, as in Rettinger et al. (2022).
    """
    rows = []
    for target in targets:
        for grain in grains:
            coarse = coarsen(grain, target)
            row = {"grain": grain.name, "target": target, "faces": len(coarse.faces)}
            for name in ("volume", "flatness", "elongation", "sphericity"):
                row[f"{name}_change_percent"] = 100 * (getattr(coarse, name) / getattr(grain, name) - 1)
            rows.append(row)
    return pd.DataFrame(rows)


def decimation_summary(table):
    """Return the mean and the largest absolute change [%] of a set for each target; table: from decimation_table."""
    changes = table.drop(columns=["grain", "faces"]).groupby("target", sort=False)
    mean, largest = changes.mean(), changes.agg(lambda column: column.abs().max())
    return mean.join(largest.add_suffix("_largest"))


def shape_comparison(shapes):
    """Compare the shapes of a set with those of scanned grains, DataFrame with one row per measure.

    shapes: from shape_table. Columns: min, max, mean, std; the same of 65 scanned grains with the prefix scans_; and
    within, whether all grains are in the range of the scans. Measures *_300 are at similar numbers of faces, the others
    at each grain's own number.
    """
    statistics = shapes.agg(["min", "max", "mean", "std"]).T
    scans = scan_ranges().loc[statistics.index, ["min", "max", "mean", "std"]]
    within = (statistics["min"] >= scans["min"]) & (statistics["max"] <= scans["max"])
    return statistics.join(scans.add_prefix("scans_")).assign(within=within).rename_axis("measure")
