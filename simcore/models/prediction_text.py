"""Write predictions of porosity as text for people, as CSV or as JSON."""

import json

import numpy as np

from simcore.grains.form_notices import SHOWN
from simcore.grains.measured_forms import FEWEST_FOR_ERRORS, read_two_axes
from simcore.grains.text_columns import text_columns
from simcore.grains.text_lists import join_first
from simcore.models.fitted_range import FAR, NEAR
from simcore.models.measured_file import MEASURED
from simcore.models.measured_prediction import check_level, models_for_cases, predict_measured
from simcore.models.measured_text_parts import records
from simcore.models.nearly_round import nearly_round_caveats
from simcore.models.prediction import (
    KINDS_OF_BED,
    ONE_CLASS,
    PREDICTION,
    describe_model,
    model_case,
    remedy_without_model,
    standard_case,
)
from simcore.models.two_axes import WITHOUT_FEW_GRAINS, predict_two_axes, two_axes_text
from simcore.reference.r22_tables import read_r22_models

FEW_GRAINS = 30  # fewer grains do not determine the spread of form well
FEW_WORDS = {
    FEW_GRAINS: "do not determine the spread of form well",
    FEWEST_FOR_ERRORS: "do not determine the error either; it is that of grains that differ as much as the Rhine's",
}

SINGLE_GRAIN = (
    "a single grain was measured, and all grains are taken to have its form. If they differ, the interval does not "
    "contain the error of the form"
)


def predict_file(path, case, models=None, source=None, column=None, level=0.95, output="text", notify=None):
    """Return what `scree predict` prints for the table of measured grains at `path`.

    Arguments and errors: as in `predict_measured`. output: "text", "csv" or "json". notify: function that is called
    with each notice on how the table was read; JSON output contains the notices too. For a table with two axes only,
    the text has a range over the third axis (simcore.models.two_axes).
    """
    check_level(level)
    two_axes = read_two_axes(path, column)
    if two_axes is not None:
        samples, notices = two_axes
        for notice in notices if notify is not None else []:
            notify(notice)
        ranges = predict_two_axes(samples, case, models_for_cases(models, source), level)
        return two_axes_text(ranges, case, notices, level, output)
    table, fitted, notices = predict_measured(path, case, models, source, column, level)
    for notice in notices if notify is not None else []:
        notify(notice)
    if output == "csv":
        return table.rename(columns={"name": "sample"}).to_csv(index=False).rstrip("\n")
    if output == "json":
        return as_json(table, case, fitted, level, notices)
    return describe(table, case, fitted, level)


def describe(table, case, fitted, level=0.95):
    """Return the predictions as text: one line per sample, then the models, and the samples outside their ranges.

    table: result of predict_samples with the same case, fitted and level.
    """
    lines = [f"Porosity of a bed, case {model_case(case)}, with {100 * level:g} % prediction intervals"]
    if standard_case(case) == ONE_CLASS and (MEASURED, model_case(case)) not in fitted.models:
        lines.append(
            "(U1's models are used: only ratios of sizes affect porosity, so any single sieve class packs like U1)"
        )
    lines += _describe_missing_models(table, model_case(case), fitted)
    lines += ["", *_samples_in_columns(table), "", "Models"]
    for (by, name), _ in table[table.model != ""].groupby(["by", "model"], sort=False):
        lines.append(f"  {_equation(by, name, model_case(case), fitted)}")
    extrapolated = table[(table.outside != "") & (table.refused == "") & (table.distance > 0)]
    remarked = table[(table.outside != "") & (table.refused == "") & (table.distance == 0)]
    refused = table[(table.refused != "") & (table.model != "")]
    if len(extrapolated):
        lines += [
            "",
            f"* outside the fitted range of the model: its interval is widened beyond {NEAR:g} of the range's width",
            *_remarks(extrapolated, "outside"),
        ]
    if len(remarked):
        lines += ["", "* inside the fitted range, with a remark", *_remarks(remarked, "outside")]
    if len(refused):
        lines += [
            "",
            f"- not evaluated: more than {FAR:g} of a range's width outside it, or the porosity is not in (0, 1)",
            *_remarks(refused, "refused"),
        ]
    return "\n".join([*lines, "", *_caveats(table, level)])


