"""One model of porosity for beds of one form and for beds with a distribution of form.

The study fits the two apart (its Eqs. 17-19 and 23-24), and its model for distributions holds 1/sigma, which has no
limit as the grains become alike. Here the features become those of one form as the distribution's width goes to zero:

    n = b0 + b1 / mu_EQ + b2 / mu_EL + b3 (sigma_EQ / mu_EQ)² + b4 (sigma_EL / mu_EL)²

Why squares: if neighbours i, j pack as n_ij, smooth in the two forms and symmetric in them, and meet at random, then
the mean over all pairs is that of the mean form and, to leading order, a term in the variance; a first power of sigma
would have a kink at zero. That holds what unlike neighbours add, and that the porosity of single forms is convex in EQ
(the mean of 1/EQ is 1/mu_EQ (1 + (sigma_EQ/mu_EQ)²) to this order). How the term depends on the mean form is open:
# ASSUME: as the square of the relative width, with one coefficient. UNIFIED_SETS holds what else was tried.
"""

import logging

import numpy as np
import pandas as pd

from simcore.models.mixtures import MIXTURE
from simcore.models.regression import FOLDS, fit_and_validate, predict_unseen
from simcore.models.single_form import SINGLE_FORM
from simcore.models.tables import over_seeds

log = logging.getLogger(__name__)

UNIFIED = ("mu_EQ_inv", "mu_EL_inv", "relative_variance_EQ", "relative_variance_EL")
# What is compared with it: the mean form alone, other measures of the width, means of the inverses over the grains
# (what linear mixing of the single forms would give), and these with a width.
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
STATISTICS = ("mu_EQ", "sigma_EQ", "mu_EL", "sigma_EL")
# Over the grains, of the inverses; a table of packings need not have them.
_OF_INVERSES = ("mu_1/EQ", "sigma_1/EQ", "mu_1/EL", "sigma_1/EL")


def unified_features(statistics):
    """Features of UNIFIED_SETS and the separate models from statistics over the grains; one row a bed.

    statistics: DataFrame with columns mu_EQ, sigma_EQ, mu_EL, sigma_EL; where it has mu_1/EQ, sigma_1/EQ, mu_1/EL and
    sigma_1/EL, these come along. 1/sigma is infinite for beds of one form.
    """
    table = statistics[[name for name in (*STATISTICS, *_OF_INVERSES) if name in statistics]].astype(float)
    with np.errstate(divide="ignore"):
        inverse = (1.0 / table[list(STATISTICS)]).add_suffix("_inv")
    relative = {
        f"relative_variance_{name}": (table[f"sigma_{name}"] / table[f"mu_{name}"]) ** 2 for name in ("EQ", "EL")
    }
    return pd.concat([table, inverse], axis=1).assign(**relative)


def single_form_statistics(L, I, S):  # noqa: E741
    """Statistics as unified_features takes them, of beds of one form each; L, I, S: full axes (n,), any length unit."""
    L, I, S = (np.asarray(axis, float) for axis in (L, I, S))  # noqa: E741
    means = {"mu_EQ": S / L, "mu_EL": I / L, "mu_1/EQ": L / S, "mu_1/EL": L / I}
    return pd.DataFrame(means | {name.replace("mu", "sigma"): np.zeros(len(L)) for name in means})


def fit_unified(single_forms, mixtures, seed=0, folds=FOLDS):
    """The unified model of each case that both studies have, by ("unified", case); arguments as of unified_models."""
    return {
        ("unified", case): fit_and_validate(features[list(UNIFIED)], n, "unified", case, seed, groups, folds)
        for case, (features, n, groups, _) in _beds(single_forms, mixtures).items()
    }


def unified_models(single_forms, mixtures, r22_models=None, seed=0, folds=FOLDS):
    """Tables and models of the unified model, per case that both studies have; returns (tables, models).

    single_forms: one row a packing, columns case, L, I, S, n, and grain if there are several seeds. mixtures: case, n,
    mu_EQ, sigma_EQ, mu_EL, sigma_EL, and sample if there are several seeds; with mean_FL and mean_EL, sets of one mean
    form are left out of a fit together. r22_models: models.csv. folds: of the cross-validation.

    Tables: `models`, coefficients; `feature_sets`, errors over the same beds of the unified model with each set of
    features, of the separate models (each sees its own kind of bed alone), all cross-validated with the same groups,
    and of the study's models as published: mean_absolute_error and median_absolute_error over all beds, the mean over
    the beds of each kind, bias (predicted less simulated) and the mean error without it.
    models maps ("unified", case) to PorosityModel. A case with too few beds of either kind is left out with a message.
    """
    rows, models = [], fit_unified(single_forms, mixtures, seed, folds)
    for case, (features, n, groups, mixed) in _beds(single_forms, mixtures).items():
        for columns in UNIFIED_SETS:
            if not set(columns) <= set(features):
                log.warning("case %s: set %s left out, the packings do not carry it", case, columns)
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
        "models": pd.concat([model.to_rows() for model in models.values()], ignore_index=True)
        if models
        else pd.DataFrame(columns=["model", "case", "term", "coefficient"]),
    }
    return tables, models


def _beds(single_forms, mixtures):
    """Of each case that both have: features, porosity (n,), groups (n,) and whether a bed is a mixture (n,).

    A case with too few of either is left out with a message.
    """
    beds = {}
    ones, many = over_seeds(single_forms, "grain"), over_seeds(mixtures, "sample")
    for case in ones["case"][ones["case"].isin(many["case"])].unique():
        one, mix = (table[table["case"] == case].reset_index(drop=True) for table in (ones, many))
        if len(one) < len(SINGLE_FORM) + 3 or len(mix) < len(MIXTURE) + 3:
            log.warning("case %s: %d beds of one form, %d mixtures: too few for both in one", case, len(one), len(mix))
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
    """Cross-validated predictions of a model for each kind of bed, (repeats, n), or None where its beds are too few."""
    both = []
    for kind, columns in ((~mixed, ["mu_EQ_inv", "mu_EL_inv"]), (mixed, list(MIXTURE))):
        try:
            predicted, _ = predict_unseen(features.loc[kind, columns], n[kind], folds, seed=seed, groups=groups[kind])
        except ValueError as error:
            log.warning("no separate models beside the unified one: %s", error)
            return None
        both.append(predicted)
    # As many repeats of the one as of the other: where one has a single repeat, all its repeats would be alike.
    repeats = max(map(len, both))
    predictions = np.full((repeats, len(n)), np.nan)
    for kind, predicted in zip((~mixed, mixed), both, strict=True):
        predictions[:, kind] = predicted if len(predicted) == repeats else predicted[:1]
    return predictions


def _published(features, mixed, study):
    """What the study's models say for the same beds, (1, n); None where it has none for this case."""
    of = {row["model"]: row for _, row in study.iterrows()}
    if not {"single_form", "form_mixture"} <= set(of):
        return None
    predicted = np.full(len(features), np.nan)
    for name, kind, columns in (
        ("single_form", ~mixed, {"EQ_inv": "mu_EQ_inv", "EL_inv": "mu_EL_inv"}),
        ("form_mixture", mixed, {feature: feature for feature in MIXTURE}),
    ):
        slopes = of[name][list(columns)].dropna()  # the study has no sigma_EL in U1
        values = features.loc[kind, [columns[term] for term in slopes.index]].to_numpy()
        predicted[kind] = of[name]["intercept"] + values @ slopes.to_numpy(float)
    return predicted[None]


def _errors(predicted, n, mixed):
    """Columns of the table of errors; predicted (repeats, n)."""
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
