"""Write the result of `fit` as text for people or as JSON."""

import json
import math
import shlex

import numpy as np

from simcore.grains.text_columns import text_columns
from simcore.models.correction import CORRECTIONS
from simcore.models.measured_candidates import BEDS_NEEDED, freedom_text
from simcore.models.measured_curves_text import curves_as_plain, describe_curves
from simcore.models.measured_file import MEASURED
from simcore.models.measured_text_parts import (
    describe_errors,
    number,
    plain,
    plain_candidate,
    records,
    scattering,
    sentences_on_reasons,
    table_of_beds,
    table_of_candidates,
    table_of_coefficients,
    validity,
    wrap,
)
from simcore.models.prediction import describe_model
from simcore.models.regression import CORRELATED

# Names in sentences: EQ = S/L is the equancy and EL = I/L the elongation of the mean form.
_AXES = (("mu_EQ_inv", "1/EQ"), ("mu_EL_inv", "1/EL"))


def describe_fit(result, path, out=None):
    """Return a MeasuredFit as text. path: the table; out: the file of the models that was written, or None."""
    lines = []
    for case in result.cases:
        lines += [*_describe_case(case, path), ""]
    if result.curves is not None:
        lines += describe_curves(result.curves, path)
    for sentence in result.left_out:
        lines += [wrap(f"Left out: {sentence}."), ""]
    cases, quoted = [case.given for case in result.cases], shlex.quote(str(out))
    if out is None:
        lines.append("No model is written; give --out MODEL.json to use it in `predict`.")
    elif cases:
        written = f"model of case {cases[0]} is" if len(cases) == 1 else f"models of the cases {', '.join(cases)} are"
        case = shlex.quote(cases[0])
        lines.append(f"The {written} written. Use it: scree predict FORMS.csv --case {case} --models {quoted}")
    if out is not None and result.curves is not None:
        lines.append(
            "The correction for sieve curves is written. Use it: scree predict FORMS.csv --sieve CURVE.csv "
            f"--models {quoted}"
        )
    return "\n".join(_flatten(lines))


def _flatten(lines):
    for line in lines:
        if isinstance(line, str):
            yield line
        else:
            yield from line


def _describe_case(case, path):
    beds = case.beds
    rows = int(beds.repeats.sum())
    of_rows = f" (means of {rows} rows)" if rows > len(beds) else ""
    lines = [f"Measured porosities of {path}: {len(beds)} beds{of_rows}, case {case.given}", ""]
    lines += _describe_agreement(case)
    lines += table_of_beds(beds, f"{_name(case.base)} as it is" if case.base else "our models")
    lines += ["Models, with the mean absolute error of predicting each bed from the others", ""]
    lines += [
        *table_of_candidates(case, f"{describe_model('ours', case.base)} as it is"),
        "",
        *table_of_coefficients(case),
        "",
    ]
    lines += [wrap(_describe_choice(case)), "", "What these beds show, and what they do not show", ""]
    return lines + [wrap(sentence, "- ") for sentence in sentences(case)]


def _describe_agreement(case):
    """Return the lines on the models as they are, before any correction."""
    if case.agreement.empty:
        return [wrap(f"No model, ours or that of Rettinger et al., is evaluated for beds of case {case.given}."), ""]
    cells = [["model as it is", "beds", "bias", "± error", "scatter", "in interval"]]
    for row in case.agreement.itertuples():
        inside = "-" if math.isnan(row.inside) else f"{row.inside:.0f}"
        numbers = [f"{row.bias:+.4f}", number(row.bias_error), number(row.scatter)]
        cells.append([describe_model(row.by, row.model), str(row.beds), *numbers, inside])
    text = (
        "The bias is the mean of predicted minus measured porosity, and the scatter is the standard deviation of "
        f"{scattering(case.beds)} about it. The last column counts the beds inside the 95 % prediction interval."
    )
    lines = [*text_columns(cells), "", wrap(text), ""]
    return [*lines, wrap(_describe_bias(case)), ""] if case.base else lines


def _describe_bias(case):
    row = case.agreement.query("by == 'ours' and model == @case.base").iloc[0]
    amount, side = f"{abs(row.bias):.4f} ± {row.bias_error:.4f}", "below" if row.bias < 0 else "above"
    text = f"On average, {_name(case.base)} predicts {amount} {side} the measured porosity"
    offset = case.candidates[0].coefficients
    if offset is not None and offset.lower.iloc[0] <= 0 <= offset.upper.iloc[0]:
        return f"{text}, which these beds do not distinguish from 0 with 95 % confidence."
    return f"{text}."


def _describe_choice(case):
    model, kind = case.model, case.chosen.kind
    slopes = zip(model.features, model.coefficients[1:], strict=True)
    formula = f"n = {model.coefficients[0]:.4f}" + "".join(f" {value:+.4f} {name}" for name, value in slopes)
    what = f"the {kind} of {_name(case.base)}" if kind in CORRECTIONS else "the fit of the features"
    text = (
        f"The chosen model is {what}: {formula}. It is the simplest one whose error is within one standard error of "
        f"the smallest. Single beds scatter about it by {model.scatter:.4f}, with {freedom_text(model)} degrees of "
        "freedom."
    )
    if case.base_error <= case.chosen.error:
        text += f" These beds give no reason to correct {_name(case.base)}: as it is, its error is not larger."
    return text


def _name(model):
    """Return a model's name in a sentence."""
    return describe_model("ours", model) if model == MEASURED else f"our model {model}"


