"""Test the models that `fit` wrote on beds that were measured later; nothing is fitted."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pandas as pd

from simcore.models.measured_file import MEASURED
from simcore.models.measured_plausibility import question_beds
from simcore.models.measured_prediction import models_for
from simcore.models.measured_table import describe_models, read_beds
from simcore.models.prediction import model_case, predict_sample, published_models
from simcore.models.size_and_form.bed_prediction import predict_curve

_COLUMNS = ["name", "n", "n_error", "predicted", "lower", "upper", "inside", "outside", "refused"]


@dataclass(frozen=True)
class ModelCheck:
    """The test of one model.

    case: of the model, "" for the correction for sieve curves. behind: description of the beds that the model was
    fitted to, and its file. beds: DataFrame with one row per row of the table: name, n, n_error (nan if unknown),
    predicted with the ends `lower` and `upper` of its 95 % prediction interval, inside (whether n is in it, None
    without a prediction), and outside and refused as in simcore.models.prediction.
    """

    case: str
    behind: str
    beds: pd.DataFrame

    @property
    def evaluated(self):
        """The rows of `beds` for which the model is evaluated."""
        return self.beds[self.beds.predicted.notna()]

    @property
    def bias(self):
        """Mean of predicted minus measured porosity."""
        return float((self.evaluated.predicted - self.evaluated.n).mean())

    @property
    def scatter(self):
        """Standard deviation of predicted minus measured porosity about the bias, nan for one bed."""
        return float((self.evaluated.predicted - self.evaluated.n).std(ddof=1))

    @property
    def inside(self):
        """Share of the beds whose porosity is inside the prediction interval."""
        return float(self.evaluated.inside.astype(bool).mean())


class MeasuredCheck(NamedTuple):
    """The tests of the models of a file.

    checks: list of ModelCheck. left_out: sentences on rows that no model of the file is for. notices: on how the table
    was read, and on porosities that differ much from the predicted ones.
    """

    checks: list
    left_out: list
    notices: list


def check_models(
    path, models, *, case=None, sieve=None, source=None, column=None, finest=None, coarsest=None
) -> MeasuredCheck:
    """Compare the measured beds of the table at `path` with the models of the file `models` that `fit` wrote.

    Each row is one bed. case: only needed if the file has models of several cases; the others: as in
    simcore.models.measured_fit.fit. ValueError if the table or an argument is wrong, or if no bed can be predicted.
    """
    fitted = models_for(models, source)
    beds, notices = read_beds(path, fitted, models, case, sieve, column, finest, coarsest)
    by_case = {}
    for bed in beds:
        by_case.setdefault("" if bed.curve is not None else model_case(bed.case), []).append(bed)
    checks, left_out = [], []
    for name, of_case in by_case.items():
        if fitted.curve is None if name == "" else name not in fitted.cases():
            left_out.append(_describe_left_out(name, len(of_case), fitted, models))
            continue
        check = _check_curves(of_case, fitted) if name == "" else _check_case(of_case, name, fitted)
        checks.append(check)
        notices = [*notices, *question_beds(of_case, check.beds.predicted)]
    if not checks:
        raise ValueError(f"{path}: {'; '.join(left_out)}")
    if all(check.evaluated.empty for check in checks):
        first = checks[0].beds.iloc[0]
        raise ValueError(f"{path}: the model is evaluated for none of the beds; {first['name']}: {first.refused}")
    return MeasuredCheck(checks, left_out, notices)


def _describe_left_out(case, number, fitted, models):
    rows = f"{number} {'row' if number == 1 else 'rows'}"
    what = f"case {case}: {rows}" if case else f"{rows} with a sieve curve"
    return f"{what}; {describe_models(fitted, models)}"


def _check_case(beds, case, fitted):
    """Return the ModelCheck of MeasuredBeds of one case."""
    published, rows = published_models(case), []
    for bed in beds:
        predictions = predict_sample(bed.sample, case, fitted, published)
        (row,) = (row for row in predictions if row["model"] == MEASURED)
        rows.append(_row(bed, row))
    return ModelCheck(case, fitted.behind[MEASURED, case], pd.DataFrame(rows, columns=_COLUMNS))


def _check_curves(beds, fitted):
    """Return the ModelCheck of MeasuredBeds with sieve curves."""
    rows = [_row(bed, predict_curve(bed.curve, [bed.sample], fitted).iloc[0]) for bed in beds]
    return ModelCheck("", fitted.curve.behind, pd.DataFrame(rows, columns=_COLUMNS))


def _row(bed, row):
    """Return the values of _COLUMNS of a MeasuredBed; row: prediction with n, lower, upper, outside and refused."""
    n, lower, upper = (float(row[key]) for key in ("n", "lower", "upper"))
    n, lower, upper = (np.nan,) * 3 if row["refused"] else (n, lower, upper)
    inside = None if row["refused"] else bool(lower <= bed.n <= upper)
    return bed.sample.name, bed.n, bed.n_error, n, lower, upper, inside, row["outside"], row["refused"]
