"""The scatter of samples about a linear model, which may grow with the first feature of the model.

The porosity of beds of long or flat grains scatters more about the models than that of beds of compact ones. With one
standard deviation for all, prediction intervals would be too wide for compact grains and too narrow for the others.
"""

import numpy as np

FEWEST = 30  # samples, from which the scatter may depend on the first feature
CHANCE = 0.01  # probability, below which a slope of the scatter is not due to chance
LEAST = 0.5  # of the scatter over all samples: the least one of any form


def scatter_line(design, residuals):
    """Return the scatter as a line over the first feature, (intercept, slope, least, 0), or None if it does not grow.

    least is the scatter where the line is below it; the last value is a part that is the same for all forms, which is
    added in quadrature. design (n, m + 1): as of PorosityModel.design; residuals (n,). The sizes of the residuals, each
    for its leverage, are fitted by a line (Glejser's test); the line is scaled so that the residuals over it have unit
    variance.
    """
    # Imported here because it loads slowly and a prediction needs no fit.
    from scipy.stats import linregress

    if len(residuals) < FEWEST:
        return None
    leverage = np.einsum("ij,ji->i", design, np.linalg.pinv(design))
    sizes, x = np.abs(residuals) / np.sqrt(1.0 - leverage), design[:, 1]
    line = linregress(x, sizes)
    if not (line.slope > 0.0 and line.pvalue < CHANCE):
        return None
    expected = np.maximum(line.intercept + line.slope * x, LEAST * sizes.mean())
    factor = np.sqrt(np.mean(np.square(sizes / expected)))
    scatter = np.sqrt(np.sum(np.square(residuals)) / (len(residuals) - design.shape[1]))
    return with_least((float(factor * line.intercept), float(factor * line.slope)), float(scatter))


def line_of_row(row):
    """Return the line from a row of PorosityModel.to_rows, or None; files of earlier versions have none."""
    line = tuple(float(row.get(name, np.nan)) for name in ("scatter_intercept", "scatter_slope"))
    return with_least(line, float(row["scatter"])) if np.isfinite(line).all() else None


def with_least(line, scatter):
    """Return the line (intercept, slope) of a fit with its other values; scatter: over all samples of the fit."""
    return *line, LEAST * scatter, 0.0


def with_constant(line, variance):
    """Return a line whose scatter has another part that is the same for all forms, of this variance."""
    return *line[:3], float(np.sqrt(line[3] ** 2 + variance))


def scatter_of(design, scatter, line):
    """Return the scatter (n,) for rows of a design; scatter: over all samples; line: from scatter_line, or None."""
    if line is None:
        return np.full(len(design), scatter)
    intercept, slope, least, constant = line
    return np.hypot(np.maximum(intercept + slope * design[:, 1], least), constant)


def covariance_of(design, scatter):
    """Return the covariance of the coefficients of least squares, if the samples have the standard deviations (n,)."""
    projection = np.linalg.pinv(design) * scatter
    return projection @ projection.T
