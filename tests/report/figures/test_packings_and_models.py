"""Figures of packings and models show the given data, with units on every axis."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from simcore.evaluation.porosity import bulk_porosity, porosity_profile
from simcore.evaluation.rounding import rounded
from simcore.grains.form import features
from simcore.models.regression import fit
from simcore.report.figures.models import form_figure, prediction_figure, shape_kind_figure
from simcore.report.figures.packings import packing_figure, packings_figure, profile_figure
from tests.helpers.figures import error_bar_points
from tests.helpers.packings import make_packing, sphere_lattice


@pytest.fixture
def bed():
    centres, width = sphere_lattice("bcc", 3, 6)
    return make_packing(1e-2 * centres, 5e-3, width=1e-2 * width)


@pytest.fixture
def forms():
    rng = np.random.default_rng(0)
    flatness, elongation = rng.uniform(0.4, 0.9, (2, 12))
    table = pd.DataFrame({"case": ["U1"] * 6 + ["U7"] * 6, "L": 1 / elongation, "I": 1.0, "S": flatness})
    return table.assign(n=0.3 + 0.02 * table.L / table.S, n_std_error=0.003)


def check(figure, path):
    """Check that every axis with data has its unit, and that the figure can be saved as a picture and as vectors."""
    assert isinstance(figure, Figure)
    for axes in figure.axes:
        if axes.axison:
            labels = [axes.get_xlabel(), axes.get_ylabel()]
            assert any("[" in label for label in labels), labels
            assert all("[" in label for label in labels if label)
    figure.savefig(path / "figure.png", dpi=40)
    figure.savefig(path / "figure.pdf")


def test_profile_shows_both_methods_and_the_interval(bed, tmp_path):
    profiles = {method: porosity_profile(bed, method=method)["porosity"] for method in ("spheres", "exact")}
    bulk = bulk_porosity(bed)
    figure = profile_figure(profiles, bulk)
    check(figure, tmp_path)
    lines = {line.get_label(): line for line in figure.axes[0].get_lines()}
    np.testing.assert_allclose(lines["spheres"].get_xdata(), profiles["spheres"])
    np.testing.assert_allclose(lines["exact"].get_ydata(), 1e3 * profiles["exact"]["z"])
    assert f"bulk n = {rounded(float(bulk['n']), float(bulk['n_std_error']))}" in lines


@pytest.mark.parametrize("domain", ["periodic", "cylinder"])
def test_packings_are_drawn_with_a_size_scale(bed, domain, tmp_path):
    bed.attrs["domain_shape"] = domain
    check(packing_figure(bed, pixels=150), tmp_path)
    check(packings_figure([("a", bed), ("a", bed), ("c", bed)], pixels=100), tmp_path)


def test_grains_of_one_size_and_form_are_coloured_by_the_angle_of_their_long_axes(tmp_path):
    """The longest axis is a grain's own z: vertical without rotation, horizontal after a quarter turn about x."""
    level = [np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0]
    bed = make_packing([[0, 0, 0.01], [0.03, 0, 0.01]], [[3e-3, 4e-3, 6e-3]] * 2, [[1.0, 0, 0, 0], level])
    figure = packing_figure(bed, pixels=150)
    check(figure, tmp_path)
    bar = figure.axes[1]
    assert "angle of the longest axis" in bar.get_ylabel() and bar.get_ylim() == (0.0, 90.0)
    image = np.asarray(figure.axes[0].images[0].get_array())
    upright, level = np.array_split(image, 2, axis=1)  # each grain is in one half of the picture
    brightness = [half[half[..., 3] > 0.99, :3].mean() for half in (upright, level)]
    assert brightness[1] > 1.5 * brightness[0]


@pytest.fixture
def study():
    """Return the correlations of Rettinger et al., and their models as in models.csv."""
    r = pd.DataFrame({"study": ["single_form"], "case": ["U1"], "feature": ["EQ_inv"], "r": [0.964]})
    models = pd.DataFrame({"model": "single_form", "case": ["U1"], "intercept": [0.278], "EQ_inv": [0.019]})
    return r, models.assign(EL_inv=0.014, equation_arxiv=17)


