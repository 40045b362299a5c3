"""Predict the porosity of the measured grains of a table."""

import logging
from typing import NamedTuple

import pandas as pd

from simcore.grains.measured_forms import read_measured
from simcore.models.fitting import FittedModels, fit_reference_models, read_campaign_models
from simcore.models.prediction import predict_samples
from simcore.models.size_and_form.bed_forms import has_curves, join_tables, read_bed_forms, refuse_curves

log = logging.getLogger(__name__)


class MeasuredPrediction(NamedTuple):
    """Predictions of `predict_samples` for the samples of a table, the models, and notices on how it was read."""

    table: pd.DataFrame
    fitted: FittedModels
    notices: list[str]


def predict_measured(path, case, models=None, source=None, column=None, level=0.95) -> MeasuredPrediction:
    """Predict the porosity of each sample of the table of measured grains at `path`.

    case, level: as in predict_samples. models: folder results/models of a campaign, or a file that `fit` wrote; None:
    models fitted to the committed packings, only to those of grains from `source` if given. column: column with the
    names of the samples.
    ValueError if the table or an argument is wrong, or if no model can be evaluated for any sample.
    """
    check_level(level)
    samples, notices = read_measured(path, column)
    fitted = models_for_cases(models, source)
    return MeasuredPrediction(predict_samples(samples, case, fitted, level), fitted, notices)


def check_level(level) -> None:
    """Raise ValueError unless `level` can be the probability of an interval."""
    if not 0 < level < 1:
        raise ValueError(f"level {level:g}: give a number between 0 and 1, such as 0.95")


def models_for(models=None, source=None) -> FittedModels:
    """Return the models of a campaign's folder or of a file of `fit`, or those of the committed packings.

    source: only those of grains from this source. ValueError if both are given, or if there is no model.
    """
    if models is not None and source is not None:
        raise ValueError(
            "--source selects committed packings, but the models of --models are already fitted; give only one"
        )
    return fit_reference_models(source=source) if models is None else read_campaign_models(models)


def models_for_cases(models=None, source=None) -> FittedModels:
    """Return the models as `models_for`; ValueError if they are for beds with sieve curves only."""
    fitted = models_for(models, source)
    if fitted.curve is not None and not fitted.models:
        raise ValueError(
            f"{models}: this model was fitted to beds with sieve curves; give a sieve curve with --sieve CURVE.csv "
            "instead of --case"
        )
    return fitted


def predict(
    forms=None, case=None, *, curve=None, models=None, source=None, column=None, level=0.95, finest=None, coarsest=None
) -> pd.DataFrame:
    """Return the porosity of each sample of a table of measured grains.

    forms: path of a table with one row per grain, columns L, I, S or FL, EL, or one row per sample, columns mean_FL,
    std_FL, mean_EL, std_EL. Give either the case or the curve, or a column `sieve` with a curve for each sample. case:
    sieve curve "U1", "U7", ..., or "one-class" for any single sieve class; the result has one row per sample and model,
    with its name, n, lower and upper [1], `preferred` for the recommended one of our models, and the columns described
    at `predict_samples`. curve: path of a table with a sieve curve, name of a listed one, or a SieveCurve; the result
    has one row per sample, with the columns of simcore.models.size_and_form.bed_prediction.predict_curve, and without
    `forms` the form is the Rhine's. With a column `class` in `forms`, each sieve class of a sample has its own form.
    finest, coarsest [m]: sizes of the grains in the pan and on the coarsest sieve of a table. Further arguments and
    errors: as in `predict_measured`. Notices on how the tables were read are logged as warnings.
    """
    own = case is None and curve is None and has_curves(forms)
    if not own and (case is None) == (curve is None):
        raise ValueError('give either the case, such as "U7" or "one-class", or the curve, the path of a sieve curve')
    if case is not None:
        if forms is None:
            raise ValueError("give the path of the table of measured grains")
        refuse_curves(forms)
        if finest is not None or coarsest is not None:
            raise ValueError("finest and coarsest are sizes for a sieve curve; give `curve` instead of `case`")
        prediction = predict_measured(forms, case, models, source, column, level)
        _log(prediction.notices)
        return prediction.table
    check_level(level)
    fitted, (beds, notices) = models_for(models, source), read_bed_forms(forms, curve, column, finest, coarsest)
    _log(notices)
    return join_tables(beds, [bed.predict(fitted, level) for bed in beds])


def _log(notices):
    for notice in notices:
        log.warning("%s", notice)
