"""Scatter that grows with the form: its line, the errors of the coefficients, and the coverage of the intervals."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scipy.stats import binom

from simcore.models.regression import fit
from simcore.models.scatter import FEWEST, LEAST, covariance_of, scatter_line, scatter_of
from simcore.models.tables import over_seeds
from simcore.paths import REFERENCE, ROOT
from simcore.reference.committed_rows import read_single_forms

LINE = (-0.002, 0.003)  # scatter 0.001 at L/S = 1, 0.01 at 4
COEFFICIENTS = np.array([0.27, 0.02, 0.015])


def forms(n, rng):
    x = rng.uniform(1.2, 4.0, n)
    return pd.DataFrame({"EQ_inv": x, "EL_inv": rng.uniform(1.0, x)})


def porosities(features, line, rng):
    design = np.column_stack([np.ones(len(features)), features])
    scatter = np.full(len(features), 0.005) if line is None else line[0] + line[1] * features["EQ_inv"]
    return design @ COEFFICIENTS + scatter * rng.normal(size=len(features))


def test_the_line_of_the_scatter_is_recovered():
    rng = np.random.default_rng(1)
    features = forms(4000, rng)
    model = fit(features, porosities(features, LINE, rng))
    assert model.scatter_line[:2] == pytest.approx(LINE, rel=0.2)
    assert scatter_of(np.array([[1.0, 1.0], [1.0, 3.0]]), model.scatter, model.scatter_line) == pytest.approx(
        [LEAST * model.scatter, 0.007], rel=0.05
    )


def test_scatter_that_is_the_same_for_all_has_no_line():
    rng, lines = np.random.default_rng(2), 0
    for _ in range(300):
        features = forms(60, rng)
        design = np.column_stack([np.ones(60), features])
        n = porosities(features, None, rng)
        lines += scatter_line(design, n - design @ np.linalg.lstsq(design, n, rcond=None)[0]) is not None
    assert lines <= binom.ppf(0.999, 300, 0.01)
    few = forms(FEWEST - 1, rng)
    assert fit(few, porosities(few, LINE, rng)).scatter_line is None


def test_errors_of_the_coefficients_are_those_of_repeated_fits():
    rng = np.random.default_rng(3)
    features = forms(80, rng)
    design = np.column_stack([np.ones(80), features])
    drawn = [np.linalg.lstsq(design, porosities(features, LINE, rng), rcond=None)[0] for _ in range(4000)]
    scatter = LINE[0] + LINE[1] * features["EQ_inv"].to_numpy()
    assert np.sqrt(np.diag(covariance_of(design, scatter))) == pytest.approx(np.std(drawn, axis=0), rel=0.05)
    model = fit(features, porosities(features, LINE, rng))
    assert np.sqrt(np.diag(model.covariance)) == pytest.approx(model.std_errors)


def test_intervals_hold_new_beds_of_compact_and_of_long_grains_as_often():
    rng, inside = np.random.default_rng(4), []
    for _ in range(60):
        features, new = forms(100, rng), forms(200, rng)
        model = fit(features, porosities(features, LINE, rng))
        _, lower, upper = model.predict_interval(new)
        n = porosities(new, LINE, rng)
        within = (lower <= n) & (n <= upper)
        inside += zip(new["EQ_inv"], within, strict=True)
    x, within = np.array(inside).T
    for low, high in ((1.2, 2.0), (2.0, 3.0), (3.0, 4.0)):
        assert within[(x >= low) & (x < high)].mean() == pytest.approx(0.95, abs=0.03)


def left_out(features, n, same):
    """Return whether each bed is inside the interval of a model of the others, and half of it; same: one scatter."""
    inside, half = np.empty(len(n), bool), np.empty(len(n))
    for k in range(len(n)):
        others = np.arange(len(n)) != k
        model = fit(features[others], n[others])
        if same:
            covariance = covariance_of(model.design(features[others]), model.scatter)
            model = replace(model, scatter_line=None, covariance=covariance)
        _, lower, upper = (values[0] for values in model.predict_interval(features.iloc[[k]]))
        inside[k], half[k] = lower <= n[k] <= upper, 0.5 * (upper - lower)
    return inside, half


def test_committed_forms_are_inside_their_intervals_as_often_as_the_page_states():
    rows = over_seeds(read_single_forms(REFERENCE / "single_form.csv", cases=["U1"]), "grain")
    features, n = pd.DataFrame({"EQ_inv": rows.L / rows.S, "EL_inv": rows.L / rows.I}), rows.n.to_numpy()
    (inside, half), (inside_same, half_same) = (left_out(features, n, same) for same in (False, True))
    page, x, low = (ROOT / "docs" / "explanation" / "models.md").read_text(encoding="utf-8"), features["EQ_inv"], 0.0
    for words, high in (("up to 2", 2.0), ("2 to 2.5", 2.5), ("2.5 to 3.2", 3.2), ("above 3.2", 9.0)):
        group = (x > low) & (x <= high)
        within, among = inside[group].sum(), group.sum()
        assert within >= binom.ppf(0.01, among, 0.95)
        halves = f"{half[group].mean():.3f} | {inside_same[group].sum()} | {half_same[group].mean():.3f}"
        assert f"| {words} | {among} | {within} | {halves} |" in page
        low = high
