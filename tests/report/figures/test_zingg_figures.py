"""Zingg diagrams show every packing, and lines of the model only among the forms to which it was fitted."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex

from simcore.grains.form import features
from simcore.models.regression import fit
from simcore.report.figures.zingg import ELONGATION, FLATNESS, form_sets_figure, porosity_zingg_figure


@pytest.fixture
def packings():
    rng = np.random.default_rng(0)
    table = pd.DataFrame({"case": ["U1"] * 8 + ["U7"] * 8, "FL": rng.uniform(0.4, 0.9, 16)})
    table["EL"] = rng.uniform(0.4, 0.9, 16)
    return table.assign(n=0.3 + 0.02 / (table.FL * table.EL))


@pytest.fixture
def model(packings):
    rows = packings[packings.case == "U1"]
    return fit(features(1 / rows.EL, np.ones(8), rows.FL)[["EQ_inv", "EL_inv"]], rows.n, case="U1")


def test_porosity_shades_every_packing_on_one_scale(packings, model, tmp_path):
    figure = porosity_zingg_figure(packings, {"U1": model})
    figure.savefig(tmp_path / "f.png", dpi=40)
    first, second, bar = figure.axes
    for axes in (first, second):
        assert (axes.get_xlabel(), axes.get_ylabel()) == (FLATNESS, ELONGATION)
    assert bar.get_ylabel() == "porosity n [-]"
    for axes, (_, rows) in zip((first, second), packings.groupby("case"), strict=True):
        points = next(c for c in axes.collections if len(c.get_offsets()) == len(rows))
        np.testing.assert_allclose(points.get_offsets(), rows[["FL", "EL"]])
        np.testing.assert_allclose(points.get_array(), rows.n)
        assert points.get_clim() == (packings.n.min(), packings.n.max())


def test_lines_of_the_model_stay_among_the_forms(packings, model):
    drawn = porosity_zingg_figure(packings, {"U1": model}).axes[0].collections
    without = porosity_zingg_figure(packings).axes[0].collections
    (lines,) = [c for c in drawn if hasattr(c, "levels")]
    assert not [c for c in without if hasattr(c, "levels")]
    rows = packings[packings.case == "U1"]
    paths = [path for path in lines.get_paths() if len(path.vertices)]
    assert len(paths) > 2
    for path in paths:
        low, high = path.vertices.min(axis=0), path.vertices.max(axis=0)
        assert (low >= rows[["FL", "EL"]].min().to_numpy() - 1e-9).all()
        assert (high <= rows[["FL", "EL"]].max().to_numpy() + 1e-9).all()


def test_forms_on_one_line_have_no_lines_between_them(packings, model):
    on_a_line = packings.assign(EL=packings.FL)
    assert not [c for c in porosity_zingg_figure(on_a_line, {"U1": model}).axes[0].collections if hasattr(c, "levels")]


def test_form_sets_are_ellipses_of_one_standard_deviation(tmp_path):
    mixtures = pd.DataFrame(
        {"mu_FL": [0.4, 0.6], "sigma_FL": 0.1, "mu_EL": [0.5, 0.7], "sigma_EL": 0.2, "n": [0.4, 0.38]}
    )
    figure = form_sets_figure(mixtures)
    figure.savefig(tmp_path / "f.png", dpi=40)
    ellipses = figure.axes[0].patches
    assert [(e.center, e.width, e.height) for e in ellipses] == [((0.4, 0.5), 0.2, 0.4), ((0.6, 0.7), 0.2, 0.4)]
    assert len(form_sets_figure(mixtures.assign(case=["U1", "U7"])).axes) == 3


def test_a_gravel_is_drawn_in_black_among_the_form_sets():
    mixtures = pd.DataFrame({"mu_FL": [0.4], "sigma_FL": 0.1, "mu_EL": [0.5], "sigma_EL": 0.2, "n": [0.4]})
    gravel = {"mu_FL": 0.647, "sigma_FL": 0.175, "mu_EL": 0.682, "sigma_EL": 0.139}
    figure = form_sets_figure(mixtures, gravel)
    ellipse = figure.axes[0].patches[-1]
    assert (ellipse.center, ellipse.width, ellipse.height) == ((0.647, 0.682), 0.35, 0.278)
    assert to_hex(ellipse.get_edgecolor()) == "#000000"
    np.testing.assert_allclose(figure.axes[0].collections[1].get_offsets(), [[0.647, 0.682]])
    assert "Rhine gravel" in [text.get_text() for text in figure.legends[0].get_texts()]