def _describe_missing_models(table, case, fitted):
    """Return lines that list the samples that none of our models predicts, with the reason."""
    lines, ours_exist = [], case in fitted.cases()
    if not ours_exist:
        available, of_fit = ", ".join(fitted.cases()), any(name == MEASURED for name, _ in fitted.models)
        why = f"your fit is for {available}" if of_fit else f"ours were fitted to {available}"
        lines.append(
            f"Only the model of Rettinger et al. is used: {why}, not {'for' if of_fit else 'to'} {case}. For an "
            f"interval, {remedy_without_model(case)}."
        )
    none = table.groupby("name").n.transform("count") == 0
    without = table.model == ""
    if without.any():
        names, reason = ", ".join(table.name[without]), table.refused[without].iloc[0]
        lines.append(f"Not predicted: {names}; {reason}. For these, {remedy_without_model(case)}.")
    if (none & ~without).any():
        lines.append(
            f"No model is evaluated for: {', '.join(table.name[none & ~without].unique())}. The reasons are listed "
            "below; correct the values, or simulate packings of these grains (scree pack)."
        )
    without = table[ours_exist & ~none & ~table.groupby("name").preferred.transform("any")]
    ours = without.name.isin(without.name[without.by == "ours"])
    for kind in without.kind_of_bed[~ours].unique():
        lines.append(
            f"Too few of our packings of {case} have {kind}: only the model of Rettinger et al. is used for these. For "
            f"an interval, {remedy_without_model(case)}."
        )
    if ours.any():
        names = ", ".join(without.name[ours].unique())
        lines.append(f"None of our models can be evaluated, only that of Rettinger et al., for: {names}.")
    return lines


def _samples_in_columns(table):
    """Return the lines of the table of samples, beginning with its header."""
    cells = [["sample", "grains", "form", "FL", "EL", "ours", "by", "other of ours", "Rettinger et al."]]
    for _, rows in table.groupby("name", sort=False):
        sample = rows.iloc[0]
        preferred = rows[rows.preferred]
        other, r22 = rows[(rows.by == "ours") & ~rows.preferred], rows[rows.by == "r22"]
        cells.append(
            [
                str(sample["name"]),
                str(sample.grains) if sample.grains else "-",
                "one" if sample.kind_of_bed == KINDS_OF_BED[0] else "distribution",
                f"{sample.mu_FL:.3f} ± {sample.sigma_FL:.3f}",
                f"{sample.mu_EL:.3f} ± {sample.sigma_EL:.3f}",
                _cell(preferred),
                preferred.model.iloc[0].replace(MEASURED, "your fit") if len(preferred) else "-",
                _cell(other),
                _cell(r22),
            ]
        )
    return text_columns(cells)


def _cell(rows):
    evaluated = rows[rows.refused == ""]
    if evaluated.empty:
        return "-"
    row = evaluated.iloc[0]
    mark = "*" if row.outside else ""
    interval = f" ({row.lower:.3f} to {row.upper:.3f})" if np.isfinite(row.lower) else ""
    return f"{row.n:.3f}{mark}{interval}"


def _remarks(rows, column):
    return [f"  {row['name']}, {describe_model(row.by, row.model)}: {row[column]}" for _, row in rows.iterrows()]


def few_grains_caveats(names, grains, of_one_form) -> list[str]:
    """Return lines on the samples of few grains.

    names, grains, of_one_form (n,): of each sample; 0 grains if they are unknown. Grains of one form have no error.
    """
    names, grains, differ = np.asarray(names), np.asarray(grains), ~np.asarray(of_one_form, bool)
    lines = []
    if single := dict.fromkeys(names[grains == 1]):
        lines.append(f"{join_first([str(name) for name in single], SHOWN)}: {SINGLE_GRAIN}.")
    for number, text in FEW_WORDS.items():
        few = dict.fromkeys(names[differ & (grains > 1) & (grains < number)])
        if few:
            lines.append(f"Fewer than {number} grains {text}: {', '.join(map(str, few))}.")
    return lines


