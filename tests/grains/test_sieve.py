"""Sieve curves: errors, numbers of grains from mass fractions, and the table of named curves."""

from pathlib import Path

import numpy as np
import pytest

from simcore.grains.sampling import grain_uniforms, sample_sizes
from simcore.grains.sieve import SieveCurve, class_fractions, read_cases

CASES = Path(__file__).parents[2] / "config" / "cases.tsv"


@pytest.mark.parametrize(
    "bounds, fractions, reason",
    [
        ([1e-3, 2e-3, 4e-3], [0.5, 0.4], "sum to 0.9"),
        ([1e-3, 2e-3, 4e-3], [1.5, -0.5], ">= 0"),
        ([1e-3, 4e-3, 2e-3], [0.5, 0.5], "increasing"),
        ([0.0, 1e-3], [1.0], "positive"),
        ([1e-3, 2e-3], [0.5, 0.5], "one bound more"),
        ([1e-3, np.nan], [1.0], "increasing"),
        ([1e-3, 2e-3], [np.nan], ">= 0"),
    ],
)
def test_bad_curves_are_refused_by_name(bounds, fractions, reason):
    with pytest.raises(ValueError, match=f"^my curve: .*{reason}"):
        SieveCurve(bounds, fractions, "my curve")


RATIOS, MOST_CLASSES, CURVES = (1.05, 16.0), 8, 50


def random_curve(rng, k, accept=None):
    """Return a curve of k classes with ratios log-uniform over RATIOS and Dirichlet fractions, a quarter of them 0."""
    while True:
        ratios = np.exp(rng.uniform(*np.log(RATIOS), k))
        fractions = rng.dirichlet(np.ones(k)) * (rng.uniform(size=k) > 0.25)
        if fractions.sum() == 0:
            continue
        curve = SieveCurve(1e-3 * np.cumprod([1.0, *ratios]), fractions / fractions.sum(), "random")
        if accept is None or accept(curve):
            return curve


def test_the_expected_mass_in_each_class_is_the_specified_one():
    """This is exact for curves of any width: the mean volume of a class is that of the sizes drawn in it."""
    rng = np.random.default_rng(1)
    within = (np.arange(4000) + 0.5) / 4000
    for number in range(CURVES):
        curve = random_curve(rng, 1 + number % MOST_CLASSES)
        np.testing.assert_allclose(curve.expected_fractions(), curve.mass_fractions, rtol=1e-13)
        mass = curve.expected_numbers(2.0, 2650) * 2650 * np.pi / 6 * curve.class_means(3)
        np.testing.assert_allclose(mass, 2.0 * curve.mass_fractions, rtol=1e-13)
        # The mean is also computed by the midpoint rule over all random numbers within a class.
        for bounds, mean in zip(
            np.column_stack([curve.bounds[:-1], curve.bounds[1:]]), curve.class_means(3), strict=True
        ):
            alone = SieveCurve(bounds, [1.0])
            D = alone.sizes(np.column_stack([np.full(len(within), 0.5), within]))
            # Its relative error is h² / 24 (3 ln r)² to leading order.
            error = (3 * np.log(alone.bounds[1] / alone.bounds[0]) / len(within)) ** 2 / 24
            assert np.mean(D**3) == pytest.approx(mean, rel=1.1 * error + 1e-13)


def test_two_million_draws_have_the_specified_masses():
    """The mass fractions of fifty random curves are within 4 standard errors.

    Let Y be the D³ of a grain, and X_i = Y if it is in class i, otherwise 0. X_i - f_i Y has the mean 0 and the
    variance Σ_k p_k m6_k ([k = i] - f_i)², exactly and at any number of draws, as no ratio is taken. Divided by the
    mean of Y it gives the standard error of a drawn mass fraction. The mean of N draws is normal only if each class
    is drawn often: curves are drawn anew until two classes or more have mass, each with more than 50 expected grains.
    """
    rng, n = np.random.default_rng(2), 2_000_000

    def can_be_judged(curve):
        numbers = n * curve.number_fractions()[curve.mass_fractions > 0]
        return len(numbers) > 1 and numbers.min() > 50

    coarsest = []
    for number in range(CURVES):
        curve = random_curve(rng, 2 + number % (MOST_CLASSES - 1), can_be_judged)
        f, p = curve.mass_fractions, curve.number_fractions()
        D = curve.sizes(rng.random((n, 2)))
        y = D * D * D
        shares = class_fractions(curve, D, y)
        of_class = np.eye(len(f)) - f[:, None]
        error = np.sqrt((of_class**2) @ (p * curve.class_means(6)) / n)
        z = (shares - f)[f > 0] * y.mean() / error[f > 0]
        assert np.abs(z).max() < 4.0, (curve.bounds, f, shares)
        coarsest.append(z[-1])
    # The errors are not too wide: the mean square of fifty ratios is 1 within 4 of its standard errors, √(2 / 50).
    assert np.mean(np.square(coarsest)) == pytest.approx(1.0, abs=4.0 * np.sqrt(2.0 / CURVES))


