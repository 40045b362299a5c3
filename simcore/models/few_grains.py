"""The error of a prediction because only some of the grains of a gravel were measured."""

import numpy as np

from simcore.evaluation.confidence import student_quantile
from simcore.grains.measured_forms import FEWEST_FOR_ERRORS
from simcore.grains.statistics import STATISTICS, means_covariance
from simcore.models.unified import feature_table
from simcore.reference.r22_tables import rhine_statistics

RELATIVE_STEP = 1e-4  # of a statistic, for the derivatives of a model
ENOUGH_GRAINS = 15  # from which the measured grains alone give the error
MOST_FREEDOM = 60  # degrees of freedom; Student's t of more is at most 2 % smaller at 95 %, 5 % at 99.9 %


def few_grains_errors(model, samples):
    """Return the standard errors (n,) of the porosity of n Samples that follow from the limited number of grains.

    model: PorosityModel. To first order, with the covariance of each Sample. That of two to FEWEST_FOR_ERRORS - 1
    grains, which do not determine it, follows from the deviations of the Rhine's gravel. Below ENOUGH_GRAINS grains,
    which may by chance be more alike than their gravel, the 95 % interval is at least that by these deviations. The
    error is nan if the number of grains is unknown, and 0 for one form, unless this is the form of a single grain.
    """
    errors = errors_by_grains(model, samples)
    few = [i for i, sample in enumerate(samples) if sample.covariance and sample.grains < ENOUGH_GRAINS]
    if few:
        samples = [samples[i] for i in few]
        by_rhine = _propagate(model, samples, [_covariance_by_rhine(sample) for sample in samples])
        ratios = [student_quantile(0.95, MOST_FREEDOM) / student_quantile(0.95, _freedom(each)) for each in samples]
        errors[few] = np.maximum(errors[few], by_rhine * ratios)
    return errors


def errors_by_grains(model, samples):
    """Return the errors of few_grains_errors (n,) without their minimum: those that are expected, not safe ones."""
    return _propagate(model, samples, [_covariance(sample) for sample in samples])


def _propagate(model, samples, covariances):
    """Return the errors (n,) of few_grains_errors that follow from covariances, a list with None if one is unknown."""
    errors = np.array([0.0 if sample.one_form and sample.grains != 1 else np.nan for sample in samples])
    measured = [index for index, covariance in enumerate(covariances) if covariance is not None]
    if not measured:
        return errors
    values = np.array([[getattr(samples[index], name) for name in STATISTICS] for index in measured])
    changes = np.empty(values.shape)
    for column in range(len(STATISTICS)):
        ends = []
        for sign in (1.0, -1.0):
            moved = values.copy()
            moved[:, column] *= 1.0 + sign * RELATIVE_STEP
            ends.append(model.predict(feature_table(dict(zip(STATISTICS, moved.T, strict=True)))))
        with np.errstate(invalid="ignore"):  # 1/sigma may be infinite; the model is then refused
            changes[:, column] = (ends[0] - ends[1]) / (2 * RELATIVE_STEP)
    # If a statistic is 0, so is its change, or the model gives no porosity.
    slopes = np.divide(changes, values, out=np.zeros(values.shape), where=values > 0)
    covariance = np.array([covariances[index] for index in measured])
    errors[measured] = np.sqrt(np.einsum("ni,nij,nj->n", slopes, covariance, slopes))
    return errors


def few_grains_half(samples, errors, level):
    """Return the half widths (n,) of the intervals by these errors (n,), by Student's t; 0 where they are unknown.

    The degrees of freedom are one less than the grains, and MOST_FREEDOM if the deviations are those of the Rhine.
    """
    return np.array([student_quantile(level, _freedom(sample)) for sample in samples]) * np.nan_to_num(errors)


def _freedom(sample):
    return MOST_FREEDOM if _has_few(sample) else min(max(sample.grains - 1, 1), MOST_FREEDOM)


def _has_few(sample):
    """Return whether the grains of a Sample are too few to determine their deviations, but more than one."""
    return 1 < sample.grains < FEWEST_FOR_ERRORS and not sample.one_form


def _covariance(sample):
    """Return the covariance (4, 4) of the errors of the STATISTICS of a Sample, or None if it is unknown."""
    return _covariance_by_rhine(sample) if _has_few(sample) else sample.covariance


def _covariance_by_rhine(sample):
    """Return the covariance of a Sample whose grains differ as much as those of the Rhine's gravel."""
    rhine = rhine_statistics()
    return means_covariance(sample.mu_FL, rhine["sigma_FL"], sample.mu_EL, rhine["sigma_EL"], sample.grains)
