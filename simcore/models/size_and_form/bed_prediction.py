"""Predict the porosity of beds from a sieve curve and the forms of the grains, without packing them."""

from functools import cache
from itertools import chain
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from simcore.evaluation.confidence import student_quantile
from simcore.grains.measured_forms import Sample
from simcore.grains.sieve import SieveCurve
from simcore.grains.statistics import equancy_statistics
from simcore.models.few_grains import few_grains_half
from simcore.models.measured_file import MEASURED
from simcore.models.packing_models.curves import gap, passing, span
from simcore.models.packing_models.empirical import PREDICTORS
from simcore.models.packing_models.literature import LITERATURE
from simcore.models.prediction import ONE_CLASS, model_case, predict_all_preferred, predict_preferred
from simcore.models.size_and_form.one_class import LARGEST, LEAST
from simcore.models.size_and_form.sized_model import SizedModel, current_model
from simcore.paths import REFERENCE
from simcore.reference.r22_tables import read_r22_table, rhine_statistics

COLUMNS = [
    "sample", "grains", "mu_FL", "sigma_FL", "mu_EL", "sigma_EL",
    "n", "lower", "upper", "n_long_shaken", "n_not_shaken", "n_one_class", "one_class_lower",
    "one_class_upper", "one_class_few_grains_error", "outside", "refused",
]  # fmt: skip
ONE_CLASS_NUMBERS = ("n", "lower", "upper", "few_grains_error")  # of the row of the model of one class
ABOVE = 1.0 + 1e-9  # ratio to a limit, from which a value is above it
STICKY = 2e-3  # [m], sieve size below which clean grains may stick together, which the packings do not contain
STICKY_SHARE = 0.01  # of the mass finer than STICKY, above which a remark is made
TOO_WIDE = 2.0  # `span` over the widest of known error, above which predictions were 0.1 too low (sorted sands, docs)
TOO_LOW = ", and the porosity is probably too low by more than the interval"
WIDE_CLASS, WIDE_SHARE = 2.1, 0.05  # ratio of the bounds of a wide class, and share of the mass there that is remarked
SHAKEN = 1.0  # [s], of the beds to which the model is fitted
MORE_MASS = 0.01  # of one class, for the sensitivity to the curve
UNKNOWN_FORMS = "the Rhine's gravel"


@cache
def rhine_sample() -> Sample:
    """Return the form statistics of the Rhine's grains in Table 2 of Rettinger et al. (2022)."""
    row = rhine_statistics()
    form = [float(row[name]) for name in ("mu_FL", "sigma_FL", "mu_EL", "sigma_EL")]
    return Sample(UNKNOWN_FORMS, 0, *form, *map(float, equancy_statistics(*form)))


def sized_model(fitted) -> SizedModel:
    """Return the model of size and form of FittedModels: that of the file of `fit`, or the current one."""
    return fitted.curve.sized if fitted.curve else current_model()


