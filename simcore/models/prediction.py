"""Predict the porosity of measured grains by our models and by those of Rettinger et al. (2022).

A model is evaluated only inside its fitted range or not far outside it (simcore.models.fitted_range). No porosity
outside (0, 1) is returned, neither as a prediction nor as an end of its interval.
"""

import re
from functools import cache
from itertools import product

import numpy as np
import pandas as pd

from simcore.grains.statistics import STATISTICS, equancy_statistics
from simcore.grains.text_lists import join_first
from simcore.models.feature_words import feature_in_words
from simcore.models.few_grains import few_grains_errors, few_grains_half
from simcore.models.fitted_range import FAR, RangedValue
from simcore.models.measured_file import MEASURED
from simcore.models.unified import feature_table, unified_features
from simcore.paths import R22_TABLES
from simcore.reference.r22_tables import read_r22_models, rhine_statistics
from simcore.scene.sizes import all_cases

ONE_CLASS = "one-class"  # any single sieve class
_OF_ONE_CLASS = "U1"
KINDS_OF_BED = ("one form", "a distribution of form")
# Ranges of the means and standard deviations of FL and EL of the mixtures to which Eqs. 23 and 24 were fitted
# (Rettinger et al. 2022, Fig. 11).
R22_MIXTURES = {"mu": (0.4, 0.8), "sigma": (0.1, 0.2)}
# A sample counts as one form for the models of Rettinger et al. if its deviations are below this share of their
# smallest one: with 1/sigma, their model for distributions could give any porosity.
NEARLY_ONE_FORM = 0.5
# A porosity closer to 0 or 1 than this would be printed as 0 or 1.
SMALLEST_PRINTED = 5e-4
NO_MODEL = "no model was fitted"
PREDICTION = ["by", "model", "preferred", "n", "lower", "upper", "few_grains_error", "outside", "distance", "refused"]


def standard_case(case):
    """Return ONE_CLASS, or the name of a listed sieve curve, that `case` is written like; otherwise `case` itself.

    Upper and lower case, hyphens, underscores and spaces do not matter.
    """
    names = {_letters(name): name for name in (*all_cases(), ONE_CLASS)}
    return case if case in all_cases() else names.get(_letters(case), case)


def _letters(case):
    return re.sub(r"[-_\s]", "", case).lower()


def model_case(case):
    """Return the case whose models are used for `case`: U1 for ONE_CLASS, else that of standard_case."""
    case = standard_case(case)
    return _OF_ONE_CLASS if case == ONE_CLASS else case


def predict_samples(samples, case, fitted, level=0.95, r22_tables=R22_TABLES, require=True):
    """Predict the porosity of each sample by each suitable model: DataFrame with one row per sample and model.

    samples: list of simcore.grains.measured_forms.Sample. case: case of the models, or ONE_CLASS for grains of any
    single sieve class: porosity depends only on ratios of sizes, so U1's models are used. fitted: FittedModels. level:
    probability of the prediction intervals. r22_tables: folder of the tables of Rettinger et al. (2022). require:
    whether at least one sample must be predicted.

    Columns: the fields of Sample but the covariance, kind_of_bed (one of KINDS_OF_BED), and those of
    PREDICTION: by ("ours", or "r22" for Rettinger et al.), model, preferred (the recommended one of our models), n,
    lower, upper (nan for Rettinger et al., who publish no covariance), few_grains_error (the standard error of n that
    follows from the limited number of measured grains, which the interval contains; nan if it is unknown),
    outside (description, empty if the sample is inside the fitted range), distance (from the range, in its widths) and
    refused. If a model is not evaluated for a sample, because the sample is too far outside or the formula or the
    interval leaves (0, 1), then n, lower and upper are nan and `refused` gives the reason; `refused` is empty
    otherwise. A sample of a kind for which the case has no model has one row, with empty `by` and `model`.

    For a distribution, the preferred model is the one with the smaller cross-validated error of distributions among our
    models whose fitted range contains the sample; if there is none, it is the unified model, which is also valid for
    narrow distributions. ValueError if there is no model for the case, or if no model can be evaluated for any of the
    samples.
    """
    case = model_case(case)
    published = published_models(case, r22_tables)
    if case not in fitted.cases() and not published:
        cases = sorted({*fitted.cases(), *(of_case for _, of_case in read_r22_models(r22_tables))})
        of_curve = f"; or {remedy_without_model(case)}" if case in all_cases() else ""
        raise ValueError(
            f"case {case}: there is no model for it; choose one of {', '.join(cases)}, {ONE_CLASS}{of_curve}"
        )
    tables = []
    for sample in samples:
        rows = predict_sample(sample, case, fitted, published, level, r22_tables) or [_no_model(sample, case)]
        statistics = {**vars(sample), "kind_of_bed": kind_of_bed(sample)}
        del statistics["covariance"]
        tables.append(pd.DataFrame(rows, columns=PREDICTION).assign(**statistics))
    if require:
        _require_one(tables, case)
    table = pd.concat(tables, ignore_index=True)
    return table[["kind_of_bed", *(name for name in table if name not in ("kind_of_bed", *PREDICTION)), *PREDICTION]]