def few_grains_error_caveats(names, of_one_form, errors, what) -> list[str]:
    """Return the lines on the error of samples that follows from the limited number of measured grains.

    names, of_one_form (n,): name of each sample, and whether its grains have one form. errors (n,): standard errors of
    `what`, such as "the porosity"; nan if they are unknown.
    """
    errors, differ = np.asarray(errors, float), ~np.asarray(of_one_form, bool)
    with_error, without_error = differ & np.isfinite(errors), differ & ~np.isfinite(errors)
    lines = []
    if with_error.any():
        least, largest = (f"{value:.3f}" for value in (errors[with_error].min(), errors[with_error].max()))
        size = largest if least == largest else f"{least} to {largest}"
        size = "less than 0.001" if largest == "0.000" else size
        lines.append(
            f"Because only some grains were measured, {what} has a standard error of {size}, which the intervals "
            "contain."
        )
    if without_error.any():
        of = (
            ""
            if not with_error.any()
            else f" of {', '.join(dict.fromkeys(map(str, np.asarray(names)[without_error])))}"
        )
        lines.append(
            f"{WITHOUT_FEW_GRAINS}{of}; it is known if each grain has a row, or if a column `grains` has their number."
        )
    return lines


def _caveats(table, level):
    lines = []
    if (table.grains == 0).any():
        lines.append(
            "If only means and deviations are given, FL and EL are assumed independent, as by Rettinger et al."
        )
    lines += few_grains_caveats(table.name, table.grains, table.kind_of_bed == KINDS_OF_BED[0])
    ours = table[table.preferred]
    one_form = ours.kind_of_bed == KINDS_OF_BED[0]
    lines += few_grains_error_caveats(ours.name, one_form, ours.few_grains_error, "the porosity")
    lines += nearly_round_caveats(ours.itertuples())
    if len(ours):
        lines.append(
            "The interval contains the porosity of a new sample, poured and shaken in the same way, with "
            f"{100 * level:g} % probability; Rettinger et al. publish no interval."
        )
    else:
        lines.append("Rettinger et al. publish no interval.")
    return lines


def _equation(by, name, case, fitted):
    if by == "r22":
        published = read_r22_models()[name, case]
        text = _terms(published.intercept, published.slopes.index, published.slopes)
        return f"{describe_model(by, name)}: {text}; their Eq. {published.equation}"
    model = fitted.models[name, case]
    text = _terms(model.coefficients[0], model.features, model.coefficients[1:])
    error = f"cross-validated error {model.mean_absolute_error:.4f} (mean), {model.median_absolute_error:.4f} (median)"
    return f"{describe_model(by, name)}: {text}; {error}; {fitted.behind[name, case]}"


def _terms(intercept, names, slopes):
    return f"n = {intercept:.4f}" + "".join(f" {slope:+.4f} {name}" for name, slope in zip(names, slopes, strict=True))


def as_json(table, case, fitted, level=0.95, notices=()):
    """Return the predictions as JSON text: the models, the predictions for each sample, and the notices.

    table: result of predict_samples with the same case, fitted and level. A number that is not finite is null.
    """
    case = model_case(case)
    common = ["name", "grains", "kind_of_bed", "mu_FL", "sigma_FL", "mu_EL", "sigma_EL", "mu_EQ", "sigma_EQ"]
    samples = []
    for _, rows in table.groupby("name", sort=False):
        predictions = records(rows[PREDICTION])
        samples.append({**records(rows[common].head(1))[0], "predictions": predictions})
    models = [
        {
            "model": name,
            "case": model.case,
            "behind": fitted.behind[name, fitted_case],
            "coefficients": dict(zip(model.terms, model.coefficients, strict=True)),
            "cross_validated_error": model.mean_absolute_error,
        }
        for (name, fitted_case), model in fitted.models.items()
        if fitted_case == case
    ]
    content = {"case": case, "level": level, "notices": list(notices), "models": models, "samples": samples}
    return json.dumps(content, indent=1, allow_nan=False)
