"""Rods on a line: porosity of a mixture from the chords that a random line cuts from its grains (Farr and Groot 2009).

A random line cuts spheres of diameter D into rods of length L < D with the density 2 L / D², and meets them in
proportion to their number times D². The rods, longest first, are placed into the largest gap between those placed
before. Each keeps the distance f L, with one factor f for all rods, from both neighbours. The solid fraction is the
length of the rods over that of rods and gaps. Equal spheres have the solid fraction 0.6435 at f = 0.7654. f is set here
so that a bed of one class has a given porosity. Sizes do not interact in classes, so splitting a class changes nothing.
"""

from functools import lru_cache

import numpy as np
from scipy.optimize import brentq

from simcore.compilation import kernel
from simcore.models.packing_models.classes import check_classes

RODS = 8000
SMALLEST_FACTOR, LARGEST_FACTOR = 0.05, 20.0  # of f, between which a one-class porosity is searched
NODES = 200  # one-class porosities at which f is tabulated


def rod_lengths(sizes, fractions, number=RODS):
    """Return the lengths (number,) of rods at equal quantiles of their law, longest first, in the unit of the sizes.

    sizes, fractions (k,): of the classes.
    """
    order = np.argsort(sizes)
    squares = np.asarray(sizes, float)[order] ** 2
    met = np.asarray(fractions, float)[order] / np.sqrt(squares)  # number times D² = y / D³ times D²
    met = met / met.sum()
    # The share of rods shorter than √s is Σ met min(1, s / D²), which is linear in s between the squares of the sizes.
    knots = np.concatenate([[0.0], squares])
    share = np.minimum(1.0, knots[:, None] / squares).astype(float) @ met
    quantiles = (np.arange(number, 0, -1) - 0.5) / number
    return np.sqrt(np.interp(quantiles, share, knots))


@kernel
def total_gap(lengths, factor):
    """Return the length of all gaps after the rods (n,), longest first, are placed on a periodic line."""
    n = len(lengths)
    gaps = np.empty(n)  # heap with the largest gap at its root
    gaps[0] = factor * lengths[0]
    for count in range(1, n):
        length = lengths[count]
        least = factor * length
        second = max(gaps[0] - length - least, least)
        # The root becomes the smaller of the two new gaps, or whichever; it sinks, the other rises from the end.
        node, value = 0, least
        while True:
            child = 2 * node + 1
            if child >= count:
                break
            if child + 1 < count and gaps[child + 1] > gaps[child]:
                child += 1
            if gaps[child] <= value:
                break
            gaps[node] = gaps[child]
            node = child
        gaps[node] = value
        node = count
        while node > 0 and gaps[(node - 1) // 2] < second:
            gaps[node] = gaps[(node - 1) // 2]
            node = (node - 1) // 2
        gaps[node] = second
    return gaps.sum()


def solid_fraction(lengths, factor):
    """Return the solid fraction of rods with these lengths (n,), longest first, at the factor f."""
    solid = lengths.sum()
    return float(solid / (solid + total_gap(lengths, float(factor))))


def factor_of(porosity, lengths):
    """Return f at which rods of these lengths (n,) have this porosity; ValueError if there is none."""

    def difference(log_factor):
        return 1 - solid_fraction(lengths, np.exp(log_factor)) - porosity

    low, high = np.log([SMALLEST_FACTOR, LARGEST_FACTOR])
    if difference(low) > 0 or difference(high) < 0:
        raise ValueError(
            f"rods on a line: no distance between rods gives the one-class porosity {porosity:.4g}; give one from "
            f"{1 - solid_fraction(lengths, SMALLEST_FACTOR):.2f} to {1 - solid_fraction(lengths, LARGEST_FACTOR):.2f}"
        )
    return float(np.exp(brentq(difference, low, high, xtol=1e-13)))


def rods(sizes, fractions, porosity, number=RODS):
    """Return the porosity of a mixture whose single classes all have the one-class porosity `porosity`.

    sizes, fractions (k,): of the classes. porosity: one number. number: of rods. The model does not broadcast: the
    result is that of one mixture. ValueError as for check_classes and factor_of, or if there is more than one porosity
    or mixture.
    """
    if np.ndim(porosity) > 0:
        raise ValueError(
            f"rods on a line: the one-class porosity has the shape {np.shape(porosity)}; give one number for all "
            "classes"
        )
    sizes, fractions, _ = check_classes(sizes, fractions, porosity)
    if sizes.ndim > 1:
        raise ValueError(
            f"rods on a line: sizes and fractions have the shape {sizes.shape}, which is more than one mixture; call "
            "the model once for each mixture"
        )
    lengths = rod_lengths(sizes, fractions, number)
    return 1 - solid_fraction(lengths, factor_of(float(porosity), _equal_rods(number)))


@lru_cache(maxsize=4)
def _equal_rods(number):
    return rod_lengths(np.ones(1), np.ones(1), number)
