"""Maxima of curves over a ratio: against exact curves, one slow fit for each draw, and the scatter of campaigns."""

import numpy as np
import pytest
from scipy.stats import f as f_distribution

from simcore.evaluation.curve_maximum import LEAST_P, WIDTHS, maximum

PEAK = 1.6


def test_a_lopsided_maximum_is_found_where_it_is():
    """A Morse curve rises by 0.08 from the sphere to 1.4 and falls by 0.02 to 2.5, as deposits do.

    The maximum of a parabola through the same points is displaced by 0.07.
    """
    ratio = np.array([1.0, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 1.7, 1.8, 2.0, 2.5])
    steep = 2.5
    value = 0.725 - 0.0458 * (1.0 - np.exp(-steep * np.log(ratio / 1.4))) ** 2
    assert maximum(ratio, value).ratio == pytest.approx(1.4, abs=0.02)
    near = np.abs(np.log(ratio / 1.4)) <= 0.3
    b, a = np.polynomial.polynomial.polyfit(np.log(ratio[near]), value[near], 2)[1:]
    assert abs(np.exp(-0.5 * b / a) - 1.4) > 0.05


def slow_maximum(ratio, value, width):
    """Return (ratio, value) of the maximum from one fit to the packings themselves; None if there is none."""
    x = np.log(ratio)
    places = np.unique(x)
    highest = places[np.argmax([value[x == place].mean() for place in places])]
    near = np.abs(x - highest) <= width
    number = len(np.unique(x[near]))
    if number < 3:
        return None
    fit = np.polynomial.Polynomial.fit(x[near], value[near], 3 if number > 4 else 2)
    slope = fit.deriv()
    turns = slope.trim(1e-9 * np.abs(slope.coef).max()).roots()
    turns = np.real(turns[np.abs(np.imag(turns)) < 1e-9])
    low, high = fit.domain
    places = np.array([*turns[(turns > low) & (turns < high)], low, high])
    top = places[np.argmax(fit(places))]
    return np.exp(top), fit(top)


@pytest.mark.parametrize("ratios", [np.linspace(1.0, 2.5, 14), [1.2, 1.3, 1.4, 1.5, 2.6], [1.3, 1.4, 1.5, 2.2]])
def test_draws_solved_at_once_are_those_of_one_fit_each(ratios):
    """With fewer ratios, some draws have their highest mean where there are too few, and are left out."""
    rng = np.random.default_rng(4)
    counts = rng.integers(2, 6, len(ratios))
    ratio = np.repeat(ratios, counts)[rng.permutation(counts.sum())]
    value = 0.72 - 0.1 * np.log(ratio / PEAK) ** 2 + 0.03 * rng.normal(size=len(ratio))
    found = maximum(ratio, value, seed=7, resampled=300)
    draw = np.random.default_rng(7)
    groups = [np.flatnonzero(ratio == level) for level in ratios]
    tops = []
    for _ in range(300):
        chosen = np.concatenate([draw.choice(group, len(group)) for group in groups])
        tops += filter(None, [slow_maximum(ratio[chosen], value[chosen], found.half_width)])
    n = np.median(counts)
    errors = np.sqrt(n / (n - 1)) * np.std(tops, axis=0, ddof=1)
    assert (found.ratio, found.value) == pytest.approx(slow_maximum(ratio, value, found.half_width), rel=1e-9)
    assert (found.ratio_error, found.value_error) == pytest.approx(tuple(errors), rel=1e-6)


