"""Models of beds with a distribution of form: porosity from means and standard deviations over the grains."""

import logging

import numpy as np
import pandas as pd

from simcore.models.regression import (
    FOLDS,
    correlate,
    cross_validate,
    dependent,
    fewest_samples,
    fit_and_validate,
    usable_features,
)
from simcore.models.tables import join_r22, join_r22_models, over_seeds, rows_of_models
from simcore.reference.columns import SPECIFIED_MEANS

log = logging.getLogger(__name__)

MIXTURE = ("mu_EQ_inv", "sigma_EQ_inv", "mu_EL_inv", "sigma_EL_inv")
FEWEST_MEANS = len(MIXTURE) + 2  # with fewer mean forms, those that remain hardly determine the coefficients
# Feature sets of Table 10 of Rettinger et al. (2022).
MIXTURE_SETS = (
    ("mu_EQ_inv",),
    ("mu_EQ_inv", "sigma_EQ_inv"),
    ("mu_EQ_inv", "sigma_EQ_inv", "mu_EL_inv"),
    MIXTURE,
    ("mu_EQ_inv", "mu_EL_inv"),
    ("mu_EQ_inv", "sigma_EQ_inv", "sigma_EL_inv"),
)


def mixture_models(packings, r22_correlations=None, r22_sets=None, r22_models=None, seed=0, folds=FOLDS):
    """Fit the models of form mixtures, per case; returns (tables, models) as single_form_models does.

    packings: one row per packing, columns case, n and the 104 of mixture_features; if there is a column sample, the
    packings of a sample are averaged first. If there are columns mean_FL and mean_EL with FEWEST_MEANS mean forms or
    more, sets of one mean form are left out of a model together, as for the unified model, so that their errors can be
    compared; the errors of the feature sets are those of single sets, as in Table 10. Tables: `correlations` of all
    usable features, the strongest first, `feature_sets` (the sets of Table 10 with cross-validated errors and R² of the
    fit to all packings), `models`. A set is left out with a logged warning if one of its features cannot be used or it
    has too few packings for its coefficients. folds: number of folds of the cross-validation. r22_correlations,
    r22_sets, r22_models: tables correlations.csv, table10_form_mixture_features.csv and models.csv of Rettinger et al.
    (2022).
    """
    correlations, sets, models = [], [], {}
    for case, rows in over_seeds(packings, "sample").groupby("case", sort=False):
        n = rows["n"].to_numpy()
        groups = groups_of_means(rows)
        rows = rows.drop(columns=list(SPECIFIED_MEANS), errors="ignore")
        features = usable_features(rows.drop(columns=["case", "n"]).select_dtypes("number"))
        correlations.append(
            correlate(features, n)
            .rename_axis("feature")
            .reset_index()
            .assign(case=case, samples=len(n))
            .sort_values("r", key=np.abs, ascending=False, kind="stable")
        )
        for columns in MIXTURE_SETS:
            if not set(columns) <= set(features) or len(n) < fewest_samples(columns):
                log.warning(
                    "case %s: feature set %s is left out: %d packings are too few, or a feature is unusable",
                    case,
                    columns,
                    len(n),
                )
                continue
            chosen = features[list(columns)]
            if dependent(chosen):
                log.warning("case %s: feature set %s is left out: its features depend on each other", case, columns)
                continue
            flags = {name: int(name in columns) for name in MIXTURE}
            model = fit_and_validate(chosen, n, "form_mixture", case, seed, groups, folds)
            result = cross_validate(chosen, n, folds, seed=seed)
            sets.append({"case": case, **flags, **result, "r_squared": model.r_squared, "samples": len(n)})
            if columns == MIXTURE:
                models["form_mixture", case] = model
    tables = {
        "correlations": pd.concat(correlations, ignore_index=True),
        "feature_sets": pd.DataFrame(sets, columns=None if sets else ["case", *MIXTURE]),
        "models": rows_of_models(models),
    }
    if r22_correlations is not None:
        published = r22_correlations.query("study == 'form_mixture'")
        published = published.assign(feature=published["feature"].str.replace(" inverse", "_inv"))
        tables["correlations"] = join_r22(tables["correlations"], published, ["case", "feature"], {"r": "r22_r"})
    if r22_sets is not None:
        published = _long_sets(r22_sets)
        columns = {"mae_1e-3": "r22_error", "R2": "r22_r_squared"}
        tables["feature_sets"] = join_r22(tables["feature_sets"], published, ["case", *MIXTURE], columns)
    if r22_models is not None and models:
        tables["models"] = join_r22_models(tables["models"], r22_models)
    return tables, models


def groups_of_means(rows, least=FEWEST_MEANS):
    """Return the labels (n,) of sets of one mean form, which are left out of a fit together.

    None if rows has no columns mean_FL and mean_EL, fewer than `least` mean forms, or too few other sets for a fit.
    """
    if not set(SPECIFIED_MEANS) <= set(rows):
        return None
    groups = rows.groupby(list(SPECIFIED_MEANS)).ngroup()
    few = groups.nunique() < least or len(rows) - groups.value_counts().max() <= len(MIXTURE) + 1
    return None if few else groups


def application_table(models, packings, r22=None):
    """Predict packings that no model was fitted to, as in Table 11 of Rettinger et al. (2022); one row per packing.

    models: dict from (name, case) to PorosityModel with the models "form_mixture" and, optionally, "unified". packings:
    columns case, kind ("continuous" or "discrete"), n and the models' features. r22: table11_application.csv.
    """
    rows = packings[packings["case"].isin({case for name, case in models if name == "form_mixture"})]
    table = rows[["case", "kind", "n"]].rename(columns={"n": "simulated"})
    for name, prefix in (("form_mixture", ""), ("unified", "unified_")):
        if any(model == name for model, _ in models):
            predicted = [
                float(models[name, case].predict(rows.loc[[index]])[0]) if (name, case) in models else np.nan
                for index, case in rows["case"].items()
            ]
            table[f"{prefix}predicted"] = predicted
            table[f"{prefix}abs_error"] = (table[f"{prefix}predicted"] - table["simulated"]).abs()
    if r22 is not None:
        parts = [
            pd.DataFrame(
                {
                    "case": r22["case"],
                    "kind": kind,
                    "r22_predicted": r22["predicted"],
                    "r22_simulated": r22[f"{kind}_simulated"],
                    "r22_abs_error": 1e-3 * r22[f"{kind}_abs_error_1e-3"],
                }
            )
            for kind in ("continuous", "discrete")
        ]
        table = table.merge(pd.concat(parts), how="left", on=["case", "kind"])
    return table


def _long_sets(published):
    """Return Table 10 with one row per case and feature set; errors in porosity."""
    parts = []
    for case in ("U1", "U7"):
        columns = {f"{case}_mae_1e-3": "mae_1e-3", f"{case}_R2": "R2"}
        parts.append(published[[*MIXTURE, *columns]].rename(columns=columns).assign(case=case))
    table = pd.concat(parts, ignore_index=True)
    table["mae_1e-3"] *= 1e-3
    return table
