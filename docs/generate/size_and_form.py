"""Page of the checks of the model of size and form: its errors on beds of known porosity, from the committed tables."""

import numpy as np
import pandas as pd

from benchmarks.studies.size_and_form_validation import (
    KNOWN,
    OF_DISTRIBUTIONS,
    OURS,
    PACKED_FORMS,
    R22,
    SETS,
    SLOPES,
    rms_errors,
)
from benchmarks.studies.sorted_sands import TABLE as SANDS
from benchmarks.studies.sorted_sands import mean_ratios
from benchmarks.studies.sorted_sands import rms_errors as rms_of_sands
from docs.generate.markdown import table
from simcore.evaluation.confidence import student_quantile
from simcore.evaluation.rounding import with_decimals
from simcore.models.packing_models.literature import LITERATURE
from simcore.models.size_and_form.known_beds import MIXTURES, OF_MIXTURES, PACKED, PACKED_BY_R22, PUBLISHED
from simcore.models.size_and_form.sized_model import current_model, unfitted_model
from simcore.paths import REFERENCE
from simcore.reference.r22_tables import read_r22_table

SLOWER = (PACKED, PACKED_BY_R22)  # sets whose wide sieve curves are inserted more slowly than their U1
LONGER, OURS_S = 6, 1  # [s], shaking of the beds behind the published models of U7 and B50, and of most of our beds
RANGES = (0.0, 0.35, 0.40, 1.0)  # of the one-class porosity, by which the mixtures are grouped
_MODELS = {OURS: "this model"} | {name: name for name in LITERATURE}
_HEAD = """# Checks of the model of size and form

This page shows how well the model of [porosity from a sieve curve and measured
grains](../how_to/predict_from_a_sieve_curve.md) predicts beds whose porosity is known. It is for readers who want to
know how far a prediction can be trusted. All numbers follow from the committed tables
[`size_and_form_*.csv`](results.md#size_and_form_knowncsv) and [`sorted_sands.csv`](results.md#sorted_sandscsv).
"""
_SETS = """## Five sets of beds

In each set, the porosity of a bed of one sieve class, U1, is known. A model gets this porosity and the sieve curve, and
predicts the porosity of the bed. The table has the root mean square of predicted minus known porosity, and the number
of beds inside the stated 95 % interval of this model.
"""
_FIGURE = """![Predicted and known porosity of five sets of beds, and errors with intervals](../size_and_form.png)

*Left: a point on the line is predicted exactly. Right: a point beside its bar is outside the stated interval. The
intervals are those of beds whose porosity of U1 is known.*
"""
_DIFFERENCES = """## What else differs between these beds

Not all differences come from the model. In each set, U1 and the other beds differ in more than their sieve curve:
"""
_CAUSES = (
    ("measured gravels, and packings of them",
     "The cylinder is only 3.3 times as wide as the largest grains of U7 and of B30 to B70.",
     "The wall makes beds with many coarse grains looser."),
    ("packed by us and by Rettinger et al.",
     "Wide sieve curves are inserted more slowly than U1.",
     "They become denser, by up to 0.03 "
     "([rate of insertion](../explanation/wide_sieve_curves.md#rate-of-insertion))."),
    ("models of Rettinger et al.",
     "Their beds are in a box without walls, are inserted at different rates, and are shaken longer than most of ours.",
     "U7 is denser after 6 s of shaking than after 1 s; see below."),
    ("distributions of form",
     "Both formulas contain 1/σ, and reach forms far flatter and longer than the Rhine's.",
     "The porosity of U1 is up to 0.47, and that of the Rhine's gravel 0.35."),
)  # fmt: skip
_BLIND = """The measured gravels and our packings of them were known when the candidates were proposed, so they are no
blind test of the list of candidates. One of these was chosen, and its parameters were fitted, on other beds.
"""
_MIXTURES = """## Distributions of form in U7

Rettinger et al. published a formula for U1 (Eq. 23) and one for U7 (Eq. 24), with means and standard deviations of
form. Both were fitted to the same 52 distributions. Here the porosity by Eq. 23 is the one-class porosity, and the
prediction is compared with Eq. 24. The form statistics are those of our packings with these distributions. The slopes
of the next section describe how the error changes with the porosity of U1.
"""
_SLOPES = """## How much of the effect of form remains

If form changes the porosity of U1 by 0.01, it changes that of U7 and B50 by less in the models of Rettinger et al. The
slope is the change of the porosity of the wide curve over that of U1. It is that of a linear regression over 63 forms
of which each fills a bed (their Eqs. 17 to 19), and over the 52 distributions above.
"""
_SANDS = """## Sands of six sortings

Beard and Weyl (1973) measured wet-packed quartz sands of eight grain sizes and six sortings. They mixed them so that
mass is normally distributed about the median size; we take this for a normal distribution over the logarithm of size.
42 of the 48 porosities are used; the six of lower medium sand are wrong in the
[transcription](results.md#beard_weyl_1973csv) that was read. The grains have other forms than ours, and were packed in
another way. Therefore only the trend with sorting is compared: each model gets the porosity of the best sorted sand of
each grain size.
"""
_SANDS_FIGURE = """![Porosity over that of the best sorted sand, against sorting](../sorted_sands.png)

*A point above a line: the measured porosity decreases less with sorting than the model predicts. In the shaded part the
sieve curves are wider than all beds whose errors the model states.*

At which sizes the sands were cut is not known. They are cut here at two standard deviations on each side of the median,
so that the coarsest grains of the last two curves are 210 and 8000 times as large as the finest ones. `python -m
benchmarks.studies.sorted_sands` prints what other cuts change. Differences in the shaded part are therefore left open.
"""


