"""Write the porosity of beds with a sieve curve as text for people, as CSV or as JSON."""

import json

import numpy as np

from simcore.grains.text_columns import text_columns
from simcore.models.fitting import FittedModels
from simcore.models.measured_prediction import check_level, models_for
from simcore.models.measured_text_parts import plain
from simcore.models.nearly_round import nearly_round_caveats
from simcore.models.prediction import ONE_CLASS, predict_all_preferred
from simcore.models.prediction_text import few_grains_caveats, few_grains_error_caveats
from simcore.models.size_and_form.bed_forms import join_tables, read_bed_forms
from simcore.models.size_and_form.bed_prediction import (
    UNKNOWN_FORMS,
    one_class_models,
    other_predictors,
    own_one_class,
    rhine_one_class,
    sensitivity,
    sized_model,
)
from simcore.models.size_and_form.candidates import CANDIDATES

NO_MODELS = FittedModels({}, {})
STATE = "The porosity is that of a bed that is shaken for about a second."
# From results/reference/size_and_form_known.csv; docs/how_to/predict_from_a_sieve_curve.md compares five sets of beds.
OTHER_BEDS = (
    "Measured gravels, and beds that are made in another way, differ from it by up to 0.03, and most are outside the "
    "interval."
)
MORE_OUTSIDE = (
    "Outside the fitted range they can differ by more."  # docs/how_to/predict_from_a_sieve_curve.md, sorted sands
)
# The rule is in docs/appendices/size_and_form_plan.md, the beds in results/reference/form_by_size.csv.
CHECK_BY_CLASS = "On two packed beds, forms by sieve class had a smaller error than the form of all grains together."


def predict_curve_file(
    path=None, forms=None, *, models=None, source=None, column=None, level=0.95, finest=None, coarsest=None,
    output="text", notify=None,
):  # fmt: skip
    """Return what `predict --sieve` prints for the sieve curve at `path` and the table of grains at `forms`.

    path: also the name of a listed curve; None if the table of grains has a column `sieve`. forms: None for the Rhine's
    mean form; with a column `class` each sieve class has its own form. finest, coarsest [m]: sizes of the grains in the
    pan and on the coarsest sieve. models, source, column, level: as in
    simcore.models.measured_prediction.predict_measured. output: "text", "csv" or "json". notify: called with each
    notice on how the tables were read. ValueError names the file and the remedy.
    """
    check_level(level)
    beds, notices = read_bed_forms(forms, path, column, finest, coarsest)
    for notice in notices if notify is not None else []:
        notify(notice)
    fitted = models_for(models, source)
    tables = [bed.predict(fitted, level) for bed in beds]
    joined = join_tables(beds, tables)
    _require_one(joined, forms if path is None else path)
    if output == "csv":
        return joined.to_csv(index=False).rstrip("\n")
    if output == "json":
        return _json(beds, tables, level, notices, fitted)
    return describe(beds, joined, forms, level, fitted)


def describe(beds, table, forms=None, level=0.95, fitted=NO_MODELS) -> str:
    """Return the text on the table of predictions of a list of BedForms, as of join_tables.

    forms: path of the table of grains. fitted: FittedModels, of which the correction to measured beds is described. How
    the sieve curve acts, and other models, are described only if all samples have one curve.
    """
    model = sized_model(fitted)
    curves = f"curve of {beds[0].source}" if len(beds) == 1 else f"curves in {forms}"
    lines = [
        f"Porosity of beds with the sieve {curves}, with {100 * level:g} % prediction intervals",
        "",
        *_samples(table),
        "",
        *_state(fitted, any_outside=bool((table["outside"] != "").any())),
        *_about_grains(beds, table, fitted),
    ]
    if len(beds) > 1:
        lines += ["", "How each curve acts and what other models predict: add --json."]
    elif (table["refused"] == "").any():
        lines += _describe_curve(beds[0], table, fitted)
    lines += [
        "",
        f"Model of size and form, candidate {model.candidate}: {CANDIDATES[model.candidate].title}; {model.behind}",
        *([CHECK_BY_CLASS] if beds[0].by_class else []),
        *([f"Correction: {fitted.curve.behind}"] if fitted.curve else []),
        *([f"One-class porosity: {behind}"] if (behind := own_one_class(fitted)) else []),
    ]
    outside = table[(table["outside"] != "") & (table["refused"] == "")]
    if len(outside):
        lines += [
            "",
            "* outside the fitted range, or with a remark",
            *(f"  {row.sample}: {row.outside}" for row in outside.itertuples()),
        ]
    refused = table[table["refused"] != ""]
    if len(refused):
        lines += ["", "- not evaluated", *(f"  {row.sample}: {row.refused}" for row in refused.itertuples())]
    return "\n".join(lines)