def test_errors_of_the_maximum_are_those_of_repeated_campaigns():
    """The stated standard errors equal the scatter of 60 campaigns within three standard errors of the two."""
    rng = np.random.default_rng(5)
    ratio = np.repeat([1.2, 1.3, 1.4, 1.5, 1.6, 1.7, 1.8, 2.0], 5)
    exact = 0.72 - 0.4 * np.log(ratio / PEAK) ** 2
    # A standard error from 400 draws has a relative error of 1/√800; each campaign has other draws.
    found = [maximum(ratio, exact + 0.001 * rng.normal(size=len(ratio)), seed, 400) for seed in range(60)]
    for value, error in ((0, 1), (2, 3)):
        scatter = np.std([top[value] for top in found], ddof=1)
        text = np.sqrt(np.mean([top[error] ** 2 for top in found]))
        # The scatter of 60 campaigns has a relative error of 1/√118, the stated standard error one of about 1/√40.
        assert text == pytest.approx(scatter, rel=3.0 * np.hypot(1 / np.sqrt(118), 1 / np.sqrt(40)))
    assert np.mean([top.ratio for top in found]) == pytest.approx(
        PEAK, abs=4 * found[0].ratio_error / np.sqrt(60) + 0.01
    )


@pytest.mark.parametrize(
    "ratio, value", [([], []), ([1.0, 1.1, 1.2], [0.1, np.nan, 0.2]), ([0.0, 1.0, 2.0], [1, 2, 1])]
)
def test_numbers_without_a_maximum_are_refused(ratio, value):
    with pytest.raises(ValueError, match="maximum: there are no packings, or a ratio is not positive or a number not"):
        maximum(ratio, value)


def test_too_few_ratios_have_no_maximum():
    with pytest.raises(ValueError, match="fewer than three ratios"):
        maximum([1.0, 1.2, 1.0, 1.2], [0.6, 0.7, 0.6, 0.7])


def misfit(ratio, value, highest, width):
    """Return the p-value of the F-test for lack of fit of a cubic to all packings in the window."""
    x, near = np.log(ratio), np.abs(np.log(ratio / highest)) <= width + 1e-12
    fit = np.polynomial.Polynomial.fit(x[near], value[near], 3)
    places = np.unique(x)
    within = sum(np.sum((value[x == place] - value[x == place].mean()) ** 2) for place in places)
    within_near = sum(np.sum((value[x == place] - value[x == place].mean()) ** 2) for place in np.unique(x[near]))
    lack = np.sum((value[near] - fit(x[near])) ** 2) - within_near
    spare, freedom = len(np.unique(x[near])) - 4, len(value) - len(places)
    return f_distribution.sf(lack / spare / (within / freedom), spare, freedom)


def test_the_window_is_the_widest_in_which_the_cubic_fits():
    """About a kink at the maximum no cubic fits well, and the less the wider the window is."""
    ratio = np.repeat(np.round(np.arange(1.0, 2.51, 0.04), 2), 4)
    value = 0.72 - 0.02 * np.abs(np.log(ratio / PEAK)) ** 0.7 + 3e-4 * np.random.default_rng(2).normal(size=len(ratio))
    found = maximum(ratio, value, resampled=10)
    ratios = np.unique(ratio)
    highest = ratios[np.argmax([value[ratio == each].mean() for each in ratios])]
    p = {width: misfit(ratio, value, highest, width) for width in WIDTHS}
    wider = [width for width in WIDTHS if width > found.half_width]
    assert wider and all(p[width] < LEAST_P for width in wider)
    assert found.misfit_p == pytest.approx(p[found.half_width], rel=1e-6)
    assert found.half_width == WIDTHS[-1] or found.misfit_p >= LEAST_P


def test_a_smooth_curve_keeps_the_widest_window():
    ratio = np.repeat(np.linspace(1.0, 2.5, 14), 4)
    value = 0.72 - 0.1 * np.log(ratio / PEAK) ** 2 + 0.002 * np.random.default_rng(3).normal(size=len(ratio))
    found = maximum(ratio, value, resampled=10)
    assert found.half_width == WIDTHS[0] and found.misfit_p >= LEAST_P
    # One packing of each ratio has no scatter over seeds to compare with.
    assert np.isnan(maximum(ratio[::4], value[::4], resampled=10).misfit_p)