def _no_model(sample, case):
    """Return the refused row of PREDICTION of a sample for which the case has no model."""
    kind = kind_of_bed(sample)
    refused = f"{NO_MODEL} to beds of {case} with {kind}, only to beds with {other_kind(kind)}"
    return dict(zip(PREDICTION, ("", "", False, *(np.nan,) * 4, "", np.nan, refused), strict=True))


def remedy_without_model(case):
    """Return what to do with samples of which the case has no model."""
    return f"use predict --sieve {case}, whose model is valid for one form and for distributions"


def predict_preferred(sample, case, fitted, level=0.95):
    """Return the row of the preferred of our models for one sample, dict with the keys PREDICTION.

    Arguments: as in predict_samples. If none of our models is evaluated, n, lower and upper are nan, and `refused` has
    the reasons. ValueError if there is no model for the case.
    """
    return predict_all_preferred([sample], case, fitted, level)[0]


def predict_all_preferred(samples, case, fitted, level=0.95):
    """Return the rows of predict_preferred for a list of samples, which are computed together."""
    case = model_case(case)
    if case not in fitted.cases():
        raise ValueError(
            f"case {case}: we have no model for it; choose one of {', '.join(fitted.cases())}, {ONE_CLASS}"
        )
    features = sample_features(samples)
    of_one_form, chosen = np.array([sample.one_form for sample in samples], bool), [None] * len(samples)
    for kind in (True, False):
        indices = np.flatnonzero(of_one_form == kind)
        if not len(indices):
            continue
        own = [samples[index] for index in indices]
        own_features = features if len(own) == len(samples) else features.iloc[indices]
        tables = _predict_ours(own, own_features, case, fitted, level)
        for index, sample, rows in zip(indices, own, tables, strict=True):
            chosen[index] = _preferred_row(_prefer(sample, rows, case, fitted), case)
    return chosen


def _preferred_row(rows, case):
    for row in rows:
        if row["preferred"]:
            return row
    reasons = "; ".join(row["refused"] for row in rows) or f"no model was fitted to such grains in beds of {case}"
    return dict.fromkeys(("n", "lower", "upper", "few_grains_error"), np.nan) | {"outside": "", "refused": reasons}


def published_models(case, r22_tables=R22_TABLES):
    """Return the models of Rettinger et al. (2022) of a case, a dict from the name to R22Model; it may be empty."""
    return {name: model for (name, of_case), model in read_r22_models(r22_tables).items() if of_case == case}


def predict_sample(sample, case, fitted, published, level=0.95, r22_tables=R22_TABLES):
    """Return one dict of PREDICTION per suitable model, a list that is empty if there is no model for the sample.

    case: as returned by model_case; published: as from published_models; the others: as in predict_samples.
    """
    features = sample_features([sample])
    ours = _prefer(sample, _predict_ours([sample], features, case, fitted, level)[0], case, fitted)
    return [*ours, *_predict_r22(sample, features, published, r22_tables)]


