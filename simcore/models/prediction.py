"""Predict the porosity of measured grains by our models and by those of Rettinger et al. (2022).

A model is evaluated only where it may be trusted: simcore.models.fitted_range has the rule. No porosity outside (0, 1)
is returned, neither as a prediction nor as an end of its interval.
"""

from itertools import product

import numpy as np
import pandas as pd

from simcore.grains.statistics import equancy_statistics
from simcore.models.fitted_range import FAR, RangedValue
from simcore.models.unified import STATISTICS, unified_features
from simcore.paths import R22_TABLES
from simcore.reference.r22_tables import read_r22_table

ONE_CLASS = "one-class"  # any single sieve class
_OF_ONE_CLASS = "U1"
# Means and standard deviations of FL and EL of the mixtures behind Eqs. 23 and 24 (Rettinger et al. 2022, Fig. 11).
R22_MIXTURES = {"mu": (0.4, 0.8), "sigma": (0.1, 0.2)}
# Share of the least deviation fitted below which the models of Rettinger et al. take a sample for one form: 1/sigma of
# their model for distributions would run to any porosity.
NEARLY_ONE_FORM = 0.5
# A porosity closer to 0 or 1 would be printed as one of them.
_SMALLEST_PRINTED = 5e-4
PREDICTION = ["by", "model", "preferred", "n", "lower", "upper", "outside", "distance", "refused"]


def model_case(case):
    """Return the case whose models serve `case`: U1 for ONE_CLASS, else itself."""
    return _OF_ONE_CLASS if case == ONE_CLASS else case


def predict_samples(samples, case, fitted, level=0.95, r22_tables=R22_TABLES):
    """Predict the porosity of each sample by each model for it: DataFrame with one row a sample and model.

    samples: list of simcore.grains.measured_forms.Sample. case: of a model, or ONE_CLASS: size does not matter then,
    for porosity depends on ratios of sizes, so that U1's model serves any one sieve class. fitted: FittedModels. level:
    of the prediction intervals. r22_tables: folder of the tables of Rettinger et al. (2022).

    Columns: the fields of Sample, taken_as ("one form" or "a distribution"), and those of PREDICTION: by ("ours", or
    "r22" for Rettinger et al.), model, preferred (of ours: the one to take), n, lower, upper (nan for Rettinger et
    al., who publish no covariance), outside (in words, empty where the sample lies within what was fitted), distance
    (how far it lies outside, in widths of the range) and refused. A model that is not evaluated for a sample, as this
    lies too far outside or as its formula or interval leaves (0, 1), has n, lower and upper nan and the reason in
    `refused`, which is empty otherwise.

    Of a distribution that of our models is preferred whose cross-validated error is smaller, among those that were
    fitted to such features; where none was, the unified one, which holds for narrow distributions too.
    ValueError if there is no model of the case or for a kind of sample, or if for any sample no model is evaluated.
    """
    case = model_case(case)
    published = read_r22_table("models", r22_tables).query("case == @case").set_index("model")
    if case not in fitted.cases() and published.empty:
        cases = sorted({*fitted.cases(), *read_r22_table("models", r22_tables)["case"]})
        raise ValueError(f"case {case}: no model was fitted to it; there are {', '.join(cases)}, {ONE_CLASS}")
    tables = []
    for sample in samples:
        features = _features(sample)
        ours = _prefer(sample, _predict_ours(sample, features, case, fitted, level), case, fitted)
        rows = [*ours, *_predict_r22(sample, features, published, r22_tables)]
        if not rows:
            raise ValueError(
                f"case {case}, sample {sample.name}: no model, ours or that of Rettinger et al., was fitted to beds of "
                f"{case} with a distribution of form, only of one form; give grains one by one, a sample each, or take "
                "another case"
            )
        statistics = {**vars(sample), "taken_as": "one form" if sample.one_form else "a distribution"}
        tables.append(pd.DataFrame(rows, columns=PREDICTION).assign(**statistics))
    _require_answers(tables, case)
    table = pd.concat(tables, ignore_index=True)
    return table[["taken_as", *(name for name in table if name not in ("taken_as", *PREDICTION)), *PREDICTION]]


def _require_answers(tables, case):
    """ValueError that names every sample for which no model is evaluated, with the reasons for the first."""
    refused = [table for table in tables if table.n.isna().all()]
    if not refused:
        return
    names = [table.name.iloc[0] for table in refused]
    samples = f"sample {names[0]}" if len(names) == 1 else f"samples {', '.join(names)}"
    reasons = "; ".join(f"{describe_model(row.by, row.model)}: {row.refused}" for row in refused[0].itertuples())
    raise ValueError(
        f"case {case}: the porosity of {samples} cannot be predicted. For {names[0]} no model is evaluated: {reasons}. "
        "Correct the values, or leave such samples out and pack them (python -m simcore pack)"
    )


def describe_model(by, name):
    """Return a model's name with whose it is, for people."""
    return f"{'Rettinger et al.' if by == 'r22' else by} {name}"


def _features(sample):
    """All features of the models, a table of one row; 1/sigma is infinite for one form."""
    statistics = pd.DataFrame([{name: getattr(sample, name) for name in STATISTICS}])
    features = unified_features(statistics)
    return features.assign(EQ_inv=features.mu_EQ_inv, EL_inv=features.mu_EL_inv)


