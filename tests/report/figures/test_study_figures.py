"""A study's porosities are drawn over its settings, beside those of Rettinger et al. (2022)."""

import numpy as np
import pandas as pd
import pytest

from simcore.report.figures.studies import porosities_figure, study_figure, sweep_figure, trends_figure
from tests.helpers.figures import error_bar_points


def table(**columns):
    return pd.DataFrame({"n_std_error": 0.004, "r22_n": np.nan, **columns})


def test_settings_are_rows_with_r22_and_the_experiment(tmp_path):
    rows = table(case=["U7", "B50"], run=[1.0, 2.5], n=[0.3, 0.26], r22_n=[0.29, np.nan], r22_n_std=[0.001, np.nan])
    figure = study_figure(rows.assign(experiment_n=0.31, experiment_n_std=0.002), ["case", "run"])
    figure.savefig(tmp_path / "f.png", dpi=40)
    axes = figure.axes[0]
    assert [label.get_text() for label in axes.get_yticklabels()] == ["U7, 1", "B50, 2.5"]
    assert axes.get_xlabel() == "porosity n [-]"
    points = error_bar_points(axes)
    assert set(points) == {"simulated (± std. error)", "Rettinger et al. (± std. over runs)", "experiment (± std.)"}
    np.testing.assert_allclose(points["simulated (± std. error)"][:, 0], [0.3, 0.26])
    np.testing.assert_allclose(points["experiment (± std.)"][:, 0], 0.31)


def test_a_time_is_an_axis_in_order(tmp_path):
    rows = table(case=["U7"] * 3, shaking_s=[6.0, 1.0, 3.0], n=[0.28, 0.3, 0.29], r22_n=[0.282, 0.291, 0.285])
    figure = porosities_figure(rows, ["case", "shaking_s"])
    figure.savefig(tmp_path / "f.png", dpi=40)
    axes = figure.axes[0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("duration of shaking [s]", "porosity n [-]")
    points = error_bar_points(axes)
    np.testing.assert_allclose(points["U7, simulated (± std. error)"], [[1, 0.3], [3, 0.29], [6, 0.28]])
    np.testing.assert_allclose(points["U7, Rettinger et al."], [[1, 0.291], [3, 0.285], [6, 0.282]])


def test_a_contact_time_is_an_axis_with_the_words_of_tables():
    rows = table(case=["U1"] * 3, contact_time_s=[1e-3, 1e-4, 5e-4], n=[0.36, 0.34, 0.35])
    axes = porosities_figure(rows, ["contact_time_s"]).axes[0]
    assert axes.get_xlabel() == "contact time [ms]"
    np.testing.assert_allclose(error_bar_points(axes)["U1, simulated (± std. error)"][:, 0], [0.1, 0.5, 1.0])


def test_a_width_is_given_in_millimetres():
    rows = table(case=["U7"] * 2, width_m=[0.1, 0.2], mass_kg=[4.0, 16.0], n=[0.28, 0.3])
    axes = porosities_figure(rows, ["case", "width_m", "mass_kg"]).axes[0]
    assert axes.get_xlabel() == "width of the domain [mm]"
    np.testing.assert_allclose(error_bar_points(axes)["U7, simulated (± std. error)"][:, 0], [100.0, 200.0])


def test_forms_of_other_settings_have_markers_of_their_own(tmp_path):
    columns = {"case": "U1", "friction": [0.1, 0.1, 0.9, 0.9], "grain": ["a", "b"] * 2, "runs": 1}
    rows = table(**columns, n=[0.3, 0.31, 0.4, 0.41], EQ=[0.8, 0.25] * 2)
    rows = rows[["case", "friction", "grain", "runs", "n", "n_std_error", "r22_n", "EQ"]]
    figure = porosities_figure(rows, ["case", "friction"])
    figure.savefig(tmp_path / "f.png", dpi=40)
    (smooth, low), (rough, high) = sorted(error_bar_points(figure.axes[0]).items())
    assert "0.1: simulated" in smooth and "0.9: simulated" in rough
    np.testing.assert_allclose(low, [[1.25, 0.3], [4.0, 0.31]])
    np.testing.assert_allclose(high, [[1.25, 0.4], [4.0, 0.41]])


def test_original_meshes_follow_the_numbers():
    rows = table(case=["U7"] * 3, faces=["original", "300", "50"], n=[0.28, 0.29, 0.3])
    axes = sweep_figure(rows, "faces").axes[0]
    assert [label.get_text() for label in axes.get_xticklabels()] == ["50", "300", "original"]
    np.testing.assert_allclose(error_bar_points(axes)["U7, simulated (± std. error)"][:, 1], [0.3, 0.29, 0.28])


def test_forms_are_drawn_over_their_equancy(tmp_path):
    rows = table(case=["U1", "U1", "U7"], grain=["a", "b", "a"], EQ=[0.5, 0.25, 0.5], n=[0.36, 0.4, 0.3])
    rows = rows.assign(r22_n=[0.35, 0.38, np.nan], r22_n_error=0.006)
    figure = porosities_figure(rows[["case", "grain", "n", "n_std_error", "r22_n", "r22_n_error", "EQ"]], ["case"])
    figure.savefig(tmp_path / "f.png", dpi=40)
    first, second = figure.axes
    assert first.get_xlabel() == "1/mean equancy, L/S [-]" and first.get_ylabel() == "porosity n [-]"
    np.testing.assert_allclose(error_bar_points(first)["simulated (± std. error)"], [[2, 0.36], [4, 0.4]])
    np.testing.assert_allclose(
        error_bar_points(first)["model of Rettinger et al. for these forms (± its error)"][:, 1], [0.35, 0.38]
    )
    assert len(error_bar_points(second)) == 1


def test_one_setting_is_a_row_whatever_varies():
    rows = table(case=["U7"], shaking_s=[1.0], n=[0.3])
    assert porosities_figure(rows, ["case", "shaking_s"]).axes[0].get_xlabel() == "porosity n [-]"


@pytest.mark.parametrize("empty", [False, True])
def test_trends_are_marked_where_they_are_beyond_chance(empty, tmp_path):
    keys = {"study": "validation", "case": "U7", "kind": "polyhedron"}
    trends = pd.DataFrame(
        [
            {**keys, "quantity": "D", "spearman_z": -3.0, "relative_change": -0.02, "relative_change_std_error": 0.005},
            {**keys, "quantity": "FL", "spearman_z": 1.0, "relative_change": 0.01, "relative_change_std_error": 0.01},
        ]
    )
    figure = trends_figure(trends.iloc[:0] if empty else trends)
    figure.savefig(tmp_path / "f.png", dpi=40)
    assert len(figure.axes) == 4
    assert all(axes.get_xlabel() == "change over height [%]" for axes in figure.axes)
    if empty:
        return
    size, flatness = figure.axes[:2]
    (point,) = (c for c in size.collections if len(c.get_offsets()) and len(c.get_facecolor()))
    np.testing.assert_allclose(point.get_offsets(), [[-2.0, 0.0]])
    assert max(point.get_facecolor()[0][:3]) < 0.5
    (point,) = (c for c in flatness.collections if len(c.get_offsets()) and len(c.get_facecolor()))
    assert tuple(point.get_facecolor()[0]) == (1.0, 1.0, 1.0, 1.0)
    assert [label.get_text() for label in size.get_yticklabels()] == ["validation, U7, polyhedron"]
