"""The table of the costs of studies, compared with sums by hand."""

import pandas as pd
import pytest

from simcore.campaign.cost_table import cost_table


def test_hours_of_each_study_and_of_all():
    packings = pd.DataFrame(
        {
            "study": ["a", "a", "b"],
            "grains": [100, 300, 20_000],
            "steps": [1000, 2000, 1_500_000],
            "cpu_s": [1800.0, 5400.0, 36_000.0],
        }
    )
    table = cost_table(packings).set_index("study")
    assert list(table.index) == ["a", "b", "all"]
    assert table.loc["a", ["packings", "grains", "cpu_h", "cpu_h_per_packing"]].tolist() == [2, 400, 2.0, 1.0]
    assert table.loc["a", "grain_steps"] == 100 * 1000 + 300 * 2000
    # Study b has the grains and steps of one packing of Rettinger et al. (2022).
    assert table.loc["b", "r22_cpu_h"] == pytest.approx(230.0)
    assert table.loc["b", "cpu_us_per_grain_step"] == pytest.approx(1.2)
    assert table.loc["all", "cpu_h"] == pytest.approx(12.0)
    assert table.loc["all", "cpu_us_per_grain_step"] == pytest.approx(12 * 3.6e9 / 3.00007e10, rel=1e-5)
