"""Models of beds in which all grains have one form: porosity from inverse equancy and inverse elongation."""

import logging

import numpy as np
import pandas as pd

from simcore.grains.form import features as form_features
from simcore.models.regression import FOLDS, correlate, cross_validate, fit_and_validate, screen, usable_features
from simcore.models.tables import beside, beside_models, over_seeds

log = logging.getLogger(__name__)

SINGLE_FORM = ("EQ_inv", "EL_inv")


def single_form_models(packings, r22_correlations=None, r22_errors=None, r22_models=None, seed=0, folds=FOLDS):
    """Tables and models of the single-form study, per case.

    packings: one row a packing, columns case, L, I, S [any length] and n; where there is a column grain, the packings
    of a grain are averaged first, so that seeds do not pass for forms. Returns (tables, models): tables is a dict of
    DataFrames `correlations` (all usable features, the closest first; r_first: their r to EQ_inv; kept: passed the
    screening), `second_features` (cross-validated error of {EQ_inv, X}), `models` (coefficients of n on EQ_inv, and on
    EQ_inv and EL_inv); models maps (name, case) to PorosityModel.
    A case with too few packings is left out with a message; ValueError if none is left. folds: of the cross-validation.
    study_*: correlations.csv, table9_second_factor_mae.csv, models.csv.
    """
    correlations, errors, models = [], [], {}
    for case, rows in _cases(over_seeds(packings, "grain"), len(SINGLE_FORM) + 3):
        n = rows["n"].to_numpy()
        features = usable_features(form_features(*(rows[axis].to_numpy() for axis in "LIS")))
        _require(features, SINGLE_FORM, case)
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
        "models": pd.concat([model.to_rows() for model in models.values()], ignore_index=True),
    }
    if r22_correlations is not None:
        study = r22_correlations.query("study == 'single_form'")
        tables["correlations"] = beside(tables["correlations"], study, ["case", "feature"], {"r": "r22_r"})
    if r22_errors is not None:
        study = r22_errors.melt(id_vars="case", var_name="feature", value_name="r22_error")
        study["r22_error"] *= 1e-3
        columns = {"r22_error": "r22_error"}
        tables["second_features"] = beside(tables["second_features"], study, ["case", "feature"], columns)
    if r22_models is not None:
        tables["models"] = beside_models(tables["models"], r22_models)
    return tables, models


def _cases(packings, least):
    """List of (case, its packings), without cases of fewer than `least` packings. ValueError if none is left."""
    groups = list(packings.groupby("case", sort=False))
    for case, rows in groups:
        if len(rows) < least:
            log.warning("case %s left out: %d packings, a model and its error need %d", case, len(rows), least)
    kept = [(case, rows) for case, rows in groups if len(rows) >= least]
    if not kept:
        raise ValueError(f"no case has the {least} packings that a model and its error need; simulate more forms")
    return kept


def _require(features, names, case):
    """ValueError if a feature of the chosen model cannot be used."""
    missing = [name for name in names if name not in features]
    if missing:
        raise ValueError(
            f"case {case}: {', '.join(missing)} is the same for all {len(features)} packings or not finite, so no "
            "model can be fitted; choose forms that differ in flatness and elongation"
        )