def predict_curve(curve, samples, fitted, level=0.95, model: SizedModel | None = None) -> pd.DataFrame:
    """Return one row per sample with COLUMNS: the porosity of a bed with this SieveCurve.

    samples: list of simcore.grains.measured_forms.Sample. fitted: FittedModels with models of beds of one class. level:
    probability of the interval. model: SizedModel; None: that of `fitted` with its correction to measured beds, or the
    current one. n, lower, upper: porosity of a bed that is shaken for about a second, and its prediction interval;
    n_long_shaken, n_not_shaken: range of its state of packing (`states`); n_one_class and its interval: of a bed of one
    sieve class of these grains;
    one_class_few_grains_error: its standard error that follows from the limited number of measured grains, which both
    intervals contain, nan if it is unknown. outside: what lies outside the fitted ranges. If there is no
    prediction, the numbers are nan and `refused` gives the reason.

    The interval adds three independent errors: of the one-class porosity with that of few grains, of the step from one
    class to the curve, which is proportional to the decrease of porosity, and of how much of the effect of form the
    step carries over. With a correction, the interval is that of CurveCorrection. With models of measured beds the
    range of the state is nan, because the state of the packing is that of these beds.
    """
    correction = fitted.curve if model is None else None
    model, fitted = model or sized_model(fitted), one_class_models(fitted)
    *rows, of_rhine = predict_all_preferred([*samples, rhine_sample()], ONE_CLASS, fitted, level)
    _require_rhine(of_rhine)
    of_class = np.array([row[key] for row in rows for key in ONE_CLASS_NUMBERS], float).reshape(len(rows), -1)
    n1 = of_class[:, :3]
    usable = np.isfinite(n1[:, 0]) & (n1[:, 0] >= LEAST) & (n1[:, 0] <= LARGEST)
    n, half = np.full((2, len(samples)), np.nan)
    if usable.any():
        one_class = np.append(np.clip(n1[usable], LEAST, LARGEST).ravel(), of_rhine["n"])
        *ends, rhine_bed = model.predict(curve, one_class[:, None], reference=of_rhine["n"])
        ends = np.reshape(ends, (-1, 3)).T
        n[usable] = ends[0]
        half[usable] = interval(curve, ends, n1[usable, 0], of_rhine["n"], model, level, rhine_bed)
        if correction is not None:
            parts = error_parts(curve, ends[0], n1[usable, 0], of_rhine["n"], model, rhine_bed)
            predicted = [sample for sample, used in zip(samples, usable, strict=True) if used]
            few = few_grains_half(predicted, of_class[usable, 3], level)
            of_model, of_few = divided(0.5 * (ends[2] - ends[1]), n1[usable].T, few)
            of_model = of_model * correction.unlike(predicted)
            n[usable], half[usable] = correction.apply(ends[0], *parts, of_model, of_few, level)
    table = []
    for i, (sample, row) in enumerate(zip(samples, rows, strict=True)):
        refused = "" if usable[i] else row["refused"] or f"its one-class porosity is outside {LEAST:g} to {LARGEST:g}"
        form = [sample.name, sample.grains, sample.mu_FL, sample.sigma_FL, sample.mu_EL, sample.sigma_EL]
        table.append(bed_row(form, of_class[i], n[i], half[i], row["outside"], refused, curve, model))
    table = pd.DataFrame(table, columns=COLUMNS)
    return without_states(table) if correction is not None or own_one_class(fitted) else table


def rhine_one_class(fitted, level=0.95) -> float:
    """Return the one-class porosity of the Rhine's grains by FittedModels, with which the stretch by form compares."""
    return _require_rhine(predict_preferred(rhine_sample(), ONE_CLASS, one_class_models(fitted), level))["n"]


def _require_rhine(row):
    """Return the row of the Rhine's grains; ValueError if it has no porosity."""
    if not np.isfinite(row["n"]):
        raise ValueError(
            "predictions from sieve curves compare with the one-class porosity of the Rhine's gravel, which these "
            f"models do not give: {row['refused']}; fit a model to beds whose forms, with their distributions, include "
            "those of the Rhine's gravel, or leave out --models to use the committed ones"
        )
    return row


def own_one_class(fitted) -> str:
    """Return what is behind the one-class porosity if `fit` gave it without curves: a text, else an empty one."""
    return "" if fitted.curve else fitted.behind.get((MEASURED, model_case(ONE_CLASS)), "")


def one_class_models(fitted):
    """Return the FittedModels that give the one-class porosity: those of the correction, if there is one."""
    return fitted.curve.one_class if fitted.curve else fitted


def interval(curve, ends, one_class, of_rhine, model, level, rhine_bed=None):
    """Return the half width (s,) of the prediction interval of s beds.

    ends (3, s): porosity of the beds, and at the lower and the upper end of their one-class porosity. one_class (s,):
    that porosity. of_rhine: that of the Rhine's grains, with which the step from one class to a curve was measured.
    rhine_bed: porosity of a bed of them with this curve, if it is known.
    """
    n, low, high = ends
    of_sizes, of_form = error_parts(curve, n, one_class, of_rhine, model, rhine_bed)
    of_sizes = student_quantile(level, model.freedom) * of_sizes
    return np.sqrt((0.5 * (high - low)) ** 2 + of_sizes**2 + of_form**2)


