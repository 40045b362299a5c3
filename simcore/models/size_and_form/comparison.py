"""Comparison of the candidates and of the models of the literature on the same packed beds, and the chosen one.

Every bed is predicted by fits without its family of curves, and by fits without its form. The models of the literature
get the same one-class porosities. docs/appendices/size_and_form_plan.md states the rules.
"""

from typing import NamedTuple

import numpy as np
import pandas as pd
from scipy.stats import norm

from simcore.evaluation.confidence import student_quantile
from simcore.models.packing_models.literature import LITERATURE
from simcore.models.size_and_form.candidates import CANDIDATES
from simcore.models.size_and_form.choice import Score, choose, score
from simcore.models.size_and_form.fit import Fit, fit_candidate, predict_beds, predict_left_out, scatter_between_beds
from simcore.models.size_and_form.sized_model import CANDIDATE, NOT_FITTED, UNFITTED, relative_error

# The order of preference among candidates with equally many parameters (docs/appendices/size_and_form_plan.md).
PREFERENCE = ("L", "F", "D_F", "H", "L_free", "D_H", "H_free", "H_form")
IN_USE = "L"  # chosen with 26 beds; the rule of docs/appendices/size_and_form_plan.md keeps it
LEVEL = 0.95  # probability of the intervals whose coverage is reported


class Comparison(NamedTuple):
    """Result of `compare`."""

    table: pd.DataFrame  # one row per candidate or model of the literature
    fits: dict  # name of a candidate -> Fit to all beds
    by_family: dict  # name -> predictions (n,) of the beds by fits without their family, and by NOT_FITTED
    chosen: str
    scatter: float  # τ


def compare(beds, names=PREFERENCE, scatter=None, in_use=IN_USE) -> Comparison:
    """Compare the candidates `names` and the literature on Beds; scatter: τ, None: by restricted maximum likelihood.

    in_use: as in simcore.models.size_and_form.choice.choose.

    Columns of the table: model, parameters (number of fitted ones), chosen; for groups = family and form:
    error_by_<groups> (weighted mean absolute error over left-out beds), excess_by_<groups> and
    excess_std_error_by_<groups> (over that of the best); bias and rms_error over the beds by left-out families;
    coverage of their intervals, nan with fewer than three families; and fitted (parameters of the fit to all beds with
    standard errors, as text). The last row, NOT_FITTED, is the candidate without fitted parameters, which is not chosen
    from. ValueError if the beds have fewer than two families or forms.
    """
    scatter = scatter_between_beds(beds) if scatter is None else scatter
    weights = 1.0 / (beds.error**2 + scatter**2)
    fits: dict[str, Fit] = {name: fit_candidate(name, beds, scatter) for name in names}
    of_literature = {
        name: np.array([porosity(curve, n1) for curve, n1 in zip(beds.curves, beds.one_class, strict=True)])
        for name, porosity in LITERATURE.items()
    }
    predictions, scores = {}, {}
    for kind in ("family", "form"):
        groups = getattr(beds, kind)
        predictions[kind] = {name: predict_left_out(name, beds, groups, scatter) for name in names} | of_literature
        errors = {name: predicted - beds.n for name, predicted in predictions[kind].items()}
        scores[kind] = score(errors, weights, groups)
    numbers = {name: len(CANDIDATES[name].parameters) for name in names} | dict.fromkeys(LITERATURE, 0)
    chosen = choose(scores["family"], scores["form"], numbers, in_use)
    unfitted = predict_beds(CANDIDATE, beds, UNFITTED)
    predictions["family"][NOT_FITTED], numbers[NOT_FITTED] = unfitted, 0
    mean_error = float(np.average(np.abs(unfitted - beds.n), weights=weights))
    rows = []
    for name, number in numbers.items():
        row = {"model": name, "parameters": number, "chosen": "yes" if name == chosen else ""}
        for kind, of_kind in scores.items():
            best = min(of_kind.values()).error
            own = of_kind[name] if name in of_kind else Score(mean_error, mean_error - best, np.nan)
            row[f"error_by_{kind}"], row[f"excess_by_{kind}"], row[f"excess_std_error_by_{kind}"] = own
        difference = predictions["family"][name] - beds.n
        row["bias"] = float(np.average(difference, weights=weights))
        row["rms_error"] = float(np.sqrt(np.average(difference**2, weights=weights)))
        row["coverage"] = coverage(beds, predictions["family"][name])
        rows.append(row | {"fitted": _describe(fits[name]) if name in fits else ""})
    return Comparison(pd.DataFrame(rows), fits, predictions["family"], chosen, scatter)


def coverage(beds, predicted, level=LEVEL) -> float:
    """Return the share of Beds whose packed porosity is within the interval of its prediction; nan below 3 families.

    predicted (n,): porosities by fits without the family of each bed. The interval of a bed is that of `predict`: the
    relative error of the decrease of porosity is that over the beds of all other families, with one degree of freedom
    less than there are other families. The sampling error of the bed is added. level: probability of the interval.
    """
    families = np.unique(beds.family)
    if len(families) < 3:
        return np.nan
    inside = np.zeros(len(beds.n), bool)
    for family in families:
        own = beds.family == family
        error = relative_error(predicted[~own], beds.n[~own], beds.one_class[~own])
        of_prediction = student_quantile(level, len(families) - 2) * error * (beds.one_class[own] - predicted[own])
        half = np.hypot(of_prediction, norm.ppf(0.5 + 0.5 * level) * beds.error[own])
        inside[own] = np.abs(predicted[own] - beds.n[own]) <= half
    return float(inside.mean())


def covariance_rows(fits) -> pd.DataFrame:
    """Return one row per pair of parameters of each Fit, dict by name: model, parameter, with_parameter, covariance."""
    rows = [
        {"model": name, "parameter": key, "with_parameter": other, "covariance": fit.covariance[i, j]}
        for name, fit in fits.items()
        for i, key in enumerate(fit.parameters)
        for j, other in enumerate(fit.parameters)
    ]
    return pd.DataFrame(rows)


def parameter_rows(fits, freedom) -> pd.DataFrame:
    """Return one row per parameter of each Fit, dict by name.

    The columns are model, parameter, value, std_error, lower_95, upper_95 and at_bound. lower_95, upper_95: 95 %
    confidence interval with Student's t of `freedom` degrees of freedom, nan for a parameter at its bound. Beds of a
    family share deviations, so that `freedom` is that of the prediction intervals, one less than there are families.
    """
    t = student_quantile(LEVEL, freedom)
    rows = []
    for name, fit in fits.items():
        errors = fit.std_errors()
        for key, value in fit.parameters.items():
            bound = key in fit.at_bound
            half = np.nan if bound else t * errors[key]
            row = {"model": name, "parameter": key, "value": value, "std_error": errors[key]}
            rows.append(row | {"lower_95": value - half, "upper_95": value + half, "at_bound": "yes" if bound else ""})
    return pd.DataFrame(rows)


def _describe(fit):
    errors = fit.std_errors()
    texts = []
    for key, value in fit.parameters.items():
        bound = " (at its bound)" if key in fit.at_bound else ""
        texts.append(f"{key} = {value:.3f} ± {errors[key]:.3f}{bound}")
    return ", ".join(texts)
