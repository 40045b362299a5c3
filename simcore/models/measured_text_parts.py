"""Tables, sentences and plain values that the text on fits to measured beds shares."""

import math
import textwrap

import numpy as np

from simcore.grains.text_columns import text_columns
from simcore.models.measured_candidates import scatter_of_means
from simcore.models.prediction import other_kind

WIDTH = 116
LISTED = 10  # maximum number of beds in the text of a fit


def table_of_candidates(case, as_it_is):
    """Return the lines on the candidates of a CaseFit or CurveFit; as_it_is: name of the model without a correction."""
    cells = [["model", "coefficients", "beds needed", "error", "± error", ""]]
    if case.base:
        cells.append([as_it_is, "0", "-", f"{case.base_error:.4f}", "", ""])
    for item in case.candidates:
        count = "-" if item.model is None else str(len(item.coefficients))
        mark = "chosen" if item is case.chosen else "not fitted" if item.reason else ""
        cells.append([item.kind, count, str(item.needed), number(item.error), number(item.error_se), mark])
    return text_columns(cells)


def validity(case):
    """Return the sentences on the beds for which the chosen model of a CaseFit or CurveFit is valid."""
    texts, only = [], case.only_kind
    if only is not None:
        texts.append(f"Each bed has {only}; these data do not show the error for beds with {other_kind(only)}.")
    texts.append(
        "The chosen model is for beds that are made and measured in the same way. The porosities alone do not show why "
        "they differ from our packings, such as by preparation, walls or method of measurement."
    )
    return texts


def table_of_beds(beds, model):
    """Return the lines on the measured and predicted porosities of a CaseFit or CurveFit; the last line is empty.

    model: name of the one that predicts. No lines are returned if no bed is predicted. If there are more than LISTED
    beds, those with the largest differences are listed, the largest first, after those that are not predicted.
    """
    if beds.predicted.isna().all():
        return []
    beds, text = beds.assign(difference=beds.predicted - beds.n), f"Measured porosity and the prediction of {model}"
    if len(beds) > LISTED:
        sizes = beds.difference.abs()
        largest = sizes.sort_values(ascending=False, kind="stable", na_position="first").index[:LISTED]
        beds, text = beds.loc[largest], f"{text}: the {LISTED} of {len(beds)} beds with the largest difference"
    cells = [["bed", "measured", "predicted", "difference"]]
    for bed in beds.itertuples():
        difference = "-" if math.isnan(bed.difference) else f"{bed.difference:+.4f}"
        cells.append([bed.name, f"{bed.n:.4f}", number(bed.predicted), difference])
    return [*wrap(text), "", *text_columns(cells), ""]


def table_of_coefficients(case):
    """Return the lines on the fitted coefficients."""
    cells = [["model", "coefficient", "value", "± error", "95 % confidence interval"]]
    for item in case.candidates:
        for row in item.coefficients.itertuples() if item.model else []:
            interval = f"{row.lower:.4f} to {row.upper:.4f}"
            cells.append([item.kind, row.term, f"{row.value:.4f}", f"{row.std_error:.4f}", interval])
    return text_columns(cells)


def scattering(beds):
    """Return what scatters about the bias in a table of agreement: single beds, or the means of repeats."""
    return "the means of repeats" if (beds.repeats > 1).any() else "single beds"


def sentences_on_reasons(case):
    """Return sentences on the candidates that are not fitted."""
    reasons = {}
    for item in case.candidates:
        if item.reason:
            reasons.setdefault(item.reason, []).append(item.kind)
    return [f"Not fitted: {' and '.join(kinds)}, because {reason}." for reason, kinds in reasons.items()]


def describe_errors(case, of_same="form"):
    """Return sentences on how the errors of the porosities and the repeats compare with the scatter.

    of_same: what the rows of one bed have in common.
    """
    texts, scatter = [], scatter_of_means(case.chosen.model, case.beds.repeats, case.repeat_scatter)
    errors = case.beds.n_error
    if errors.notna().all():
        given = float(np.sqrt(np.mean(errors**2)))
        means = (
            f"they explain {100 * (given / scatter) ** 2:.0f} % of the variance about the chosen model"
            if given < scatter
            else "they are as large as the scatter about the chosen model, so the data show no other scatter"
        )
        texts.append(f"The measurement errors that you give are {given:.4f} (root mean square); {means}.")
    else:
        texts.append(
            "If n_error is not given for every bed, measurement errors and errors of the model cannot be separated."
        )
    if not math.isnan(case.repeat_scatter):
        texts.append(
            f"Repeats of the same {of_same} scatter by {case.repeat_scatter:.4f}. Their mean counts as one bed; the "
            "interval is for a single bed, whose scatter contains that of repeats."
        )
    return texts


def plain_candidate(item, chosen, coefficients):
    """Return a Candidate as plain values; coefficients: dict of those of its model, or None."""
    model = item.model
    return {
        "kind": item.kind,
        "beds_needed": item.needed,
        "chosen": chosen,
        "reason": item.reason or None,
        "error": plain(item.error),
        "error_se": plain(item.error_se),
        "fitted": records(item.coefficients) if model else [],
        "model": coefficients,
        "scatter": model.scatter if model else None,
    }


def records(table):
    """Return the rows of a DataFrame as plain values."""
    return [{key: plain(value) for key, value in row.items()} for row in table.to_dict("records")]


def plain(value):
    """Return a value for JSON: None in place of a number that is not finite."""
    value = value.item() if isinstance(value, np.generic) else value
    return None if isinstance(value, float) and not math.isfinite(value) else value


def number(value):
    """Return a number with four decimals, or a dash."""
    return "-" if math.isnan(value) else f"{value:.4f}"


def wrap(text, bullet=""):
    """Return the lines of a sentence after a bullet; further lines are indented like the text."""
    return textwrap.wrap(
        bullet + text, WIDTH, subsequent_indent=" " * len(bullet), break_long_words=False, break_on_hyphens=False
    )
