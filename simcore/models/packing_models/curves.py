"""From a sieve curve to size classes for a packing model, and the statistics of a curve that river predictors use.

A packing model takes a class for grains of one size. Wide classes are therefore divided into parts of equal width in
log D. How the mass is distributed over the parts is not known from sieving. Two laws:

    number  numbers are uniform in log D, so mass grows with D³: the grains that Scree draws (simcore.grains.sieve)
    mass    mass is uniform in log D: the usual interpolation of a measured curve

A model that depends on the distribution alone gives one answer for a curve in few or many classes, if the classes are
divided by the same law.
"""

import numpy as np

from simcore.grains.sieve import SieveCurve

WIDEST = 2 ** (1 / 12)  # ratio of the bounds of a part
LAWS = ("number", "mass")
TAIL = 0.01  # share of the mass at each end of a curve that its span and its gap leave out
IN_GAP = 0.01  # share of the mass that may lie in a gap
BEYOND = 1e-9  # share of the mass that is next to nothing


def parts(curve, law="number", widest=WIDEST):
    """Return sizes (p,) [m], volume fractions (p,) and classes (p,) of the parts of a SieveCurve's classes with mass.

    size: mean of log D over the part, by mass. class: index into curve.mass_fractions. widest: ratio of the bounds that
    no part exceeds. ValueError if the law is unknown or `widest` is not above 1.
    """
    if not widest > 1:
        raise ValueError(f"parts: the widest ratio {widest} is not above 1; give a ratio such as {WIDEST:.3f}")
    sizes, fractions, classes = [], [], []
    for index in np.flatnonzero(curve.mass_fractions):
        bounds = _divided(curve, index, widest)
        shares, logs = _by_law(bounds, law)
        sizes.append(np.exp(logs))
        fractions.append(curve.mass_fractions[index] * shares)
        classes.append(np.full(len(shares), index))
    return np.concatenate(sizes), np.concatenate(fractions), np.concatenate(classes)


def split(curve, number, law="number"):
    """Return the SieveCurve with every class divided into `number` classes of equal width in log D, by this law."""
    bounds, fractions = [curve.bounds[:1]], []
    for index, mass in enumerate(curve.mass_fractions):
        edges = np.geomspace(curve.bounds[index], curve.bounds[index + 1], number + 1)
        bounds.append(edges[1:])
        fractions.append(mass * _by_law(edges, law)[0])
    return SieveCurve(np.concatenate(bounds), np.concatenate(fractions), curve.name)


def quantile(curve, share):
    """Return the size [m] below which this share of the mass is, with mass uniform in log D within a class."""
    return float(np.exp(_log_quantiles(curve, np.array([share]))[0]))


def _log_quantiles(curve, shares):
    """Return the logarithms of the sizes [m] below which these shares (k,) of the mass are."""
    with_mass = np.flatnonzero(curve.mass_fractions > 0)
    cumulative = np.cumsum(curve.mass_fractions)
    wanted = shares * cumulative[-1]
    index = with_mass[np.searchsorted(cumulative[with_mass], wanted - 1e-12)]
    within = 1 - (cumulative[index] - wanted) / curve.mass_fractions[index]
    logs = np.log(curve.bounds)
    return logs[index] + within * (logs[index + 1] - logs[index])


def passing(curve, size):
    """Return the share of the mass finer than a size [m], or each of several, with mass uniform in log D in a class."""
    cumulative = np.concatenate([[0.0], np.cumsum(curve.mass_fractions)])
    return np.interp(np.log(size), np.log(curve.bounds), cumulative)


def span(curve):
    """Return the width of a SieveCurve: the ratio of the sizes below which 99 % and 1 % of the mass are."""
    return quantile(curve, 1.0 - TAIL) / quantile(curve, TAIL)


def gap(curve):
    """Return the widest gap of a SieveCurve: the largest ratio of sizes between which IN_GAP of the mass is.

    The coarsest and the finest 1 % of the mass do not count, as for `span`.
    """
    ends = np.cumsum(curve.mass_fractions) / np.sum(curve.mass_fractions)
    # The ratio is largest if the share begins at an end of a class, or ends just beyond one.
    starts = np.concatenate([ends, ends - IN_GAP + BEYOND, [TAIL, 1.0 - TAIL - IN_GAP]])
    starts = starts[(starts >= TAIL) & (starts <= 1.0 - TAIL - IN_GAP)]
    return float(np.exp(np.max(_log_quantiles(curve, starts + IN_GAP) - _log_quantiles(curve, starts))))


def log2_deviation(curve):
    """Return σφ, the standard deviation of log2 D by mass, with mass uniform in log D within a class."""
    logs = np.log2(curve.bounds)
    centres, widths = 0.5 * (logs[1:] + logs[:-1]), np.diff(logs)
    mean = curve.mass_fractions @ centres
    return float(np.sqrt(curve.mass_fractions @ ((centres - mean) ** 2 + widths**2 / 12)))


def _divided(curve, index, widest):
    low, high = curve.bounds[index : index + 2]
    number = int(np.ceil(np.log(high / low) / np.log(widest) - 1e-9))
    return np.geomspace(low, high, max(number, 1) + 1)


def _by_law(bounds, law):
    """Return the shares (p,) of the mass of a class in its parts, and their mean log D by mass (p,)."""
    logs = np.log(bounds)
    if law == "mass":
        return np.diff(logs) / (logs[-1] - logs[0]), 0.5 * (logs[1:] + logs[:-1])
    if law != "number":
        raise ValueError(f"parts: the law {law!r} is unknown; use {' or '.join(LAWS)}")
    cubes = (bounds / bounds[-1]) ** 3
    shares = np.diff(cubes)
    # The mean of ln D under a density proportional to D³ d ln D.
    means = np.diff(cubes * logs) / shares - 1 / 3
    return shares / shares.sum(), means
