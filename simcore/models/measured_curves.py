"""Compare measured beds that have sieve curves with the model of size and form, and correct it to them.

Beds are rows that differ in form or sieve curve. An offset needs 3 beds and a rescaling 6; each bed is left out once,
and the simplest correction is chosen by the rule of simcore.models.measured_candidates. No parameter of the packing
model is fitted to measured beds.
"""

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from simcore.models.correction import CORRECTIONS, regressors
from simcore.models.fitting import FittedModels
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
from simcore.models.measured_plausibility import question_repeats
from simcore.models.packing_models.curves import span
from simcore.models.prediction import ONE_CLASS, kind_of_bed, model_case, predict_all_preferred, sample_features
from simcore.models.regression import varies
from simcore.models.scatter import scatter_of
from simcore.models.size_and_form.bed_prediction import (
    error_parts,
    one_class_models,
    other_predictors,
    predict_curve,
    rhine_one_class,
    sized_model,
)
from simcore.models.size_and_form.curve_correction import correct_curves, describe_forms, form_numbers

OURS, CORRECTED, LITERATURE = "size and form", "size and form, corrected", "literature"


@dataclass(frozen=True)
class CurveFit:
    """The fit to the beds with sieve curves.

    beds: DataFrame with one row per bed: name, n, n_error (nan if unknown), repeats, curve (its name), ratio (`span` of
    its sieve curve), n_one_class, one_class_scatter (of beds about the model that gave it), form (number of its form,
    from 0) and predicted (by the model). agreement: as in CaseFit, also of the models of the literature. base_error:
    mean absolute error of the model without a correction. The others as in CaseFit.
    """

    beds: pd.DataFrame
    only_kind: str | None
    repeat_scatter: float
    agreement: pd.DataFrame
    base_error: float
    candidates: tuple
    chosen: Candidate
    notices: tuple = ()

    @property
    def model(self):
        """The chosen CurveCorrection."""
        return self.chosen.model

    @property
    def base(self):
        """Name of the model that is corrected."""
        return OURS


def fit_curves(measured, fitted):
    """Return the CurveFit of measured beds with sieve curves.

    measured: list of MeasuredBed with a curve. fitted: FittedModels. If they have a correction of an earlier fit, it is
    compared too, and the new correction replaces it. TooFewBeds if there are too few beds,
    ValueError if one cannot be predicted.
    """
    groups = group_repeats(measured)
    first_of = [group[0] for group in groups]
    beds, repeat_scatter = means_of_repeats(groups)
    if len(beds) < BEDS_NEEDED["offset"]:
        rows = f"{len(measured)} {'row' if len(measured) == 1 else 'rows'} with a sieve curve"
        raise TooFewBeds(
            f"{rows} with {len(beds)} {'bed' if len(beds) == 1 else 'different beds'}; the simplest model, an offset, "
            f"needs {BEDS_NEEDED['offset']} beds of different form or sieve curve; measure more beds"
        )
    plain = replace(one_class_models(fitted), curve=None)
    model = sized_model(fitted)
    rows = _predict(first_of, plain, model)
    beds = beds.assign(
        curve=[bed.curve.name for bed in first_of],
        ratio=[span(bed.curve) for bed in first_of],
        n_one_class=rows.n_one_class,
        predicted=rows.n,
    )
    of_rhine = rhine_one_class(plain)
    parts = [
        np.ravel(error_parts(bed.curve, np.array([row.n]), np.array([row.n_one_class]), of_rhine, model))
        for bed, row in zip(first_of, rows.itertuples(), strict=True)
    ]
    one_class = _of_one_class(plain)
    forms, form_model = describe_forms([bed.sample for bed in first_of], one_class)
    beds = beds.assign(
        form=form_numbers([bed.sample for bed in first_of], one_class),
        one_class_scatter=_scatter_of_one_class([bed.sample for bed in first_of], one_class),
    )
    constants = {"forms": forms, "form_model": form_model, "sized": model, "one_class": one_class}
    candidates = [_fit_correction(kind, beds, np.transpose(parts), constants) for kind in CORRECTIONS]
    candidates = [for_single_beds(item, beds.repeats, repeat_scatter) for item in candidates]
    chosen = choose(candidates)
    behind = f"{chosen.kind} of the model of {OURS}, {len(beds)} measured beds"
    chosen = chosen._replace(model=replace(chosen.model, behind=behind))
    kinds = {kind_of_bed(bed.sample) for bed in first_of}
    return CurveFit(
        beds=beds,
        only_kind=kinds.pop() if len(kinds) == 1 else None,
        repeat_scatter=repeat_scatter,
        agreement=_compare(first_of, rows, beds.n.to_numpy(), fitted),
        base_error=float(np.abs(rows.n - beds.n).mean()),
        candidates=tuple(chosen if item.kind == chosen.kind else item for item in candidates),
        chosen=chosen,
        notices=tuple(question_repeats(groups, rows.n)),
    )


