"""Figures about grains show the numbers of their tables, with units on every axis."""

import numpy as np
import pytest

from simcore.grains.scan_shapes import scan_ranges, shape_table
from simcore.grains.synthetic import synthetic_grains
from simcore.grains.tables import decimation_summary, decimation_table, factor_correlations, form_table
from simcore.reference.r22_tables import rhine_statistics
from simcore.report.figures import grains as figures


@pytest.fixture(scope="module")
def grains():
    return synthetic_grains(n=21)


@pytest.fixture(scope="module")
def table(grains):
    return form_table(grains)


def check(figure, path, units="[-]"):
    for axes in figure.axes:
        labels = [axes.get_xlabel(), axes.get_ylabel()]
        assert any(labels)
        others = ("form factor", "sieve size D [mm]", "")
        assert all(units in label or "[%]" in label or label in others for label in labels)
    figure.savefig(path)
    assert path.stat().st_size > 5000


def test_zingg_diagram_holds_every_grain(table, tmp_path):
    figure = figures.zingg_diagram({"a": table, "b": table.iloc[:5]})
    first, second = figure.axes[0].collections
    np.testing.assert_array_equal(first.get_offsets(), table[["FL", "EL"]])
    assert len(second.get_offsets()) == 5
    check(figure, tmp_path / "f.png")


def test_one_set_of_grains_is_coloured_by_sieve_class(table):
    figure = figures.zingg_diagram({"a": table})
    (points,) = figure.axes[0].collections
    np.testing.assert_array_equal(points.get_offsets(), table[["FL", "EL"]])
    bounds = [2.8, 4, 5.6, 8, 11.2, 16, 22.4, 31.5]
    np.testing.assert_allclose(points.norm.boundaries, bounds)
    colours = points.to_rgba(table.D_mm)
    of_class = np.digitize(table.D_mm, bounds)
    assert len(np.unique(colours, axis=0)) == len(np.unique(of_class)) == 7
    assert all(len(np.unique(colours[of_class == k], axis=0)) == 1 for k in range(1, 8))
    assert figure.axes[1].get_ylabel() == "sieve size D [mm]"


@pytest.mark.parametrize(
    ("sizes", "bounds"),
    [
        ([3, 3.1], [2.8, 4]),
        ([4, 8], [4, 5.6, 8]),
        ([4, 4], [4, 5.6]),
        ([0.5, 100], [0.5, 1, 2, 4, 8, 16, 31.5, 63, 125]),
    ],
)
def test_sieve_classes_contain_all_sizes(sizes, bounds):
    np.testing.assert_allclose(figures.sieve_class_bounds(sizes), bounds)


def test_r22_grains_are_shown_with_ours(table, tmp_path):
    study = rhine_statistics()
    figure = figures.zingg_diagram({"a": table}, study)
    (cross,) = figure.axes[0].containers
    np.testing.assert_allclose(cross[0].get_xydata()[0], [0.647, 0.682])
    assert cross.get_label() == "63 grains of Rettinger et al.: mean ± std."
    check(figure, tmp_path / "a.png")
    figure = figures.form_histograms(table, study)
    for axes, mean in zip(figure.axes, (0.647, 0.682), strict=True):
        theirs = {line.get_label(): line for line in axes.lines}["normal distribution, Rettinger et al."]
        assert abs(theirs.get_xdata()[np.argmax(theirs.get_ydata())] - mean) < 0.8 / 199
    check(figure, tmp_path / "b.png")


def test_histograms_count_every_grain(table, tmp_path):
    figure = figures.form_histograms(table)
    for axes in figure.axes:
        assert sum(bar.get_height() for bar in axes.patches) == len(table)
    check(figure, tmp_path / "f.png")


def test_correlation_matrix_shows_every_number(table, tmp_path):
    figure = figures.correlation_matrix(factor_correlations(table))
    assert len(figure.axes[0].texts) == 169
    check(figure, tmp_path / "f.png")


def test_shapes_and_decimation(grains, tmp_path):
    shapes = shape_table(grains)
    figure = figures.shapes_against_scans({"pebbles": shapes}, scan_ranges())
    offsets = figure.axes[0].collections[-1].get_offsets()
    np.testing.assert_array_equal(offsets, shapes[["sphericity_300", "facet_share_300"]])
    check(figure, tmp_path / "a.png")
    check(figures.decimation_changes(decimation_summary(decimation_table(grains))), tmp_path / "b.png")
