"""Stratified random numbers: the grains of a packing represent their sieve curve and their forms instead of scattering.

Sizes and forms are drawn by inversion of uniform numbers (simcore.grains.sampling). A draw by quota replaces these
numbers by stratified ones; the inversion stays the same:

    class            each sieve class gets the number of grains that its mass fraction requires
    size in a class  the mid-quantiles (k + 1/2) / m of its m grains
    shape and form   one random number in each of m equal strata, independently for shape, flatness and elongation

The strata of a class are shuffled, and so is the order of the classes. Sizes take mid-quantiles, because one stone of a
wide class may be a large share of its mass. Forms take random numbers within the strata, because mid-quantiles of few
grains have a smaller variance than their distribution.
"""

import numpy as np

from simcore.grains.sieve import SieveCurve

# Columns of the random numbers of a grain, (n, NUMBERS_PER_GRAIN).
NUMBERS_PER_GRAIN = 8
SIZE_CLASS, SIZE_IN_CLASS, SHAPE, FLATNESS, ELONGATION = range(5)
_ORDER = 5  # column of the shuffling stream that orders the classes


def stratify(curve, uniforms, shuffle):
    """Return stratified uniform numbers (n, NUMBERS_PER_GRAIN) for the n grains of a packing.

    curve: SieveCurve; sizes of another kind count as one class. uniforms, shuffle (n, NUMBERS_PER_GRAIN): independent
    random numbers in (0, 1); the first are the positions within the strata, the second order grains and strata.
    """
    n = len(uniforms)
    sieved = isinstance(curve, SieveCurve)
    shares = curve.number_fractions() if sieved else np.ones(1)
    numbers = largest_remainder(shares, n)
    edges = np.concatenate([[0.0], np.cumsum(shares) / shares.sum()])
    class_of_grain = np.empty(n, np.int64)
    class_of_grain[np.argsort(shuffle[:, _ORDER], kind="stable")] = np.repeat(np.arange(len(numbers)), numbers)
    start = np.cumsum(numbers) - numbers
    stratified = uniforms.copy()
    for column in (SIZE_IN_CLASS, SHAPE, FLATNESS, ELONGATION):
        rank = np.empty(n, np.int64)
        rank[np.lexsort((shuffle[:, column], class_of_grain))] = np.arange(n)
        rank -= start[class_of_grain]
        within = 0.5 if column == SIZE_IN_CLASS else uniforms[:, column]
        stratified[:, column] = (rank + within) / numbers[class_of_grain]
    if sieved:
        stratified[:, SIZE_CLASS] = 0.5 * (edges[:-1] + edges[1:])[class_of_grain]
    else:
        stratified[:, SIZE_CLASS] = stratified[:, SIZE_IN_CLASS]  # BetaSizes are drawn from the first number
    return stratified


def largest_remainder(shares, total):
    """Return whole numbers (k,) with sum `total`, each the floor or the ceiling of its share of it.

    shares (k,): not negative, with a positive sum. What the floors leave goes to the largest remainders, of equal ones
    to the first; a share of 0 gets 0.
    """
    exact = np.asarray(shares, float) / np.sum(shares) * total
    numbers = np.floor(exact).astype(np.int64)
    order = np.argsort(-(exact - numbers), kind="stable")
    numbers[order[: total - numbers.sum()]] += 1
    return numbers
