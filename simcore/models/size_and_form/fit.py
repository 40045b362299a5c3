"""Fit of the candidates for size and form to packed beds, by the rules of docs/appendices/size_and_form_plan.md.

The parameters minimise Σ w (predicted − packed)² within their bounds, with w = 1/(σ² + τ²): σ is the sampling error of
a bed and τ the scatter between beds, which restricted maximum likelihood gives once, with candidate H over all beds.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares, minimize_scalar

from simcore.models.size_and_form.candidates import CANDIDATES

SCATTER_BY = "H"
LARGEST_SCATTER = 0.03
STEP = 1e-4  # of the numerical derivatives, as a share of a parameter's range; predictions are exact to 1e-9


class Fit(NamedTuple):
    """A fitted candidate with p parameters."""

    name: str
    parameters: dict
    covariance: np.ndarray  # (p, p), in the order of the parameters
    predicted: np.ndarray  # (n,), of the beds of the fit
    at_bound: tuple  # names of the parameters that lie at a bound, for which the covariance does not hold

    def std_errors(self) -> dict:
        """Return the standard error of each parameter."""
        return dict(zip(self.parameters, np.sqrt(np.diag(self.covariance)), strict=True))


def predict_beds(name, beds, parameters) -> np.ndarray:
    """Return the porosity (n,) of Beds by candidate `name` with these parameters."""
    porosity = CANDIDATES[name].porosity
    rows = zip(beds.curves, beds.one_class, beds.reference, beds.mu_EQ, beds.mu_EL, strict=True)
    predicted = [porosity(curve, n1, (EQ, EL), "number", n_ref, **parameters) for curve, n1, n_ref, EQ, EL in rows]
    return np.array([float(np.squeeze(n)) for n in predicted])


def fit_candidate(name, beds, scatter, start=None, fixed=None) -> Fit:
    """Fit candidate `name` to Beds; scatter: τ. start: dict of parameters to begin with. fixed: dict of those kept.

    ValueError if there are fewer beds than parameters.
    """
    fixed = fixed or {}
    parameters = {key: limits for key, limits in CANDIDATES[name].parameters.items() if key not in fixed}
    if len(beds.n) < len(parameters):
        raise ValueError(
            f"candidate {name}: {len(beds.n)} beds are too few for {len(parameters)} parameters; pack more beds"
        )
    low, high = (np.array([getattr(limits, end) for limits in parameters.values()]) for end in ("low", "high"))
    first = np.array([(start or {}).get(key, limits.start) for key, limits in parameters.items()])
    weights = (beds.error**2 + scatter**2) ** -0.5

    # Parameters are scaled to 1 to 2, because the step of the derivatives is relative: it would vanish at 0.
    def residuals(scaled):
        values = dict(zip(parameters, low + (scaled - 1.0) * (high - low), strict=True)) | fixed
        return weights * (predict_beds(name, beds, values) - beds.n)

    begin = 1.0 + np.clip((first - low) / (high - low), 0.01, 0.99)
    solution = least_squares(residuals, begin, bounds=(1.0, 2.0), diff_step=STEP, xtol=1e-8, ftol=1e-10)
    scaled = solution.x - 1.0
    values = low + scaled * (high - low)
    normal = solution.jac.T @ solution.jac
    covariance = np.linalg.pinv(normal) * np.outer(high - low, high - low)
    bound = tuple(key for key, x in zip(parameters, scaled, strict=True) if not 1e-3 < x < 1 - 1e-3)
    predicted = beds.n + solution.fun / weights
    return Fit(name, dict(zip(parameters, map(float, values), strict=True)), covariance, predicted, bound)


def scatter_between_beds(beds, name=SCATTER_BY) -> float:
    """Return τ, the scatter of Beds about candidate `name`, by restricted maximum likelihood; 0 where there is none."""
    start = {}

    def deviance(scatter):
        fit = fit_candidate(name, beds, scatter, start or None)
        start.update(fit.parameters)
        variance = beds.error**2 + scatter**2
        information = np.linalg.slogdet(np.linalg.pinv(fit.covariance))[1]
        return float(np.sum(np.log(variance)) + information + np.sum((fit.predicted - beds.n) ** 2 / variance))

    minimum = minimize_scalar(deviance, bounds=(0.0, LARGEST_SCATTER), method="bounded", options={"xatol": 1e-5})
    return float(minimum.x) if minimum.fun < deviance(0.0) else 0.0


def predict_left_out(name, beds, groups, scatter) -> np.ndarray:
    """Return the porosity (n,) of each bed by fits to the beds of all other groups; groups (n,): labels."""
    groups, whole = np.asarray(groups), fit_candidate(name, beds, scatter)
    predicted = np.full(len(groups), np.nan)
    for label in np.unique(groups):
        out = groups == label
        fit = fit_candidate(name, beds.select(~out), scatter, whole.parameters)
        predicted[out] = predict_beds(name, beds.select(out), fit.parameters)
    return predicted
