"""Calliper axes instead of those of the mass-equivalent ellipsoid change the predicted porosity by little."""

import numpy as np
import pandas as pd
import pytest
from scipy.spatial.distance import pdist, squareform

import simcore
from simcore.grains.synthetic import synthetic_grains
from simcore.paths import ROOT


def calliper_axes(points):
    """Return the longest distance, the longest across it and the extent across both of (n, 3) points."""
    axes = []
    for _ in range(3):
        distances = squareform(pdist(points))
        first, second = np.unravel_index(distances.argmax(), distances.shape)
        axes.append(distances[first, second])
        direction = (points[second] - points[first]) / axes[-1]
        points = points - np.outer(points @ direction, direction)
    return axes


def test_the_axes_of_a_box_are_its_diagonal_and_what_is_across():
    corners = np.array([(x, y, z) for x in (0, 3.0) for y in (0, 2.0) for z in (0, 1.0)])
    assert calliper_axes(corners)[0] == pytest.approx(np.sqrt(14))


def test_calliper_axes_lower_the_predicted_porosity_as_the_tutorial_says(tmp_path):
    grains = synthetic_grains()
    tables = {
        "calliper": [calliper_axes(grain.vertices) for grain in grains],
        "ellipsoid": [(grain.L, grain.I, grain.S) for grain in grains],
    }
    n = {}
    for name, axes in tables.items():
        path = tmp_path / f"{name}.csv"
        pd.DataFrame(axes, columns=["L", "I", "S"]).to_csv(path, index=False)
        predicted = simcore.predict(path, "one-class")
        (n[name],) = predicted[(predicted.model == "unified") & (predicted.by == "ours")].n
    assert n["calliper"] - n["ellipsoid"] == pytest.approx(-0.002, abs=5e-4)
    page = (ROOT / "docs/tutorials/porosity_of_my_gravel.md").read_text(encoding="utf-8")
    assert "0.002 (`tests/documentation/test_calliper_axes.py`)" in page