def sentences(case):
    """Return sentences on what the beds of a CaseFit show and what they do not show."""
    beds = case.beds
    texts = [*_describe_range(case)]
    x, y = (beds[name].to_numpy() for name, _ in _AXES)
    if np.ptp(x) > 1e-6 * x.max() and np.ptp(y) > 1e-6 * y.max():
        r = float(np.corrcoef(x, y)[0, 1])
        means = ""
        fitted = case.candidates[-1].model
        if fitted is not None and {name.removeprefix("mu_") for name in fitted.features} >= {"EQ_inv", "EL_inv"}:
            extent = "hardly separate" if abs(r) > CORRELATED else "can separate"
            means = f", so these beds {extent} their effects"
        texts.append(f"The correlation between 1/EQ and 1/EL is {r:.2f}{means}.")
    else:
        texts.append("1/EQ or 1/EL is the same for all beds, so its effect cannot be measured with them.")
    texts += sentences_on_reasons(case)
    texts += [*_describe_terms(case), *describe_errors(case)]
    texts += validity(case)
    return texts


def _describe_range(case):
    """Return sentences on the forms of the beds, beside those to which our model was fitted."""
    ranges = [f"{label} from {case.beds[name].min():.2f} to {case.beds[name].max():.2f}" for name, label in _AXES]
    text = f"The forms of the beds range over {' and '.join(ranges)}"
    model, own = case.base_model, []
    for name, label in _AXES if case.base else ():
        for key in {name, name.removeprefix("mu_")} & set(model.features):
            position = model.features.index(key)
            own.append(f"{label} from {model.minimum[position]:.2f} to {model.maximum[position]:.2f}")
    if not own:
        return [f"{text}."]
    range_of = "the range of your fit is that of the model that it corrects," if case.base == MEASURED else ""
    range_of = range_of or f"{_name(case.base)} was fitted to"
    texts = [f"{text}; {range_of} {' and '.join(own)}."]
    if case.chosen.kind in CORRECTIONS:
        texts.append("For forms that the beds do not cover, these data do not show whether the correction is the same.")
    return texts


def _describe_terms(case):
    """Return sentences on coefficients that the beds do not determine."""
    texts = []
    _, rescaling, features = case.candidates
    if rescaling.model is not None:
        row = rescaling.coefficients.iloc[1]
        span = f"{row.value:.2f} ({row.lower:.2f} to {row.upper:.2f})"
        if row.lower <= 1 <= row.upper:
            texts.append(f"The factor of the rescaling, {span}, does not differ from 1 at 95 % confidence.")
        elif row.value > 1 or row.value < 0:
            effect = "a stronger effect than" if row.value > 1 else "the opposite of the effect"
            texts.append(f"The factor of the rescaling is {span}: form has {effect} in our model.")
        else:
            texts.append(f"The factor of the rescaling is {span}: {_describe_weaker(case, row.upper)}.")
    if features.model is not None:
        open_terms = [row for row in features.coefficients.iloc[1:].itertuples() if row.lower <= 0 <= row.upper]
        for row in open_terms:
            texts.append(
                f"The beds do not show whether {row.term} has an effect: its coefficient is {row.value:.4f} "
                f"({row.lower:.4f} to {row.upper:.4f})."
            )
    return texts


def _describe_weaker(case, upper):
    """Return a clause on a factor below 1, which errors of the measured forms lower too; upper: end of its interval."""
    errors = case.beds.form_error.to_numpy()
    if not np.isfinite(errors).all():
        return (
            "form has a weaker effect than in our model, or few grains of each bed were measured, because errors of "
            "the measured forms lower this factor too"
        )
    expected = expected_factor(case.beds)
    if upper < expected or not errors.any():
        return "form has a weaker effect than in our model"
    return (
        f"because only some grains of each bed were measured, {expected:.2f} is expected if form has the same effect "
        "as in our model, so these beds do not show a weaker one"
    )


def expected_factor(beds):
    """Return the factor of a rescaling that errors of the forms let expect if the model is right; beds: as in CaseFit.

    The expectation of the inverse variance of n beds is 1/variance with the divisor n - 3.
    """
    predicted = beds.predicted.to_numpy()
    variance = np.sum((predicted - predicted.mean()) ** 2) / (len(beds) - 3)
    return max(1.0 - np.mean(beds.form_error.to_numpy() ** 2) / variance, 0.0)


def _coefficients(model):
    return dict(zip(model.terms, model.coefficients, strict=True)) if model else None


def fit_as_json(result, path):
    """Return a MeasuredFit as JSON text; a number that is not finite is null."""
    cases = [
        {
            "case": case.case,
            "beds": records(case.beds[["name", "n", "n_error", "repeats", "predicted", *(name for name, _ in _AXES)]]),
            "agreement": records(case.agreement),
            "corrected": case.base or None,
            "features": case.features,
            "error_as_it_is": plain(case.base_error),
            "candidates": [
                plain_candidate(item, item is case.chosen, _coefficients(item.model)) for item in case.candidates
            ],
            "repeat_scatter": plain(case.repeat_scatter),
            "sentences": sentences(case),
        }
        for case in result.cases
    ]
    content = {
        "table": str(path),
        "beds_needed": BEDS_NEEDED,
        "notices": list(result.notices),
        "left_out": list(result.left_out),
        "cases": cases,
        "curves": curves_as_plain(result.curves) if result.curves is not None else None,
    }
    return json.dumps(content, indent=1, allow_nan=False)
