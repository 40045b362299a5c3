"""Statistics of sieve curves, compared with a run of GRADISTAT and with a normal distribution, and their words."""

import numpy as np
import pytest
from scipy.stats import norm

from simcore.grains.sieve_statistics import folk_ward, percentile, sieve_statistics, size_word, to_phi
from simcore.grains.sieve_table import SieveTable


def table_of(openings_mm, retained):
    """Return a table of shares retained between the openings."""
    return SieveTable(np.array(openings_mm) * 1e-3, np.r_[0.0, np.cumsum(retained)] / np.sum(retained))


def log_normal(mean, deviation, classes, reach=5.0):
    """Return a table of classes of equal width in phi of a normal distribution, from +reach to -reach deviations."""
    phi = np.linspace(mean + reach * deviation, mean - reach * deviation, classes + 1)
    return table_of(2.0**-phi, -np.diff(norm.cdf(phi, mean, deviation)))


def values(moments):
    return [moments.mean, moments.sorting, moments.skewness, moments.kurtosis]


def test_a_run_of_gradistat_is_reproduced_to_its_digits():
    """GRADISTAT v9.1 (Blott & Pye 2001) for these five classes, as printed in tests/test_statistics.py of SedStat.

    Source: github.com/d-handy/SedStat, class TestAgainstGRADISTATv91; sizes there are in µm.
    """
    result = sieve_statistics(table_of([0.25, 0.355, 0.5, 0.71, 1.0, 1.4], [15, 25, 30, 20, 10]))
    assert values(result.folk_ward) == pytest.approx([0.817982, 0.645783, -0.033002, 0.918079], abs=1e-6)
    assert values(result.phi_moments) == pytest.approx([0.823078, 0.595554, -0.104357, 2.134044], abs=1e-6)
    assert values(result.mm_moments)[:2] == pytest.approx([0.624750000, 0.262897199], abs=1e-9)
    assert values(result.mm_moments)[2:] == pytest.approx([0.800024, 2.827894], abs=1e-6)
    sizes = [1e6 * result.percentiles[percent] for percent in (10, 50, 90)]
    assert sizes == pytest.approx([315.838866, 561.995432, 1000.0], abs=1e-6)
    assert result.folk_ward.words == ("coarse sand", "moderately well sorted", "symmetrical", "mesokurtic")
    assert result.phi_moments.words[3] == "platykurtic" and result.notices == []


def test_a_log_normal_curve_has_its_parameters():
    result = sieve_statistics(log_normal(-3.2, 0.9, 2000))
    # The expected values are Folk and Ward's formulas with quantiles z of the standard normal; z16 = -z84 and so on.
    z = {p: norm.ppf(p / 100) for p in (75, 84, 95)}
    graphical = [-3.2, 0.9 * (z[84] / 2 + z[95] / 3.3), 0.0, z[95] / (2.44 * z[75])]
    # The ends at five deviations leave out 6e-7 of the mass, and linear interpolation adds less than (0.0045)²/2.
    assert values(result.folk_ward) == pytest.approx(graphical, abs=2e-5)
    assert values(result.phi_moments) == pytest.approx([-3.2, 0.9, 0.0, 3.0], abs=1e-3)
    for percent, size in result.percentiles.items():
        assert to_phi(size) == pytest.approx(-3.2 - 0.9 * norm.ppf(percent / 100), abs=2e-5)
    ratio = 2.0**0.9
    assert result.uniformity == pytest.approx(ratio ** (norm.ppf(0.6) - norm.ppf(0.1)), rel=1e-4)
    assert result.curvature == pytest.approx(ratio ** (2 * norm.ppf(0.3) - norm.ppf(0.6) - norm.ppf(0.1)), rel=1e-4)


def test_the_error_of_wide_classes_is_of_second_order():
    errors = []
    for classes in (20, 40, 80):
        moments = sieve_statistics(log_normal(-3.0, 1.0, classes)).phi_moments
        # Sheppard: a class of width h adds h²/12 to the variance.
        assert moments.sorting**2 - 1.0 == pytest.approx((10 / classes) ** 2 / 12, rel=0.02, abs=2e-5)
        errors.append(moments.sorting**2 - 1.0)
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.02)


def test_one_class_has_no_skewness_of_moments():
    result = sieve_statistics(table_of([4.0, 8.0], [1.0]))
    assert result.percentiles[50] == pytest.approx(np.sqrt(32) * 1e-3)
    assert (result.phi_moments.sorting, result.folk_ward.skewness) == (0.0, pytest.approx(0.0))
    assert np.isnan(result.phi_moments.skewness)
    # The distribution is uniform in phi.
    assert result.folk_ward.kurtosis == pytest.approx(0.9 / 2.44 / 0.5)


def test_a_step_between_two_sizes_gives_the_smaller():
    table = SieveTable(np.array([1.0, 2.0, 4.0, 8.0]) * 1e-3, np.array([0.0, 0.5, 0.5, 1.0]))
    assert percentile(table, 0.5) == 2e-3
    assert percentile(table, 0.75) == pytest.approx(np.sqrt(32) * 1e-3)


