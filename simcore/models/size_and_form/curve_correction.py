"""Correction of the model of size and form to beds with sieve curves whose porosity was measured.

    offset       n = a + n_model          one fitted coefficient
    rescaling    n = a + b n_model        two fitted coefficients

The interval of a new bed combines the scatter of the measured beds about the correction and the uncertainty of a and
b by least squares with what a and b do not remove of the model's own errors: of the step from one class to the curve,
and of how much of the effect of form the step carries over. Each of these errors e is one unknown factor times a
quantity that is known for each bed. If G are the regressors of the new bed and A projects the quantities of the
measured beds on their regressors, e_new - G A e remains; it is small for beds like the measured ones.

The error of the one-class porosity is the same for all beds of one form. If its variance is v, the scatter of beds of
F forms contains v (1 - 1/F) of it. A bed of another form has the whole v, and the mean of F forms, which is in the
correction, adds v / F. Therefore 2 v / F is added for a form that is farther than NEAR from all measured ones, in
widths of the range of the one-class model.
"""

from dataclasses import dataclass, fields

import numpy as np

from simcore.evaluation.confidence import student_quantile
from simcore.models.correction import Fitted, regressors
from simcore.models.fitted_range import NEAR
from simcore.models.prediction import sample_features
from simcore.models.size_and_form.sized_model import SizedModel


@dataclass(frozen=True)
class CurveCorrection:
    """A correction of a SizedModel.

    coefficients: (a,) or (a, b). covariance: of these. scatter: standard deviation of the measured beds about it, with
    its degrees of freedom. of_sizes, of_form: A e of the two errors of the model, like the coefficients. sized: the
    SizedModel. one_class: FittedModels that gave the one-class porosities. form_model: key of the one of them whose
    features describe a form; forms: these features of the F forms of the measured beds. behind: description.
    """

    kind: str
    coefficients: tuple
    covariance: tuple
    scatter: float
    degrees_of_freedom: float
    of_sizes: tuple
    of_form: tuple
    forms: tuple
    form_model: tuple
    sized: SizedModel
    one_class: object
    behind: str = ""
    mean_absolute_error: float = np.nan
    median_absolute_error: float = np.nan

    @property
    def factor(self):
        """The factor b of the model's porosity."""
        return 1.0 if self.kind == "offset" else self.coefficients[1]

    @property
    def freedom(self):
        """Degrees of freedom of the scatter, as PorosityModel has them."""
        return self.degrees_of_freedom

    def unlike(self, samples):
        """Return the factor (s,) of the error of the one-class porosity of samples: 0 for forms like measured ones."""
        model = self.one_class.models[tuple(self.form_model)]
        features = sample_features(samples)[list(model.features)].to_numpy()
        width = np.subtract(model.maximum, model.minimum)
        away = np.abs(features[:, None] - np.array(self.forms)) / width
        nearest = np.min(np.max(away, axis=2), axis=1)
        return np.where(nearest > NEAR, np.sqrt(2.0 / len(self.forms)), 0.0)

    def apply(self, n, of_sizes, of_form, of_one_class, of_few_grains, level=0.95):
        """Return (porosity, half width of its interval), each (s,).

        n (s,): porosity by the model. of_sizes, of_form (s,): its errors, from bed_prediction.error_parts. of_one_class
        (s,): half width of its interval by the error of the one-class porosity, times `unlike`. of_few_grains (s,):
        that by the limited number of measured grains. level: probability of the interval.
        """
        columns, added = regressors(self.kind, np.asarray(n, float))
        corrected = columns @ np.array(self.coefficients) + added
        variance = self.scatter**2 + np.einsum("si,ij,sj->s", columns, np.array(self.covariance), columns)
        sizes = student_quantile(level, self.sized.freedom) * (of_sizes - columns @ np.array(self.of_sizes))
        form = of_form - columns @ np.array(self.of_form)
        own = self.factor**2 * (sizes**2 + form**2 + np.square(of_one_class) + np.square(of_few_grains))
        return corrected, np.sqrt(student_quantile(level, self.freedom) ** 2 * variance + own)

    def to_dict(self):
        """Return plain values without the one-class models."""
        names = (field.name for field in fields(self) if field.name != "one_class")
        return {name: getattr(self, name) for name in names} | {"sized": self.sized._asdict()}


def read_correction(values, one_class):
    """Return the CurveCorrection of plain values of to_dict; one_class: FittedModels."""
    values = dict(values)
    if "freedom" in values:  # the name in files of earlier versions
        values["degrees_of_freedom"] = values.pop("freedom")
    for name in ("coefficients", "of_sizes", "of_form"):
        values[name] = tuple(map(float, values[name]))
    values["forms"] = tuple(tuple(map(float, form)) for form in values["forms"])
    values["form_model"] = tuple(values["form_model"])
    if values["form_model"] not in one_class.models:
        raise ValueError("the file has no model of the form of the beds")
    values["covariance"] = tuple(tuple(map(float, row)) for row in values["covariance"])
    sized = SizedModel(**values["sized"])
    values["sized"] = sized._replace(one_class=tuple(sized.one_class))
    size = 1 if values["kind"] == "offset" else 2
    if {len(values[name]) for name in ("coefficients", "covariance", "of_sizes", "of_form")} != {size}:
        raise ValueError("the coefficients of the correction do not fit its kind")
    return CurveCorrection(**values, one_class=one_class)


def describe_forms(samples, one_class):
    """Return (forms, form_model) of CurveCorrection for the samples of the measured beds; one_class: FittedModels."""
    features, key = _features(samples, one_class)
    return tuple(map(tuple, features.drop_duplicates().to_numpy().tolist())), key


def form_numbers(samples, one_class):
    """Return for each sample the place (s,) of its form among the forms of describe_forms."""
    features, _ = _features(samples, one_class)
    return features.groupby(list(features), sort=False).ngroup().to_numpy()


def _features(samples, one_class):
    """Return the features that describe a form, one row per sample, and the key of their model."""
    key = next((key for key in one_class.models if key[0] == "unified"), next(iter(one_class.models)))
    return sample_features(samples)[list(one_class.models[key].features)].round(9), key


def correct_curves(kind, predicted, porosity, errors, **constants):
    """Fit a correction to beds: (CurveCorrection, Fitted).

    kind: "offset" or "rescaling". predicted, porosity (n,): by the SizedModel, and measured. errors: the pair
    (of_sizes, of_form) of the beds, each (n,). constants: the other fields of CurveCorrection.
    """
    # Imported here because it loads slowly and a prediction needs no fit.
    from statsmodels.regression.linear_model import OLS

    columns, added = regressors(kind, predicted)
    result = OLS(np.asarray(porosity, float) - added, columns).fit()
    projection = np.linalg.pinv(columns)
    model = CurveCorrection(
        kind=kind,
        coefficients=tuple(result.params.tolist()),
        covariance=tuple(map(tuple, result.cov_params().tolist())),
        scatter=float(np.sqrt(result.mse_resid)),
        degrees_of_freedom=float(result.df_resid),
        of_sizes=tuple((projection @ errors[0]).tolist()),
        of_form=tuple((projection @ errors[1]).tolist()),
        **constants,
    )
    return model, Fitted(result.params, result.cov_params(), int(result.df_resid))
