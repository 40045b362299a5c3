"""Packing models of a sieve curve that give the one-class porosity exactly for a bed of one class.

The one-class porosity n1 belongs to beds of a sieve class as wide as REFERENCE, which is that of U1. Its parts mix by
themselves. Therefore each model first finds the porosity b of grains of one size with which it gives n1 for that class,
and uses b for the parts of the curve. A curve in few or in many classes then has one answer, and U1 has n1.
"""

from functools import lru_cache

import numpy as np
from scipy.interpolate import interp1d

from simcore.grains.sieve import SieveCurve
from simcore.models.packing_models import linear as published
from simcore.models.packing_models.classes import porosity_of_volume, specific_volume
from simcore.models.packing_models.compressible import compressible
from simcore.models.packing_models.curves import parts
from simcore.models.packing_models.linear import linear
from simcore.models.packing_models.rods import RODS, factor_of, rod_lengths, solid_fraction
from simcore.models.size_and_form.one_class import LARGEST, LEAST

REFERENCE = SieveCurve([5.6e-3, 8e-3], [1.0], "U1")
ROUNDS, TOLERANCE = 60, 1e-13
NODES = 81  # one-class porosities at which the factor of the rods is tabulated


def least_porosity(curve, one_class):
    """Return the porosity (...,) of a bed in which fine grains fill the pores of coarse ones without a gap.

    The grains of a part of the curve as wide as REFERENCE have the volume of a bed of one class, all coarser grains add
    their own volume, and all finer ones lie in the pores. The part for which the bed is largest counts. A real bed is
    looser, unless its coarse grains are denser than without the fine ones. Mass is uniform in log D within a class.
    one_class: as for `_calibrated`.
    """
    volume = specific_volume(by_class(curve, one_class))
    logs, width = np.log(curve.bounds), np.log(REFERENCE.largest / REFERENCE.least)
    # The volume is piecewise linear in the upper end of the part, so that it is largest at one of these ends.
    ends = np.concatenate([logs, logs[:-1] + width])
    masses, volumes = (_cumulated(logs, values) for values in (curve.mass_fractions, curve.mass_fractions * volume))
    filled = 1 - masses(ends) + volumes(ends) - volumes(ends - width)
    return porosity_of_volume(filled.max(axis=-1))


def _cumulated(logs, values):
    """Return the function of log D that is the sum of values (..., k) of classes below it, linear within a class."""
    sums = np.concatenate([np.zeros((*values.shape[:-1], 1)), np.cumsum(values, axis=-1)], axis=-1)
    return interp1d(logs, sums, bounds_error=False, fill_value=(sums[..., 0], sums[..., -1]))


def power_functions(p, q, s):
    """Return f(r) = (1-r)^p (1 + q r) and g(r) = (1-r)^s, with slope 0 at r = 1 for p, s > 1."""
    return (lambda r: (1 - r) ** p * (1 + q * r)), (lambda r: (1 - r) ** s)


def linear_skeleton(curve, one_class, stretch=1.0, law="number", functions=(published.filling, published.occupying)):
    """Return the porosity (...,) by the linear packing model; arguments as for `_calibrated`."""

    def model(sizes, fractions, porosities, m):
        return linear(sizes, fractions, porosities, m, functions)

    return _calibrated(model, curve, one_class, stretch, law)


def compressible_skeleton(
    curve, one_class, K, stretch=1.0, law="number", functions=(published.filling, published.occupying)
):
    """Return the porosity (...,) by the compressible packing model with compaction index K (number)."""

    def model(sizes, fractions, porosities, m):
        return compressible(sizes, fractions, porosities, K, m, functions)

    return _calibrated(model, curve, one_class, stretch, law)


def rods_skeleton(curve, one_class, stretch=1.0, law="number", number=RODS):
    """Return the porosity (...,) by rods on a line; number: of rods. Other arguments as for `_calibrated`.

    # ASSUME: if one-class porosity or stretch differ between classes, their means by mass apply to all rods.
    """
    one_class, stretch = by_class(curve, one_class), by_class(curve, stretch)
    volume, m = specific_volume(one_class) @ curve.mass_fractions, stretch @ curve.mass_fractions
    sizes, fractions, _ = parts(curve, law)
    reference_sizes, reference_fractions = _reference_parts(law)
    shape = np.broadcast_shapes(volume.shape, m.shape)
    porosity = np.empty(shape)
    for index in np.ndindex(shape):
        V, exponent = np.broadcast_to(volume, shape)[index], np.broadcast_to(m, shape)[index]
        factor = np.exp(np.interp(1 - 1 / V, *rods_factors(number)))
        mixed = solid_fraction(rod_lengths(sizes**exponent, fractions, number), factor)
        one = solid_fraction(rod_lengths(reference_sizes**exponent, reference_fractions, number), factor)
        # The last factor corrects what the table of f and the stretch of one class leave, and is close to 1.
        porosity[index] = porosity_of_volume(min(V * one / mixed, V))
    return porosity


def _calibrated(model, curve, one_class, stretch, law):
    """Return the porosity (...,) of a curve by a model whose one-size porosities are set by REFERENCE.

    model(sizes, fractions, porosities, stretch) -> (...,). one_class: porosity of beds of one class, a number, (..., 1)
    for all classes, or (..., k) by class; stretch likewise. The result is at most what the classes would give if they
    did not interact, so that a curve narrower than REFERENCE has n1.
    """
    one_class, stretch = by_class(curve, one_class), by_class(curve, stretch)
    sizes, fractions, classes = parts(curve, law)
    reference_sizes, reference_fractions = _reference_parts(law)
    one_class, stretch = np.broadcast_arrays(one_class, stretch)
    b = one_class.copy()
    for _ in range(ROUNDS):
        left = one_class - model(reference_sizes, reference_fractions, b[..., None], stretch[..., None])
        b = b + left
        if np.all(np.abs(left) <= TOLERANCE):
            break
    n = model(sizes, fractions, b[..., classes], stretch[..., classes])
    return np.minimum(n, porosity_of_volume(specific_volume(one_class) @ curve.mass_fractions))


@lru_cache(maxsize=4)
def _reference_parts(law):
    return parts(REFERENCE, law)[:2]


def by_class(curve, values):
    """Return values (..., k) for the classes of a curve, from a number, (..., 1) or (..., k)."""
    values = np.atleast_1d(np.asarray(values, float))
    k = len(curve.mass_fractions)
    if values.shape[-1] not in (1, k):
        raise ValueError(f"{curve.name}: {values.shape[-1]} values do not fit {k} classes; give one, or one per class")
    return np.broadcast_to(values, (*values.shape[:-1], k))


@lru_cache(maxsize=4)
def rods_factors(number=RODS):
    """Return one-class porosities and the logarithms of the factor of the rods for them, without stretch."""
    sizes, fractions, _ = parts(REFERENCE)
    lengths = rod_lengths(sizes, fractions, number)
    nodes = np.linspace(LEAST, LARGEST, NODES)
    return nodes, np.log([factor_of(n, lengths) for n in nodes])
