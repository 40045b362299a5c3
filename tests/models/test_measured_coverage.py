"""Intervals from beds made by a known model contain the truth as often as docs/how_to/fit_a_table.md states."""

import re

import pytest

from benchmarks.studies.measured_fit import CONFIGURATIONS, DRAWS, coverage
from simcore.models.fitting import fit_reference_models
from simcore.paths import ROOT

LEAST = [("offset", 3), ("rescaling", 6), ("features", 9)]  # the smallest number of beds of each kind
ERROR = (0.95 * 0.05 / DRAWS) ** 0.5  # standard error of a share of 200 draws; that of a mean probability is smaller


@pytest.fixture(scope="module")
def base():
    return fit_reference_models().models["unified", "U1"]


def documented():
    """Return the rows of the table in docs/how_to/fit_a_table.md: (truth, beds) and three shares."""
    rows = re.findall(
        r"^\| (\w+) \| (\d+) \| ([\d.]+) \| ([\d.]+) \| ([\d.]+) \|$",
        (ROOT / "docs/how_to/fit_a_table.md").read_text(),
        re.M,
    )
    return {(truth, int(beds)): [float(share) for share in shares] for truth, beds, *shares in rows}


def test_known_models_come_back_within_their_intervals(base):
    """In 200 draws the model of the true kind keeps its 95 %; choosing among three kinds costs a little."""
    table = documented()
    assert list(table) == list(CONFIGURATIONS)
    for kind, beds in LEAST:
        row = coverage(kind, beds, base)
        # The coefficients of one draw are correlated, at worst fully.
        assert abs(row["coefficients"] - 0.95) < 4 * ERROR
        assert abs(row["prediction"] - 0.95) < 4 * ERROR
        assert 0.90 - 4 * ERROR < row["chosen"]
        assert table[kind, beds] == pytest.approx(
            [row[name] for name in ("coefficients", "prediction", "chosen")], abs=0.006
        )
