# ruff: noqa: E741  L, I, S are the field's names of the axes
"""Form of a grain: mass-equivalent ellipsoid, sieve size, and the 13 form factors with their inverses."""

import numpy as np
import pandas as pd

# Share of the longest axis. Axes whose difference is smaller are equal; it is then the rounding of a computed mesh.
EQUAL_AXES = 1e-9


def _disc_rod(L, I, S):
    """Return (L - I) / (L - S): 0 for grains with L = I, and nan for those with L = S."""
    span, first = L - S, L - I
    return np.where(first > EQUAL_AXES * L, first, 0.0) / np.where(span > EQUAL_AXES * L, span, np.nan)


# Table 1 of Rettinger et al. (2022), in its order. L >= I >= S > 0 in any one unit of length.
FORM_FACTORS = {
    "FL": lambda L, I, S: S / I,
    "EL": lambda L, I, S: I / L,
    "EQ": lambda L, I, S: S / L,
    "ASF": lambda L, I, S: L * S / I**2,
    "CSF": lambda L, I, S: S / np.sqrt(L * I),
    "DRI": _disc_rod,
    "IFI": lambda L, I, S: (L + S) / I,
    "IRI": lambda L, I, S: (S + I) / L,
    "JFF": lambda L, I, S: S / np.sqrt((L**2 + I**2 + S**2) / 3),
    "KIS": lambda L, I, S: np.cbrt(I * S / L**2),
    "MPS": lambda L, I, S: np.cbrt(S**2 / (L * I)),
    "OPI": lambda L, I, S: 10 * (_disc_rod(L, I, S) - 0.5) / (S / L),
    "WFI": lambda L, I, S: (L + I) / (2 * S),
}


def mass_equivalent_axes(second_moments):
    """Return the full axes (L, I, S) [m], longest first, of the homogeneous ellipsoid with the same second moments.

    second_moments: the three principal means <x_i²> over the volume [m²], any order, shape (..., 3).
    An ellipsoid of semi-axis a has <x²> = a²/5. In terms of the moments of inertia this is
    a = sqrt(5 (-I_x + I_y + I_z) / (2 m)) of Rettinger et al. (2022), because (-I_x + I_y + I_z) / 2 = m <x²>.
    """
    axes = 2 * np.sqrt(5 * np.sort(np.asarray(second_moments, float), axis=-1))
    return axes[..., 2], axes[..., 1], axes[..., 0]


def sieve_size(I, S):
    """Return the sieve size D = sqrt((S² + I²) / 2) [m], the square opening that the ellipse (I, S) just passes."""
    return np.sqrt((np.asarray(S) ** 2 + np.asarray(I) ** 2) / 2)


def equal_volume_diameter(volume):
    """Return the diameter [m] of the sphere that has a volume [m³]."""
    return np.cbrt(6.0 / np.pi * volume)


def axes_from_form(sieve_size, flatness, elongation):
    """Return the full axes (L, I, S) [m] of the ellipsoid with this sieve size [m], FL = S/I and EL = I/L."""
    I = np.sqrt(2 / (1 + np.asarray(flatness) ** 2)) * sieve_size
    return I / elongation, I, flatness * I


def sieve_size_of_volume(diameter, flatness, elongation):
    """Return the sieve size [m] of the ellipsoid of FL = S/I and EL = I/L that has the volume of a sphere.

    diameter: of the sphere [m].
    """
    L, I, S = axes_from_form(1.0, flatness, elongation)
    return diameter / np.cbrt(L * I * S)


def ellipsoid_sphericity(L, I, S):
    """Return the Wadell sphericity of the ellipsoid with full axes L, I, S, about the roundest grain of its form.

    Its surface is 4 pi R_G(b²c², a²c², a²b²) with Carlson's symmetric integral (Carlson 1995).
    """
    from scipy.special import elliprg  # imported here because it loads slowly and most commands do not need it

    a, b, c = (np.asarray(axis, float) / 2 for axis in (L, I, S))
    surface = 4 * np.pi * elliprg((b * c) ** 2, (a * c) ** 2, (a * b) ** 2)
    return np.pi ** (1 / 3) * (8 * np.pi * a * b * c) ** (2 / 3) / surface


def form_factors(L, I, S):
    """Return the 13 form factors as a DataFrame (n, 13), dimensionless, in the order of FORM_FACTORS.

    L >= I >= S > 0: full axes, scalars or (n,), in one unit of length; ValueError otherwise.
    Not every factor is finite for every grain: DRI and OPI are nan for a sphere (0/0). There is no warning; the caller
    drops values that are not finite.
    """
    L, I, S = (np.atleast_1d(np.asarray(a, float)) for a in (L, I, S))
    slack = 1 - 1e-12  # equal axes may differ by round-off
    if not (np.all(S > 0) and np.all(I >= S * slack) and np.all(L >= I * slack)):
        raise ValueError("form factors need L >= I >= S > 0; sort the axes of each grain, longest first")
    with np.errstate(divide="ignore", invalid="ignore"):
        return pd.DataFrame({name: factor(L, I, S) for name, factor in FORM_FACTORS.items()})


def features(L, I, S):
    """Return the 26 features of the models, DataFrame (n, 26): the 13 form factors X, then their inverses X_inv.

    A feature is not finite if its factor is not finite (see form_factors), or if it is the inverse of zero: DRI_inv for
    L = I, OPI_inv (inf) for OPI = 0.
    """
    factors = form_factors(L, I, S)
    with np.errstate(divide="ignore", invalid="ignore"):
        inverses = (1 / factors).add_suffix("_inv")
    return pd.concat([factors, inverses], axis=1)
