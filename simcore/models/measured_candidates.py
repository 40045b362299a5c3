"""Candidates for a model of measured beds: which are fitted, how they are tested, and which one is chosen.

Each bed is left out once and predicted from the others. The chosen model is the simplest of which the mean absolute
error is at most the smallest one plus its standard error.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pandas as pd

from simcore.evaluation.confidence import error_of_mean, student_quantile
from simcore.grains.measured_beds import form_key
from simcore.models.scatter import with_constant

BEDS_NEEDED = {"offset": 3, "rescaling": 6}
# A bed with a leverage above this determines a coefficient alone, so that it cannot be predicted from the others.
_ALONE = 1.0 - 1e-9
AGREEMENT = ["by", "model", "beds", "bias", "bias_error", "scatter", "inside"]
SAME = "all measured porosities are the same"
NO_SPREAD = "our model predicts nearly the same porosity for all beds, or for all but one"


class TooFewBeds(ValueError):
    """There are too few measured beds for any model."""


class Candidate(NamedTuple):
    """A model of one kind.

    kind: "offset", "rescaling" or "features". needed: number of beds. model: PorosityModel or CurveCorrection, or None
    with the `reason` why it is not fitted. coefficients: DataFrame of the fitted ones, columns term, value, std_error,
    lower, upper (95 % confidence interval). error, error_se: mean absolute error over beds left out, and its standard
    error.
    """

    kind: str
    needed: int
    model: object
    coefficients: pd.DataFrame | None
    error: float
    error_se: float
    reason: str = ""


def fitted_candidate(kind, needed, model, columns, errors):
    """Return the Candidate with the cross-validated errors (n,); columns: rows of its coefficients."""
    table = pd.DataFrame(columns, columns=["term", "value", "std_error", "lower", "upper"])
    size = np.abs(errors)
    mean, median = float(size.mean()), float(np.median(size))
    model = replace(model, mean_absolute_error=mean, median_absolute_error=median)
    return Candidate(kind, needed, model, table, size.mean(), size.std(ddof=1) / np.sqrt(len(size)))


def not_fitted(kind, needed, reason):
    """Return the Candidate of a model that is not fitted."""
    return Candidate(kind, needed, None, None, np.nan, np.nan, reason)


def too_few(what, needed, beds, differ="form"):
    """Return the reason that a model needs more beds."""
    return f"{what} needs {needed} beds of different {differ}, and there are {beds}"


def rows_of_coefficients(kind, result):
    """Return the rows of the coefficients of a correction; result: Fitted."""
    values, errors = result.coefficients, np.sqrt(np.diag(result.covariance))
    half = student_quantile(0.95, result.freedom) * errors
    terms = [kind] if kind == "offset" else ["constant", "factor"]
    return zip(terms, values, errors, values - half, values + half, strict=True)


def group_repeats(measured):
    """Return lists of MeasuredBed with the same form and, if they have one, the same sieve curve."""
    groups = {}
    for bed in measured:
        curve = bed.curve
        of_curve = () if curve is None else (*curve.bounds, *curve.mass_fractions)
        key = form_key(bed), tuple(f"{value:.8g}" for value in of_curve)
        groups.setdefault(key, []).append(bed)
    return list(groups.values())


def means_of_repeats(groups):
    """Return beds, a DataFrame with name, n, n_error and repeats per group, and the standard deviation of repeats."""
    rows, squares, freedom = [], 0.0, 0
    for group in groups:
        n, errors = np.array([(bed.n, bed.n_error) for bed in group]).T
        squares, freedom = squares + np.sum((n - n.mean()) ** 2), freedom + len(n) - 1
        rows.append((group[0].sample.name, n.mean(), error_of_mean(errors), len(n)))
    beds = pd.DataFrame(rows, columns=["name", "n", "n_error", "repeats"])
    return beds, float(np.sqrt(squares / freedom)) if freedom else np.nan


def for_single_beds(candidate, repeats, repeat_scatter):
    """Return a Candidate whose model has the scatter of single beds instead of that of means of repeats.

    repeats (n,): number of repeats of each bed. repeat_scatter: standard deviation of repeats about their means, nan
    without repeats. The degrees of freedom follow from those of the two variances by Satterthwaite's formula, for a
    bed in the middle of the measured ones.
    """
    model = candidate.model
    if model is None or np.isnan(repeat_scatter):
        return candidate
    lost = _lost_in_means(repeats, repeat_scatter)
    scatter = float(np.sqrt(model.scatter**2 + lost))
    changes = {"scatter": scatter, "degrees_of_freedom": _freedom(model, lost, np.asarray(repeats))}
    if getattr(model, "scatter_line", None) is not None:
        changes["scatter_line"] = with_constant(model.scatter_line, lost)
    return candidate._replace(model=replace(model, **changes))


def _freedom(model, lost, repeats):
    """Return the degrees of freedom of the variance of a single bed; model: of means; lost: as _lost_in_means."""
    fitted = len(repeats) - model.freedom
    of_means = model.scatter**2 * (1.0 + fitted / len(repeats))
    divided = of_means**2 / model.freedom + lost**2 / np.sum(repeats - 1)
    return float((of_means + lost) ** 2 / divided) if divided > 0.0 else float(model.freedom)


def freedom_text(model):
    """Return the degrees of freedom of a model of `for_single_beds`, which need not be whole."""
    return f"{model.freedom:.0f}" if float(model.freedom).is_integer() else f"{model.freedom:.1f}"


def scatter_of_means(model, repeats, repeat_scatter):
    """Return the scatter of the means of repeats about a model of `for_single_beds`."""
    return float(np.sqrt(max(model.scatter**2 - _lost_in_means(repeats, repeat_scatter), 0.0)))


def _lost_in_means(repeats, repeat_scatter):
    """Return the part of the variance of single beds that their means do not have, 0 without repeats."""
    return 0.0 if np.isnan(repeat_scatter) else repeat_scatter**2 * float(np.mean(1.0 - 1.0 / np.asarray(repeats)))


def left_out_errors(columns, y):
    """Return the errors (n,) of predicting each of y (n,) by least squares on the others; columns (n, k).

    They are the residuals divided by 1 minus the leverage, which is exact. None if the columns do not determine the
    coefficients without one of the rows.
    """
    y = np.asarray(y, float)
    largest = np.abs(columns).max(axis=0)
    columns = columns / np.where(largest > 0, largest, 1.0)
    if np.linalg.matrix_rank(columns, tol=1e-9 * np.sqrt(len(y))) < columns.shape[1]:
        return None
    Q, _ = np.linalg.qr(columns)
    leverage = np.einsum("ij,ij->i", Q, Q)
    if leverage.max() > _ALONE:
        return None
    return (y - Q @ (Q.T @ y)) / (1.0 - leverage)


def choose(candidates):
    """Return the simplest Candidate whose error is at most the smallest one plus its standard error."""
    fitted = [item for item in candidates if item.model is not None]
    best = min(fitted, key=lambda item: item.error)
    return next(item for item in fitted if item.error <= best.error + best.error_se)


def agreement(by, model, difference, inside=np.nan):
    """Return a row of AGREEMENT from the differences (k,) of predicted and measured porosities.

    The bias is their mean and the scatter their standard deviation, nan for one bed. inside: number of beds in their
    prediction intervals, nan if the model has none.
    """
    scatter = difference.std(ddof=1) if len(difference) > 1 else np.nan
    return by, model, len(difference), difference.mean(), scatter / np.sqrt(len(difference)), scatter, inside
