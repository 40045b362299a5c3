"""From sieve curves to classes, statistics of curves, and the predictors that take a curve alone."""

import numpy as np
import pandas as pd
import pytest

from simcore.grains.sieve import SieveCurve, read_cases
from simcore.models.packing_models.curves import LAWS, gap, log2_deviation, parts, passing, quantile, span, split
from simcore.models.packing_models.empirical import PREDICTORS
from simcore.paths import CONFIG, R22_TABLES, ROOT

CASES = {name: case.curve for name, case in read_cases(CONFIG / "cases.tsv").items()}
GAP = SieveCurve(np.array([1.0, 2.0, 4.0, 10.0]) * 1e-3, [0.5, 0.0, 0.5], "gap")


@pytest.mark.parametrize("law", LAWS)
def test_parts_keep_mass_classes_and_width(law):
    for curve in (*CASES.values(), GAP):
        sizes, fractions, classes = parts(curve, law, 2**0.25)
        np.testing.assert_allclose(np.bincount(classes, fractions, len(curve.mass_fractions)), curve.mass_fractions)
        assert np.all(sizes > curve.bounds[classes]) and np.all(sizes < curve.bounds[classes + 1])
        assert np.all(fractions > 0)
        for index in np.unique(classes):
            ratio = curve.bounds[index + 1] / curve.bounds[index]
            assert ratio ** (1 / np.sum(classes == index)) <= 2**0.25 * (1 + 1e-9)


def test_parts_by_number_are_what_scree_draws():
    """The mean log size by mass equals that of drawn grains, whose sizes are uniform in log D by number."""
    curve = SieveCurve([1e-3, 8e-3], [1.0])
    sizes, fractions, _ = parts(curve, "number")
    drawn = np.geomspace(1e-3, 8e-3, 200_001)
    drawn = np.sqrt(drawn[1:] * drawn[:-1])
    weight = drawn**3 / np.sum(drawn**3)
    assert fractions @ np.log(sizes) == pytest.approx(weight @ np.log(drawn), abs=1e-8)
    assert fractions[sizes < 4e-3].sum() == pytest.approx(weight[drawn < 4e-3].sum(), abs=1e-5)


@pytest.mark.parametrize("law", LAWS)
def test_a_split_curve_has_the_same_distribution(law):
    for curve in (CASES["U7"], GAP):
        for number in (2, 4, 8):
            finer = split(curve, number, law)
            assert len(finer.mass_fractions) == number * len(curve.mass_fractions)
            whole, divided = (parts(c, law, 2.0)[:2] for c in (curve, finer))
            # The mean of log D by mass is exact for parts of any width.
            means = [fractions @ np.log(sizes) for sizes, fractions in (whole, divided)]
            assert means[0] == pytest.approx(means[1], abs=1e-12)


def test_unknown_laws_are_refused():
    with pytest.raises(ValueError, match="law 'volume' is unknown"):
        parts(GAP, "volume")
    with pytest.raises(ValueError, match="not above 1"):
        parts(GAP, widest=1.0)


def test_a_gap_is_the_widest_ratio_of_sizes_with_a_hundredth_of_the_mass():
    """It is as found by trying many places, and not changed by a little mass in the gap or by finer classes."""
    rng = np.random.default_rng(5)
    assert gap(GAP) == pytest.approx(2.0 * 2.0 ** (0.01 / 0.5), rel=0.02)  # from 2 to 4 mm, and 1 % of the mass more
    boulders = [SieveCurve([1.0, 2.0, 200.0, 220.0], [1 - share, 0.0, share]) for share in (0.012, 0.015, 0.025)]
    fines = [SieveCurve([1.0, 4.0, 12.0, 14.0], [share, 0.0, 1 - share]) for share in (0.012, 0.02, 0.3)]
    drawn = [SieveCurve(GAP.bounds, rng.dirichlet([0.3, 0.1, 0.3])) for _ in range(20)]
    for curve in (GAP, *boulders, *fines, *drawn, *CASES.values()):
        ends = np.cumsum(curve.mass_fractions)
        starts = np.r_[np.linspace(0.01, 0.98, 2001), ends, ends - 0.01 + 1e-7]
        starts = starts[(starts >= 0.01) & (starts <= 0.98)]
        tried = max(quantile(curve, start + 0.01) / quantile(curve, start) for start in starts)
        assert tried <= gap(curve) * (1 + 1e-9) and gap(curve) == pytest.approx(tried, rel=1e-5)
        assert gap(split(curve, 3, "mass")) == pytest.approx(gap(curve), rel=1e-6)


