# ruff: noqa: E741  L, I, S are the field's names of the axes
"""Linear models of porosity from the form of the grains: correlation, screening, cross-validation, fit."""

import logging
from dataclasses import asdict, dataclass, replace

import numpy as np
import pandas as pd
import statsmodels.api as sm
import xarray as xr
from scipy.stats import t as student
from sklearn.linear_model import LinearRegression
from sklearn.model_selection import GroupKFold

from simcore.grains.form import features as form_features
from simcore.models.fitted_range import RangedValue, distance_outside, widening

log = logging.getLogger(__name__)

FOLDS, REPEATS = 10, 10
RESAMPLES = 2000  # of the bootstrap: the ends of its 95 % intervals are known to 4 % of a standard error
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


def predict_unseen(features, porosity, folds=FOLDS, repeats=REPEATS, seed=0, groups=None):
    """Porosity of each sample by linear regressions that have not seen its group, (repeats, n).

    Shuffled k-fold cross-validation, repeated with new shuffles drawn from `seed` so that the result does not hang on
    one division. groups: (n,), samples that are left out together; None: each by itself. With fewer groups than folds
    there are as many folds as groups, and one repeat, since all are alike.
    Returns (predictions, folds used). ValueError where too few samples are left to fit.
    """
    X, y = features.to_numpy(float), np.asarray(porosity, float)
    groups = np.arange(len(y)) if groups is None else np.unique(np.asarray(groups), return_inverse=True)[1]
    n_groups = len(np.unique(groups))
    folds_used = min(folds, n_groups)
    repeats_used = repeats if folds_used < n_groups else 1
    too_few = (
        f"cross_validate: {len(y)} samples are too few for {X.shape[1]} features and an intercept with one fold left "
        "out; simulate more packings or use fewer features"
    )
    if folds_used < 2:
        raise ValueError(too_few)
    predictions = np.full((repeats_used, len(y)), np.nan)
    for repeat in range(repeats_used):
        splits = GroupKFold(folds_used, shuffle=True, random_state=seed + repeat)
        for train, test in splits.split(X, y, groups):
            if len(train) < X.shape[1] + 1:
                raise ValueError(too_few)
            predictions[repeat, test] = LinearRegression().fit(X[train], y[train]).predict(X[test])
    return predictions, folds_used


def cross_validate(features, porosity, folds=FOLDS, repeats=REPEATS, seed=0, groups=None):
    """Errors of a linear regression on samples it has not seen, dict; features (n, m), porosity (n,).

    Folds, repeats and groups as in predict_unseen. mean_absolute_error and median_absolute_error are over all
    predictions of all repeats: the study's text says median, its Table 9 says mean, so both are given.
    """
    predictions, folds_used = predict_unseen(features, porosity, folds, repeats, seed, groups)
    errors = np.abs(predictions - np.asarray(porosity, float))
    return {
        "mean_absolute_error": errors.mean(),
        "median_absolute_error": np.median(errors),
        "folds": folds_used,
        "repeats": len(predictions),
    }


def bootstrap(features, porosity, resamples=RESAMPLES, seed=0):
    """Coefficients of fits to samples drawn with replacement, (resamples or fewer, m + 1), the intercept first.

    features (n, m), porosity (n,): one row what is drawn as a whole, such as a form; average over its seeds before. A
    draw of too few different rows to fit is left out.
    """
    # An orthonormal basis: the normal equations are then as well conditioned as a draw can be.
    Q, R = np.linalg.qr(sm.add_constant(features.to_numpy(float), has_constant="add"))
    y = np.asarray(porosity, float)
    rng = np.random.default_rng(seed)
    drawn = rng.multinomial(len(y), np.full(len(y), 1.0 / len(y)), size=resamples).astype(float)
    normal = np.einsum("bi,ij,ik->bjk", drawn, Q, Q, optimize=True)
    # A draw that lacks a direction leaves an eigenvalue of rounding, 1e-16 of the largest.
    spans = np.linalg.eigvalsh(normal)[:, 0] > 1e-10
    solved = np.linalg.solve(normal[spans], ((drawn[spans] * y) @ Q)[..., None])[..., 0]
    return np.linalg.solve(R, solved.T).T


