"""Figures are drawn from what they are given, with units on every axis."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from simcore.figures.models import (
    form_figure,
    form_sets_figure,
    prediction_figure,
    shape_kind_figure,
    study_figure,
)
from simcore.figures.packings import packing_figure, packings_figure, profile_figure
from simcore.grains.form import features
from simcore.porosity import bulk_porosity, porosity_profile
from simcore.regression import fit


@pytest.fixture
def bed(packings):
    centres, width = packings.lattice("bcc", 3, 6)
    return packings.make(1e-2 * centres, 5e-3, width=1e-2 * width)


@pytest.fixture
def forms():
    rng = np.random.default_rng(0)
    flatness, elongation = rng.uniform(0.4, 0.9, (2, 12))
    table = pd.DataFrame({"case": ["U1"] * 6 + ["U7"] * 6, "L": 1 / elongation, "I": 1.0, "S": flatness})
    return table.assign(n=0.3 + 0.02 * table.L / table.S, n_std_error=0.003)


def check(figure, path):
    """Every axis with data states its unit; the figure can be saved as a picture and as a vector file."""
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
    assert any(f"{float(bulk['n']):.4f}" in label for label in lines)


@pytest.mark.parametrize("domain", ["periodic", "cylinder"])
def test_packings_are_drawn_with_a_size_scale(bed, domain, tmp_path):
    bed.attrs["domain_shape"] = domain
    check(packing_figure(bed, pixels=150), tmp_path)
    check(packings_figure({"a": bed, "b": bed, "c": bed}, pixels=100), tmp_path)


def test_form_figure_states_r_beside_the_studys(forms, tmp_path):
    study = pd.DataFrame({"study": ["single_form"], "case": ["U1"], "feature": ["EQ_inv"], "r": [0.964]})
    figure = form_figure(forms, study=study)
    check(figure, tmp_path)
    texts = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert texts == ["U1: r = 1.000 (study 0.964)", "U7: r = 1.000"]


def test_prediction_figure_holds_every_packing(forms, tmp_path):
    model = fit(features(forms.L, forms.I, forms.S)[["EQ_inv"]], forms.n, case="U1")
    predictions = forms.assign(simulated=forms.n, predicted=model.predict_form(forms.L, forms.I, forms.S))
    figure = prediction_figure(predictions, [model])
    check(figure, tmp_path)
    points = [line for line in figure.axes[0].get_lines() if line.get_linestyle() == "None"]
    assert sum(len(line.get_xdata()) for line in points) == len(forms)


def test_remaining_figures_are_drawn(forms, tmp_path):
    pairs = forms.assign(EQ=forms.S / forms.L, n_mesh=forms.n, n_ellipsoid=forms.n + 0.01)
    figure = shape_kind_figure(pairs)
    check(figure, tmp_path)
    assert "0.0100" in figure.axes[0].get_title()
    table = pd.DataFrame(
        {
            "case": ["U7", "B50"],
            "shaking_s": [1.0, 2.0],
            "n": [0.3, 0.26],
            "n_std_error": 0.004,
            "study_n": [0.29, np.nan],
        }
    )
    figure = study_figure(table, ["case", "shaking_s"])
    check(figure, tmp_path)
    assert [label.get_text() for label in figure.axes[0].get_yticklabels()] == ["U7, 1", "B50, 2"]
    mixtures = pd.DataFrame(
        {"mu_FL": [0.4, 0.6], "sigma_FL": 0.1, "mu_EL": [0.5, 0.7], "sigma_EL": 0.2, "n": [0.4, 0.38]}
    )
    check(form_sets_figure(mixtures), tmp_path)
