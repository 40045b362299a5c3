"""The stability map: every cell has its colour, lightness falls from stable to wrong, and counts are shown."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_rgb

from simcore.report.figures.stability import OUTCOMES, stability_figure


@pytest.fixture
def cells():
    rows = [("steps and contact time", x, y, "stable") for x in (1e-4, 1e-3) for y in (10, 20, 40)]
    rows[0] = (*rows[0][:3], "refused")
    rows[4] = (*rows[4][:3], "wrong")
    rows += [("weight and contact time", 10.0, 1e-4, "soft"), ("weight and contact time", 10.0, 1e-3, "stopped")]
    return pd.DataFrame(rows, columns=["map", "x", "y", "outcome"])


def test_every_cell_is_drawn_with_its_outcome(cells, tmp_path):
    figure = stability_figure(cells)
    steps, weight = figure.axes
    codes = steps.collections[0].get_array()
    order = list(OUTCOMES)
    expected = np.array([["refused", "stable"], ["stable", "wrong"], ["stable", "stable"]])  # rows are steps
    np.testing.assert_array_equal(codes, [[order.index(outcome) for outcome in row] for row in expected])
    assert [text.get_text() for text in steps.texts if text.get_text()] == ["r", "W"]
    assert steps.get_ylabel() == "steps per contact time [-]" and "[s]" in steps.get_xlabel()
    assert weight.get_xlabel() == "mass carried, relative to own mass [-]" and "[s]" in weight.get_ylabel()
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "stable and correct (4)" in labels and "W: silently wrong (1)" in labels
    figure.savefig(tmp_path / "map.png")


def test_it_reads_in_grey():
    """The lightness (luma) of each outcome is lower than that of the one before by at least a tenth."""
    luma = [np.dot([0.299, 0.587, 0.114], to_rgb(color)) for color, _, _ in OUTCOMES.values()]
    assert (np.diff(luma) < -0.1).all()


def test_an_unknown_outcome_is_refused(cells):
    with pytest.raises(ValueError, match="outcome 'fine' is not one of stable, vibrating, soft"):
        stability_figure(cells.assign(outcome="fine"))
