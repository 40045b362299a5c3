"""Grains given by spherical-harmonic coefficients of their radius, as CT laboratories publish them."""

from pathlib import Path

import numpy as np
from scipy.special import sph_harm_y

from simcore.grains.spiral import spiral_directions


def read_coefficients(path):
    """Degrees n, orders m, and complex coefficients a_nm, each (k,), of a text file with rows `n m re im`.

    Lines that start with # are skipped. Rows may hold m >= 0 only (then a(n, -m) = (-1)^m conj a(n, m) is
    understood) or all m, as in the files of the VCCTL repository. ValueError if the rows are anything else.
    """
    try:
        lines = [line for line in Path(path).read_text().splitlines() if not line.startswith("#")]
        rows = np.loadtxt(lines, ndmin=2) if any(lines) else np.empty((0, 0))
    except ValueError as error:
        raise ValueError(f"{path}: not rows of `n m re im`: {error}") from None
    if rows.shape[0] == 0 or rows.shape[1] != 4:
        raise ValueError(f"{path}: needs rows of four numbers `n m re im`, got an array {rows.shape}")
    n, m = rows[:, 0].astype(int), rows[:, 1].astype(int)
    if not np.isfinite(rows).all():
        raise ValueError(f"{path}: coefficients with NaN or infinite values")
    if np.any(rows[:, :2] != np.stack([n, m], axis=1)) or np.any((n < 0) | (np.abs(m) > n)):
        raise ValueError(f"{path}: n and m must be integers with |m| <= n")
    if len(set(zip(n.tolist(), m.tolist(), strict=True))) < len(n):
        raise ValueError(f"{path}: a pair n, m occurs twice")
    return n, m, rows[:, 2] + 1j * rows[:, 3]


def radius(coefficients, directions):
    """r(theta, phi) = sum a_nm Y_nm along unit vectors (k, 3), in the coefficients' unit, shape (k,).

    Y_nm orthonormal with the Condon-Shortley phase. ValueError if the sum is not real, or not positive.
    """
    n, m, a = coefficients
    polar = np.arccos(np.clip(directions[:, 2], -1, 1))
    azimuth = np.arctan2(directions[:, 1], directions[:, 0])
    half = not np.any(m < 0)
    total = np.zeros(len(directions), complex)
    for degree, order, value in zip(n, m, a, strict=True):
        term = value * sph_harm_y(degree, order, polar, azimuth)
        total += 2 * term.real if half and order > 0 else term
    scale = np.abs(total).max()
    # a published file carries about ten digits, a truncated one six
    if np.abs(total.imag).max() > 1e-3 * scale:
        raise ValueError("coefficients do not sum to a real radius: check that a(n, -m) = (-1)^m conj a(n, m)")
    if total.real.min() <= 0:
        raise ValueError("the radius is not positive everywhere: the coefficients are no closed surface")
    return total.real


def sampled_directions(coefficients):
    """Directions (k, 3), evenly spread, in which the surface is taken, dense enough for the hull.

    16 (n_max + 1)² points, about eight to a wavelength of the highest degree, and at least 4000: the hull then
    has lost 0.3 % of its volume or less, against one of far more points.
    """
    return spiral_directions(max(4000, 16 * (int(coefficients[0].max()) + 1) ** 2))


def surface_points(coefficients):
    """Points (k, 3) on the surface, in the coefficients' unit, in sampled_directions."""
    directions = sampled_directions(coefficients)
    return radius(coefficients, directions)[:, None] * directions
