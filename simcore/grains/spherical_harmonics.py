"""Reads grains given by spherical-harmonic coefficients of their radius, as CT laboratories publish them."""

from pathlib import Path

import numpy as np
from scipy.special import sph_harm_y

from simcore.grains.spiral import spiral_directions


def read_coefficients(path):
    """Read degrees n, orders m, and complex coefficients a_nm, each (k,), from a text file with rows `n m re im`.

    Lines that start with #, and a first line with these names, are skipped. The rows contain only m >= 0, which implies
    a(n, -m) = (-1)^m conj a(n, m), or all m, as in the files of the VCCTL repository. ValueError if the rows are not of
    this kind.
    """
    rows = []
    for number, line in enumerate(Path(path).read_text(errors="replace").splitlines(), start=1):
        words = line.split()
        if not words or line.startswith("#") or not rows and [word.lower() for word in words] == ["n", "m", "re", "im"]:
            continue
        try:
            rows.append([float(word) for word in words])
        except ValueError:
            rows.append([])
        if len(rows[-1]) != 4:
            points = len(words) == 3 or len(line.replace(";", ",").split(",")) == 3
            hint = "; points are read from .xyz or .csv: rename the file" if points else ""
            raise ValueError(
                f"{path}, line {number}: '{line.strip()[:60]}' is no row of four numbers `n m re im`{hint}"
            )
    if not rows:
        raise ValueError(f"{path}: the file is empty; rows of four numbers `n m re im` are needed")
    rows = np.array(rows)
    n, m = rows[:, 0].astype(int), rows[:, 1].astype(int)
    if not np.isfinite(rows).all():
        raise ValueError(f"{path}: some coefficients are NaN or infinite; correct or remove their rows")
    if np.any(rows[:, :2] != np.stack([n, m], axis=1)) or np.any((n < 0) | (np.abs(m) > n)):
        raise ValueError(f"{path}: n and m must be integers with |m| <= n; correct the rows")
    if len(set(zip(n.tolist(), m.tolist(), strict=True))) < len(n):
        raise ValueError(f"{path}: a pair n, m occurs twice; remove one of the rows")
    return n, m, rows[:, 2] + 1j * rows[:, 3]


def cut_at(coefficients, degree):
    """Return the coefficients of at most this degree; all if it is None.

    ValueError if no coefficient has a degree as high.
    """
    n, m, a = coefficients
    if degree is None:
        return coefficients
    if n.max() < degree:
        raise ValueError(
            f"grains.degree is {degree}, but the highest degree of these coefficients is {n.max()}; lower it, or set "
            "it to null to use all coefficients"
        )
    return n[n <= degree], m[n <= degree], a[n <= degree]


def radius(coefficients, directions):
    """Return r(theta, phi) = sum a_nm Y_nm along unit vectors (k, 3), in the coefficients' unit, (k,).

    Y_nm are orthonormal with the Condon-Shortley phase. ValueError if the sum is not real or not positive.
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
    # Published files have about ten digits, truncated ones six.
    if np.abs(total.imag).max() > 1e-3 * scale:
        raise ValueError("the coefficients do not sum to a real radius; check that a(n, -m) = (-1)^m conj a(n, m)")
    if total.real.min() <= 0:
        raise ValueError(
            "the radius is not positive everywhere, so the coefficients do not describe a closed surface; correct them"
        )
    return total.real


def sampled_directions(coefficients):
    """Return evenly spread directions (k, 3) that sample the surface densely enough for its hull.

    There are 16 (n_max + 1)² directions, about eight per wavelength of the highest degree, and at least 4000. Compared
    with far more points, the hull then loses at most 0.3 % of its volume, or 1 % if a smooth grain is five times as
    long as wide.
    """
    return spiral_directions(max(4000, 16 * (int(coefficients[0].max()) + 1) ** 2))
