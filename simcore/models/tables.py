"""The study's tables from our packings, each beside the study's own values.

Every function takes DataFrames and returns DataFrames; where a file lies is the workflow's business. The tables of the
study come as read from its CSVs (`pd.read_csv`); without one, the columns `study_*` are left out.
"""

import logging

import numpy as np
import pandas as pd
import xarray as xr

from simcore.grains.form import features as form_features
from simcore.models.regression import (
    FOLDS,
    PorosityModel,
    correlate,
    cross_validate,
    fit_and_validate,
    screen,
    usable_features,
)

log = logging.getLogger(__name__)

SINGLE_FORM = ("EQ_inv", "EL_inv")
MIXTURE = ("mu_EQ_inv", "sigma_EQ_inv", "mu_EL_inv", "sigma_EL_inv")
# Table 10's feature sets
MIXTURE_SETS = (
    ("mu_EQ_inv",),
    ("mu_EQ_inv", "sigma_EQ_inv"),
    ("mu_EQ_inv", "sigma_EQ_inv", "mu_EL_inv"),
    MIXTURE,
    ("mu_EQ_inv", "mu_EL_inv"),
    ("mu_EQ_inv", "sigma_EQ_inv", "sigma_EL_inv"),
)


def single_form_models(packings, study_correlations=None, study_errors=None, study_models=None, seed=0, folds=FOLDS):
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
    if study_correlations is not None:
        study = study_correlations.query("study == 'single_form'")
        tables["correlations"] = _beside(tables["correlations"], study, ["case", "feature"], {"r": "study_r"})
    if study_errors is not None:
        study = study_errors.melt(id_vars="case", var_name="feature", value_name="study_error")
        study["study_error"] *= 1e-3
        columns = {"study_error": "study_error"}
        tables["second_features"] = _beside(tables["second_features"], study, ["case", "feature"], columns)
    if study_models is not None:
        tables["models"] = _beside_models(tables["models"], study_models)
    return tables, models


def mixture_models(packings, study_correlations=None, study_sets=None, study_models=None, seed=0, folds=FOLDS):
    """Tables and models of the form-mixture study, per case; returns (tables, models) as single_form_models.

    packings: one row a packing, columns case, n and the 104 of mixture_features; where there is a column sample, the
    packings of a sample are averaged first. Tables: `correlations` of all usable features, the closest first,
    `feature_sets` (Table 10's sets, cross-validated errors and R² of the fit to all packings), `models`.
    A set with a feature that cannot be used, or with more coefficients than packings, is left out with a message.
    folds: of the cross-validation.
    study_*: correlations.csv, table10_form_mixture_features.csv, models.csv.
    """
    correlations, sets, models = [], [], {}
    for case, rows in over_seeds(packings, "sample").groupby("case", sort=False):
        n = rows["n"].to_numpy()
        features = usable_features(rows.drop(columns=["case", "n"]).select_dtypes("number"))
        correlations.append(
            correlate(features, n)
            .rename_axis("feature")
            .reset_index()
            .assign(case=case, samples=len(n))
            .sort_values("r", key=np.abs, ascending=False, kind="stable")
        )
        for columns in MIXTURE_SETS:
            if not set(columns) <= set(features) or len(n) <= len(columns) + 2:
                log.warning("case %s: feature set %s left out, %d packings do not carry it", case, columns, len(n))
                continue
            chosen = features[list(columns)]
            flags = {name: int(name in columns) for name in MIXTURE}
            model = fit_and_validate(chosen, n, "form_mixture", case, seed, folds=folds)
            result = cross_validate(chosen, n, folds, seed=seed)
            sets.append({"case": case, **flags, **result, "r_squared": model.r_squared, "samples": len(n)})
            if columns == MIXTURE:
                models["form_mixture", case] = model
    tables = {
        "correlations": pd.concat(correlations, ignore_index=True),
        "feature_sets": pd.DataFrame(sets, columns=None if sets else ["case", *MIXTURE]),
        "models": pd.concat([m.to_rows() for m in models.values()], ignore_index=True) if models else pd.DataFrame(),
    }
    if study_correlations is not None:
        study = study_correlations.query("study == 'form_mixture'")
        study = study.assign(feature=study["feature"].str.replace(" inverse", "_inv"))
        tables["correlations"] = _beside(tables["correlations"], study, ["case", "feature"], {"r": "study_r"})
    if study_sets is not None:
        study = _long_sets(study_sets)
        columns = {"mae_1e-3": "study_error", "R2": "study_r_squared"}
        tables["feature_sets"] = _beside(tables["feature_sets"], study, ["case", *MIXTURE], columns)
    if study_models is not None and models:
        tables["models"] = _beside_models(tables["models"], study_models)
    return tables, models


def application_table(models, packings, study=None):
    """Prediction for packings no model has seen (Table 11), one row each.

    models: dict from (name, case) to PorosityModel, "form_mixture", and "unified" if it is to stand beside; packings:
    columns case, kind ("continuous" or "discrete"), n and the models' features. study: table11_application.csv.
    """
    rows = packings[packings["case"].isin({case for name, case in models if name == "form_mixture"})]
    table = rows[["case", "kind", "n"]].rename(columns={"n": "simulated"})
    for name, before in (("form_mixture", ""), ("unified", "unified_")):
        if any(model == name for model, _ in models):
            predicted = [
                float(models[name, case].predict(rows.loc[[index]])[0]) if (name, case) in models else np.nan
                for index, case in rows["case"].items()
            ]
            table[f"{before}predicted"] = predicted
            table[f"{before}abs_error"] = (table[f"{before}predicted"] - table["simulated"]).abs()
    if study is not None:
        parts = [
            pd.DataFrame(
                {
                    "case": study["case"],
                    "kind": kind,
                    "study_predicted": study["predicted"],
                    "study_simulated": study[f"{kind}_simulated"],
                    "study_abs_error": 1e-3 * study[f"{kind}_abs_error_1e-3"],
                }
            )
            for kind in ("continuous", "discrete")
        ]
        table = table.merge(pd.concat(parts), how="left", on=["case", "kind"])
    return table


