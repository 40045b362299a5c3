"""Compare measured porosities with the models, and correct or fit a model to them.

Three kinds of model are fitted to the beds of a case, where these are enough. Beds are rows of different form; rows of
the same form are repeats, and their mean is one bed.

    kind         model                                        beds needed
    offset       our model plus a constant                    3
    rescaling    a constant plus our model times a factor     6
    features     linear in a named set of features            3 per coefficient, the intercept included

Each bed is left out once and predicted from the others. The chosen model is the simplest, in this order, of which the
mean absolute error is at most the smallest one plus its standard error. These rules were fixed before any measured
table was read.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pandas as pd

from simcore.grains.form_notices import SHOWN
from simcore.grains.text_lists import join_first
from simcore.models.correction import CORRECTIONS, correct_model, regressors
from simcore.models.few_grains import errors_by_grains
from simcore.models.measured_candidates import (
    AGREEMENT,
    BEDS_NEEDED,
    NO_SPREAD,
    SAME,
    Candidate,
    TooFewBeds,
    agreement,
    choose,
    fitted_candidate,
    for_single_beds,
    group_repeats,
    left_out_errors,
    means_of_repeats,
    not_fitted,
    rows_of_coefficients,
    too_few,
)
from simcore.models.measured_curves import CurveFit, fit_curves
from simcore.models.measured_file import MEASURED, write_measured_models
from simcore.models.measured_plausibility import question_repeats
from simcore.models.measured_prediction import models_for
from simcore.models.measured_table import given_case, read_beds
from simcore.models.mixtures import MIXTURE
from simcore.models.prediction import (
    ONE_CLASS,
    describe_model,
    kind_of_bed,
    model_case,
    predict_sample,
    published_models,
    sample_features,
)
from simcore.models.regression import PorosityModel, dependent, varies
from simcore.models.regression import fit as fit_features
from simcore.models.single_form import SINGLE_FORM
from simcore.models.unified import UNIFIED
from simcore.scene.sizes import all_cases

BEDS_PER_COEFFICIENT = 3
FEATURE_SETS = {
    "single_form_EQ": SINGLE_FORM[:1],
    "single_form": SINGLE_FORM,
    "form_mixture": MIXTURE,
    "unified": UNIFIED,
}


@dataclass(frozen=True)
class CaseFit:
    """The fit to the beds of one case.

    case: of the models. given: its name in messages: ONE_CLASS if the case of all beds was given so, else `case`. beds:
    DataFrame with one row per bed: name, n, n_error (nan if unknown), repeats, all features of the models, and
    predicted: by `base`, or, if there is none, by that of our models which is preferred for the bed, else nan;
    form_error: standard error of `predicted` by the limited number of measured grains, nan if it is unknown.
    only_kind: "one form" or "a distribution of form" if all beds are of this kind, else None. repeat_scatter: standard
    deviation of repeats about their means, nan without repeats. agreement: DataFrame with the columns AGREEMENT, one
    row per model: number of beds for which it is evaluated, bias (mean of predicted minus measured porosity) with its
    standard error, scatter (standard deviation about the bias), and number of beds inside its 95 % prediction interval
    (nan for Rettinger et al., who publish none). base, base_model: name of our model that is corrected, and the
    PorosityModel itself; "" and None if there is none, for the reason base_reason. base_error: its mean absolute error
    without a correction. features: name of the set. candidates: a Candidate of each kind; chosen: one of them.
    notices: on porosities that differ much from the predicted ones.
    """

    case: str
    given: str
    beds: pd.DataFrame
    only_kind: str | None
    repeat_scatter: float
    agreement: pd.DataFrame
    base: str
    base_model: PorosityModel | None
    base_error: float
    base_reason: str
    features: str
    candidates: tuple
    chosen: Candidate
    notices: tuple = ()

    @property
    def model(self):
        """The chosen PorosityModel."""
        return self.chosen.model

    def describe(self):
        """Return what was fitted to which beds, for the file of the model."""
        base = "an earlier fit" if self.base == MEASURED else self.base
        fitted = (
            f"{self.chosen.kind} of {base}"
            if self.chosen.kind in CORRECTIONS
            else f"fit of {', '.join(self.model.features)}"
        )
        return f"{fitted}, {len(self.beds)} measured beds"


class MeasuredFit(NamedTuple):
    """The fits to a table.

    cases: list of CaseFit. left_out: sentences on cases that are left out. notices: on how the table was read, and on
    porosities that differ much from the predicted ones. curves: CurveFit of the rows with sieve curves, or None.
    """

    cases: list
    left_out: list
    notices: list
    curves: CurveFit | None = None

    @property
    def table(self):
        """DataFrame with a row per case and kind of model: error over beds left out, chosen, reason if not fitted.

        The case of rows with sieve curves is "sieve curves".
        """
        fits = [(case.case, case) for case in self.cases]
        fits += [("sieve curves", self.curves)] if self.curves is not None else []
        return pd.DataFrame(
            [
                {"case": name, "kind": item.kind, "beds": len(case.beds), "needed": item.needed}
                | {"error": item.error, "error_se": item.error_se, "chosen": item is case.chosen, "reason": item.reason}
                for name, case in fits
                for item in case.candidates
            ]
        )


def fit(
    path, *, case=None, sieve=None, features="single_form", models=None, source=None, column=None, finest=None,
    coarsest=None, out=None,
) -> MeasuredFit:  # fmt: skip
    """Compare the measured beds of a table with the models, and correct or fit a model to them.

    path: table with a row per bed: measured porosity n, optionally n_error, case or sieve, and the form of the grains,
    as in simcore.grains.measured_beds. case: sieve curve, if there is no such column; "one-class" for any single sieve
    class. sieve: path of a table with the sieve curve of all beds instead; beds with such a curve are compared with the
    model of size and form. features: key of FEATURE_SETS. models: folder results/models of a campaign, or a file of an
    earlier fit, instead of the models of the committed packings; such a file with one case gives the case. source: only
    those of grains from this source. column: with the names of the beds. finest, coarsest [m]: as in
    simcore.grains.sieve_table.read_curve. out: file for the chosen models, for `predict(..., models=out)`.
    TooFewBeds, a ValueError, if there are too few beds for any model; ValueError also if the table or an argument is
    wrong.
    """
    _check_features(features)
    fitted = None if models is None else models_for(models, source)
    beds, notices = read_beds(path, fitted, models, case, sieve, column, finest, coarsest)
    fitted = fitted or models_for(None, source)
    by_case, cases, errors = {}, [], []
    for bed in beds:
        if bed.curve is None:
            by_case.setdefault(model_case(bed.case), []).append(bed)
    for name, of_case in by_case.items():
        try:
            cases.append(fit_case(of_case, name, fitted, features))
        except ValueError as error:
            errors.append(error)
    of_curves = None
    if with_curve := [bed for bed in beds if bed.curve is not None]:
        try:
            of_curves = fit_curves(with_curve, fitted)
        except ValueError as error:
            errors.append(error)
    left_out = [str(error) for error in errors]
    if not cases and of_curves is None:
        kind = TooFewBeds if all(isinstance(error, TooFewBeds) for error in errors) else ValueError
        raise kind(f"{path}: {'; '.join(left_out)}")
    if out is not None:
        written = [(item.model, item.describe(), item.only_kind) for item in cases]
        write_measured_models(out, written, of_curves and of_curves.model)
    fits = [*cases, of_curves] if of_curves is not None else cases
    notices = [*notices, *(notice for item in fits for notice in item.notices)]
    return MeasuredFit(cases, left_out, notices, of_curves)


def _check_features(features):
    if features not in FEATURE_SETS:
        raise ValueError(f"--features {features}: there is no such set of features; choose {', '.join(FEATURE_SETS)}")


def fit_case(measured, case, fitted, features="single_form"):
    """Return the CaseFit of the beds of one case.

    measured: list of MeasuredBed; case: as returned by model_case; fitted: FittedModels; features: key of FEATURE_SETS.
    TooFewBeds if there are too few beds for any of the models.
    """
    samples, beds, repeat_scatter = average_repeats(measured)
    given = given_case(measured, case)
    if len(beds) < min(BEDS_NEEDED.values()):
        rows = f"{len(measured)} {'row' if len(measured) == 1 else 'rows'}"
        forms = f"{len(beds)} {'form' if len(beds) == 1 else 'different forms'}"
        raise TooFewBeds(
            f"case {given}: {rows} with {forms}; the simplest model, an offset, needs {BEDS_NEEDED['offset']} beds of "
            "different form; measure more beds"
        )
    predictions = _predict(samples, case, fitted)
    base, reason = _find_base(predictions, samples, case, fitted)
    base_model = fitted.models[base, case] if base else None
    beds["form_error"] = errors_by_grains(base_model, samples) if base else np.nan
    beds["predicted"] = base_model.predict(beds) if base else _preferred(predictions, len(beds))
    candidates = fit_candidates(base_model, beds, case, features, reason)
    candidates = [for_single_beds(item, beds.repeats, repeat_scatter) for item in candidates]
    if not any(item.model for item in candidates):
        reasons = "; ".join(dict.fromkeys(item.reason for item in candidates))
        kind = ValueError if any(by == "ours" for by, _ in predictions) else TooFewBeds
        raise kind(f"case {given}: no model can be fitted to its {len(beds)} beds: {reasons}")
    kinds = {kind_of_bed(sample) for sample in samples}
    return CaseFit(
        case=case,
        given=given,
        beds=beds,
        only_kind=kinds.pop() if len(kinds) == 1 else None,
        repeat_scatter=repeat_scatter,
        agreement=_compare(predictions, beds.n.to_numpy()),
        base=base,
        base_model=base_model,
        base_error=float(np.abs(beds.predicted - beds.n).mean()) if base else np.nan,
        base_reason=reason,
        features=features,
        candidates=tuple(candidates),
        chosen=choose(candidates),
        notices=tuple(question_repeats(group_repeats(measured), beds.predicted)),
    )


def average_repeats(measured):
    """Return samples, beds and the standard deviation of repeats: rows of one form become one bed with their mean.

    measured: list of MeasuredBed. samples: list of Sample; beds: DataFrame as in CaseFit, one row per sample.
    """
    groups = group_repeats(measured)
    beds, scatter = means_of_repeats(groups)
    samples = [group[0].sample for group in groups]
    return samples, beds.join(sample_features(samples)), scatter


def _predict(samples, case, fitted):
    """Return the predictions of all models: dict from (by, model) to a list of rows of PREDICTION, or None in it."""
    published, predictions = published_models(case), {}
    for i, sample in enumerate(samples):
        for row in predict_sample(sample, case, fitted, published):
            predictions.setdefault((row["by"], row["model"]), [None] * len(samples))[i] = row
    return predictions


def _preferred(predictions, number):
    """Return the porosity of each of `number` beds by that of our models which is preferred for it, nan without one."""
    n = np.full(number, np.nan)
    for (by, _), rows in predictions.items():
        for i, row in enumerate(rows):
            if by == "ours" and row is not None and row["preferred"]:
                n[i] = row["n"]
    return n


def _compare(predictions, n):
    """Return the agreement of the models with the measured porosities n (k,), DataFrame with the columns AGREEMENT."""
    table = []
    for (by, model), rows in predictions.items():
        used = [i for i, row in enumerate(rows) if row is not None and np.isfinite(row["n"])]
        if not used:
            continue
        difference = np.array([rows[i]["n"] for i in used]) - n[used]
        inside = sum(rows[i]["lower"] <= n[i] <= rows[i]["upper"] for i in used) if by == "ours" else np.nan
        table.append(agreement(by, model, difference, inside))
    return pd.DataFrame(table, columns=AGREEMENT)


def _find_base(predictions, samples, case, fitted):
    """Return the name of our model that is corrected, or "" with the reason.

    It is evaluated for all beds; of several, it is preferred for most beds, or else has the smaller error.
    """
    ours = {model: rows for (by, model), rows in predictions.items() if by == "ours"}
    if not ours:
        return "", f"there is no model of ours for case {case} and beds of this kind to correct{_remedy(case, fitted)}"
    suitable, reasons, without = {}, [], []
    for model, rows in ours.items():
        missing = [i for i, row in enumerate(rows) if row is None or row["refused"]]
        if not missing:
            suitable[model] = -sum(row["preferred"] for row in rows), fitted.models[model, case].mean_absolute_error
        else:
            row, without = rows[missing[0]], min([without or missing, missing], key=len)
            why = row["refused"] if row else "the model is for beds of another kind"
            reasons.append(f"{describe_model('ours', model)} is not evaluated for {samples[missing[0]].name}: {why}")
    if suitable:
        return min(suitable, key=suitable.get), ""
    others = len(samples) - len(without)
    names = join_first([samples[i].name for i in without], SHOWN)
    remedy = f"; remove {names} to correct a model to the other {others}" if others >= BEDS_NEEDED["offset"] else ""
    return "", f"none of our models is evaluated for all beds ({'; '.join(reasons)}){remedy}"


def _remedy(case, fitted):
    """Return what to do if none of the FittedModels is for the beds of a case, as a clause, or ""."""
    if case in all_cases():
        return f"; for our model of sieve curve and form, give --sieve {case} instead of the case"
    if case in fitted.cases():
        return ""
    return (
        f"; for beds of any single sieve class give {ONE_CLASS} as their case, and for a sieve curve of your own "
        "--sieve CURVE.csv instead of the case"
    )


def fit_candidates(base, beds, case, features="single_form", reason=""):
    """Return a Candidate of each kind, the simplest first.

    base: PorosityModel to correct, or None for the `reason`. beds: DataFrame with n, name and the features, one row per
    bed; case: of the models; features: key of FEATURE_SETS.
    """
    candidates = [_fit_correction(kind, base, beds, case, reason) for kind in CORRECTIONS]
    return [*candidates, _fit_features(FEATURE_SETS[features], beds, case)]


def _fit_correction(kind, base, beds, case, reason):
    """Return the Candidate of a correction of the PorosityModel `base`, which is None for the `reason`."""
    needed = BEDS_NEEDED[kind]
    if base is None:
        return not_fitted(kind, needed, reason)
    if len(beds) < needed:
        return not_fitted(kind, needed, too_few(f"{'an' if kind == 'offset' else 'a'} {kind}", needed, len(beds)))
    if kind == "rescaling" and not varies(beds.n):
        return not_fitted(kind, needed, SAME)
    columns, added = regressors(kind, base.predict(beds))
    errors = left_out_errors(columns, beds.n - added)
    if errors is None:
        return not_fitted(kind, needed, NO_SPREAD)
    model, fitted = correct_model(base, kind, beds, beds.n, MEASURED, case)
    return fitted_candidate(kind, needed, model, rows_of_coefficients(kind, fitted), errors)


def _fit_features(names, beds, case):
    """Return the Candidate that is linear in the features `names`."""
    needed = BEDS_PER_COEFFICIENT * (len(names) + 1)
    if len(beds) < needed:
        return not_fitted("features", needed, too_few(f"a fit of {len(names)} features", needed, len(beds)))
    if not varies(beds.n):
        return not_fitted("features", needed, SAME)
    X = beds[list(names)]
    for name in names:
        if not np.isfinite(X[name]).all():
            bed = beds.name[~np.isfinite(X[name])].iloc[0]
            return not_fitted("features", needed, f"{name} is not finite for {bed}; choose other features")
    errors = left_out_errors(np.column_stack([np.ones(len(X)), X]), beds.n)
    if errors is None or dependent(X):
        reason = f"the beds do not differ enough to separate {', '.join(names)}, or one bed alone separates them"
        return not_fitted("features", needed, reason)
    model = fit_features(X, beds.n, MEASURED, case)
    columns = zip(model.terms, model.coefficients, model.std_errors, model.lower, model.upper, strict=True)
    return fitted_candidate("features", needed, model, columns, errors)
