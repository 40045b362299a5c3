"""Statistics of axes in space, unit vectors without a sense, about the vertical.

The angle theta is that against the vertical, 0 to pi/2. P2 = (3 <cos² theta> - 1) / 2 is 1 where all axes stand
upright, -1/2 where all lie horizontal, 0 where they point anywhere. Weights say how often a vector counts; standard
errors take the vectors, not what they count, as independent.
"""

import numpy as np
from scipy.spatial.transform import Rotation
from scipy.special import eval_legendre

ORDERS = (2, 4, 6)  # of Legendre polynomials
# Twofold: a preferred horizontal direction; fourfold: two at right angles, as a square box could give them.
FOLDS = (2, 4)
MAGIC_ANGLE = float(np.arccos(1.0 / np.sqrt(3.0)))  # 54.7°, where P2 vanishes
# An axis is known where it differs by more than this, relative, from the next one: beyond the axes' own round-off.
_DISTINCT = 1e-6


def equal_solid_angles(n_bins):
    """Edges of bins of equal solid angle from the vertical to the horizontal, (n_bins + 1,) [rad], increasing."""
    return np.arccos(np.linspace(1.0, 0.0, n_bins + 1))


def density_per_solid_angle(directions, weights, edges):
    """Share of the axes in each bin over its share of the hemisphere, (k,), and its standard error, (k,).

    directions (n, 3), weights (n,); edges (k + 1,) of the angle against the vertical, increasing from 0 to pi/2 [rad].
    Isotropic axes give 1. nan without axes; the error of an empty bin is 0, of which too few axes are the reason.
    """
    edges = np.asarray(edges, float)
    if not (np.all(np.diff(edges) > 0.0) and edges[0] == 0.0 and np.isclose(edges[-1], 0.5 * np.pi, rtol=1e-12)):
        raise ValueError("density_per_solid_angle: edges must increase from 0 to pi/2 [rad]; sort and complete them")
    sines = np.cos(edges)[::-1]  # increasing heights on the unit sphere
    height = np.minimum(np.abs(directions[:, 2]), 1.0)
    inside = np.clip(np.searchsorted(sines, height, side="right"), 1, len(sines) - 1)
    n_bins = len(edges) - 1
    mean, error = mean_and_error(np.eye(n_bins)[n_bins - inside], weights)
    return mean / -np.diff(np.cos(edges)), error / -np.diff(np.cos(edges))


def legendre_moments(directions, weights, orders=ORDERS):
    """Means of P_l(cos theta), (l,), and their standard errors, (l,); 0 for isotropic axes.

    The density per solid angle has the series f(theta) = sum over even l of (2 l + 1) <P_l> P_l(cos theta).
    """
    return mean_and_error(eval_legendre(np.array(orders), directions[:, 2, None]), weights)


def second_rank_tensor(directions, weights):
    """Mean of u ⊗ u, (3, 3), trace 1, isotropic I/3, and standard errors, (3, 3)."""
    return mean_and_error(directions[:, :, None] * directions[:, None, :], weights)


def tensor_invariants(tensor):
    """Invariants of a second-rank tensor of trace 1, dict: eigenvalues (3,), descending; anisotropy; determinant.

    With its deviator D = F - I/3 the anisotropy is √(3/2 D:D), for axial symmetry the distance of the eigenvalue along
    the axis from the other two; the determinant of D tells one long direction (+) from one short one (-). A finite
    sample's anisotropy is above 0 even where the material's is not: of N isotropic axes 1/√N on root mean square.
    """
    if not np.isfinite(tensor).all():
        return {"eigenvalues": np.full(3, np.nan), "anisotropy": np.nan, "determinant": np.nan}
    deviator = tensor - np.eye(3) / 3.0
    return {
        "eigenvalues": np.linalg.eigvalsh(tensor)[::-1],
        "anisotropy": np.sqrt(1.5 * np.sum(deviator**2)),
        "determinant": np.linalg.det(deviator),
    }


def azimuth_moments(directions, weights, folds=FOLDS):
    """Means of cos(m phi) and sin(m phi) over the axes for each fold m, (m, 2), and how many axes they stand for.

    phi: azimuth from the x axis; upright axes have none and do not count. The number (sum w)² / sum w² is that of
    equally weighted axes of the same error.
    """
    x, y, _ = directions.T
    leaning = np.hypot(x, y) > 1e-9
    phi, weights = np.arctan2(y[leaning], x[leaning]), weights[leaning]
    angle = np.multiply.outer(phi, np.array(folds))
    mean, _ = mean_and_error(np.stack([np.cos(angle), np.sin(angle)], axis=-1), weights)
    return mean, weights.sum() ** 2 / np.sum(weights**2) if len(weights) else 0.0


def rayleigh_test(resultant, number):
    """p-value of a resultant |<exp(i m phi)>| of that many independent uniform azimuths, of the resultant's shape.

    Zar's approximation (Biostatistical Analysis, 1999, eq. 27.4), right to 0.001 from 10 azimuths on.
    """
    length = number * np.asarray(resultant)
    exponent = np.sqrt(1.0 + 4.0 * number + 4.0 * (number**2 - length**2)) - (1.0 + 2.0 * number)
    return np.exp(np.minimum(exponent, 0.0))


def grain_axes(packing):
    """Directions of the grains' long and short axes, dict of (axes (k, 3), grains (k,)).

    The body's own z is its longest axis, x its shortest (simcore.grains). Grains count where the axis is the longest,
    or shortest, by more than round-off: spheres have none, prolate spheroids no short one, oblate ones no long one.
    ValueError for ellipsoids whose semi-axes are not in that order.
    """
    scale = packing["scale"].values
    smooth = packing["shape_kind"].values.astype(str)[packing["shape"].values] == "sphere"
    wrong = np.flatnonzero(smooth & (np.diff(scale, axis=1) < -_DISTINCT * scale[:, :1]).any(axis=1))
    if len(wrong):
        raise ValueError(
            f"grain_axes: grain {wrong[0]} has the semi-axes {scale[wrong[0]]} m along its x, y, z; they must increase "
            "from x to z, so that z is its long axis: turn the grain"
        )
    longest, middle, shortest = (packing[name].values for name in "LIS")
    axes = Rotation.from_quat(packing["orientation"].values, scalar_first=True).as_matrix()
    long_ones = np.flatnonzero(longest > (1.0 + _DISTINCT) * middle)
    short_ones = np.flatnonzero(middle > (1.0 + _DISTINCT) * shortest)
    return {"long_axis": (axes[long_ones, :, 2], long_ones), "short_axis": (axes[short_ones, :, 0], short_ones)}


def mean_and_error(values, weights):
    """Weighted mean over the first axis of values (n, ...), and its standard error; nan without, or with one value."""
    total, n = weights.sum(), len(weights)
    if not total > 0.0:
        return np.full(values.shape[1:], np.nan), np.full(values.shape[1:], np.nan)
    mean = np.tensordot(weights, values, axes=1) / total
    if n < 2:
        return mean, np.full(values.shape[1:], np.nan)
    squares = np.tensordot(weights**2, (values - mean) ** 2, axes=1)
    return mean, np.sqrt(squares * n / (n - 1)) / total