def _predict_ours(sample, features, case, fitted, level):
    """Rows of our models."""
    rows = []
    for name in ("single_form" if sample.one_form else "form_mixture", "unified"):
        model = fitted.models.get((name, case))
        if model is not None:
            n, lower, upper = (float(value[0]) for value in model.predict_interval(features, level))
            rows.append(_row("ours", name, n, lower, upper, model.outside(features)[0], digits=4))
    return rows


def _prefer(sample, rows, case, fitted):
    """The same rows, one of those that are evaluated marked as preferred."""
    evaluated = [row for row in rows if np.isfinite(row["n"])]
    if evaluated:
        chosen = evaluated[0]
        if not sample.one_form:
            inside = [row for row in evaluated if not row["outside"]] or evaluated[-1:]
            chosen = min(inside, key=lambda row: fitted.models[row["model"], case].mean_absolute_error)
        chosen["preferred"] = True
    return rows


def _predict_r22(sample, features, published, folder):
    """The row of the model of Rettinger et al., if they have one for this case and kind of sample, in a list."""
    least = NEARLY_ONE_FORM * R22_MIXTURES["sigma"][0]
    nearly = not sample.one_form and max(sample.sigma_FL, sample.sigma_EL) < least
    name = "single_form" if sample.one_form or nearly else "form_mixture"
    if name not in published.index:
        return []
    slopes = published.loc[name].drop(["intercept", "case", "equation_arxiv"]).dropna().astype(float)
    values = features[slopes.index].iloc[0]
    n = published.loc[name, "intercept"] + float(values.to_numpy() @ slopes.to_numpy())
    ranges = _r22_form_range(folder) if name == "single_form" else _r22_mixture_range()
    quantities = [RangedValue(key, getattr(sample, key), *limits) for key, limits in ranges.items()]
    quantities += [RangedValue(key, values[key], *limits) for key, limits in _feature_ranges(ranges, values.index)]
    outside = [quantity for quantity in quantities if quantity.distance > 0]
    remark = f"sigma_FL and sigma_EL are below {least:g}: taken for one form" if nearly else ""
    return [_row("r22", name, n, np.nan, np.nan, outside, digits=3, remark=remark)]


def _r22_form_range(folder):
    """Ranges of FL and EL of the single forms of Rettinger et al., dict of (low, high).

    They are not published: two deviations about the means of their grains, the first data set of their Table 2.
    """
    grains = read_r22_table("table2_form_statistics", folder).iloc[0]
    return {
        f"mu_{X}": (
            grains[f"mu_{X}"] - 2 * grains[f"sigma_{X}"],
            min(grains[f"mu_{X}"] + 2 * grains[f"sigma_{X}"], 1.0),
        )
        for X in ("FL", "EL")
    }


def _r22_mixture_range():
    """Ranges of the statistics of FL and EL of the mixtures of Rettinger et al., dict of (low, high)."""
    return {f"{kind}_{X}": R22_MIXTURES[kind] for kind in ("mu", "sigma") for X in ("FL", "EL")}


def _feature_ranges(ranges, names):
    """[(name, (low, high))] of the features that follow from ranges of the statistics of FL and EL.

    All are monotonic in these statistics, so that the corners of the ranges have the extremes.
    """
    corners = pd.DataFrame(product(*ranges.values()), columns=list(ranges)).reindex(
        columns=["mu_FL", "sigma_FL", "mu_EL", "sigma_EL"], fill_value=0.0
    )
    corners["mu_EQ"], corners["sigma_EQ"] = equancy_statistics(*(corners[name] for name in corners))
    features = unified_features(corners[list(STATISTICS)])
    features = features.assign(EQ_inv=features.mu_EQ_inv, EL_inv=features.mu_EL_inv)
    return [(name, (features[name].min(), features[name].max())) for name in names]


def _row(by, model, n, lower, upper, outside, digits, remark=""):
    """One row of PREDICTION; outside: list of RangedValue. A model that is refused has no numbers."""
    distance = max((quantity.distance for quantity in outside), default=0.0)
    remarks = [remark] if remark else []
    remarks += [
        f"{name} = {value:.4g}, fitted from {low:.{digits}g} to {high:.{digits}g}" for name, value, low, high in outside
    ]
    refused = ""
    if distance > FAR:
        refused = _describe_farthest(max(outside, key=lambda quantity: quantity.distance), digits)
    elif not _is_porosity(n):
        refused = "its formula leaves (0, 1)"
    elif not all(_is_porosity(value) for value in (lower, upper) if not np.isnan(value)):
        refused = "its prediction interval leaves (0, 1)"
    if refused:
        n = lower = upper = np.nan
    values = (by, model, False, n, lower, upper, "; ".join(remarks), distance, refused)
    return dict(zip(PREDICTION, values, strict=True))


def _describe_farthest(quantity, digits):
    """Describe a quantity that lies too far outside, with the limit up to which a model is evaluated."""
    name, value, low, high = quantity
    least, largest = quantity.limits
    limit = f"above {largest:.{digits}g}" if value > high else f"below {least:.{digits}g}"
    return f"{name} = {value:.4g} is {limit}, fitted from {low:.{digits}g} to {high:.{digits}g}"


def _is_porosity(value):
    return _SMALLEST_PRINTED <= value <= 1 - _SMALLEST_PRINTED