def _describe_curve(bed, table, fitted):
    """Return the lines on how the curve of BedForms acts, and on other models, for its first sample with a porosity."""
    row = table[table["refused"] == ""].iloc[0]
    model, curve, n1 = sized_model(fitted), bed.curve, row["n_one_class"]
    of_classes = bed.one_class(row.name, n1, fitted)
    with_mass = np.where(curve.mass_fractions > 0, of_classes, n1)
    step = n1 - model.predict(curve, with_mass, reference=rhine_one_class(fitted))
    change = _sensitivity(curve, of_classes, fitted)
    one_class = (
        f"if its classes did not interact, the bed would have the porosity {n1:.3f},"
        if bed.by_class
        else f"a bed of one sieve class of these grains has the porosity {n1:.3f},"
    )
    return [
        "",
        f"How the curve acts, sample {row['sample']}: {one_class}",
        f"and the range of sizes lowers it by {step:.3f}. If the mass of one class grows by 1 % of the whole,",
        "and the other masses stay, the porosity changes by the number in the last column:",
        "",
        *text_columns([["class [mm]", "mass [%]", "change of porosity"], *_classes(curve, change)], "lrr"),
        "",
        f"Other models, sample {row['sample']}",
        *text_columns(
            [
                [other.model, f"{other.n:.3f}", f"from {other.given}"]
                for other in other_predictors(curve, n1).itertuples()
            ],
        ),
        "The range of validity of those from the curve alone is not known to us.",
    ]


def _state(fitted, any_outside):
    """Return the lines on the state of the packing; any_outside: whether a sample is outside the fitted range."""
    if fitted.curve is not None:
        return [
            "The porosity is that of beds that are made and measured like those to which the model was corrected; the",
            "one-class porosity and the other models are without the correction.",
        ]
    if own_one_class(fitted):
        return [
            "The one-class porosity is that of your fit: of beds that are made and measured like yours. The step from",
            "one class to the sieve curve is that of our packings, which are shaken for about a second.",
        ]
    return [
        STATE,
        "The state of packing ranges from a bed that is shaken for eight seconds to one that is placed and not shaken.",
        OTHER_BEDS,
        *([MORE_OUTSIDE] if any_outside else []),
    ]


def _about_grains(beds, table, fitted):
    """Return the lines on the grains of the BedForms: on their number, and on those that are nearly round.

    With forms by sieve class the lines are about the classes.
    """
    refused = dict(zip(table["sample"], table["refused"], strict=True))
    names = [[sample[0] if bed.by_class else sample.name for sample in bed.samples] for bed in beds]
    samples, predicted = [], []
    for bed, of_bed in zip(beds, names, strict=True):
        for index, name in enumerate(of_bed):
            measured = bed.measured(index)
            samples += measured
            predicted += measured if refused[name] == "" else []
    known = [sample for sample in predicted if sample.name != UNKNOWN_FORMS]
    rows = predict_all_preferred(known, ONE_CLASS, one_class_models(fitted)) if known else []
    return [
        *few_grains_caveats(
            [sample.name for sample in samples],
            [sample.grains for sample in samples],
            [sample.one_form for sample in samples],
        ),
        *few_grains_error_caveats(
            [sample.name for sample in known],
            [sample.one_form for sample in known],
            [row["few_grains_error"] for row in rows],
            "the one-class porosity",
        ),
        *nearly_round_caveats(predicted),
    ]