def _predict(beds, fitted, model=None):
    """Return the rows of predict_curve, one per MeasuredBed; ValueError for a bed that is not evaluated."""
    rows = [predict_curve(bed.curve, [bed.sample], fitted, model=model) for bed in beds]
    rows = pd.concat(rows, ignore_index=True)
    for bed, refused in zip(beds, rows.refused, strict=True):
        if refused:
            raise ValueError(
                f"{bed.sample.name}, sieve curve {bed.curve.name}: the model is not evaluated: {refused}; correct the "
                "row or remove it"
            )
    return rows


def _of_one_class(fitted):
    """Return the models of one sieve class among FittedModels."""
    keys = [key for key in fitted.models if key[1] == model_case(ONE_CLASS)]
    return FittedModels(
        {key: fitted.models[key] for key in keys},
        {key: fitted.behind.get(key, "") for key in keys},
        {key: fitted.only_kind[key] for key in keys if key in fitted.only_kind},
    )


def _scatter_of_one_class(samples, one_class):
    """Return the scatter (n,) of beds of one class about the model that is preferred for each of the samples."""
    rows = predict_all_preferred(samples, ONE_CLASS, one_class)
    models = [one_class.models[row["model"], model_case(ONE_CLASS)] for row in rows]
    features = sample_features(samples)
    designs = [model.design(features.iloc[[i]]) for i, model in enumerate(models)]
    scatters = [scatter_of(design, m.scatter, m.scatter_line) for design, m in zip(designs, models, strict=True)]
    return np.concatenate(scatters)


def _fit_correction(kind, beds, errors, constants):
    """Return the Candidate of a correction; errors (2, n): as from error_parts; constants: as for correct_curves."""
    needed = BEDS_NEEDED[kind]
    if len(beds) < needed:
        return not_fitted(kind, needed, too_few(f"a {kind}", needed, len(beds), "form or sieve curve"))
    if kind == "rescaling" and not varies(beds.n):
        return not_fitted(kind, needed, SAME)
    predicted = beds.predicted.to_numpy(float)
    columns, added = regressors(kind, predicted)
    left_out = left_out_errors(columns, beds.n - added)
    if left_out is None:
        return not_fitted(kind, needed, NO_SPREAD)
    correction, fitted = correct_curves(kind, predicted, beds.n, errors, **constants)
    return fitted_candidate(kind, needed, correction, rows_of_coefficients(kind, fitted), left_out)


def _compare(beds, rows, n, fitted):
    """Return the agreement of all models with the porosities n (k,), DataFrame with the columns AGREEMENT."""
    table = [_agreement(OURS, rows, n)]
    if fitted.curve is not None:
        corrected = _predict(beds, fitted)
        table.append(_agreement(CORRECTED, corrected, n))
    others = [other_predictors(bed.curve, row.n_one_class) for bed, row in zip(beds, rows.itertuples(), strict=True)]
    for i, name in enumerate(others[0]["model"]):
        predicted = np.array([other["n"].iloc[i] for other in others])
        table.append(agreement(LITERATURE, name.removeprefix("packing model: "), predicted - n))
    return pd.DataFrame(table, columns=AGREEMENT)


def _agreement(model, rows, n):
    inside = float(((rows.lower <= n) & (n <= rows.upper)).sum())
    return agreement("ours", model, np.asarray(rows.n, float) - n, inside)
