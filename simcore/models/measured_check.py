"""Test our models, or those that `fit` wrote, on measured beds; nothing is fitted."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pandas as pd

from simcore.models.measured_file import MEASURED
from simcore.models.measured_plausibility import question_beds
from simcore.models.measured_prediction import models_for
from simcore.models.measured_table import describe_models, given_case, read_beds, written_by_fit
from simcore.models.prediction import (
    ONE_CLASS,
    kind_of_bed,
    model_case,
    predict_preferred,
    predict_sample,
    published_models,
)
from simcore.models.size_and_form.bed_prediction import predict_curve, sized_model
from simcore.scene.sizes import all_cases

_COLUMNS = ["name", "n", "n_error", "predicted", "lower", "upper", "inside", "outside", "refused"]


@dataclass(frozen=True)
class ModelCheck:
    """The test of one model.

    case: of the model, "" for beds with sieve curves. given: name of this case in messages. behind: description of the
    model and of the beds that it was fitted to, with its file if there is one. beds: DataFrame with one row per row of
    the table: name, n, n_error (nan if unknown), predicted with the ends `lower` and `upper` of its 95 % prediction
    interval, inside (whether n is in it, None without a prediction), and outside and refused as in
    simcore.models.prediction.
    """

    case: str
    given: str
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

    checks: list of ModelCheck. left_out: sentences on rows that none of the models is for. notices: on how the table
    was read, and on porosities that differ much from the predicted ones.
    """

    checks: list
    left_out: list
    notices: list


def check_models(
    path, models=None, *, case=None, sieve=None, source=None, column=None, finest=None, coarsest=None
) -> MeasuredCheck:
    """Compare the measured beds of the table at `path` with models: each row is one bed.

    models: file that `fit` wrote; or as in simcore.models.measured_fit.fit, to compare with that of our models which is
    preferred for each bed. case: not needed if `fit` wrote models of one case; the others: as in that function.
    ValueError if the table or an argument is wrong, or if no bed can be predicted.
    """
    fitted = models_for(models, source)
    beds, notices = read_beds(path, fitted, models, case, sieve, column, finest, coarsest)
    by_case = {}
    for bed in beds:
        by_case.setdefault("" if bed.curve is not None else model_case(bed.case), []).append(bed)
    checks, left_out = [], []
    of_fit = written_by_fit(fitted)
    for name, of_case in by_case.items():
        has_model = name in fitted.cases() if name else not of_fit or fitted.curve is not None
        if not has_model:
            left_out.append(_describe_left_out(name, len(of_case), fitted, models))
            continue
        check = (_check_curves if name == "" else _check_case if of_fit else _check_preferred)(of_case, name, fitted)
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
    remedy = ""
    if models is None and case:
        curve = case if case in all_cases() else "a file, or a listed curve such as U3,"
        remedy = (
            f"; for our model of sieve curve and form, give {curve} as --sieve or in a column sieve, not as a case"
            + ("" if case in all_cases() else f"; for beds of any single sieve class the case is {ONE_CLASS}")
        )
    if models is not None:
        remedy = "; leave out --models to compare with our models, or give a file that was fitted to such beds"
    return f"{what}; {describe_models(fitted, models)}{remedy}"


def _check_preferred(beds, case, fitted):
    """Return the ModelCheck of MeasuredBeds of one case by our models."""
    rows = [_row(bed, predict_preferred(bed.sample, case, fitted)) for bed in beds]
    behind = f"ours for {' and for '.join(sorted({kind_of_bed(bed.sample) for bed in beds}))}"
    return ModelCheck(case, given_case(beds, case), behind, pd.DataFrame(rows, columns=_COLUMNS))


def _check_case(beds, case, fitted):
    """Return the ModelCheck of MeasuredBeds of one case by the model that `fit` wrote."""
    published, rows = published_models(case), []
    for bed in beds:
        predictions = predict_sample(bed.sample, case, fitted, published)
        (row,) = (row for row in predictions if row["model"] == MEASURED)
        rows.append(_row(bed, row))
    return ModelCheck(case, given_case(beds, case), fitted.behind[MEASURED, case], pd.DataFrame(rows, columns=_COLUMNS))


def _check_curves(beds, case, fitted):
    """Return the ModelCheck of MeasuredBeds with sieve curves; case: ""."""
    rows = [_row(bed, predict_curve(bed.curve, [bed.sample], fitted).iloc[0]) for bed in beds]
    behind = fitted.curve.behind if fitted.curve else f"ours of size and form, {sized_model(fitted).behind}"
    return ModelCheck(case, case, behind.removesuffix("."), pd.DataFrame(rows, columns=_COLUMNS))


def _row(bed, row):
    """Return the values of _COLUMNS of a MeasuredBed; row: prediction with n, lower, upper, outside and refused."""
    n, lower, upper = (float(row[key]) for key in ("n", "lower", "upper"))
    n, lower, upper = (np.nan,) * 3 if row["refused"] else (n, lower, upper)
    inside = None if row["refused"] else bool(lower <= bed.n <= upper)
    return bed.sample.name, bed.n, bed.n_error, n, lower, upper, inside, row["outside"], row["refused"]
