"""Maximum of a result over a ratio of axes, from packings of several ratios with several seeds each."""

from typing import NamedTuple

import numpy as np
from scipy.stats import f as f_distribution

# Half widths in ln(ratio) of the window about the highest mean, of which the widest is used whose fit is good enough.
WIDTHS = (0.3, 0.25, 0.2, 0.15)
LEAST_P = 0.05  # of the test for lack of fit
# ASSUME: density rises faster from the sphere than it falls beyond its maximum. A cubic can follow this; the maximum of
# a parabola is shifted to the flat side.
DEGREE = 3
RESAMPLED = 2000


class Maximum(NamedTuple):
    """Maximum of a curve over a ratio of axes: where it is, how high it is, and their standard errors."""

    ratio: float
    ratio_error: float
    value: float
    value_error: float
    packings: int  # in the window
    half_width: float  # of the window, in ln(ratio)
    misfit_p: float  # p-value of the test for lack of fit; nan without two seeds, or without spare ratios


def maximum(ratio, value, seed=1, resampled=RESAMPLED):
    """Return the Maximum of a value over a ratio, both (n,), from a cubic fit to all packings near the highest mean.

    The cubic (with fewer than five ratios: a parabola) is in ln(ratio), within a window about the ratio with the
    highest mean. The window is the widest of WIDTHS in which the means deviate from the fit by no more than the scatter
    over seeds explains (F-test, p >= LEAST_P), or else the narrowest. If the fit has no maximum inside the window, the
    higher end is used. The standard errors are from a bootstrap: in each of `resampled` draws the packings of each
    ratio are drawn again, and the window of the same width is placed again. They contain no bias of the cubic, and are
    nan with one packing per ratio.
    ValueError if there are fewer than three ratios in the window, or if a ratio is not positive or a number not finite.
    """
    ratio, value = np.asarray(ratio, float), np.asarray(value, float)
    if not (len(ratio) and np.isfinite([ratio, value]).all() and (ratio > 0.0).all()):
        raise ValueError(
            "maximum: there are no packings, or a ratio is not positive or a number not finite; correct it"
        )
    ratios, counts = np.unique(ratio, return_counts=True)
    value = value[np.argsort(ratio, kind="stable")]
    starts = np.cumsum(counts) - counts
    places, means = np.log(ratios), np.add.reduceat(value, starts) / counts
    squares = float(np.sum((value - np.repeat(means, counts)) ** 2))
    width, p = _widest_good_window(places, counts, means, squares)
    (top,), (height,) = _tops(places, counts, means[None], width)
    if np.isnan(top):
        raise ValueError("maximum: there are fewer than three ratios near the highest mean; pack more forms near it")
    # A packing is drawn from those of its ratio.
    rng = np.random.default_rng(seed)
    chosen = np.repeat(starts, counts) + rng.integers(0, np.repeat(counts, counts), (resampled, len(value)))
    drawn = _tops(places, counts, np.add.reduceat(value[chosen], starts, axis=1) / counts, width)
    draws = np.transpose(drawn)[~np.isnan(drawn[0])]
    # The spread of n packings drawn with replacement is too small by √((n-1)/n); n is the median over the ratios.
    n = np.median(counts)
    scale = np.sqrt(n / (n - 1.0)) if n > 1 else np.nan
    errors = scale * np.std(draws, axis=0, ddof=1)
    packings = counts[_window(places, np.argmax(means), width)].sum()
    return Maximum(float(top), float(errors[0]), float(height), float(errors[1]), int(packings), width, p)


def _widest_good_window(places, counts, means, squares):
    """Return (half width, p-value) of the window that `maximum` uses.

    places, counts, means (k,): as in _tops, of one curve; squares: sum of the squared deviations from the means.
    """
    freedom = int(counts.sum()) - len(counts)
    width, p = WIDTHS[0], np.nan
    for narrower in WIDTHS:
        near = _window(places, np.argmax(means), narrower)
        if near.sum() < 3:
            break
        width = narrower
        powers, weights, fit = _fit(places[near], counts[near], means[None, near])
        spare = near.sum() - np.count_nonzero(powers.any(axis=0))
        p = np.nan
        if spare > 0 and freedom > 0 and squares > 1e-20 * float(np.sum(counts * means**2)):
            lack = np.sum((weights * (means[near] - powers @ fit[:, 0])) ** 2) / spare
            p = float(f_distribution.sf(lack / (squares / freedom), spare, freedom))
        if not p < LEAST_P:
            break
    return width, p


def _window(places, highest, width):
    """Return a mask (k,) of the places within the half width about the one with the index `highest`."""
    return np.abs(places - places[highest]) <= width


def _fit(places, counts, means):
    """Return (powers (k, 4), weights (k,), coefficients (4, m)) of cubics, or parabolas, through m curves.

    The powers are of places (k,) that are mapped to [-1, 1]. means (m, k). A fit to the means, weighted by their
    counts, is that to the packings.
    """
    degree = DEGREE if len(places) > DEGREE + 1 else 2
    middle, half = (places[-1] + places[0]) / 2.0, (places[-1] - places[0]) / 2.0
    powers = np.vander((places - middle) / half, DEGREE + 1, increasing=True)
    powers[:, degree + 1 :] = 0.0
    weights = np.sqrt(counts)
    return powers, weights, np.linalg.pinv(weights[:, None] * powers) @ (weights * means).T


def _tops(places, counts, means, width):
    """Return (ratios, values), each (m,), of the maxima of m curves; nan with fewer than three ratios in the window.

    places (k,): ln(ratio), ascending; counts (k,): packings at each; means (m, k): of the value over these packings;
    width: half width of the window. Curves with the same window are solved at once.
    """
    ratios, values = np.full((2, len(means)), np.nan)
    highest = np.argmax(means, axis=1)
    for index in np.unique(highest):
        near = _window(places, index, width)
        x = places[near]
        if len(x) < 3:
            continue
        curves = highest == index
        _, _, fit = _fit(x, counts[near], means[curves][:, near])
        middle, half = (x[-1] + x[0]) / 2.0, (x[-1] - x[0]) / 2.0
        ends = np.broadcast_to([[-1.0], [1.0]], (2, curves.sum()))
        turns = _turns(fit)
        inside = np.where(np.abs(turns) < 1.0, turns, -1.0)
        candidates = np.concatenate([inside, ends])
        heights = np.polynomial.polynomial.polyval(candidates, fit[:, None, :], tensor=False)
        best = np.argmax(heights, axis=0)[None]
        ratios[curves] = np.exp(middle + half * np.take_along_axis(candidates, best, axis=0)[0])
        values[curves] = np.take_along_axis(heights, best, axis=0)[0]
    return ratios, values


def _turns(fit):
    """Return the places (2, m) where cubics with the coefficients fit (4, m) are level; nan or infinite without one.

    Both roots are from the same sum, so that the smaller one is exact also if the cubic is nearly a parabola.
    """
    constant, linear, square = fit[1], 2.0 * fit[2], 3.0 * fit[3]
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(linear**2 - 4.0 * square * constant)
        half_sum = -0.5 * (linear + np.copysign(root, linear))
        return np.stack([half_sum / square, constant / half_sum])
