"""One model of porosity for both beds of one form and beds with a distribution of form.

Rettinger et al. (2022) fit separate models (their Eqs. 17-19 and 23-24), and their model for distributions contains
1/sigma, which diverges as the grains become alike. Here the features become those of one form as the width of the
distribution goes to zero:

    n = b0 + b1 / mu_EQ + b2 / mu_EL + b3 (sigma_EQ / mu_EQ)² + b4 (sigma_EL / mu_EL)²

Why squares: let a pair of neighbours i, j contribute a porosity n_ij that is smooth and symmetric in the two forms, and
let neighbours meet at random. The mean over all pairs is then the value at the mean form plus, to leading order, a term
in the variance; a first power of sigma would have a kink at zero. The term includes both the effect of unlike
neighbours and the convexity in EQ of the porosity of single forms (the mean of 1/EQ is 1/mu_EQ (1 + (sigma_EQ/mu_EQ)²)
to this order). How it depends on the mean form is open.
# ASSUME: it is proportional to the square of the relative width, with one coefficient.
UNIFIED_SETS lists the other sets of features that were tried.
"""

import logging

import numpy as np
import pandas as pd

from simcore.grains.statistics import STATISTICS
from simcore.models.mixtures import MIXTURE
from simcore.models.regression import FOLDS, fewest_samples, fit_and_validate, predict_unseen
from simcore.models.single_form import SINGLE_FORM
from simcore.models.tables import over_seeds, rows_of_models
from simcore.reference.r22_tables import parse_r22_models

log = logging.getLogger(__name__)

UNIFIED = ("mu_EQ_inv", "mu_EL_inv", "relative_variance_EQ", "relative_variance_EL")
# Sets of features that are compared: the mean form alone, other measures of the width, means of the inverses over the
# grains (equivalent to linear mixing of the single forms), and these means with a width.
UNIFIED_SETS = (
    ("mu_EQ_inv", "mu_EL_inv"),
    ("mu_EQ_inv", "mu_EL_inv", "sigma_EQ"),
    ("mu_EQ_inv", "mu_EL_inv", "sigma_EQ", "sigma_EL"),
    ("mu_EQ_inv", "mu_EL_inv", "relative_variance_EQ"),
    UNIFIED,
    ("mu_1/EQ", "mu_1/EL"),
    ("mu_1/EQ", "mu_1/EL", "sigma_1/EQ", "sigma_1/EL"),
    ("mu_1/EQ", "mu_1/EL", "relative_variance_EQ", "relative_variance_EL"),
)
# Statistics over the grains of the inverses; a table of packings need not have them.
_OF_INVERSES = ("mu_1/EQ", "sigma_1/EQ", "mu_1/EL", "sigma_1/EL")


def unified_features(statistics):
    """Return the features of UNIFIED_SETS and of the separate models from statistics over the grains; one row per bed.

    statistics: DataFrame with columns mu_EQ, sigma_EQ, mu_EL, sigma_EL; the columns mu_1/EQ, sigma_1/EQ, mu_1/EL and
    sigma_1/EL are optional and are kept. 1/sigma is infinite for beds of one form.
    """
    return pd.DataFrame(feature_arrays(statistics), index=statistics.index)


def feature_arrays(statistics):
    """Return the columns of unified_features as a dict of arrays (n,); statistics: a dict of arrays or a DataFrame."""
    values = {name: np.asarray(statistics[name], float) for name in (*STATISTICS, *_OF_INVERSES) if name in statistics}
    with np.errstate(divide="ignore", invalid="ignore"):
        values |= {f"{name}_inv": 1.0 / values[name] for name in STATISTICS}
        for name in ("EQ", "EL"):
            values[f"relative_variance_{name}"] = (values[f"sigma_{name}"] / values[f"mu_{name}"]) ** 2
    return values


def feature_table(statistics):
    """Return the features of all models, of one form too, as a DataFrame; statistics: as for feature_arrays."""
    features = feature_arrays(statistics)
    # One table from arrays, since tables of one row are computed for many curves.
    return pd.DataFrame(features | {"EQ_inv": features["mu_EQ_inv"], "EL_inv": features["mu_EL_inv"]})


def single_form_statistics(L, I, S):  # noqa: E741
    """Return statistics for unified_features of beds of one form each; L, I, S: full axes (n,), any length unit."""
    L, I, S = (np.asarray(axis, float) for axis in (L, I, S))  # noqa: E741
    means = {"mu_EQ": S / L, "mu_EL": I / L, "mu_1/EQ": L / S, "mu_1/EL": L / I}
    return pd.DataFrame(means | {name.replace("mu", "sigma"): np.zeros(len(L)) for name in means})


def fit_unified(single_forms, mixtures, seed=0, folds=FOLDS):
    """Fit the unified model per case of both tables: dict by ("unified", case); arguments as in unified_models."""
    return {
        ("unified", case): fit_and_validate(features[list(UNIFIED)], n, "unified", case, seed, groups, folds, mixed)
        for case, (features, n, groups, mixed) in _beds(single_forms, mixtures).items()
    }


