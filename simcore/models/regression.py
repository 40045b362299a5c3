# ruff: noqa: E741  L, I, S are the field's names of the axes
"""Linear models of porosity from the form of the grains: correlation, screening, cross-validation, fit."""

import logging
from dataclasses import asdict, dataclass, replace

import numpy as np
import pandas as pd

from simcore.evaluation.confidence import student_quantile
from simcore.grains.form import features as form_features
from simcore.models.fitted_range import RangedValue, distance_outside, widening
from simcore.models.scatter import covariance_of, scatter_line, scatter_of

log = logging.getLogger(__name__)

FOLDS, REPEATS = 10, 10
RESAMPLES = 2000  # of the bootstrap; the ends of its 95 % intervals of 63 beds then vary by a tenth of a standard error
LEAST_FOR_BOOTSTRAP = 12  # samples; with six, resamples of nearly one form make its intervals meaningless
DEPENDENT = 1e-7  # sine of the angle between a feature and the others, below which it may be only round-off
CORRELATED = 0.8  # a second feature with |r| above this to the first is dropped (Rettinger et al. 2022)


def fewest_samples(features):
    """Return how many samples a fit to these features with its error needs; features: their names."""
    return len(features) + 3  # the intercept, the slopes, and two for the scatter about them


def usable_features(features):
    """Return the columns of a feature table (n, m) that can enter a model; the others are logged with the reason.

    A feature that is not finite for one row is left out for all, so that all features are compared on the same rows.
    A feature that is the same for all rows is left out, because it has no correlation.
    """
    values = features.to_numpy(float)
    finite = np.isfinite(values).all(axis=0)
    with np.errstate(invalid="ignore"):
        varying = varies(values)
    for reason, columns in (("not finite for every row", ~finite), ("the same for all rows", finite & ~varying)):
        if columns.any():
            log.warning("left out, %s: %s", reason, ", ".join(features.columns[columns]))
    return features.loc[:, finite & varying]


def varies(values):
    """Return whether values (n,), or each column of values (n, m), differ by more than round-off."""
    return np.ptp(values, axis=0) > 1e-12 * np.abs(values).max(axis=0)


def dependent(features) -> bool:
    """Return whether columns of a feature table (n, m) depend linearly on each other or on the intercept."""
    X = features.to_numpy(float)
    centred = X - X.mean(axis=0)
    scale = np.linalg.norm(centred, axis=0)
    if not np.all(scale > DEPENDENT * np.linalg.norm(X, axis=0)):
        return True
    return bool(np.linalg.svd(centred / scale, compute_uv=False)[-1] < DEPENDENT)


def correlate(features, porosity):
    """Return Pearson's r of every feature with porosity, Series indexed by feature; features (n, m), porosity (n,)."""
    return features.corrwith(pd.Series(np.asarray(porosity, float), index=features.index)).rename("r")


def screen(features, leading="EQ_inv", limit=CORRELATED):
    """Return the name of the feature `leading`, and of all whose |r| to it is at most `limit`."""
    r = correlate(features, features[leading])
    return [leading] + [name for name in features.columns if name != leading and abs(r[name]) <= limit]


def predict_unseen(features, porosity, folds=FOLDS, repeats=REPEATS, seed=0, groups=None):
    """Predict the porosity of each sample by linear regressions fitted without its group, (repeats, n).

    Shuffled k-fold cross-validation, repeated with new shuffles drawn from `seed` so that the result does not depend on
    one division. groups: (n,), labels of samples that are left out together; None: each sample by itself. With fewer
    groups than folds there are as many folds as groups; if each group is a fold, one repeat suffices.
    Returns (predictions, number of folds used). ValueError if too few samples are left to fit.
    """
    # Imported here because it loads slowly and a prediction needs no cross-validation.
    from sklearn.model_selection import GroupKFold

    X, y = features.to_numpy(float), np.asarray(porosity, float)
    groups = np.arange(len(y)) if groups is None else np.unique(np.asarray(groups), return_inverse=True)[1]
    n_groups = len(np.unique(groups))
    folds_used = min(folds, n_groups)
    repeats_used = repeats if folds_used < n_groups else 1
    too_few = (
        f"cross_validate: {len(y)} samples are too few to fit {X.shape[1]} features and an intercept with one fold "
        "left out; simulate more packings or use fewer features"
    )
    if folds_used < 2:
        raise ValueError(too_few)
    predictions = np.full((repeats_used, len(y)), np.nan)
    for repeat in range(repeats_used):
        splits = GroupKFold(folds_used, shuffle=True, random_state=seed + repeat)
        for train, test in splits.split(X, y, groups):
            if len(train) < X.shape[1] + 1:
                raise ValueError(too_few)
            predictions[repeat, test] = _predict_linear(X[train], y[train], X[test])
    return predictions, folds_used