def _sensitivity(curve, one_class, fitted):
    factor = fitted.curve.factor if fitted.curve else 1.0
    return factor * sensitivity(curve, one_class, fitted)


def _require_one(table, path):
    if (table["refused"] != "").all():
        row = table.iloc[0]
        raise ValueError(
            f"{path}: the porosity cannot be predicted for any sample; {row['sample']}: {row['refused']}. Correct the "
            "sieve curve or the table of grains; if both are right, none of the models covers this bed"
        )


def _samples(table):
    own_curves = ["curve"] if "curve" in table and table["curve"].nunique() > 1 else []
    rows = [["sample", *own_curves, "grains", "FL", "EL", "porosity", "state of packing", "one class"]]
    for row in table.itertuples():
        form = [f"{row.mu_FL:.3f} ± {row.sigma_FL:.3f}", f"{row.mu_EL:.3f} ± {row.sigma_EL:.3f}"]
        numbers = ["-", "-", "-"]
        if not row.refused:
            mark = "*" if row.outside else ""
            numbers = [
                f"{row.n:.3f}{mark} ({row.lower:.3f} to {row.upper:.3f})",
                "-" if np.isnan(row.n_not_shaken) else f"{row.n_long_shaken:.3f} to {row.n_not_shaken:.3f}",
                f"{row.n_one_class:.3f} ({row.one_class_lower:.3f} to {row.one_class_upper:.3f})",
            ]
        curve = [row.curve] if own_curves else []
        rows.append([str(row.sample), *curve, str(row.grains or "-"), *form, *numbers])
    return text_columns(rows)


def _classes(curve, change):
    bounds = 1e3 * curve.bounds
    return [
        [f"{low:g} to {high:g}", f"{100 * share:.1f}", "-" if np.isnan(value) else f"{value:+.4f}"]
        for low, high, share, value in zip(bounds[:-1], bounds[1:], curve.mass_fractions, change, strict=True)
    ][::-1]


def _json(beds, tables, level, notices, fitted):
    """Return JSON text: an object, or a list with one for each sieve curve if the table of forms has the curves."""
    content = [_plain_bed(bed, table, fitted) for bed, table in zip(beds, tables, strict=True)]
    model, correction = sized_model(fitted), fitted.curve
    shared = {
        "level": level,
        "model": {"candidate": model.candidate, "parameters": model.parameters, "behind": model.behind},
        "correction": {"kind": correction.kind, "coefficients": correction.coefficients, "behind": correction.behind}
        if correction
        else None,
        "one_class_fit": own_one_class(fitted) or None,
        "notices": list(notices),
    }
    content = [{"curve": bed["curve"], **shared, "samples": bed["samples"]} for bed in content]
    return json.dumps(content[0] if beds[0].places is None else content, indent=1, allow_nan=False)


def _plain_bed(bed, table, fitted):
    """Return the curve of BedForms and the table of its samples as plain values."""
    samples, curve = [], bed.curve
    for index, row in enumerate(table.to_dict("records")):
        sample = {key: plain(value) for key, value in row.items()}
        if not row["refused"]:
            of_classes = bed.one_class(index, row["n_one_class"], fitted)
            sample["other_models"] = other_predictors(curve, row["n_one_class"]).to_dict("records")
            sample["sensitivity"] = [plain(value) for value in _sensitivity(curve, of_classes, fitted)]
        samples.append(sample)
    bounds, fractions = list(1e3 * curve.bounds), list(curve.mass_fractions)
    return {"curve": {"name": curve.name, "bounds_mm": bounds, "mass_fractions": fractions}, "samples": samples}