def page():
    """Return the page of the checks."""
    known, mixtures, slopes, sands = (
        pd.read_csv(REFERENCE / name, keep_default_na=name != SANDS)
        for name in (KNOWN, OF_DISTRIBUTIONS, SLOPES, SANDS)
    )
    model = current_model()
    parts = [
        _HEAD,
        f"The model is candidate {model.candidate} of [the plan](../appendices/size_and_form_plan.md), "
        f"{_parameters(model)}: {model.behind}",
        _SETS,
        _errors(known, mixtures),
        _FIGURE,
        _beds(known),
        _DIFFERENCES,
        table(["beds", "difference", "what follows from it"], _CAUSES),
        _misses(known, mixtures),
        _longer_shaking(known),
        _BLIND,
        _MIXTURES,
        _ranges(mixtures),
        _SLOPES,
        _slope_rows(slopes),
        _judgement(slopes),
        _SANDS,
        _ratios(sands),
        _SANDS_FIGURE,
        _narrow_sands(sands, model),
    ]
    return "\n\n".join(part.strip("\n") for part in parts) + "\n"


def _parameters(model):
    """Return the parameters of a SizedModel in words, fitted ones with their 95 % intervals."""
    if model == unfitted_model():
        return "with " + ", ".join(f"{name} = {value:.3g}" for name, value in model.parameters.items())
    rows = pd.read_csv(REFERENCE / "models" / "size_and_form_parameters.csv").query("model == @model.candidate")
    values = [
        f"{row.parameter} = {row.value:.3f}"
        + ("" if np.isnan(row.lower_95) else f" ({row.lower_95:.3f} to {row.upper_95:.3f})")
        for row in rows.itertuples()
    ]
    return f"with {', '.join(values)}, in brackets 95 % intervals"


def _errors(known, mixtures):
    rms = rms_errors({KNOWN: known, OF_DISTRIBUTIONS: mixtures})
    inside = {name: _inside(mixtures if name == MIXTURES else known[known["set"] == name]) for name in SETS}
    rows = [
        [_label(name), *(f"{rms.loc[name, f'error_{model}']:.4f}" for model in _MODELS), f"{kept.sum()} of {len(kept)}"]
        for name, kept in inside.items()
    ]
    return table(["beds", *_MODELS.values(), "inside the interval"], rows)


