"""Porosity of beds whose grains have another form in each sieve class."""

import numpy as np
import pandas as pd

from simcore.grains.forms_by_class import BY_CLASS, has_class, sample_of_class
from simcore.models.few_grains import few_grains_half
from simcore.models.packing_models.classes import porosity_of_volume, specific_volume
from simcore.models.prediction import ONE_CLASS, predict_preferred
from simcore.models.size_and_form.bed_prediction import (
    COLUMNS,
    ONE_CLASS_NUMBERS,
    bed_row,
    error_parts,
    interval,
    one_class_models,
    own_one_class,
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

    classes: as from simcore.grains.forms_by_class.classes_of_table; each class of the curve that has mass must lie
    within one of them. The errors of the one-class porosities of the classes are taken as equal in sign, because one
    model gives them; their errors from few measured grains are independent. Form statistics of the row are by mass;
    n_one_class is the porosity that the classes would give if they did not interact. ValueError if a class has no
    forms; a form that is too far outside the fitted range is a refusal, as in predict_curve. name: of the sample.
    """
    correction = fitted.curve if model is None else None
    model, fitted = model or sized_model(fitted), one_class_models(fitted)
    with_mass = np.flatnonzero(curve.mass_fractions > 0)
    samples = [sample_of_class(curve, index, classes) for index in with_mass]
    rows = [predict_preferred(sample, ONE_CLASS, fitted, level) for sample in samples]
    shares = curve.mass_fractions[with_mass]
    refused = "; ".join(
        dict.fromkeys(f"{s.name}: {row['refused']}" for s, row in zip(samples, rows, strict=True) if row["refused"])
    )
    outside = "; ".join(
        dict.fromkeys(f"{s.name}: {row['outside']}" for s, row in zip(samples, rows, strict=True) if row["outside"])
    )
    form = [name, sum(sample.grains for sample in dict.fromkeys(samples)), *_moments(samples, shares)]
    if refused:
        return pd.DataFrame([bed_row(form, np.full(4, np.nan), np.nan, np.nan, outside, refused)], columns=COLUMNS)
    n1, lower, upper, errors = np.array([[row[key] for row in rows] for key in ONE_CLASS_NUMBERS])
    if n1.min() < LEAST or n1.max() > LARGEST:
        refused = f"the one-class porosity of a class is outside {LEAST:g} to {LARGEST:g}"
        return pd.DataFrame([bed_row(form, np.full(4, np.nan), np.nan, np.nan, outside, refused)], columns=COLUMNS)
    few = few_grains_half(samples, errors, level)
    of_model = np.sqrt(np.maximum((0.5 * (upper - lower)) ** 2 - few**2, 0.0))
    of_rhine = rhine_one_class(fitted, level)

    def bed(values):
        # Classes without mass get the value of the first one; it has no effect.
        of_all = np.repeat(values[:, :1], len(curve.mass_fractions), axis=1)
        of_all[:, with_mass] = values
        return model.predict(curve, np.clip(of_all, LEAST, LARGEST), reference=of_rhine)

    def mixture(values):
        return porosity_of_volume(specific_volume(values) @ shares)

    one_class, *halves = _with_halves(mixture, samples, n1, of_model, few)
    one_class_half = np.hypot(*halves)
    n, of_model, few = _with_halves(bed, samples, n1, of_model, few)
    both = np.hypot(of_model, few)
    half = interval(curve, np.array([[n, n - both, n + both]]).T, np.array([one_class]), of_rhine, model, level)[0]
    if correction is not None:
        parts = error_parts(curve, np.array([n]), np.array([one_class]), of_rhine, model)
        of_model = of_model * correction.unlike(samples).max()
        (n,), (half,) = correction.apply([n], *parts, of_model, few, level)
    few_grains_error = _with_halves(mixture, samples, n1, np.zeros(len(n1)), errors)[2]
    one_class = [one_class, one_class - one_class_half, one_class + one_class_half, few_grains_error]
    table = pd.DataFrame([bed_row(form, one_class, n, half, outside, "", curve, model)], columns=COLUMNS)
    return without_states(table) if correction is not None or own_one_class(fitted) else table


def one_class_by_class(curve, classes, fitted) -> np.ndarray:
    """Return the one-class porosity (k,) of the grains of each class of the SieveCurve.

    Arguments: as for predict_by_class. It is nan for a class without forms, which has no mass, or without a prediction.
    """
    porosities = np.full(len(curve.mass_fractions), np.nan)
    for index, share in enumerate(curve.mass_fractions):
        if share > 0 or has_class(curve, index, classes):
            sample = sample_of_class(curve, index, classes)
            porosities[index] = predict_preferred(sample, ONE_CLASS, one_class_models(fitted))["n"]
    return porosities


def _with_halves(porosity, samples, n1, of_model, few):
    """Return a porosity and two half widths of its interval: by the model of one class, and by the few grains.

    porosity: function of one-class porosities by class (m, k), which returns (m,). samples: of the k classes. n1 (k,):
    the one-class porosities. of_model, few (k,): half widths of their intervals by the model, which are equal in sign,
    and by the few grains, which are independent for different samples.
    """
    by_sample = [few * [other is own for other in samples] for own in dict.fromkeys(samples)]
    changes = np.array([np.zeros(len(n1)), of_model, *by_sample])
    above, below = porosity(n1 + changes), porosity(n1 - changes)
    halves = 0.5 * (above - below)
    return above[0], halves[1], np.linalg.norm(halves[2:])


def _moments(samples, shares):
    """Return mean and standard deviation of FL and of EL over the classes, by mass."""
    moments = []
    for name in ("FL", "EL"):
        mu = np.array([getattr(sample, f"mu_{name}") for sample in samples])
        sigma = np.array([getattr(sample, f"sigma_{name}") for sample in samples])
        mean = shares @ mu
        moments += [mean, np.sqrt(shares @ (sigma**2 + (mu - mean) ** 2))]
    return moments
