"""Write the fit to measured beds with sieve curves as text for people or as plain values for JSON."""

import numpy as np

from simcore.grains.text_columns import text_columns
from simcore.models.measured_candidates import freedom_text
from simcore.models.measured_curves import LITERATURE, OURS
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


def describe_curves(fit, path):
    """Return the lines on a CurveFit; path: the table."""
    rows = int(fit.beds.repeats.sum())
    of_rows = f" (means of {rows} rows)" if rows > len(fit.beds) else ""
    lines = [f"Measured porosities of {path}: {len(fit.beds)} beds{of_rows} with sieve curves", ""]
    lines += [*_table_of_agreement(fit), ""]
    lines += wrap(
        "The bias is the mean of predicted minus measured porosity, and the scatter is the standard deviation of "
        f"{scattering(fit.beds)} about it. The last column counts the beds inside the 95 % prediction interval. "
        "Packing models get the one-class porosity from our models."
    )
    lines += ["", *wrap(_describe_bias(fit)), ""]
    lines += table_of_beds(fit.beds, f"our model of {OURS} as it is")
    lines += ["Models, with the mean absolute error of predicting each bed from the others", ""]
    lines += [*table_of_candidates(fit, f"ours, {OURS}, as it is"), "", *table_of_coefficients(fit), ""]
    lines += [*wrap(_describe_choice(fit)), "", "What these beds show, and what they do not show", ""]
    return [*lines, *(line for sentence in sentences(fit) for line in wrap(sentence, "- ")), ""]


def _table_of_agreement(fit):
    cells = [["model as it is", "beds", "bias", "± error", "scatter", "in interval"]]
    for row in fit.agreement.itertuples():
        name = row.model if row.by == LITERATURE else f"ours, {row.model}"
        inside = "-" if row.by == LITERATURE else f"{row.inside:.0f}"
        cells.append([name, str(row.beds), f"{row.bias:+.4f}", number(row.bias_error), number(row.scatter), inside])
    return text_columns(cells)


def _describe_bias(fit):
    row = fit.agreement.iloc[0]
    side = "below" if row.bias < 0 else "above"
    amount = f"{abs(row.bias):.4f} ± {row.bias_error:.4f}"
    text = f"On average, our model of {OURS} predicts {amount} {side} the measured porosity"
    offset = fit.candidates[0].coefficients
    if offset is not None and offset.lower.iloc[0] <= 0 <= offset.upper.iloc[0]:
        return f"{text}, which these beds do not distinguish from 0 with 95 % confidence."
    return f"{text}."


def _describe_choice(fit):
    model = fit.model
    factor = "" if fit.chosen.kind == "offset" else f"{model.factor:.4f} "
    text = (
        f"The chosen model is the {fit.chosen.kind} of our model: n = {model.coefficients[0]:+.4f} + {factor}n_model. "
        "It is the simplest one whose error is within one standard error of the smallest. Single beds scatter about it "
        f"by {model.scatter:.4f}, with {freedom_text(model)} degrees of freedom."
    )
    if fit.base_error <= fit.chosen.error:
        text += " These beds give no reason to correct our model: as it is, its error is not larger."
    return text


def sentences(fit):
    """Return sentences on what the beds of a CurveFit show and what they do not show."""
    beds = fit.beds
    texts = [
        f"98 % of the mass of a bed spans {beds.ratio.min():.3g} : 1 to {beds.ratio.max():.3g} : 1 in size; errors of "
        f"our model are known up to {fit.model.sized.widest:.3g} : 1. The one-class porosity of the forms ranges from "
        f"{beds.n_one_class.min():.3f} to {beds.n_one_class.max():.3f}.",
        f"The beds have {len(fit.model.forms)} {'form' if len(fit.model.forms) == 1 else 'forms'}. For forms "
        "and curves that they do not cover, these data do not show whether the correction is the same; there the "
        "interval is wider.",
        *_shared_by_form(fit),
        *sentences_on_reasons(fit),
    ]
    rescaling = fit.candidates[1]
    if rescaling.model is not None:
        row = rescaling.coefficients.iloc[1]
        span = f"{row.value:.2f} ({row.lower:.2f} to {row.upper:.2f})"
        if row.lower <= 1 <= row.upper:
            texts.append(f"The factor of the rescaling, {span}, does not differ from 1 at 95 % confidence.")
        else:
            what = (
                "sizes and form act less than in our model, or the curves and forms have errors, which lower it too"
                if row.value < 1
                else "sizes and form act more than in our model"
            )
            texts.append(f"The factor of the rescaling is {span}: {what}.")
    texts += describe_errors(fit, "form and sieve curve")
    texts += validity(fit)
    return texts


def _shared_by_form(fit):
    """Return a sentence on the error that beds of one form share, if a form has several beds, as a list."""
    errors = (fit.beds.predicted - fit.beds.n).groupby(fit.beds.form)
    counts, total = errors.size(), len(fit.beds)
    if counts.max() == 1:
        return []
    of_forms = fit.beds.one_class_scatter.groupby(fit.beds.form).mean()
    within = ((errors.size() - 1) * errors.var().fillna(0.0)).sum() / (total - len(counts))
    error = np.sqrt(((of_forms * counts) ** 2).sum() / total**2 + within / total)
    scatter = " to ".join(dict.fromkeys(f"{value:.4f}" for value in (of_forms.min(), of_forms.max())))
    bias_error = fit.agreement.iloc[0].bias_error
    return [
        f"Beds of one form share the error of its one-class porosity, whose standard deviation is {scatter}. If "
        f"the bias is to be that of beds of other forms too, its standard error is {error:.4f} instead of "
        f"{bias_error:.4f}, and the confidence intervals of the coefficients are too narrow likewise."
    ]


def curves_as_plain(fit):
    """Return a CurveFit as plain values for JSON."""
    return {
        "beds": records(fit.beds),
        "agreement": records(fit.agreement),
        "corrected": OURS,
        "error_as_it_is": plain(fit.base_error),
        "candidates": [
            plain_candidate(item, item is fit.chosen, _coefficients(item.model) if item.model else None)
            for item in fit.candidates
        ],
        "repeat_scatter": plain(fit.repeat_scatter),
        "sentences": sentences(fit),
    }


def _coefficients(model):
    return dict(zip(("constant", "factor"), (model.coefficients[0], model.factor), strict=True))