def _beds(known):
    rows = [
        [_label(bed.set), bed.case, f"{bed.n_one_class:.3f}", f"{bed.n:.3f}", f"{bed.predicted:.3f}",
         _signed(bed.predicted - bed.n), f"{bed.half_width:.4f}", "yes" if kept else "no"]
        for bed, kept in zip(known.itertuples(), _inside(known), strict=True)
    ]  # fmt: skip
    heads = ["set", "curve", "U1", "known", "predicted", "error", "half width of the interval", "inside"]
    return table(heads, rows)


def _misses(known, mixtures):
    """Return sentences on the beds outside their interval, and on what is known about their errors."""
    outside = known[~_inside(known)]
    denser = outside["predicted"] > outside["n"]
    slower, longer = outside["set"].isin(SLOWER) & denser, outside["set"].eq(PUBLISHED) & denser
    sentences = []
    if slower.any():
        sentences.append(
            f"Outside their intervals and denser than predicted are {_named(outside[slower])}. Slower insertion "
            "than that of U1 explains the direction of these errors, but their size was not measured."
        )
    wrong = ~_inside(mixtures)
    if longer.any() or wrong.any():
        beds = [_named(outside[longer])] if longer.any() else []
        if wrong.any():
            errors = (mixtures["predicted"] - mixtures["n"])[wrong]
            beds.append(
                f"{wrong.sum()} of the {len(mixtures)} distributions of form in {OF_MIXTURES}, whose predicted minus "
                f"published porosity is {_signed(errors.mean(), 3)} on average"
            )
        sentences.append(
            f"Outside their intervals are {'; '.join(beds)}. Longer shaking may explain a part of these errors, as "
            "stated below; the reason for the rest is not known."
        )
    others = outside[~slower & ~longer]
    if len(others):
        sentences.append(f"Also outside their intervals are {_named(others)}; the reason is not known.")
    return " ".join(sentences) or "All beds are inside their stated intervals."


def _longer_shaking(known):
    """Return sentences on U7 at the mean form, corrected for the time of shaking."""
    bed = known[(known["set"] == PUBLISHED) & (known["case"] == OF_MIXTURES)].iloc[0]
    looser = shorter_shaking()
    left = bed.predicted - bed.n - looser
    return (
        f"For {OF_MIXTURES} at the mean form this model predicts {bed.predicted:.3f}. The model of Rettinger et al. "
        f"gives {bed.n:.3f} for beds that were shaken for {LONGER} s. In their Table 8, the porosity of {OF_MIXTURES} "
        f"is {looser:.3f} larger after {OURS_S} s than after {LONGER} s. With this correction, predicted minus "
        f"published porosity is {_signed(left, 3)}. The correction may be generous: {OF_MIXTURES} is predicted from "
        f"their beds of U1, which were shaken for {LONGER} s too, and their table has no U1."
    )


def shorter_shaking(case=OF_MIXTURES):
    """Return by how much a bed of Rettinger et al. in a periodic box is looser after OURS_S than after LONGER [s]."""
    rows = read_r22_table("table8_shaking_periodic").set_index(["case", "t_s"])["n"]
    return float(rows[case, OURS_S] - rows[case, LONGER])


def _named(beds):
    """Return the beds of each set in words."""
    groups = beds.groupby("set", sort=False)["case"].agg(", ".join)
    return "; ".join(f"{cases} ({_label(name)})" for name, cases in groups.items())


def _ranges(mixtures):
    rows = []
    errors = mixtures["predicted"] - mixtures["n"]
    for low, high in zip(RANGES[:-1], RANGES[1:], strict=True):
        own = mixtures["n_one_class"].between(low, high, inclusive="left")
        words = (
            f"below {high:.2f}" if low == 0.0 else f"{low:.2f} and more" if high == 1.0 else f"{low:.2f} to {high:.2f}"
        )
        rms = np.sqrt(np.mean(errors[own] ** 2))
        kept = _inside(mixtures[own])
        rows.append([words, own.sum(), _signed(errors[own].mean()), f"{rms:.4f}", f"{kept.sum()} of {len(kept)}"])
    return table(["porosity of U1", "distributions", "mean error", "root mean square", "inside the interval"], rows)


