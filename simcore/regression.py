# ruff: noqa: E741  L, I, S are the field's names of the axes
"""Linear models of porosity from the form of the grains: correlation, screening, cross-validation, fit."""

import logging
from dataclasses import asdict, dataclass

import numpy as np
import pandas as pd
import statsmodels.api as sm
import xarray as xr
from sklearn.linear_model import LinearRegression
from sklearn.model_selection import RepeatedKFold

from simcore.grains.form import features as form_features

log = logging.getLogger(__name__)

FOLDS, REPEATS = 10, 10
CORRELATED = 0.8  # a second feature with |r| above this to the first is dropped (the study)


def usable_features(features):
    """Those columns of a feature table (n, m) that can enter a model; the log says what is left out and why.

    The rule: a feature that is not finite for one row is left out for all, so that all features are compared on the
    same rows; so is a feature that is the same for all rows, to which no correlation exists.
    """
    values = features.to_numpy(float)
    finite = np.isfinite(values).all(axis=0)
    with np.errstate(invalid="ignore"):
        varying = np.ptp(values, axis=0) > 1e-12 * np.abs(values).max(axis=0)
    for reason, columns in (("not finite for every row", ~finite), ("the same for all rows", finite & ~varying)):
        if columns.any():
            log.warning("left out, %s: %s", reason, ", ".join(features.columns[columns]))
    return features.loc[:, finite & varying]


def correlate(features, porosity):
    """Pearson's r of every feature with porosity, Series indexed by feature; features (n, m), porosity (n,)."""
    return features.corrwith(pd.Series(np.asarray(porosity, float), index=features.index)).rename("r")


def screen(features, first="EQ_inv", limit=CORRELATED):
    """Names of the features that may stand beside `first`: |r| to it at most `limit`; `first` itself leads the list."""
    r = correlate(features, features[first])
    return [first] + [name for name in features.columns if name != first and abs(r[name]) <= limit]


def cross_validate(features, porosity, folds=FOLDS, repeats=REPEATS, seed=0):
    """Errors of a linear regression on samples it has not seen, dict; features (n, m), porosity (n,).

    Shuffled k-fold cross-validation, repeated with new shuffles drawn from `seed` so that the result does not hang on
    one division. With fewer samples than folds there are as many folds as samples, and one repeat, since all are alike.
    mean_absolute_error and median_absolute_error are over all predictions of all repeats: the study's text says
    median, its Table 9 says mean, so both are given.
    """
    X, y = features.to_numpy(float), np.asarray(porosity, float)
    folds_used = min(folds, len(y))
    repeats_used = repeats if folds_used < len(y) else 1
    if len(y) - int(np.ceil(len(y) / max(folds_used, 1))) < X.shape[1] + 1:
        raise ValueError(
            f"cross_validate: {len(y)} samples are too few for {X.shape[1]} features and an intercept with one fold "
            "left out; simulate more packings or use fewer features"
        )
    splits = RepeatedKFold(n_splits=folds_used, n_repeats=repeats_used, random_state=seed)
    errors = []
    for train, test in splits.split(X):
        model = LinearRegression().fit(X[train], y[train])
        errors.append(np.abs(model.predict(X[test]) - y[test]))
    errors = np.concatenate(errors)
    return {
        "mean_absolute_error": errors.mean(),
        "median_absolute_error": np.median(errors),
        "folds": folds_used,
        "repeats": repeats_used,
    }


@dataclass(frozen=True)
class PorosityModel:
    """A fitted linear model n = b0 + b1 X1 + ...; arrays (m+1,) start with the intercept.

    lower, upper: 95 % confidence intervals. rmse: root mean square residual over the samples of the fit.
    """

    name: str
    case: str
    features: tuple
    coefficients: tuple
    std_errors: tuple
    lower: tuple
    upper: tuple
    r_squared: float
    rmse: float
    n_samples: int

    @property
    def terms(self):
        """Names of the coefficients."""
        return ("intercept", *self.features)

    def predict(self, features):
        """Porosity (n,) for a feature table (n, m) that holds at least this model's features."""
        missing = [name for name in self.features if name not in features]
        if missing:
            raise ValueError(f"model {self.name}: the table lacks its feature {', '.join(missing)}; add the column")
        values = np.column_stack([np.asarray(features[name], float) for name in self.features])
        return self.coefficients[0] + values @ np.array(self.coefficients[1:])

    def predict_form(self, L, I, S):
        """Porosity (n,) of single-form beds of grains with full axes L >= I >= S, any length unit."""
        return self.predict(form_features(L, I, S))

    def to_rows(self):
        """The model as a table, one row a coefficient."""
        columns = ("coefficients", "std_errors", "lower", "upper")
        table = pd.DataFrame({name: getattr(self, name) for name in columns})
        table.columns = ["coefficient", "std_error", "lower_95", "upper_95"]
        table.insert(0, "term", self.terms)
        table.insert(0, "case", self.case)
        table.insert(0, "model", self.name)
        return table.assign(r_squared=self.r_squared, rmse=self.rmse, samples=self.n_samples)

    def to_dataset(self):
        """The model as a Dataset over `term`."""
        data = {
            "coefficient": ("term", list(self.coefficients), {"units": "1", "long_name": "coefficient"}),
            "std_error": ("term", list(self.std_errors), {"units": "1", "long_name": "standard error"}),
            "lower_95": ("term", list(self.lower), {"units": "1", "long_name": "lower end of the 95 % interval"}),
            "upper_95": ("term", list(self.upper), {"units": "1", "long_name": "upper end of the 95 % interval"}),
            "r_squared": ((), self.r_squared, {"units": "1", "long_name": "coefficient of determination"}),
            "rmse": ((), self.rmse, {"units": "1", "long_name": "root mean square residual of porosity"}),
            "samples": ((), self.n_samples, {"units": "1", "long_name": "number of packings in the fit"}),
        }
        attrs = {"Conventions": "CF-1.11", "title": f"Porosity model {self.name}", "case": self.case}
        return xr.Dataset(data, coords={"term": list(self.terms)}, attrs=attrs)

    def to_dict(self):
        """The model as plain Python values, for JSON."""
        return asdict(self)


def fit(features, porosity, name="porosity", case=""):
    """Ordinary least squares of porosity (n,) on all columns of `features` (n, m) and an intercept: a PorosityModel."""
    X, y = features.to_numpy(float), np.asarray(porosity, float)
    if len(y) <= X.shape[1] + 1:
        raise ValueError(
            f"fit of model {name}, case {case or '-'}: {len(y)} samples are too few for {X.shape[1] + 1} coefficients "
            "and their errors; simulate more packings"
        )
    if not (np.isfinite(X).all() and np.isfinite(y).all()):
        raise ValueError(f"fit of model {name}, case {case or '-'}: a value is not finite; see usable_features")
    result = sm.OLS(y, sm.add_constant(X, has_constant="add")).fit()
    lower, upper = result.conf_int(alpha=0.05).T
    return PorosityModel(
        name=name,
        case=case,
        features=tuple(features.columns),
        coefficients=tuple(result.params.tolist()),
        std_errors=tuple(result.bse.tolist()),
        lower=tuple(lower.tolist()),
        upper=tuple(upper.tolist()),
        r_squared=float(result.rsquared),
        rmse=float(np.sqrt(np.mean(result.resid**2))),
        n_samples=len(y),
    )
