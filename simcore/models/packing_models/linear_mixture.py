"""Linear-mixture packing model: classes of similar size mix, others fill or occupy as in the linear packing model.

Equations: Yu and Standish (1991), with the window of mixing classes as Frings et al. (2008) modified it. Classes whose
size ratio to the controlling class is at least MIXING form one component. The model jumps where a ratio crosses MIXING
or STRONG. Splitting a class changes its result, because one term is the skewness of two components. Its ten constants
are fitted to poured spheres and sand.
"""

import numpy as np

from simcore.models.packing_models.classes import check_classes, porosity_of_volume, size_ratios, specific_volume
from simcore.models.packing_models.linear import filling, occupying

MIXING = 0.154  # smallest ratio of a class that mixes with the controlling class
STRONG = 0.741  # largest ratio of a pair whose mixing changes the volume


def linear_mixture(sizes, fractions, porosities):
    """Return the porosity (...,) by the linear-mixture packing model; arguments (..., k) as for check_classes."""
    sizes, fractions, porosities = check_classes(sizes, fractions, porosities)
    V = specific_volume(porosities)
    r, coarser = size_ratios(sizes)
    slack = 1e-12  # a ratio on the limit counts the same however it was computed
    mixes = r >= MIXING - slack
    y = fractions[..., None, :]
    share = np.sum(np.where(mixes, y, 0), axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):  # classes without mass may have no component
        x = np.where(mixes, y, 0) / share[..., None]
    x = np.nan_to_num(x)
    mean = np.sum(x * V[..., None, :], axis=-1)
    mean = np.where(share > 0, mean, 1.5)  # any finite volume
    density = 1 / mean
    # Pairs (h, l) with h coarser than l: the entry [l, h] of `coarser` says so.
    active = coarser & (r <= STRONG + slack)
    linear_part = np.where(active, _symmetric(r), 0)
    skewed_part = np.where(active, _skewed(r), 0)
    product = np.einsum("...il,...ih,...lh->...i", x, x, linear_part)
    skewed = np.einsum("...il,...ih,...lh->...i", x, x**2, skewed_part)
    skewed -= np.einsum("...il,...ih,...lh->...i", x**2, x, skewed_part)
    mixed = mean + _symmetric_strength(density) * product + _skewed_strength(density) * skewed
    m = mixed[..., None]
    outside = np.where(coarser, m - (m - 1) * occupying(r), m * (1 - filling(r)))
    T = share * mixed + np.sum(np.where(mixes, 0, y * outside), axis=-1)
    return porosity_of_volume(np.max(np.where(fractions > 0, T, -np.inf), axis=-1))


def _symmetric_strength(density):
    return 10.288 * 10 ** (-1.4566 * density)


def _symmetric(r):
    return -1.0002 + 0.1126 * r + 5.8455 * r**2 - 7.9488 * r**3 + 3.1222 * r**4


def _skewed_strength(density):
    return -1.3092 + 15.039 * density - 37.453 * density**2 + 40.869 * density**3 - 17.110 * density**4


def _skewed(r):
    return -1.0029 + 0.3589 * r + 10.970 * r**2 - 22.197 * r**3 + 12.434 * r**4