def _predict_linear(X, y, unseen):
    """Predict unseen (k, m) by the linear regression of y (n,) on X (n, m) and an intercept.

    The operations are those of sklearn's LinearRegression, whose checks of its input take ten times as long.
    """
    from scipy.linalg import lstsq

    X_mean, y_mean = np.average(X, axis=0), np.average(y)
    slopes = lstsq(X - X_mean, y - y_mean, cond=max(X.shape) * np.finfo(float).eps)[0]
    return unseen @ slopes + (y_mean - X_mean @ slopes)


def cross_validate(features, porosity, folds=FOLDS, repeats=REPEATS, seed=0, groups=None):
    """Return the errors of a linear regression on samples left out of its fit, dict; features (n, m), porosity (n,).

    folds, repeats, seed and groups: as in predict_unseen. mean_absolute_error and median_absolute_error are over all
    predictions of all repeats. Both are given because Rettinger et al. (2022) name the median in the text, but the mean
    in Table 9.
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
    """Return coefficients of fits to samples drawn with replacement, (resamples or fewer, m + 1), the intercept first.

    features (n, m), porosity (n,): one row per independent unit, such as a form; average over its seeds before. A
    draw with too few different rows to fit is left out.
    """
    # In an orthonormal basis, the normal equations are as well conditioned as the draw allows.
    Q, R = np.linalg.qr(np.column_stack([np.ones(len(features)), features.to_numpy(float)]))
    y = np.asarray(porosity, float)
    rng = np.random.default_rng(seed)
    drawn = rng.multinomial(len(y), np.full(len(y), 1.0 / len(y)), size=resamples).astype(float)
    normal = np.einsum("bi,ij,ik->bjk", drawn, Q, Q, optimize=True)
    # If a draw does not determine a direction, an eigenvalue is only round-off, about 1e-16 of the largest.
    spans = np.linalg.eigvalsh(normal)[:, 0] > 1e-10
    solved = np.linalg.solve(normal[spans], ((drawn[spans] * y) @ Q)[..., None])[..., 0]
    return np.linalg.solve(R, solved.T).T


@dataclass(frozen=True)
class PorosityModel:
    """A fitted linear model n = b0 + b1 X1 + ...; arrays (m+1,) start with the intercept.

    lower, upper: 95 % confidence intervals by least squares; bootstrap_lower, bootstrap_upper: the same by the
    bootstrap, nan for fewer than LEAST_FOR_BOOTSTRAP samples. covariance (m+1, m+1): of the coefficients. scatter:
    standard deviation of the samples about the model, corrected for the degrees of freedom of the model; scatter_line:
    intercept and slope of the scatter over the first feature, its least value and its constant part, if it grows with
    this feature, else None (simcore.models.scatter); rmse: root mean square residual over the samples of the fit.
    minimum, maximum (m,): of each feature over these samples. mean_absolute_error, median_absolute_error:
    cross-validated errors, nan without cross-validation; form_mixture_error: the mean one over the beds with a
    distribution of form, if there are others too, else None. degrees_of_freedom: of the scatter, if some coefficients
    were not fitted to the samples (simcore.models.correction); None: n_samples minus the number of coefficients.
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
    degrees_of_freedom: float | None = None
    scatter_line: tuple | None = None
    form_mixture_error: float | None = None

    @property
    def terms(self):
        """Names of the coefficients."""
        return ("intercept", *self.features)

    @property
    def freedom(self):
        """Degrees of freedom of the scatter, which Student's t of an interval has."""
        return self.degrees_of_freedom or self.n_samples - len(self.coefficients)

    @property
    def error_of_mixtures(self):
        """Mean cross-validated error of beds with a distribution of form, or of all beds if they are of one kind."""
        return self.mean_absolute_error if self.form_mixture_error is None else self.form_mixture_error

    def predict(self, features):
        """Return the porosity (n,) for a feature table (n, m) with at least this model's features.

        This is the formula without checks: simcore.models.prediction.predict_samples also checks the fitted range and
        that the porosity is in (0, 1).
        """
        return self.design(features) @ np.array(self.coefficients)

    def predict_interval(self, features, level=0.95):
        """Return (porosity, lower, upper), each (n,), with the prediction interval of probability `level`.

        The interval is for a new sample like those of the fit: a new form, whose porosity is measured as precisely. By
        least squares and Student's t it combines the uncertainty of the coefficients, which grows with the distance
        from the samples of the fit, and the scatter about the model, which may grow with the first feature. Farther
        outside the fitted range it is widened by the rule of simcore.models.fitted_range.
        """
        return self._interval(self.design(features), level)

    def predict_interval_and_outside(self, features, level=0.95, further=0.0):
        """Return what predict_interval and `outside` return: (porosity, lower, upper, outside).

        further: half width of the interval of an independent error, a number or (n,); its square is added to that of
        the model's half width.
        """
        design = self.design(features)
        n, lower, upper = self._interval(design, level)
        half = np.hypot(0.5 * (upper - lower), further)
        return n, n - half, n + half, self._outside(design)

    def _interval(self, design, level):
        porosity = design @ np.array(self.coefficients)
        scatter = scatter_of(design, self.scatter, self.scatter_line)
        variance = scatter**2 + np.einsum("ni,ij,nj->n", design, np.array(self.covariance), design)
        half = student_quantile(level, self.freedom) * np.sqrt(variance)
        half = half * widening(self._distances(design).max(axis=1, initial=0.0))
        return porosity, porosity - half, porosity + half

    def distance_outside(self, features):
        """Return the distance (n,) of each row of a feature table from the fitted range, as defined in fitted_range."""
        return self._distances(self.design(features)).max(axis=1, initial=0.0)

    def outside(self, features):
        """Return for each row of a feature table the list of features outside the fitted range, as RangedValue."""
        return self._outside(self.design(features))

    def _outside(self, design):
        outside = [[] for _ in design]
        for row, feature in np.argwhere(self._distances(design) > 0):
            value = float(design[row, 1 + feature])
            limits = self.minimum[feature], self.maximum[feature]
            outside[row].append(RangedValue(self.features[feature], value, *limits))
        return outside

    def _distances(self, design):
        """Return the distance of each feature from its range, (n, m)."""
        return distance_outside(design[:, 1:], self.minimum, self.maximum)

    def design(self, features):
        """Return the matrix (n, m+1) that multiplies the coefficients, for a feature table; ValueError if one lacks."""
        missing = [name for name in self.features if name not in features]
        if missing:
            raise ValueError(f"model {self.name}: the table lacks its feature {', '.join(missing)}; add the column")
        values = [np.asarray(features[name], float) for name in self.features]
        return np.column_stack([np.ones(len(features)), *values])

    def predict_form(self, L, I, S):
        """Return the porosity (n,) of beds of one form with full axes L >= I >= S, any length unit."""
        return self.predict(form_features(L, I, S))

    def to_rows(self):
        """Return the model as a table, one row per coefficient; the range of the intercept is nan."""
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
            scatter_intercept=np.nan if self.scatter_line is None else self.scatter_line[0],
            scatter_slope=np.nan if self.scatter_line is None else self.scatter_line[1],
            mean_absolute_error=self.mean_absolute_error,
            median_absolute_error=self.median_absolute_error,
            form_mixture_error=np.nan if self.form_mixture_error is None else self.form_mixture_error,
            samples=self.n_samples,
        )

    def to_dict(self):
        """Return the model as plain Python values, for JSON."""
        return asdict(self)