def test_quantiles_and_passing_shares():
    assert quantile(GAP, 0.25) == pytest.approx(np.sqrt(2) * 1e-3)
    assert quantile(GAP, 0.5) == pytest.approx(2e-3)  # the end of the class that reaches it
    assert quantile(GAP, 0.75) == pytest.approx(np.sqrt(40) * 1e-3)
    assert quantile(CASES["U3"], 0.0) == pytest.approx(5.6e-3) and quantile(CASES["U3"], 1.0) == pytest.approx(16e-3)
    assert passing(GAP, 3e-3) == pytest.approx(0.5) and passing(GAP, 0.1e-3) == 0.0 and passing(GAP, 1.0) == 1.0
    for share in (0.1, 0.3, 0.6, 0.9):
        assert passing(GAP, quantile(GAP, share)) == pytest.approx(share)


def test_log2_deviation_of_uniform_and_split_curves():
    assert log2_deviation(SieveCurve([1e-3, 4e-3], [1.0])) == pytest.approx(2 / np.sqrt(12))
    for curve in CASES.values():
        assert log2_deviation(split(curve, 4, "mass")) == pytest.approx(log2_deviation(curve), abs=1e-12)


def test_predictors_on_the_measured_gravels():
    """An independent program gave the errors to 0.001; those of the medians are only bounds.

    Its rule for the width of a class in σφ is unknown; in U1 this width is all of σφ, so 0.002 is allowed there.
    """
    measured = pd.read_csv(R22_TABLES / "table3_cases.csv").set_index("case")["n_exp"]
    errors = {
        predictor.name: np.array([predictor.porosity(CASES[name]) - n for name, n in measured.items()])
        for predictor in PREDICTORS
    }
    independent = {
        "Frings 2011": [-0.028, -0.027, -0.026, -0.011, 0.016, -0.007, -0.013],
        "Wooster 2008": [0.005, -0.009, -0.020, -0.024, -0.018, -0.047, -0.047],
    }
    for name, expected in independent.items():
        np.testing.assert_allclose(errors[name][1:], expected[1:], atol=1.1e-3)
        assert errors[name][0] == pytest.approx(expected[0], abs=2e-3)
    for name, bound in (("Komura", 0.055), ("Wu and Wang 2006", 0.105), ("Carling and Reader 1982", 0.105)):
        assert 0.8 * bound < np.abs(errors[name]).max() < bound


def test_sources_and_ranges_of_the_predictors_are_documented():
    text = (ROOT / "docs" / "explanation" / "models.md").read_text(encoding="utf-8")
    for predictor in PREDICTORS:
        assert f"| {predictor.source} | {predictor.range} |" in text and f"| {predictor.name} | n = " in text
        assert predictor.range.startswith("unknown: the publication was not read")


def test_only_frings_counts_sand():
    """A tenth of the mass below 0.5 mm adds 0.0146 beside the change of the spread."""
    sandy = SieveCurve([0.25e-3, 0.5e-3, 4e-3, 5.6e-3], [0.1, 0.0, 0.9])
    frings = PREDICTORS[0].porosity
    assert frings(sandy) == pytest.approx(0.353 - 0.068 * log2_deviation(sandy) + 0.0146)


def test_a_trace_of_mass_far_away_does_not_widen_a_curve():
    bounds = np.array([0.063, 2.8, 4, 5.6, 8]) * 1e-3
    shares = np.array([0.2, 0.5, 0.3])
    without = span(SieveCurve(bounds[1:], shares))
    assert without == pytest.approx(quantile(SieveCurve(bounds[1:], shares), 0.99) / (2.8e-3 * (4 / 2.8) ** 0.05))
    for trace in (1e-9, 1e-4):
        assert span(SieveCurve(bounds, [trace, *(shares * (1 - trace))])) == pytest.approx(without, rel=1e-3)
    assert span(SieveCurve(bounds, [0.02, *(0.98 * shares)])) > 5 * without