def unified_models(single_forms, mixtures, r22_models=None, seed=0, folds=FOLDS):
    """Fit the unified model for each case that both tables have, and compare it; returns (tables, models).

    single_forms: one row per packing, columns case, L, I, S, n, and grain if there are several seeds. mixtures: columns
    case, n, mu_EQ, sigma_EQ, mu_EL, sigma_EL, and sample if there are several seeds; if there are columns mean_FL and
    mean_EL, sets of one mean form are left out of a fit together. r22_models: models.csv. folds: number of folds of the
    cross-validation.

    Tables: `models` with the coefficients; `feature_sets` with errors over the same beds: of the unified model with
    each set of features, of the separate models (each fitted to its own kind of bed), both cross-validated with the
    same groups, and of the published models of Rettinger et al. (2022). Its columns are mean_absolute_error and
    median_absolute_error over all beds, the mean error over the beds of each kind, bias (predicted minus simulated) and
    the mean error without the bias.
    models: dict from ("unified", case) to PorosityModel. A case with too few beds of either kind is left out with a
    logged warning.
    """
    rows, models = [], fit_unified(single_forms, mixtures, seed, folds)
    for case, (features, n, groups, mixed) in _beds(single_forms, mixtures).items():
        for columns in UNIFIED_SETS:
            if not set(columns) <= set(features):
                log.warning("case %s: feature set %s is left out: the packings lack one of its columns", case, columns)
                continue
            predicted, folds_used = predict_unseen(features[list(columns)], n, folds, seed=seed, groups=groups)
            rows.append(
                {"case": case, "model": "unified", "features": " ".join(columns), "folds": folds_used}
                | _errors(predicted, n, mixed)
            )
        separate = _separate(features, n, groups, mixed, seed, folds)
        if separate is not None:
            rows.append(
                {"case": case, "model": "separate", "features": " ".join([*SINGLE_FORM, *MIXTURE])}
                | _errors(separate, n, mixed)
            )
        if r22_models is not None:
            published = _published(features, mixed, r22_models[r22_models["case"] == case])
            if published is not None:
                rows.append(
                    {"case": case, "model": "r22", "features": " ".join([*SINGLE_FORM, *MIXTURE])}
                    | _errors(published, n, mixed)
                )
    tables = {
        "feature_sets": pd.DataFrame(rows, columns=None if rows else ["case", "model", "features"]),
        "models": rows_of_models(models),
    }
    return tables, models


def _beds(single_forms, mixtures):
    """Return per case that both tables have: features, porosity (n,), groups (n,) and whether a bed is a mixture (n,).

    A case with too few beds of either kind is left out with a logged warning.
    """
    beds = {}
    all_forms, all_mixtures = over_seeds(single_forms, "grain"), over_seeds(mixtures, "sample")
    for case in all_forms["case"][all_forms["case"].isin(all_mixtures["case"])].unique():
        one, mix = (table[table["case"] == case].reset_index(drop=True) for table in (all_forms, all_mixtures))
        if len(one) < fewest_samples(SINGLE_FORM) or len(mix) < fewest_samples(MIXTURE):
            log.warning(
                "case %s: %d beds of one form and %d mixtures are too few for the unified model; it is left out",
                case,
                len(one),
                len(mix),
            )
            continue
        statistics = single_form_statistics(one["L"], one["I"], one["S"])
        features = [unified_features(table) for table in (statistics, mix)]
        common = [name for name in features[0] if name in features[1]]
        same_mean = ["mean_FL", "mean_EL"]
        groups = mix.groupby(same_mean).ngroup() if set(same_mean) <= set(mix) else pd.Series(mix.index)
        beds[case] = (
            pd.concat([table[common] for table in features], ignore_index=True),
            np.concatenate([one["n"], mix["n"]]),
            np.concatenate([np.arange(len(one)), len(one) + groups.to_numpy()]),
            np.repeat([False, True], [len(one), len(mix)]),
        )
    return beds


def _separate(features, n, groups, mixed, seed, folds):
    """Return cross-validated predictions of a model per kind of bed, (repeats, n); None if a kind has too few beds."""
    both = []
    for kind, columns in ((~mixed, ["mu_EQ_inv", "mu_EL_inv"]), (mixed, list(MIXTURE))):
        try:
            predicted, _ = predict_unseen(features.loc[kind, columns], n[kind], folds, seed=seed, groups=groups[kind])
        except ValueError as error:
            log.warning("the separate models are not compared with the unified one: %s", error)
            return None
        both.append(predicted)
    # Both kinds need the same number of repeats; a single repeat is copied, because further ones would be equal to it.
    repeats = max(map(len, both))
    predictions = np.full((repeats, len(n)), np.nan)
    for kind, predicted in zip((~mixed, mixed), both, strict=True):
        predictions[:, kind] = predicted if len(predicted) == repeats else predicted[:1]
    return predictions


def _published(features, mixed, r22_models):
    """Return predictions of the models of Rettinger et al. for the same beds, (1, n); None if a model is missing."""
    by_name = {name: model for (name, _), model in parse_r22_models(r22_models).items()}
    if not {"single_form", "form_mixture"} <= set(by_name):
        return None
    features = features.assign(EQ_inv=features["mu_EQ_inv"], EL_inv=features["mu_EL_inv"])
    predicted = np.full(len(features), np.nan)
    for name, kind in (("single_form", ~mixed), ("form_mixture", mixed)):
        predicted[kind] = by_name[name].porosity(features[kind])
    return predicted[None]


def _errors(predicted, n, mixed):
    """Return the columns of the table of errors as a dict; predicted (repeats, n)."""
    difference = predicted - n
    error = np.abs(difference)
    return {
        "mean_absolute_error": error.mean(),
        "median_absolute_error": np.median(error),
        "single_form_error": error[:, ~mixed].mean(),
        "form_mixture_error": error[:, mixed].mean(),
        "bias": difference.mean(),
        "error_without_bias": np.abs(difference - difference.mean()).mean(),
        "repeats": len(predicted),
        "single_forms": int((~mixed).sum()),
        "form_mixtures": int(mixed.sum()),
    }
