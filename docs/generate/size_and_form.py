"""Page of the checks of the model of size and form: its errors on beds of known porosity, from the committed tables."""

import numpy as np
import pandas as pd

from benchmarks.studies.size_and_form_validation import (
    KNOWN,
    OF_DISTRIBUTIONS,
    OURS,
    R22,
    SETS,
    SLOPES,
    rms_errors,
)
from benchmarks.studies.sorted_sands import TABLE as SANDS
from benchmarks.studies.sorted_sands import mean_ratios
from benchmarks.studies.sorted_sands import rms_errors as rms_of_sands
from docs.generate.markdown import table
from simcore.models.packing_models.literature import LITERATURE
from simcore.models.size_and_form.known_beds import MIXTURES, PACKED, PACKED_BY_R22
from simcore.models.size_and_form.sized_model import current_model, unfitted_model
from simcore.paths import REFERENCE

SLOWER = (PACKED, PACKED_BY_R22)  # sets whose wide sieve curves are inserted more slowly than their U1
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
     "U7 is 0.009 denser after 6 s of shaking than after 1 s (their Table 8)."),
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
prediction is compared with Eq. 24. The form statistics are those of our packings with these distributions. How the
error grows with the porosity of U1 follows from the slopes in the next section.
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
so that the coarsest grains of the last two curves are 160 and 5000 times as large as the finest ones. `python -m
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
        _misses(known),
        _BLIND,
        _MIXTURES,
        _ranges(mixtures),
        _SLOPES,
        _slope_rows(slopes),
        _judgement(slopes),
        _SANDS,
        _ratios(sands),
        _SANDS_FIGURE,
    ]
    return "\n\n".join(part.strip("\n") for part in parts) + "\n"


def _parameters(model):
    """Return the parameters of a SizedModel in words, fitted ones with their 95 % intervals."""
    if model == unfitted_model():
        return "with " + ", ".join(f"{name} = {value:.3g}" for name, value in model.parameters.items())
    rows = pd.read_csv(REFERENCE / "models" / "size_and_form_parameters.csv").query("model == @model.candidate")
    values = [
        f"{row.parameter} = {row.value:.3f}" + ("" if np.isnan(row.lower) else f" ({row.lower:.3f} to {row.upper:.3f})")
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


def _misses(known):
    """Return sentences on the beds outside their interval: those whose error has a known direction, and the others."""
    outside = known[~_inside(known)]
    explained = outside["set"].isin(SLOWER) & (outside["predicted"] > outside["n"])
    if outside.empty:
        return "All beds are inside their stated intervals."
    sentences = []
    if explained.any():
        sentences.append(
            f"Outside their intervals and denser than predicted are {_named(outside[explained])}. Slower insertion "
            "than that of U1 explains the direction of these errors, but their size was not measured."
        )
    if not explained.all():
        sentences.append(
            f"Also outside are {_named(outside[~explained])}; the reason is not known."
            if explained.any()
            else f"Outside their intervals are {_named(outside)}; the reason is not known."
        )
    return " ".join(sentences)


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
         _with_error(row.slope_B50, row.slope_B50_std_error), f"{row.slope_mixtures:.2f}"]
        for row in slopes.itertuples() if row.model in (R22, *_MODELS)
    ]  # fmt: skip
    return table(["model", "U7, 63 forms", "B50, 63 forms", "U7, 52 distributions"], rows)


def _judgement(slopes):
    """Return sentences on the slopes of the model of size and form beside the published ones."""
    ours, theirs = (slopes.set_index("model").loc[name] for name in (OURS, R22))
    sentences = [
        "± is a standard error. That of the published slopes follows from the rounding of their coefficients to three "
        "decimals, that of this model from those of its fitted parameters, without their correlations. Models without "
        "± have no fitted parameter."
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


def _inside(beds):
    return (beds["predicted"] - beds["n"]).abs() <= beds["half_width"]


def _label(name):
    return SETS[name][0]


def _with_error(value, error):
    return f"{value:.2f}" + ("" if np.isnan(error) else f" ± {error:.2f}")


def _signed(value, digits=4):
    return f"{value:+.{digits}f}".replace("-", "−")
