"""Models of beds in which all grains have one form: porosity from inverse equancy and inverse elongation."""

import logging

import numpy as np
import pandas as pd

from simcore.grains.form import features as form_features
from simcore.models.regression import (
    FOLDS,
    correlate,
    cross_validate,
    dependent,
    fewest_samples,
    fit_and_validate,
    screen,
    usable_features,
)
from simcore.models.tables import join_r22, join_r22_models, over_seeds, rows_of_models

log = logging.getLogger(__name__)

SINGLE_FORM = ("EQ_inv", "EL_inv")


def single_form_models(packings, r22_correlations=None, r22_errors=None, r22_models=None, seed=0, folds=FOLDS):
    """Fit the models of single forms, per case; returns (tables, models).

    packings: one row per packing, columns case, L, I, S [any length] and n; if there is a column grain, the packings
    of a grain are averaged first, so that seeds do not count as forms. tables: dict of DataFrames `correlations` (all
    usable features, the strongest first; r_first: their r to EQ_inv; kept: passed the screening), `second_features`
    (cross-validated error of {EQ_inv, X}), `models` (coefficients of n on EQ_inv, and on EQ_inv and EL_inv). models:
    dict from (name, case) to PorosityModel.
    A case with too few packings is left out with a logged warning; ValueError if none is left. folds: number of folds
    of the cross-validation. r22_correlations, r22_errors, r22_models: tables correlations.csv,
    table9_second_factor_mae.csv and models.csv of Rettinger et al. (2022).
    """
    correlations, errors, models = [], [], {}
    for case, rows in _cases(over_seeds(packings, "grain"), fewest_samples(SINGLE_FORM)):
        n = rows["n"].to_numpy()
        features = usable_features(form_features(*(rows[axis].to_numpy() for axis in "LIS")))
        _require(features, SINGLE_FORM, case)
        if dependent(features[list(SINGLE_FORM)]):
            raise ValueError(
                f"case {case}: no model can be fitted, because L/S depends linearly on L/I in all {len(n)} "
                "packings, as for rods. Choose forms that differ in flatness and elongation"
            )
        kept = screen(features)
        correlations.append(
            pd.DataFrame({"r": correlate(features, n), "r_first": correlate(features, features["EQ_inv"])})
            .rename_axis("feature")
            .reset_index()
            .assign(case=case, samples=len(n), kept=lambda table, kept=kept: table["feature"].isin(kept))
            .sort_values("r", key=np.abs, ascending=False, kind="stable")
        )
        for name in kept:
            result = cross_validate(features[list(dict.fromkeys(["EQ_inv", name]))], n, folds, seed=seed)
            errors.append({"case": case, "feature": name, **result, "samples": len(n)})
        for name, columns in (("single_form_EQ", SINGLE_FORM[:1]), ("single_form", SINGLE_FORM)):
            models[name, case] = fit_and_validate(features[list(columns)], n, name, case, seed, folds=folds)
    tables = {
        "correlations": pd.concat(correlations, ignore_index=True),
        "second_features": pd.DataFrame(errors),
        "models": rows_of_models(models),
    }
    if r22_correlations is not None:
        published = r22_correlations.query("study == 'single_form'")
        tables["correlations"] = join_r22(tables["correlations"], published, ["case", "feature"], {"r": "r22_r"})
    if r22_errors is not None:
        published = r22_errors.melt(id_vars="case", var_name="feature", value_name="r22_error")
        published["r22_error"] *= 1e-3
        columns = {"r22_error": "r22_error"}
        tables["second_features"] = join_r22(tables["second_features"], published, ["case", "feature"], columns)
    if r22_models is not None:
        tables["models"] = join_r22_models(tables["models"], r22_models)
    return tables, models


def _cases(packings, minimum):
    """Return a list of (case, packings) of cases with at least `minimum` packings; ValueError if there is none."""
    groups = list(packings.groupby("case", sort=False))
    for case, rows in groups:
        if len(rows) < minimum:
            log.warning(
                "case %s is left out: it has %d packings, but a fit with its error needs %d", case, len(rows), minimum
            )
    kept = [(case, rows) for case, rows in groups if len(rows) >= minimum]
    if not kept:
        raise ValueError(f"no case has the {minimum} packings that a fit with its error needs; simulate more forms")
    return kept


def _require(features, names, case):
    """Raise a ValueError if a feature of the model cannot be used."""
    missing = [name for name in names if name not in features]
    if missing:
        raise ValueError(
            f"case {case}: no model can be fitted, because {', '.join(missing)} is the same for all {len(features)} "
            "packings or not finite. Choose forms that differ in flatness and elongation"
        )