def shape_kind_table(packings, study=None):
    """How far meshes and their equivalent ellipsoids differ in porosity, one row a case.

    packings: columns case, n_mesh, n_ellipsoid, one row a form. study: columns case, rms_difference.
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
    return table if study is None else _beside(table, study, ["case"], {"rms_difference": "study_rms_difference"})


def over_seeds(packings, key):
    """Means of all numbers over the packings of one case that agree in `key`; as given where there is no such column.

    Rows of one form with other seeds are no samples of their own: a fit would take its error for too small, and
    cross-validation would see the form it is to predict.
    """
    if key not in packings:
        return packings
    return packings.groupby(["case", key], sort=False).mean(numeric_only=True).copy().reset_index()


def models_dataset(models, table, title):
    """As table_dataset of the models' table, with the covariance of the coefficients, which has no place in a CSV.

    models: dict from (name, case) to PorosityModel, in the order of the table, one row a coefficient. covariance: of a
    row's coefficient with each coefficient of its model, in their order; nan beyond the last.
    """
    dataset = table_dataset(table, title)
    covariance = np.full((len(table), max((len(model.terms) for model in models.values()), default=0)), np.nan)
    at = 0
    for model in models.values():
        size = len(model.terms)
        covariance[at : at + size, :size] = model.covariance
        at += size
    attrs = {"units": "1", "long_name": "covariance with the coefficients of the same model, in their order"}
    return dataset.assign(covariance=(("row", "term_of_model"), covariance, attrs))


def read_models(path):
    """The models of a file from models_dataset: dict from (name, case) to PorosityModel.

    ValueError or OSError if it is none.
    """
    try:
        with xr.open_dataset(path, engine="netcdf4") as dataset:
            dataset.load()
    except FileNotFoundError:
        raise ValueError(f"{path}: there is no such file; run the campaign's models first") from None
    if "covariance" not in dataset:
        raise ValueError(f"{path}: these models were written without covariances; run the rule that fits them again")
    if dataset.sizes["row"] == 0:
        return {}
    models = {}
    rows = pd.DataFrame({name: dataset[name].values for name in dataset.data_vars if dataset[name].dims == ("row",)})
    for (name, case), part in rows.groupby(["model", "case"], sort=False):
        size, first = len(part), part.iloc[0]
        column = {key: tuple(part[key].tolist()) for key in part}
        models[name, case] = PorosityModel(
            name=name,
            case=case,
            features=column["term"][1:],
            coefficients=column["coefficient"],
            std_errors=column["std_error"],
            lower=column["lower_95"],
            upper=column["upper_95"],
            bootstrap_lower=column["bootstrap_lower_95"],
            bootstrap_upper=column["bootstrap_upper_95"],
            covariance=tuple(map(tuple, dataset["covariance"].values[part.index, :size].tolist())),
            minimum=column["feature_min"][1:],
            maximum=column["feature_max"][1:],
            n_samples=int(first["samples"]),
            **{
                key: float(first[key])
                for key in ("scatter", "r_squared", "rmse", "mean_absolute_error", "median_absolute_error")
            },
        )
    return models


def table_dataset(table, title):
    """A table as a Dataset over `row`, for netCDF; all its numbers are dimensionless."""
    dataset = xr.Dataset(attrs={"Conventions": "CF-1.11", "title": title})
    for name in table.columns:
        values = table[name]
        text = not pd.api.types.is_numeric_dtype(values)
        attrs = {"long_name": name.replace("_", " ")} | ({} if text else {"units": "1"})
        # CF knows no boolean, and netCDF allows no slash in a name.
        data = values.astype(str) if text else values.astype("i1") if values.dtype == bool else values
        dataset[name.replace("/", "_per_")] = ("row", data.to_numpy(object if text else None), attrs)
    return dataset


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


def _beside(ours, study, keys, columns):
    """Our table with columns of the study's, renamed by `columns`, where the keys agree."""
    return ours.merge(study[[*keys, *columns]].rename(columns=columns), how="left", on=keys)


def _beside_models(ours, study):
    """Our coefficients beside the study's, which come one row a model."""
    study = study.melt(id_vars=["model", "case"], value_name="coefficient", var_name="term").dropna()
    return _beside(ours, study, ["model", "case", "term"], {"coefficient": "study_coefficient"})


def _long_sets(study):
    """Table 10 with one row a case and feature set, errors in porosity."""
    parts = []
    for case in ("U1", "U7"):
        columns = {f"{case}_mae_1e-3": "mae_1e-3", f"{case}_R2": "R2"}
        parts.append(study[[*MIXTURE, *columns]].rename(columns=columns).assign(case=case))
    table = pd.concat(parts, ignore_index=True)
    table["mae_1e-3"] *= 1e-3
    return table