def _slope_rows(slopes):
    rows = [
        [_MODELS.get(row.model, row.model), _with_error(row.slope_U7, row.slope_U7_std_error),
         _with_error(row.slope_B50, row.slope_B50_std_error),
         "" if np.isnan(row.slope_mixtures) else f"{row.slope_mixtures:.2f}"]
        for row in slopes.itertuples() if row.model in (R22, PACKED_FORMS, *_MODELS)
    ]  # fmt: skip
    return table(["model", "U7, 63 forms", "B50, 63 forms", "U7, 52 distributions"], rows)


def _judgement(slopes):
    """Return sentences on the slopes of the model of size and form beside the published ones."""
    ours, theirs = (slopes.set_index("model").loc[name] for name in (OURS, R22))
    sentences = [
        "± is a standard error. That of the published slopes follows from the rounding of their coefficients to three "
        "decimals, that of this model from the covariance of its fitted parameters, that of packings of one form from "
        "their scatter about the line. Models without ± have no fitted parameter."
    ]
    for case in ("U7", "B50"):
        name = f"slope_{case}"
        error = np.hypot(theirs[f"{name}_std_error"], np.nan_to_num(ours[f"{name}_std_error"]))
        difference = ours[name] - theirs[name]
        verdict = "agree" if abs(difference) <= 2.0 * error else "do not agree"
        sentences.append(
            f"For {case} the slope of this model minus the published one is {_signed(difference, 2)} ± {error:.2f}: "
            f"they {verdict} within two standard errors."
        )
    return " ".join(sentences)


def _ratios(sands):
    means = mean_ratios(sands)
    rows = [
        [name, f"{row.log_deviation:.2f}", f"{row.measured:.3f} ± {row.spread:.3f}",
         *("refused" if np.isnan(row[model]) else f"{row[model]:.3f}" for model in _MODELS)]
        for name, row in means.iterrows()
    ]  # fmt: skip
    rms = rms_of_sands(sands)
    rows.append(["rms of porosity", "", "", *(f"{rms[model]:.4f}" for model in _MODELS)])
    heads = ["sorted", "standard deviation of ln D", "measured ± its spread over grain sizes", *_MODELS.values()]
    words = (
        "The table has the porosity relative to that of the best sorted sand, as mean over the grain sizes. Its last "
        "row is the root mean square of predicted minus measured porosity of the 35 sands that are not the best sorted."
    )
    return f"{words}\n\n{table(heads, rows)}"


def _narrow_sands(sands, model):
    """Return sentences on the sands whose curves are not wider than the beds behind the model."""
    best = sands.groupby("grain_size")["log_deviation"].transform("idxmin")
    one_class = sands["n"].to_numpy()[best]  # the best sorted sands are narrower than one sieve class
    narrow = (sands["outside"] != "yes") & (sands["log_deviation"] > sands["log_deviation"].min())
    errors = (sands[f"predicted_{OURS}"] - sands["n"])[narrow]
    half = student_quantile(0.95, model.freedom) * model.error * (one_class - sands[f"predicted_{OURS}"])[narrow]
    rms = {
        name: np.sqrt(np.mean((sands[f"predicted_{key}"] - sands["n"])[narrow] ** 2)) for key, name in _MODELS.items()
    }
    words = "; ".join(f"{name} {value:.4f}" for name, value in rms.items())
    return (
        f"In the part that is not shaded, {(errors.abs() > half).sum()} of the {narrow.sum()} sands are outside the "
        "95 % interval of the step from one class to the curve. Predicted minus measured porosity is "
        f"{_signed(errors.mean(), 3)} on average; its root mean square by model is: {words}. The errors of the "
        "measured values are not known, and the reason for these differences is not known either."
    )


def _inside(beds):
    return (beds["predicted"] - beds["n"]).abs() <= beds["half_width"]


def _label(name):
    return SETS[name][0]


def _with_error(value, error):
    return f"{value:.2f}" + ("" if np.isnan(error) else f" ± {error:.2f}")


def _signed(value, digits=4):
    return with_decimals(value, digits, "+")
