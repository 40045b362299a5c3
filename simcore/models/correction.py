"""Corrections of a porosity model to measured porosities: an offset, or a rescaling.

    offset       n = a + n_model          one fitted coefficient
    rescaling    n = a + b n_model        two fitted coefficients

The model is linear in its features, so the corrected model is linear in the same ones. Its intervals combine the
uncertainty of a and b and the scatter of the measured beds about it by least squares, as for any regression, with the
uncertainty of the model's own slopes, which a and b do not remove. The latter counts where the form of a bed differs
from that of the measured ones: if G x = (1) or (1, n_model)ᵀ are the regressors of a bed with the row x of the
model's design, and A is the least-squares projection of the design on these regressors, the part (I - Aᵀ G) x remains.
"""

from typing import NamedTuple

import numpy as np

from simcore.evaluation.confidence import student_quantile
from simcore.models.regression import PorosityModel, varies
from simcore.models.scatter import covariance_of, scatter_of

CORRECTIONS = {"offset": 1, "rescaling": 2}  # number of fitted coefficients


class Fitted(NamedTuple):
    """The fitted coefficients a (and b) of a correction, their covariance, and the degrees of freedom."""

    coefficients: np.ndarray
    covariance: np.ndarray
    freedom: int


def regressors(kind, predicted):
    """Return the regressors of a correction, (n, 1) or (n, 2), and what is added to their product, (n,).

    kind: key of CORRECTIONS; predicted (n,): porosity by the model that is corrected.
    """
    constant = np.ones(len(predicted))
    if kind == "offset":
        return constant[:, None], predicted
    return np.column_stack([constant, predicted]), np.zeros(len(predicted))


def correct_model(base, kind, features, porosity, name, case):
    """Fit a correction of the PorosityModel `base` to measured porosities (n,).

    kind: key of CORRECTIONS. features: table (n, m) with the features of `base`. Returns the corrected PorosityModel,
    and the Fitted coefficients a (and b). The range of the corrected model is that of `base`; its bootstrap intervals
    are nan. If the scatter of `base` grows with its first feature, so does that of the corrected model, scaled to the
    measured beds, and the covariance is for beds of this scatter.
    """
    # Imported here because it loads slowly and a prediction needs no fit.
    from statsmodels.regression.linear_model import OLS

    y, own = np.asarray(porosity, float), np.array(base.coefficients)
    design = base.design(features)
    columns, added = regressors(kind, design @ own)
    result = OLS(y - added, columns).fit()
    G = np.eye(len(own))[:1] if kind == "offset" else np.vstack([np.eye(len(own))[0], own])
    slope = 1.0 if kind == "offset" else result.params[1]
    coefficients = result.params @ G + (own if kind == "offset" else 0.0)
    remaining = np.eye(len(own)) - (np.linalg.pinv(columns) @ design).T @ G
    fitted_covariance, line = result.cov_params(), None
    if base.scatter_line is not None:
        own_scatter = scatter_of(design, base.scatter, base.scatter_line)
        growth = _growth(columns, result.resid, own_scatter)
        fitted_covariance = covariance_of(columns, growth * own_scatter)
        line = tuple(growth * value for value in base.scatter_line)
    covariance = G.T @ fitted_covariance @ G + slope**2 * remaining.T @ np.array(base.covariance) @ remaining
    errors = np.sqrt(np.diag(covariance))
    half = student_quantile(0.95, result.df_resid) * errors
    unknown = (np.nan,) * len(own)
    scatter = float(np.sqrt(result.mse_resid))
    model = PorosityModel(
        name=name,
        case=case,
        features=base.features,
        coefficients=tuple(coefficients.tolist()),
        std_errors=tuple(errors.tolist()),
        lower=tuple((coefficients - half).tolist()),
        upper=tuple((coefficients + half).tolist()),
        bootstrap_lower=unknown,
        bootstrap_upper=unknown,
        covariance=tuple(map(tuple, covariance.tolist())),
        scatter=scatter,
        scatter_line=line,
        minimum=base.minimum,
        maximum=base.maximum,
        r_squared=float(1.0 - result.ssr / np.sum((y - y.mean()) ** 2)) if varies(y) else np.nan,
        rmse=float(np.sqrt(np.mean(result.resid**2))),
        n_samples=len(y),
        degrees_of_freedom=int(result.df_resid),
    )
    return model, Fitted(result.params, fitted_covariance, int(result.df_resid))


def _growth(columns, residuals, scatter):
    """Return the scatter of measured beds over that of the model that is corrected.

    columns (n, k): regressors; residuals (n,): of the fit; scatter (n,): of the model at the beds.
    """
    projection = np.eye(len(residuals)) - columns @ np.linalg.pinv(columns)
    # The residuals over the scatter have this sum of squares on average if the beds have the scatter of the model.
    expected = np.sum((projection * scatter / scatter[:, None]) ** 2)
    return float(np.sqrt(np.sum((residuals / scatter) ** 2) / expected))