@dataclass(frozen=True)
class PorosityModel:
    """A fitted linear model n = b0 + b1 X1 + ...; arrays (m+1,) start with the intercept.

    lower, upper: 95 % confidence intervals by least squares; bootstrap_lower, bootstrap_upper: by drawing the samples
    anew. covariance (m+1, m+1): of the coefficients. scatter: standard deviation of the samples about the model, its
    degrees of freedom taken off; rmse: root mean square residual over the samples of the fit. minimum, maximum (m,): of
    each feature over these samples. mean_absolute_error, median_absolute_error: cross-validated, nan where that was not
    asked for.
    """

    name: str
    case: str
    features: tuple
    coefficients: tuple
    std_errors: tuple
    lower: tuple
    upper: tuple
    bootstrap_lower: tuple
    bootstrap_upper: tuple
    covariance: tuple
    scatter: float
    minimum: tuple
    maximum: tuple
    r_squared: float
    rmse: float
    n_samples: int
    mean_absolute_error: float = np.nan
    median_absolute_error: float = np.nan

    @property
    def terms(self):
        """Names of the coefficients."""
        return ("intercept", *self.features)

    def predict(self, features):
        """Porosity (n,) for a feature table (n, m) that holds at least this model's features.

        The plain formula: it is not checked whether a row lies within what was fitted, nor whether its porosity is in
        (0, 1); simcore.models.prediction.predict_samples does both.
        """
        return self._design(features) @ np.array(self.coefficients)

    def predict_interval(self, features, level=0.95):
        """(porosity, lower, upper), each (n,): the interval holds the porosity of a new sample with chance `level`.

        Of a sample as those of the fit: a new form, its porosity as well known as theirs. By least squares: the
        uncertainty of the coefficients, which grows with the distance from the samples of the fit, and the scatter
        about the model, Student's t. Farther outside the fitted range it is wider, by the rule of
        simcore.models.fitted_range.
        """
        design = self._design(features)
        porosity = design @ np.array(self.coefficients)
        variance = self.scatter**2 + np.einsum("ni,ij,nj->n", design, np.array(self.covariance), design)
        half = student.ppf(0.5 + 0.5 * level, self.n_samples - len(self.coefficients)) * np.sqrt(variance)
        half = half * widening(self.distance_outside(features))
        return porosity, porosity - half, porosity + half

    def distance_outside(self, features):
        """How far each row of a feature table lies outside those of the fit, (n,), by the rule of fitted_range."""
        values = self._design(features)[:, 1:]
        return distance_outside(values, self.minimum, self.maximum).max(axis=1, initial=0.0)

    def outside(self, features):
        """For each row of a feature table the features that lie outside those of the fit, a list of RangedValue, empty
        where all lie within."""
        rows = [
            [
                RangedValue(*each)
                for each in zip(self.features, map(float, row), self.minimum, self.maximum, strict=True)
            ]
            for row in self._design(features)[:, 1:]
        ]
        return [[each for each in row if each.distance > 0] for row in rows]

    def _design(self, features):
        missing = [name for name in self.features if name not in features]
        if missing:
            raise ValueError(f"model {self.name}: the table lacks its feature {', '.join(missing)}; add the column")
        values = [np.asarray(features[name], float) for name in self.features]
        return np.column_stack([np.ones(len(features)), *values])

    def predict_form(self, L, I, S):
        """Porosity (n,) of single-form beds of grains with full axes L >= I >= S, any length unit."""
        return self.predict(form_features(L, I, S))

    def to_rows(self):
        """The model as a table, one row a coefficient; the range of an intercept is nan."""
        columns = {
            "coefficients": "coefficient",
            "std_errors": "std_error",
            "lower": "lower_95",
            "upper": "upper_95",
            "bootstrap_lower": "bootstrap_lower_95",
            "bootstrap_upper": "bootstrap_upper_95",
        }
        table = pd.DataFrame({column: getattr(self, name) for name, column in columns.items()})
        table.insert(0, "term", self.terms)
        table.insert(0, "case", self.case)
        table.insert(0, "model", self.name)
        return table.assign(
            feature_min=[np.nan, *self.minimum],
            feature_max=[np.nan, *self.maximum],
            r_squared=self.r_squared,
            rmse=self.rmse,
            scatter=self.scatter,
            mean_absolute_error=self.mean_absolute_error,
            median_absolute_error=self.median_absolute_error,
            samples=self.n_samples,
        )

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


def fit(features, porosity, name="porosity", case="", seed=0):
    """Ordinary least squares of porosity (n,) on all columns of `features` (n, m) and an intercept: a PorosityModel.

    seed: of the bootstrap.
    """
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
    drawn_lower, drawn_upper = np.percentile(bootstrap(features, y, seed=seed), [2.5, 97.5], axis=0)
    return PorosityModel(
        name=name,
        case=case,
        features=tuple(features.columns),
        coefficients=tuple(result.params.tolist()),
        std_errors=tuple(result.bse.tolist()),
        lower=tuple(lower.tolist()),
        upper=tuple(upper.tolist()),
        bootstrap_lower=tuple(drawn_lower.tolist()),
        bootstrap_upper=tuple(drawn_upper.tolist()),
        covariance=tuple(map(tuple, result.cov_params().tolist())),
        scatter=float(np.sqrt(result.mse_resid)),
        minimum=tuple(X.min(axis=0).tolist()),
        maximum=tuple(X.max(axis=0).tolist()),
        r_squared=float(result.rsquared),
        rmse=float(np.sqrt(np.mean(result.resid**2))),
        n_samples=len(y),
    )


def fit_and_validate(features, porosity, name="porosity", case="", seed=0, groups=None, folds=FOLDS):
    """As `fit`, with the cross-validated errors; groups, folds: as in predict_unseen."""
    errors = cross_validate(features, porosity, folds, seed=seed, groups=groups)
    chosen = {key: float(errors[key]) for key in ("mean_absolute_error", "median_absolute_error")}
    return replace(fit(features, porosity, name, case, seed), **chosen)