def error_parts(curve, n, one_class, of_rhine, model, rhine_bed=None):
    """Return two errors (s,) of the porosities n (s,) of beds: of the step to the curve, and of the effect of form.

    The first is a standard error, which grows beyond the widest curve of known error, the second the largest one. Other
    arguments: as for `interval`.
    """
    rhine_bed = model.predict(curve, of_rhine, reference=of_rhine) if rhine_bed is None else rhine_bed
    decrease = 1.0 - rhine_bed / of_rhine
    return model.error * wider(curve, model) * (one_class - n), model.form_error * decrease * (one_class - of_rhine)


def divided(half, one_class, few):
    """Return two half widths (s,) of the interval of a bed: by the model of one class, and by the few measured grains.

    half (s,): both together. one_class (3, s): one-class porosity and its interval. few (s,): half width of this
    interval by the few grains alone.
    """
    share = np.minimum(few / (0.5 * (one_class[2] - one_class[1])), 1.0)
    return half * np.sqrt(1.0 - share**2), half * share


def wider(curve, model) -> float:
    """Return the factor of the error of a SieveCurve that is wider, or has a wider gap, than those of known error.

    It is the larger ratio of the logarithms of their `span` and `gap`, and 1 for all other curves.
    """
    return max(1.0, float(np.log(span(curve)) / np.log(model.widest)), float(np.log(gap(curve)) / np.log(model.gap)))


def bed_row(form, one_class, n, half, outside, refused, curve=None, model=None):
    """Return the values of COLUMNS of one bed.

    form: the first six of them. one_class (4,): one-class porosity, its interval and its error of few grains. half:
    half width of the interval of n. outside, refused: of the forms; what lies outside in the SieveCurve is added.
    """
    beyond = [] if curve is None else [*_outside_of_curve(curve, model), *_outside_of_forms(one_class[0], model)]
    if np.isfinite(n) and not 0.0 < n - half < n + half < 1.0:
        refused, n = _beyond_porosities(curve, model), np.nan
    numbers = [n, n - half, n + half, *(n + change for change in states()), *one_class]
    return [*form, *numbers, "; ".join(filter(None, [outside, *beyond])), refused]


def _beyond_porosities(curve, model):
    """Return why a bed has no porosity if its interval reaches outside (0, 1)."""
    causes = [] if curve is None else _outside_of_curve(curve, model)
    first = [text.partition(TOO_LOW)[0] for text in causes[:1]]
    return ": ".join(["its prediction interval reaches outside (0, 1)", *first])


def _outside_of_curve(curve, model):
    """Return remarks on what lies outside the SieveCurves of known error."""
    texts = []
    if (ratio := span(curve)) > model.widest * ABOVE:
        too_wide = ratio > TOO_WIDE * model.widest
        low = TOO_LOW if too_wide else ""
        texts.append(
            f"98 % of the mass spans {ratio:.3g} : 1 in size, errors are known up to {model.widest:.3g} : 1{low}"
        )
    if (share := in_wide_classes(curve)) > WIDE_SHARE:
        texts.append(
            f"{100 * share:.0f} % of the mass is in sieve classes wider than {WIDE_CLASS:g} : 1, whose sizes are "
            "assumed to be uniform in log size; give more sieves"
        )
    if (ratio := gap(curve)) > model.gap * ABOVE:
        texts.append(f"the curve has a gap of {ratio:.3g} : 1 in size, errors are known up to {model.gap:.3g} : 1")
    if (share := passing(curve, STICKY)) > STICKY_SHARE:
        texts.append(
            f"{100 * share:.0f} % of the mass is finer than {1e3 * STICKY:g} mm, where grains may stick together"
        )
    return texts


