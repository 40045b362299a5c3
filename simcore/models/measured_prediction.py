"""Predict the porosity of the measured grains of a table."""

from typing import NamedTuple

import pandas as pd

from simcore.grains.measured_forms import read_measured
from simcore.models.fitting import FittedModels, fit_reference_models, read_campaign_models
from simcore.models.prediction import predict_samples


class MeasuredPrediction(NamedTuple):
    """Predictions of `predict_samples` for the samples of a table, the models, and notices on how it was read."""

    table: pd.DataFrame
    fitted: FittedModels
    notices: list[str]


def predict_measured(path, case, models=None, source=None, column=None, level=0.95) -> MeasuredPrediction:
    """Predict the porosity of each sample of the table of measured grains at `path`.

    case, level: as in predict_samples. models: folder results/models of a campaign; None: models fitted to the
    committed packings, only to those of grains from `source` if given. column: column with the names of the samples.
    ValueError if the table or an argument is wrong, or if no model can be evaluated for a sample.
    """
    if not 0 < level < 1:
        raise ValueError(f"level {level:g}: give a number between 0 and 1, such as 0.95")
    if models is not None and source is not None:
        raise ValueError(
            "--source selects committed packings, but a campaign's models (--models) are already fitted; give only one"
        )
    samples, notices = read_measured(path, column)
    fitted = fit_reference_models(source=source) if models is None else read_campaign_models(models)
    return MeasuredPrediction(predict_samples(samples, case, fitted, level), fitted, notices)


def predict(path, case, *, models=None, source=None, column=None, level=0.95) -> pd.DataFrame:
    """Return the porosity of each sample of a table of measured grains, one row per sample and model.

    path: table with one row per grain, columns L, I, S or FL, EL, or one row per sample, columns mean_FL, std_FL,
    mean_EL, std_EL. case: sieve curve "U1", "U7", ..., or "one-class" for any single sieve class. Columns of the
    result: name of the sample, n, lower and upper [1], `preferred` for the recommended one of our models, and those
    described at `predict_samples`. Further arguments and errors: as in `predict_measured`.
    """
    return predict_measured(path, case, models, source, column, level).table