def fit(features, porosity, name="porosity", case="", seed=0):
    """Fit porosity (n,) to all columns of `features` (n, m) and an intercept by ordinary least squares: PorosityModel.

    If the scatter about the model grows with the first feature, the errors of the coefficients are for this scatter.
    seed: of the bootstrap. ValueError if there are too few samples, a value is not finite or features depend on each
    other.
    """
    # Imported here because it loads slowly and a prediction needs no fit.
    from statsmodels.regression.linear_model import OLS
    from statsmodels.tools import add_constant

    X, y = features.to_numpy(float), np.asarray(porosity, float)
    if len(y) <= X.shape[1] + 1:
        raise ValueError(
            f"fit of model {name}, case {case or '-'}: {len(y)} samples are too few for {X.shape[1] + 1} coefficients "
            "and their errors; simulate more packings"
        )
    if not (np.isfinite(X).all() and np.isfinite(y).all()):
        raise ValueError(
            f"fit of model {name}, case {case or '-'}: a value is not finite; select the columns with usable_features"
        )
    if dependent(features):
        raise ValueError(
            f"fit of model {name}, case {case or '-'}: {' and '.join(features.columns)} depend linearly on each other "
            f"in all {len(y)} samples, so that a fit cannot separate their effects; choose forms in which they vary "
            "independently"
        )
    design = add_constant(X, has_constant="add")
    result = OLS(y, design).fit()
    scatter, line = float(np.sqrt(result.mse_resid)), scatter_line(design, result.resid)
    covariance = result.cov_params() if line is None else covariance_of(design, scatter_of(design, scatter, line))
    errors = np.sqrt(np.diag(covariance))
    half = student_quantile(0.95, result.df_resid) * errors
    drawn_lower, drawn_upper = np.full((2, design.shape[1]), np.nan)
    if len(y) >= LEAST_FOR_BOOTSTRAP:
        drawn_lower, drawn_upper = np.percentile(bootstrap(features, y, seed=seed), [2.5, 97.5], axis=0)
    return PorosityModel(
        name=name,
        case=case,
        features=tuple(features.columns),
        coefficients=tuple(result.params.tolist()),
        std_errors=tuple(errors.tolist()),
        lower=tuple((result.params - half).tolist()),
        upper=tuple((result.params + half).tolist()),
        bootstrap_lower=tuple(drawn_lower.tolist()),
        bootstrap_upper=tuple(drawn_upper.tolist()),
        covariance=tuple(map(tuple, covariance.tolist())),
        scatter=scatter,
        scatter_line=line,
        minimum=tuple(X.min(axis=0).tolist()),
        maximum=tuple(X.max(axis=0).tolist()),
        r_squared=float(result.rsquared) if varies(y) else np.nan,
        rmse=float(np.sqrt(np.mean(result.resid**2))),
        n_samples=len(y),
    )


def fit_and_validate(features, porosity, name="porosity", case="", seed=0, groups=None, folds=FOLDS, mixed=None):
    """Fit as `fit` does, and add the cross-validated errors; groups, folds: as in predict_unseen.

    mixed (n,): whether a bed has a distribution of form, if the beds are of both kinds.
    """
    predictions, _ = predict_unseen(features, porosity, folds, seed=seed, groups=groups)
    errors = np.abs(predictions - np.asarray(porosity, float))
    return replace(
        fit(features, porosity, name, case, seed),
        mean_absolute_error=float(errors.mean()),
        median_absolute_error=float(np.median(errors)),
        form_mixture_error=None if mixed is None else float(errors[:, mixed].mean()),
    )
