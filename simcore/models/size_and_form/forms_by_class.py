"""Porosity of beds whose grains have another form in each sieve class."""

import numpy as np
import pandas as pd

from simcore.grains.forms_by_class import BY_CLASS, sample_of_class
from simcore.models.few_grains import few_grains_half
from simcore.models.packing_models.classes import porosity_of_volume, specific_volume
from simcore.models.prediction import ONE_CLASS, predict_preferred
from simcore.models.size_and_form.bed_prediction import (
    COLUMNS,
    bed_row,
    divided,
    error_parts,
    interval,
    one_class_models,
    rhine_one_class,
    sized_model,
    without_states,
)
from simcore.models.size_and_form.one_class import LARGEST, LEAST
from simcore.models.size_and_form.sized_model import SizedModel


def predict_by_class(
    curve, classes, fitted, level=0.95, model: SizedModel | None = None, name=BY_CLASS
) -> pd.DataFrame:
    """Return one row with the columns of predict_curve: the porosity of a bed with this SieveCurve.

    classes: as from simcore.grains.forms_by_class.read_classes; each class of the curve that has mass must lie within
    one of them. The errors of the one-class porosities of the classes are taken as equal in sign, because one model
    gives them. Their errors from few measured grains are independent, but the interval adds them with equal sign and is
    too wide by that. Form statistics of the row are by mass; n_one_class is the porosity that the classes would give if
    they did not interact. ValueError if a class has no forms; a form that is too far outside the fitted range is a
    refusal, as in predict_curve. name: of the sample.
    """
    correction = fitted.curve if model is None else None
    model, fitted = model or sized_model(fitted), one_class_models(fitted)
    held = np.flatnonzero(curve.mass_fractions > 0)
    samples = [sample_of_class(curve, index, classes) for index in held]
    rows = [predict_preferred(sample, ONE_CLASS, fitted, level) for sample in samples]
    shares = curve.mass_fractions[held]
    refused = "; ".join(
        dict.fromkeys(f"{s.name}: {row['refused']}" for s, row in zip(samples, rows, strict=True) if row["refused"])
    )
    outside = "; ".join(
        dict.fromkeys(f"{s.name}: {row['outside']}" for s, row in zip(samples, rows, strict=True) if row["outside"])
    )
    form = [name, sum(sample.grains for sample in dict.fromkeys(samples)), *_moments(samples, shares)]
    if refused:
        return pd.DataFrame([bed_row(form, np.full(4, np.nan), np.nan, np.nan, outside, refused)], columns=COLUMNS)
    n1 = np.array([[row[key] for row in rows] for key in ("n", "lower", "upper")])
    if n1[0].min() < LEAST or n1[0].max() > LARGEST:
        refused = f"the one-class porosity of a class is outside {LEAST:g} to {LARGEST:g}"
        return pd.DataFrame([bed_row(form, np.full(4, np.nan), np.nan, np.nan, outside, refused)], columns=COLUMNS)
    mean = porosity_of_volume(specific_volume(n1) @ shares)
    errors, weights = (
        np.array([row["few_grains_error"] for row in rows]),
        shares * ((1.0 - mean[0]) / (1.0 - n1[0])) ** 2,
    )
    of_rhine = rhine_one_class(fitted, level)
    # Classes without mass get the value of the first one; it has no effect.
    values = np.repeat(n1[:, :1], len(curve.mass_fractions), axis=1)
    values[:, held] = n1
    values = np.clip(values, LEAST, LARGEST)
    n, low, high = model.predict(curve, values, reference=of_rhine)
    half = interval(curve, np.array([[n, low, high]]).T, mean[:1], of_rhine, model, level)[0]
    if correction is not None:
        parts = error_parts(curve, np.array([n]), mean[:1], of_rhine, model)
        few = _of_samples(samples, few_grains_half(samples, errors, level) * weights)
        of_model, of_few = divided(0.5 * (high - low), mean, few)
        of_model = of_model * correction.unlike(samples).max()
        (n,), (half,) = correction.apply([n], *parts, of_model, of_few, level)
    mean = np.append(mean, _of_samples(samples, errors * weights))
    table = pd.DataFrame([bed_row(form, mean, n, half, outside, "", curve, model)], columns=COLUMNS)
    return table if correction is None else without_states(table)


def _of_samples(samples, errors):
    """Return the root of the sum of squares of the errors (n,) of different samples; those of one sample are added."""
    by_sample = [sum(e for s, e in zip(samples, errors, strict=True) if s is own) for own in dict.fromkeys(samples)]
    return float(np.linalg.norm(by_sample))


def _moments(samples, shares):
    """Return mean and standard deviation of FL and of EL over the classes, by mass."""
    moments = []
    for name in ("FL", "EL"):
        mu = np.array([getattr(sample, f"mu_{name}") for sample in samples])
        sigma = np.array([getattr(sample, f"sigma_{name}") for sample in samples])
        mean = shares @ mu
        moments += [mean, np.sqrt(shares @ (sigma**2 + (mu - mean) ** 2))]
    return moments
