"""Statistics of axes in space (unit vectors u, where u and -u are the same axis) relative to the vertical.

theta is the angle between an axis and the vertical, 0 to pi/2. P2 = (3 <cos² theta> - 1) / 2 is 1 if all axes are
vertical, -1/2 if all are horizontal, and 0 if they are isotropic. A weight is the number of times that a vector counts.
Standard errors assume that the vectors are independent, not the items that the weights count.
"""

import numpy as np
from scipy.spatial.transform import Rotation
from scipy.special import eval_legendre

ORDERS = (2, 4, 6)  # of Legendre polynomials
# Twofold: one preferred horizontal direction; fourfold: two at right angles, which a square box may cause.
FOLDS = (2, 4)
MAGIC_ANGLE = float(np.arccos(1.0 / np.sqrt(3.0)))  # 54.7°, where P2 vanishes
# Minimum relative difference of two axes of a grain above which their directions are defined, above round-off.
DISTINCT = 1e-6


def equal_solid_angles(n_bins):
    """Return the edges (n_bins + 1,) [rad], increasing, of bins of equal solid angle from vertical to horizontal."""
    return np.arccos(np.linspace(1.0, 0.0, n_bins + 1))


def density_per_solid_angle(directions, weights, edges):
    """Return the share of the axes in each bin divided by the bin's share of the hemisphere, and its standard error.

    Both are (k,). directions (n, 3), weights (n,); edges (k + 1,): angles with the vertical, increasing from 0 to pi/2
    [rad]; ValueError otherwise. The density is 1 for isotropic axes and nan without axes. The error of an empty bin is
    0, which only means that there are too few axes.
    """
    edges = np.asarray(edges, float)
    if not (np.all(np.diff(edges) > 0.0) and edges[0] == 0.0 and np.isclose(edges[-1], 0.5 * np.pi, rtol=1e-12)):
        raise ValueError("density_per_solid_angle: edges must increase from 0 to pi/2 [rad]; sort and complete them")
    heights = np.cos(edges)[::-1]  # increasing heights of the edges on the unit sphere
    height = np.minimum(np.abs(directions[:, 2]), 1.0)
    upper_edge = np.clip(np.searchsorted(heights, height, side="right"), 1, len(heights) - 1)
    n_bins = len(edges) - 1
    mean, error = mean_and_error(np.eye(n_bins)[n_bins - upper_edge], weights)
    return mean / -np.diff(np.cos(edges)), error / -np.diff(np.cos(edges))


def legendre_moments(directions, weights, orders=ORDERS):
    """Return the means of P_l(cos theta), (l,), which are 0 for isotropic axes, and their standard errors, (l,).

    The density per solid angle has the series f(theta) = sum over even l of (2 l + 1) <P_l> P_l(cos theta).
    """
    return mean_and_error(eval_legendre(np.array(orders), directions[:, 2, None]), weights)


def second_rank_tensor(directions, weights):
    """Return the mean of u ⊗ u, (3, 3), with trace 1 and I/3 for isotropic axes, and its standard errors, (3, 3)."""
    return mean_and_error(directions[:, :, None] * directions[:, None, :], weights)


def tensor_invariants(tensor):
    """Return the invariants of a second-rank tensor F of trace 1, dict: eigenvalues, anisotropy, determinant.

    The eigenvalues (3,) are in descending order. With the deviator D = F - I/3, the anisotropy is √(3/2 D:D); for axial
    symmetry it is the distance of the eigenvalue along the axis from the other two. The determinant is that of D:
    positive for one long direction, negative for one short direction. The anisotropy of a finite sample is positive
    even if the material is isotropic; its root mean square for N isotropic axes is 1/√N.
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
    """Return the means of cos(m phi) and sin(m phi) over the axes for each fold m, (m, 2), and the number of axes.

    phi: azimuth from the x axis; vertical axes have none and do not count. The number is (sum w)² / sum w², that of
    equally weighted axes with the same error.
    """
    x, y, _ = directions.T
    inclined = np.hypot(x, y) > 1e-9
    phi, weights = np.arctan2(y[inclined], x[inclined]), weights[inclined]
    angle = np.multiply.outer(phi, np.array(folds))
    mean, _ = mean_and_error(np.stack([np.cos(angle), np.sin(angle)], axis=-1), weights)
    return mean, weights.sum() ** 2 / np.sum(weights**2) if len(weights) else 0.0


def rayleigh_test(resultant, number):
    """Return the p-value of a resultant |<exp(i m phi)>| for `number` independent uniform azimuths, in its shape.

    Zar's approximation (Biostatistical Analysis, 1999, eq. 27.4), correct to 0.001 for at least 10 azimuths.
    """
    length = number * np.asarray(resultant)
    exponent = np.sqrt(1.0 + 4.0 * number + 4.0 * (number**2 - length**2)) - (1.0 + 2.0 * number)
    return np.exp(np.minimum(exponent, 0.0))


def grain_axes(packing):
    """Return the directions of the grains' long and short axes, dict of (axes (k, 3), indices of the grains (k,)).

    A grain's own z is its longest axis, its x the shortest (simcore.grains). An axis counts if it is longer, or
    shorter, than the middle one by more than round-off: spheres have none, prolate spheroids no short axis, oblate ones
    no long axis. ValueError if the semi-axes of an ellipsoid are not in that order.
    """
    check_order_of_axes(packing)
    longest, middle, shortest = (packing[name].values for name in "LIS")
    axes = Rotation.from_quat(packing["orientation"].values, scalar_first=True).as_matrix()
    long_ones = np.flatnonzero(longest > (1.0 + DISTINCT) * middle)
    short_ones = np.flatnonzero(middle > (1.0 + DISTINCT) * shortest)
    return {"long_axis": (axes[long_ones, :, 2], long_ones), "short_axis": (axes[short_ones, :, 0], short_ones)}


def check_order_of_axes(packing):
    """Raise ValueError unless the semi-axes of each ellipsoid increase from its x to its z."""
    scale = packing["scale"].values
    is_ellipsoid = packing["shape_kind"].values.astype(str)[packing["shape"].values] == "sphere"
    disordered = np.flatnonzero(is_ellipsoid & (np.diff(scale, axis=1) < -DISTINCT * scale[:, :1]).any(axis=1))
    if len(disordered):
        raise ValueError(
            f"packing: grain {disordered[0]} has the semi-axes {scale[disordered[0]]} m along its x, y, z; they must "
            "increase from x to z, so that z is its long axis; rotate the grain"
        )


def mean_and_error(values, weights):
    """Return the weighted mean over the first axis of values (n, ...), and its standard error.

    Both are nan without values; the error is nan with a single one.
    """
    total, n = weights.sum(), len(weights)
    if not total > 0.0:
        return np.full(values.shape[1:], np.nan), np.full(values.shape[1:], np.nan)
    mean = np.tensordot(weights, values, axes=1) / total
    if n < 2:
        return mean, np.full(values.shape[1:], np.nan)
    squares = np.tensordot(weights**2, (values - mean) ** 2, axes=1)
    return mean, np.sqrt(squares * n / (n - 1)) / total