def test_sizes_of_grains_are_the_draws_of_their_curve():
    curve, ids = random_curve(np.random.default_rng(4), 3), np.arange(1000)
    np.testing.assert_array_equal(sample_sizes(curve, ids, 7), curve.sizes(grain_uniforms(ids, 7)[:, :2]))


@pytest.mark.parametrize(
    "bounds, fractions",
    [([1, 4, 5], [0.5, 0.5]), ([2, 16, 20], [0.5, 0.5]), ([1, 16, 31.5, 63], [0.2, 0.4, 0.4])],
)
def test_numbers_by_the_geometric_mean_miss_the_masses_of_unequal_classes(bounds, fractions):
    bounds = 1e-3 * np.array(bounds)
    old = SieveCurve(bounds, fractions, "old", "geometric_mean").expected_fractions()
    r = bounds[1:] / bounds[:-1]
    weighted = np.array(fractions) * (r**3 - 1) / (3 * r**1.5 * np.log(r))
    np.testing.assert_allclose(old, weighted / weighted.sum(), rtol=1e-12)
    assert np.abs(old - fractions).max() > 0.1


def test_one_class_and_equal_ratios_have_the_same_sizes_by_either_rule():
    uniforms = np.random.default_rng(3).uniform(size=(1000, 2))
    for bounds, fractions, rtol in (
        ([5.6, 8], [1.0], 0),
        ([2, 5, 9], [0.0, 1.0], 0),
        ([1, 2, 4, 8], [0.2, 0.5, 0.3], 1e-12),
    ):
        both = [SieveCurve(bounds, fractions, numbers_by=rule) for rule in ("mean_volume", "geometric_mean")]
        np.testing.assert_allclose(both[0].number_fractions(), both[1].number_fractions(), rtol=rtol)
        np.testing.assert_allclose(*(curve.sizes(uniforms) for curve in both), rtol=rtol)
    with pytest.raises(ValueError, match="numbers_by 'mass' is unknown"):
        SieveCurve([1, 2], [1.0], numbers_by="mass")


def test_cases_keep_the_rule_of_their_source():
    """Their drawn masses differ from Table 3 by less than 0.3 % of the bed; see the table in the module's docstring."""
    differences = {}
    for name, case in read_cases(CASES).items():
        curve = case.curve
        assert curve.numbers_by == "geometric_mean"
        mass = curve.number_fractions() * (curve.bounds[:-1] * curve.bounds[1:]) ** 1.5
        np.testing.assert_allclose(mass / mass.sum(), curve.mass_fractions, rtol=1e-14)
        differences[name] = round(float(np.abs(curve.expected_fractions() - curve.mass_fractions).max()), 4)
    assert differences == {"U1": 0, "U3": 13e-4, "U5": 10e-4, "U7": 7e-4, "B30": 6e-4, "B50": 5e-4, "B70": 7e-4}


def test_class_fractions_weigh_volumes():
    curve = SieveCurve([1e-3, 2e-3, 4e-3, 8e-3], [0.2, 0.5, 0.3])
    # A grain on a bound belongs to the coarser class; one beyond the curve, by rounding, belongs to the last.
    found = class_fractions(curve, [1e-3, 1.9e-3, 2e-3, 5e-3, 8.0001e-3], [1.0, 2.0, 3.0, 5.0, 9.0])
    np.testing.assert_allclose(found, np.array([3.0, 3.0, 14.0]) / 20.0, rtol=1e-15)
    with pytest.raises(ValueError, match="there is no grain"):
        class_fractions(curve, [], [])


