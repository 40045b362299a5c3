"""Read a table of measured beds for models: those of the committed packings, of a campaign, or that `fit` wrote."""

from simcore.grains.measured_beds import CurveReader, read_measured_beds
from simcore.models.measured_file import MEASURED
from simcore.models.prediction import ONE_CLASS, model_case, standard_case
from simcore.scene.sizes import all_cases


def read_beds(path, fitted, models, case, sieve, column, finest, coarsest):
    """Return the result of read_measured_beds; models of one case that `fit` wrote to the file `models` give the case.

    fitted: FittedModels of the path `models`, or None. ValueError also if the models are of other cases than `case`.
    """
    default = None
    if fitted is not None and written_by_fit(fitted):
        if case is not None and model_case(case) not in fitted.cases():
            raise ValueError(
                f"--case {case}: {describe_models(fitted, models)}; leave out --case, or give other models"
            )
        default = fitted.cases()[0] if len(fitted.cases()) == 1 else None
    curves = CurveReader({name: of_case.curve for name, of_case in all_cases().items()}, finest, coarsest)
    return read_measured_beds(path, case, column, sieve, curves, default)


def written_by_fit(fitted):
    """Return whether FittedModels are from a file that `fit` wrote."""
    return fitted.curve is not None or any(name == MEASURED for name, _ in fitted.models)


def given_case(measured, case):
    """Return the name of a case of the models in messages: ONE_CLASS if it was given so for all of the MeasuredBeds."""
    return ONE_CLASS if all(standard_case(bed.case) == ONE_CLASS for bed in measured) else case


def describe_models(fitted, models):
    """Return a clause on the beds that FittedModels are for; models: their path, or None."""
    cases = fitted.cases()
    kinds = [f"case{'s' if len(cases) > 1 else ''} {', '.join(cases)}"] if cases else []
    kinds += ["beds with sieve curves"] if fitted.curve is not None else []
    return f"{models or 'our model'} is for {' and for '.join(kinds)}"
