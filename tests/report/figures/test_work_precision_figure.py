"""The figure of error over CPU time: axes, Pareto front, default and reference."""

import numpy as np
import pandas as pd
import pytest

from simcore.report.figures.saving import save_figure
from simcore.report.figures.work_precision import work_precision_figure
from simcore.verification.work_precision import settings_table


def runs(methods=2):
    rows = [
        {
            "case": case,
            "quantity": "porosity",
            "method": f"method {m}",
            "setting": n,
            "default": (m, n) == (0, 20),
            "repeat": repeat,
            "error": (1.0 + m) / n,
            "error_std": 0.1 / n,
            "cpu_s": 1e-6 * n * (1.0 + 0.1 * repeat),
            "reference_error": 1e-3,
        }
        for case in ("first", "second")
        for m in range(methods)
        for n in (10, 20, 40)
        for repeat in range(3)
    ]
    return pd.DataFrame(rows)


def draw(table):
    return work_precision_figure(table, "CPU time of a packing", {"porosity": "error of n [-]"}, "steps", note="here")


def test_axes_are_logarithmic_and_carry_units():
    for axes in draw(runs()).axes:
        assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
        assert axes.get_xlabel() == "CPU time of a packing [µs]"
    first, second = draw(runs()).axes
    assert first.get_ylabel() == "error of n [-]"
    assert (first.get_title(), second.get_title()) == ("first", "second")


def test_front_default_and_reference_are_marked():
    table = runs()
    figure = draw(table)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {"method 0", "method 1", "Pareto front", "default", "error of the reference"} == set(labels)
    on_front = settings_table(table).query("case == 'first' and on_front")
    assert set(on_front["method"]) == {"method 0"}  # the other has twice the error at the same cost
    rings = [line for line in figure.axes[0].lines if line.get_markersize() == 9]
    np.testing.assert_allclose(np.sort(rings[0].get_xdata()), 1e6 * np.sort(on_front["cpu_s"]))
    stars = [line for line in figure.axes[0].lines if line.get_marker() == "*"]
    np.testing.assert_allclose(stars[0].get_ydata(), [1.0 / 20])


def test_it_is_written_as_picture_and_as_vectors(tmp_path):
    for name in ("figure.png", "figure.pdf"):
        save_figure(draw(runs()), tmp_path / name)
        assert (tmp_path / name).stat().st_size > 1000


def test_more_methods_than_styles_are_refused():
    with pytest.raises(ValueError, match="9 methods, but only"):
        draw(runs(methods=9))