def test_an_open_end_gives_no_number_that_the_sieves_do_not_determine():
    table = SieveTable(np.array([2.0, 4.0, 8.0]) * 1e-3, np.array([0.2, 0.5, 0.98]))
    result = sieve_statistics(table)
    missing = [percent for percent, size in result.percentiles.items() if np.isnan(size)]
    assert missing == [5, 10, 16]
    assert np.isnan(result.uniformity) and np.isnan(result.folk_ward.sorting) and np.isnan(result.phi_moments.mean)
    assert result.folk_ward.words == ("", "", "", "")
    assert (
        "D5, D10, D16 are outside the sieves, because 20.0% of the mass pass the finest sieve (2 mm)"
        in result.notices[0]
    )
    assert "--finest" in result.notices[0] and "the moments are not given" in result.notices[1]
    closed = sieve_statistics(table.closed(1e-3, 16e-3))
    assert closed.percentiles[10] == pytest.approx(np.sqrt(2) * 1e-3) and closed.notices == []


def test_a_small_open_end_is_closed_by_an_assumption_that_is_stated():
    table = SieveTable(np.array([2.0, 4.0, 8.0]) * 1e-3, np.array([0.005, 0.5, 0.992]))
    result = sieve_statistics(table)
    same = sieve_statistics(table.closed(1e-3, 16e-3))
    assert values(result.phi_moments) == values(same.phi_moments)
    assert [notice.split(" the ")[1].split(" ")[0] for notice in result.notices] == ["0.5%", "0.8%"]


@pytest.mark.parametrize(
    ("percentiles", "words"),
    [
        ((-4.0, 0.3, 0.0, 1.0), ("coarse gravel", "very well sorted", "symmetrical", "mesokurtic")),
        ((-3.9, 0.4, 0.25, 0.7), ("medium gravel", "well sorted", "fine skewed", "platykurtic")),
        ((0.5, 0.8, -0.25, 1.3), ("coarse sand", "moderately sorted", "coarse skewed", "leptokurtic")),
        ((-6.5, 1.5, 0.45, 2.0), ("very small boulders", "poorly sorted", "very fine skewed", "very leptokurtic")),
        ((4.5, 3.0, -0.45, 0.6), ("very coarse silt", "very poorly sorted", "very coarse skewed", "very platykurtic")),
    ],
)
def test_words_follow_from_the_numbers(percentiles, words):
    """Percentiles are made so that Folk and Ward's formulas return these numbers."""
    mean, sorting, skewness, kurtosis = percentiles
    # phi16 and phi84 are s away from their middle, phi5 and phi95 1.65 s, so both terms of the sorting are s/2. The
    # middles are shifted by the skewness times these distances, so both terms of the skewness are half of it.
    s, tail = sorting, 1.65 * sorting
    p50 = mean - 2 * skewness * s / 3
    p16, p84 = p50 + skewness * s - s, p50 + skewness * s + s
    p5, p95 = p50 + skewness * tail - tail, p50 + skewness * tail + tail
    half = tail / (2.44 * kurtosis)
    phi = {5: p5, 16: p16, 25: p50 - half, 50: p50, 75: p50 + half, 84: p84, 95: p95}
    result = folk_ward({100 - percent: 2.0**-value * 1e-3 for percent, value in phi.items()})
    assert values(result) == pytest.approx(percentiles, abs=1e-9)
    assert result.words == words


def test_sizes_have_words_with_the_limits_of_blott_and_pye():
    for size, word in (
        (1.99, "very coarse sand"), (2.0, "very fine gravel"), (4.0, "fine gravel"), (8.0, "medium gravel"),
        (16.0, "coarse gravel"), (32.0, "very coarse gravel"), (64.0, "very small boulders"), (np.nan, ""),
    ):  # fmt: skip
        assert size_word(size) == word


def test_geometric_measures_are_those_of_the_logarithms_of_sizes():
    """The expected values are computed from natural logarithms of sizes in mm, without phi."""
    rng = np.random.default_rng(2)
    for _ in range(20):
        openings = 1e-3 * np.cumprod(rng.uniform(1.2, 3.0, 7))
        passing = np.r_[0.0, np.cumsum(rng.dirichlet(np.ones(6)))]
        passing[-1] = 1.0
        statistics = sieve_statistics(SieveTable(openings, passing))
        logs, shares = np.log(openings * 1e3), np.diff(passing)
        middles = 0.5 * (logs[1:] + logs[:-1])
        mean = shares @ middles
        deviation = np.sqrt(shares @ (middles - mean) ** 2)
        found = statistics.phi_moments.geometric()
        assert [found.mean, found.sorting] == pytest.approx([np.exp(mean), np.exp(deviation)])
        assert found.skewness == pytest.approx(shares @ (middles - mean) ** 3 / deviation**3, abs=1e-9)
        assert found.kurtosis == pytest.approx(shares @ (middles - mean) ** 4 / deviation**4)
        p5, p16, p50, p84, p95 = np.interp([0.05, 0.16, 0.5, 0.84, 0.95], passing, logs)
        found = statistics.folk_ward.geometric()
        assert [found.mean, found.sorting] == pytest.approx(
            [np.exp((p16 + p50 + p84) / 3), np.exp((p84 - p16) / 4 + (p95 - p5) / 6.6)]
        )
        skewness = (p16 + p84 - 2 * p50) / (2 * (p84 - p16)) + (p5 + p95 - 2 * p50) / (2 * (p95 - p5))
        assert found.skewness == pytest.approx(skewness, abs=1e-9)