def _require_one(tables, case):
    """Raise a ValueError that names all samples, with the reasons for the first, if no model is evaluated for any."""
    if not all(table.n.isna().all() for table in tables):
        return
    names = [table.name.iloc[0] for table in tables]
    samples = f"sample {names[0]}" if len(names) == 1 else f"samples {join_first(names, 10)}"
    if all((table.model == "").all() for table in tables):
        remedy = remedy_without_model(case)
        raise ValueError(
            f"case {case}: the porosity of {samples} cannot be predicted: {tables[0].refused[0]}; {remedy}"
        )
    first = next(table for table in tables if (table.model != "").any())
    reasons = "; ".join(f"{describe_model(row.by, row.model)}: {row.refused}" for row in first.itertuples())
    raise ValueError(
        f"case {case}: the porosity of {samples} cannot be predicted. For {first.name[0]} no model is evaluated: "
        f"{reasons}. Correct the values, or simulate packings of these grains (scree pack)"
    )


def describe_model(by, name):
    """Return a model's name for people: ours, or Rettinger et al., and the name; "your fit" if `fit` wrote it."""
    if name == MEASURED:
        return "your fit"
    return f"{'Rettinger et al.' if by == 'r22' else by} {name}"


def sample_features(samples):
    """Return all features of the models, a table with one row per Sample; 1/sigma is infinite for one form."""
    return feature_table({name: [getattr(sample, name) for sample in samples] for name in STATISTICS})


def kind_of_bed(sample):
    """Return which of KINDS_OF_BED the grains of a Sample make."""
    return KINDS_OF_BED[0] if sample.one_form else KINDS_OF_BED[1]


def other_kind(kind):
    """Return the other one of KINDS_OF_BED."""
    return KINDS_OF_BED[1 - KINDS_OF_BED.index(kind)]


def _predict_ours(samples, features, case, fitted, level):
    """Return the rows of our models for each sample, a list of lists; the samples are all of one kind."""
    tables = [[] for _ in samples]
    kind = kind_of_bed(samples[0])
    for name in ("single_form" if samples[0].one_form else "form_mixture", "unified", MEASURED):
        model = fitted.models.get((name, case))
        if model is not None:
            only = fitted.only_kind.get((name, case), kind)
            remark = "" if only == kind else f"it was fitted only to beds with {only}"
            errors = few_grains_errors(model, samples)
            further = few_grains_half(samples, errors, level)
            *numbers, outside = model.predict_interval_and_outside(features, level, further)
            values = zip(tables, *(column.tolist() for column in (*numbers, errors)), outside, strict=True)
            for rows, *of_sample, beyond in values:
                rows.append(_row("ours", name, of_sample, beyond, digits=4, remark=remark))
    return tables


def _prefer(sample, rows, case, fitted):
    """Mark one of the evaluated rows as preferred, and return all rows."""
    evaluated = [row for row in rows if np.isfinite(row["n"])]
    if evaluated:
        chosen = evaluated[0]
        if not sample.one_form:
            inside = [row for row in evaluated if not row["outside"]] or evaluated[-1:]
            chosen = min(inside, key=lambda row: fitted.models[row["model"], case].error_of_mixtures)
        chosen["preferred"] = True
    return rows


def _predict_r22(sample, features, published, folder):
    """Return the row of the model of Rettinger et al. in a list, empty if they have none for this kind of sample."""
    least = NEARLY_ONE_FORM * R22_MIXTURES["sigma"][0]
    nearly_one_form = not sample.one_form and max(sample.sigma_FL, sample.sigma_EL) < least
    name = "single_form" if sample.one_form or nearly_one_form else "form_mixture"
    if name not in published:
        return []
    model = published[name]
    n, values = float(model.porosity(features)[0]), features[model.slopes.index].iloc[0]
    ranges = r22_ranges(name, values.index, folder)
    quantities = [
        RangedValue(key, values[key] if key in values else getattr(sample, key), *limits) for key, limits in ranges
    ]
    outside = [quantity for quantity in quantities if quantity.distance > 0]
    remark = f"sigma_FL and sigma_EL are below {least:g}: taken for one form" if nearly_one_form else ""
    return [_row("r22", name, (n, np.nan, np.nan, np.nan), outside, digits=3, remark=remark)]


