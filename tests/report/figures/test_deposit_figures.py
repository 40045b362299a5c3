"""Figures of deposits show the numbers of their rows."""

import numpy as np
import pandas as pd
import pytest

from simcore.campaign.deposit_findings import maxima
from simcore.campaign.deposits import RESULTS, add_family
from simcore.grains.beta_sizes import BetaSizes
from simcore.report.figures.deposits import (
    bridge_figure,
    directions_figure,
    forms_figure,
    map_figure,
    size_distributions_figure,
    sizes_figure,
)


def row(study, eta, zeta, seed=1, shaking=0.0, spread=0.0, fraction=None):
    fraction = 0.60 + 0.01 * eta + 0.02 * zeta if fraction is None else fraction
    values = {"study": study, "eta": eta, "zeta": zeta, "seed": seed, "std_eta": 0.0, "std_zeta": 0.0}
    values |= {"spread": spread, "law": "hertz", "shaking_s": shaking, "change": ""}
    values |= dict.fromkeys(RESULTS, 0.1) | {"solid_fraction": fraction}
    return values | {"mean_overlap": 1e-3, "time_s": 1.0, "steps": 1, "grains": 9, "cpu_s": 1.0}


@pytest.fixture
def rows():
    ratios = (1.0, 1.5, 2.0, 2.5)
    table = [row("deposit_map", eta, zeta, 6) for eta in ratios for zeta in ratios]
    table += [row("deposit_diagonal", r, r, seed, fraction=0.7 + 0.01 * seed) for r in ratios for seed in (1, 3)]
    table += [row("deposit_sizes", r, r, 7, spread=s, fraction=0.6 + 0.1 * s) for r in (1.0, 1.5) for s in (0.0, 0.8)]
    table += [row("deposit_bridge", r, r, shaking=s, fraction=0.55 + 0.01 * s) for r in (1.0, 2.0) for s in (0.0, 6.0)]
    return add_family(pd.DataFrame(table))


def labels_of(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_the_map_has_the_mean_of_each_form_in_its_cell(rows, tmp_path):
    figure = map_figure(rows)
    figure.savefig(tmp_path / "map.png", dpi=40)
    axes = figure.axes[0]
    image = axes.images[0].get_array()
    assert image.shape == (4, 4) and image[3, 0] == pytest.approx(0.66)
    # A cell of the diagonal is the mean over the seed of the map and two seeds of the diagonal.
    assert image[1, 1] == pytest.approx((0.645 + 0.71 + 0.73) / 3)
    assert axes.get_xlabel() == "η = a/b [-]" and len(axes.texts) == 16


def test_lines_over_form_hold_means_with_errors_and_the_maximum(rows, tmp_path):
    tops = maxima(rows)
    figure = forms_figure(rows, tops)
    figure.savefig(tmp_path / "forms.png", dpi=40)
    line = figure.axes[0].containers[0].lines[0].get_xydata()
    np.testing.assert_allclose(line[:, 0], [1.0, 1.5, 2.0, 2.5])
    np.testing.assert_allclose(line[1, 1], (0.645 + 0.71 + 0.73) / 3)
    assert len(figure.axes[0].containers) == 3 + len(tops[tops["of"] == "solid_fraction"])
    assert all("[-]" in axes.get_ylabel() and "[-]" in axes.get_xlabel() for axes in figure.axes)
    directions = directions_figure(rows)
    assert "isotropic" in labels_of(directions) and len(directions.axes) == 2


def test_sizes_and_bridge(rows, tmp_path):
    figure = sizes_figure(rows)
    figure.savefig(tmp_path / "sizes.png", dpi=40)
    np.testing.assert_allclose(figure.axes[0].containers[0].lines[0].get_xydata(), [[0.0, 0.6], [0.8, 0.68]])
    assert len(labels_of(figure)) == 2
    bridge = bridge_figure(rows)
    bridge.savefig(tmp_path / "bridge.png", dpi=40)
    points = [container.lines[0].get_xydata() for container in bridge.axes[0].containers]
    # The lines are the diagonal, and the sphere in both families of spheroids: not shaken, shaken, deposits.
    np.testing.assert_allclose(points[0], [[1.0, 0.45], [4.0, 0.45]])
    np.testing.assert_allclose(points[3], [[1.0, 0.39], [4.0, 0.39]])
    assert [len(each) for each in points] == [2, 1, 1] * 3
    assert "[-]" in bridge.axes[0].get_xlabel()


def test_distributions_of_size_have_the_means_of_what_is_drawn():
    """The circles are at the mean radius of 40 000 drawn sizes, and at their mean by volume."""
    figure = size_distributions_figure([0.2, 0.8])
    drawn = 0.5 * BetaSizes(1.0, 0.8, 3.0, 3.0).sizes(np.random.default_rng(1).random((40_000, 1)))
    for axes, weights in zip(figure.axes, (drawn**3, np.ones(len(drawn))), strict=True):
        lines = {line.get_label(): line for line in axes.lines}
        radius, density = lines["S = 0.8"].get_data()
        assert np.trapezoid(density, radius) == pytest.approx(1.0, abs=1e-9)
        (mark,) = axes.lines[3].get_xdata()
        mean = np.average(drawn, weights=weights)
        # Four standard errors of a weighted mean are allowed.
        error = np.sqrt(np.average((drawn - mean) ** 2, weights=weights**2) * (weights**2).sum()) / weights.sum()
        assert mark == pytest.approx(mean, abs=4 * error)
        assert "[-]" in axes.get_xlabel() and "[-]" in axes.get_ylabel()
    assert labels_of(figure) == ["S = 0.2", "S = 0.8", "mean"]