def legend(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


def test_form_figure_has_a_fit_for_each_case_and_feature(forms, study, tmp_path):
    figure = form_figure(forms, r22_correlations=study[0], r22_models=study[1])
    figure.savefig(tmp_path / "figure.pdf")
    assert len(figure.axes) == 2 * 3
    # Panels share their axes; the labels are below and at the left.
    assert [axes.get_ylabel() for axes in figure.axes[::3]] == ["U1: porosity n [-]", "U7: porosity n [-]"]
    assert [axes.get_xlabel() for axes in figure.axes[3:]] == [
        "longest over shortest axis L/S [-]", "inverse Janke form factor [-]", "Wentworth flatness (L + I)/(2 S) [-]",
    ]  # fmt: skip
    assert set(legend(figure.axes[0])) == {
        "6 forms", "fit: r = 1.000 (Rettinger et al. 0.964)",
        f"Rettinger et al., Eq. 17 at mean L/I = {forms.L[:6].mean():.2f}",
    }  # fmt: skip
    assert set(legend(figure.axes[3])) == {"6 forms", "fit: r = 1.000"}
    lines = {line.get_label(): line.get_xydata() for line in figure.axes[0].lines}
    # The forms were made with n = 0.3 + 0.02 L/S.
    fit_line = lines["fit: r = 1.000 (Rettinger et al. 0.964)"]
    np.testing.assert_allclose(fit_line[:, 1], 0.3 + 0.02 * fit_line[:, 0])
    (theirs,) = (line for label, line in lines.items() if label.startswith("Rettinger"))
    np.testing.assert_allclose(theirs[:, 1], 0.278 + 0.019 * theirs[:, 0] + 0.014 * forms.L[:6].mean())
    assert len(error_bar_points(figure.axes[0])["6 forms"]) == 6


def test_prediction_figure_holds_every_packing(forms, tmp_path):
    model = fit(features(forms.L, forms.I, forms.S)[["EQ_inv"]], forms.n, case="U1")
    predictions = forms.assign(simulated=forms.n, predicted=model.predict_form(forms.L, forms.I, forms.S))
    figure = prediction_figure(predictions, [model])
    check(figure, tmp_path)
    assert len(figure.axes) == 1
    assert sum(map(len, error_bar_points(figure.axes[0]).values())) == len(forms)


def test_r22_predictions_are_shown_with_ours_and_their_error(forms, tmp_path):
    predictions = forms.assign(simulated=forms.n, predicted=forms.n, r22_predicted=forms.n - 0.01)
    figure = prediction_figure(predictions, [])
    check(figure, tmp_path)
    ours, theirs = figure.axes
    assert [axes.get_title() for axes in (ours, theirs)] == ["our model", "model of Rettinger et al."]
    assert "U1: mean error −0.0100, RMS 0.0100" in legend(theirs)
    np.testing.assert_allclose(
        np.concatenate([points[:, 1] for points in error_bar_points(theirs).values()]), np.asarray(forms.n) - 0.01
    )


def test_shape_kinds_name_their_difference_and_show_spheres_where_there_are(forms, tmp_path):
    pairs = forms.assign(EQ=forms.S / forms.L, n_mesh=forms.n, n_ellipsoid=forms.n + 0.01)
    figure = shape_kind_figure(pairs.assign(n_mesh_error=0.002, n_ellipsoid_error=0.003))
    check(figure, tmp_path)
    assert "0.0100" in figure.axes[0].get_title()
    near = pd.DataFrame({"case": "U1", "EQ": [1.0, 1 / 1.1, 1 / 1.2], "n": [0.36, 0.34, 0.33], "n_std_error": 0.004})
    figure = shape_kind_figure(pairs, near)
    check(figure, tmp_path)
    points = error_bar_points(figure.axes[0])
    np.testing.assert_allclose(points["spheres"], [[1.0, 0.36]])
    np.testing.assert_allclose(points["ellipsoids with FL = EL"], [[1.1, 0.34], [1.2, 0.33]])
    assert len(points["grains (polyhedra)"]) == len(points["their equivalent ellipsoids"]) == 6
    assert "equal spheres, Rettinger et al.: 0.36" in [text.get_text() for text in figure.legends[0].get_texts()]
    assert "spheres" not in error_bar_points(figure.axes[1])  # U7 has none