def r22_ranges(name, features, folder=R22_TABLES):
    """Return the fitted range of a model of Rettinger et al., [(name, (low, high))]: of statistics, then features.

    name: "single_form" or "form_mixture"; features: names of the model's features.
    """
    ranges = _r22_form_range(folder) if name == "single_form" else _r22_mixture_range()
    return [*ranges.items(), *_feature_ranges(tuple(ranges.items()), tuple(features))]


def _r22_form_range(folder):
    """Return ranges of FL and EL of the single forms of Rettinger et al., dict of (low, high).

    The ranges are not published. We take two standard deviations about the means of their grains, which are the first
    data set of their Table 2.
    """
    grains = rhine_statistics(folder)
    return {
        f"mu_{X}": (
            grains[f"mu_{X}"] - 2 * grains[f"sigma_{X}"],
            min(grains[f"mu_{X}"] + 2 * grains[f"sigma_{X}"], 1.0),
        )
        for X in ("FL", "EL")
    }


def _r22_mixture_range():
    """Return ranges of the statistics of FL and EL of the mixtures of Rettinger et al., dict of (low, high)."""
    return {f"{kind}_{X}": R22_MIXTURES[kind] for kind in ("mu", "sigma") for X in ("FL", "EL")}


@cache  # the same for every sample, and most of the time of a prediction
def _feature_ranges(ranges, names):
    """Return [(name, (low, high))] of the features that follow from ranges of the statistics of FL and EL.

    ranges: tuple of (name, (low, high)); names: tuple of the features' names. All features are monotonic in these
    statistics, so their extremes are at corners of the ranges.
    """
    statistics, limits = zip(*ranges, strict=True)
    corners = pd.DataFrame(product(*limits), columns=statistics).reindex(
        columns=["mu_FL", "sigma_FL", "mu_EL", "sigma_EL"], fill_value=0.0
    )
    corners["mu_EQ"], corners["sigma_EQ"] = equancy_statistics(*(corners[name] for name in corners))
    features = unified_features(corners[list(STATISTICS)])
    features = features.assign(EQ_inv=features.mu_EQ_inv, EL_inv=features.mu_EL_inv)
    return [(name, (features[name].min(), features[name].max())) for name in names]


def _row(by, model, numbers, outside, digits, remark=""):
    """Return one row of PREDICTION; its numbers are nan if the model is refused.

    numbers: porosity, lower and upper end of its interval, and its error of few grains. outside: list of RangedValue;
    digits: of the limits in the text.
    """
    n, lower, upper, _ = numbers
    distance = max((quantity.distance for quantity in outside), default=0.0)
    remarks = [remark] if remark else []
    remarks += [
        f"{feature_in_words(name)} = {value:.4g}, fitted from {low:.{digits}g} to {high:.{digits}g}"
        for name, value, low, high in outside
    ]
    refused = ""
    if distance > FAR:
        refused = _describe_farthest(max(outside, key=lambda quantity: quantity.distance), digits)
    elif not _is_porosity(n):
        refused = "its formula gives a porosity outside (0, 1)"
    elif not all(_is_porosity(value) for value in (lower, upper) if by == "ours" or not np.isnan(value)):
        refused = "its prediction interval reaches outside (0, 1)"
    if refused:
        numbers = (np.nan,) * len(numbers)
    values = (by, model, False, *numbers, "; ".join(remarks), distance, refused)
    return dict(zip(PREDICTION, values, strict=True))


def _describe_farthest(quantity, digits):
    """Describe a quantity that lies too far outside, with the limit up to which a model is evaluated."""
    name, value, low, high = quantity
    least, largest = quantity.limits
    limit = f"above {largest:.{digits}g}" if value > high else f"below {least:.{digits}g}"
    return f"{feature_in_words(name)} = {value:.4g} is {limit}, fitted from {low:.{digits}g} to {high:.{digits}g}"


def _is_porosity(value):
    return SMALLEST_PRINTED <= value <= 1 - SMALLEST_PRINTED