@pytest.mark.parametrize(
    "fractions, message",
    [
        ([0.4, 1.0], r"\[0\.4, 1\] sum to 1\.4, .* look cumulative: give the share retained .* \[0\.4, 0\.6\]"),
        ([0.1, 0.45, 1.0], r"look cumulative: .* \[0\.1, 0\.35, 0\.55\]"),
        ([1.0, 0.6, 0.1], r"look cumulative from the coarse end: .* \[0\.4, 0\.5, 0\.1\]"),
        ([40, 60], r"sum to 100: give fractions, not percent"),
        ([40, 100], r"give fractions, not percent"),
        ([0.4, 0.5], r"sum to 0\.9, not to 1: divide them by their sum"),
    ],
)
def test_the_error_of_shares_that_do_not_sum_to_one_names_the_fault(fractions, message):
    with pytest.raises(ValueError, match=message):
        SieveCurve(np.arange(1, len(fractions) + 2), fractions)


def test_largest_is_that_of_the_largest_class_with_mass():
    assert SieveCurve([1e-3, 2e-3, 4e-3], [1.0, 0.0]).largest == 2e-3


def test_a_curve_without_empty_ends_keeps_its_rules():
    curve = SieveCurve([1, 2, 4, 8, 16], [0, 0.4, 0.6, 0], "mine", "geometric_mean", np.array([1.0, 1.1, 0.9, 1.0]))
    kept = curve.without_empty_ends()
    assert (kept.bounds.tolist(), kept.name, kept.numbers_by) == ([2, 4, 8], "mine", "geometric_mean")
    np.testing.assert_array_equal(kept.number_fractions(), curve.number_fractions()[1:3])


def test_top_class_needs_five_grains():
    curve = SieveCurve([1e-3, 2e-3, 4e-3, 8e-3], [0.5, 0.5, 0.0], "two")
    # ∫ D³ dlnD over the class, over ln 2: (64 - 8) / (3 ln 2) mm³
    needed = 5 * 2650 * np.pi / 6 * (64e-9 - 8e-9) / (3 * np.log(2)) / 0.5
    curve.check_top_class(needed * 1.001, 2650)
    with pytest.raises(ValueError, match=r"^two: .* 5 grains.*4 mm.*0\.000374 kg.*allow_few_top_grains"):
        curve.check_top_class(needed * 0.999, 2650)
    with pytest.raises(ValueError, match=r"^two: of 30 grains, 2\.5 are .*give at least 60 grains, or allow"):
        curve.check_top_class(needed * 0.5, 2650, grains=30)


def test_cases_are_table_3():
    cases = read_cases(CASES)
    assert list(cases) == ["U1", "U3", "U5", "U7", "B30", "B50", "B70"]
    assert cases["U1"].curve.largest == pytest.approx(8e-3)
    assert cases["B30"].generation_spacing == pytest.approx(0.020)
    np.testing.assert_allclose(cases["U7"].curve.bounds, np.array([2.8, 4, 5.6, 8, 11.2, 16, 22.4, 31.5]) * 1e-3)
    np.testing.assert_allclose(cases["B70"].curve.mass_fractions, [0.18, 0.29, 0.18, 0.06, 0.08, 0.13, 0.08])


def test_bad_tables_are_refused_with_their_path(tmp_path):
    path = tmp_path / "cases.tsv"
    with pytest.raises(ValueError, match=r"cases\.tsv does not exist"):
        read_cases(path)
    good = CASES.read_text()
    for text, reason in [
        (good.replace("0.21\t0.58", "0.21\t0.5"), "'U3'.*sum"),
        (good.replace("generation_spacing [mm]", "spacing"), "needs"),
        (good.replace("5.6-8 mm", "6-8 mm"), "must begin"),
        (good.replace("0.58", "much"), "much"),
    ]:
        path.write_text(text)
        with pytest.raises(ValueError, match=rf"(?s)cases\.tsv.*{reason}"):
            read_cases(path)