def in_wide_classes(curve) -> float:
    """Return the share of the mass in classes of a SieveCurve that are wider than WIDE_CLASS."""
    return float(curve.mass_fractions[curve.bounds[1:] / curve.bounds[:-1] > WIDE_CLASS * ABOVE].sum())


def _outside_of_forms(one_class, model):
    """Return remarks on a one-class porosity outside those of beds of known error."""
    least, largest = model.one_class
    if not (one_class < least / ABOVE or one_class > largest * ABOVE):
        return []
    return [f"the one-class porosity is {one_class:.3f}, errors are known from {least:.3f} to {largest:.3f}"]


class States(NamedTuple):
    """Changes of porosity by the state of packing, from that of a bed that is shaken for a second."""

    long_shaken: float
    not_shaken: float


@cache
def states(folder=REFERENCE) -> States:
    """Return the largest changes of porosity by the state of packing over the sieve curves U7 and B50.

    not_shaken: the porosity after 0 s of shaking less that after 1 s, of beds in shaking_cylinder.csv that have both.
    long_shaken: that after the longest time, 8 s, less that after 1 s, in Table 8 of Rettinger et al. (2022).
    """
    rows = pd.read_csv(Path(folder) / "shaking_cylinder.csv").assign(t_s=lambda rows: rows["shaking_s"])
    beds = [bed for _, bed in rows.groupby(["case", "seed"]) if {0.0, SHAKEN} <= set(bed["t_s"])]
    placed = [by_time(bed, 0.0) - by_time(bed, SHAKEN) for bed in beds]
    published = read_r22_table("table8_shaking_periodic").groupby("case")
    longest = [by_time(bed, bed["t_s"].max()) - by_time(bed, SHAKEN) for _, bed in published]
    return States(min(longest), max(placed))


def by_time(bed, t) -> float:
    """Return the porosity in the row of a bed that was shaken for t seconds."""
    return float(bed.loc[bed["t_s"] == t, "n"].item())


def without_states(table):
    """Return the table of predict_curve without the range of the state of packing."""
    return table.assign(n_long_shaken=np.nan, n_not_shaken=np.nan)


def sensitivity(curve, one_class, fitted) -> np.ndarray:
    """Return the change of porosity (k,) if the mass of one class of the SieveCurve grows by 1 % of the whole.

    The masses of the other classes stay, so that all shares are divided by 1.01. one_class: one-class porosity, a
    number, or (k,) by class; for a class where it is nan, which has no mass, the change is nan. fitted: FittedModels,
    as for predict_curve.
    """
    model, reference = sized_model(fitted), rhine_one_class(fitted)
    of_classes = np.broadcast_to(np.asarray(one_class, float), curve.mass_fractions.shape)
    known = np.isfinite(of_classes)
    of_classes = np.where(known, of_classes, of_classes[known][0])  # without mass it has no effect
    base = model.predict(curve, of_classes, reference=reference)
    changed = np.full(len(curve.mass_fractions), np.nan)
    for index in np.flatnonzero(known):
        fractions = curve.mass_fractions.copy()
        fractions[index] += MORE_MASS
        more = SieveCurve(curve.bounds, fractions / fractions.sum(), curve.name, curve.numbers_by)
        changed[index] = model.predict(more, of_classes, reference=reference) - base
    return changed


def other_predictors(curve, one_class) -> pd.DataFrame:
    """Return the porosity by models of others: columns model, given ("curve" or with the one-class porosity) and n."""
    from_curve = ((predictor.name, "curve", predictor.porosity(curve)) for predictor in PREDICTORS)
    packing = (
        (f"packing model: {name}", "curve and one-class porosity", porosity(curve, float(one_class)))
        for name, porosity in LITERATURE.items()
    )
    return pd.DataFrame(chain(packing, from_curve), columns=["model", "given", "n"])
