"""The tables and figures of a set of grains on a page."""

import numpy as np
import pandas as pd
import pytest

from simcore.grains.synthetic import synthetic_grains
from simcore.grains.tables import factor_correlations, form_table
from simcore.report.grains import grain_findings
from simcore.report.tables import show_table
from tests.helpers.column_names import undescribed_columns


@pytest.mark.parametrize("count", [1, 2])
def test_a_folder_of_one_or_two_grains_has_its_tables_and_figures(count, tmp_path):
    """What needs three grains, such as correlations, is empty."""
    found = grain_findings(synthetic_grains(seed=1, n=21)[:count])
    (statistics, *_) = found.tables["statistics"].to_dict("records")
    assert statistics["n_samples"] == count and np.isnan(statistics["shapiro_p_FL"]) and np.isnan(statistics["r_FL_EL"])
    assert len(found.tables["components"]) == 0 and found.tables["correlations"].iloc[:, 1:].isna().all(axis=None)
    for name, figure in found.figures.items():
        figure.savefig(tmp_path / f"{name}.png", dpi=30)
    assert show_table(found.tables["components"], "grains/principal_components").rows == []


def test_grains_have_tables_with_their_row_names_and_figures(tmp_path):
    grains = synthetic_grains(seed=1, n=21)
    found = grain_findings(grains)
    (tmp_path / "grains").mkdir()
    output = {name: tmp_path / "grains" / f"{name}.csv" for name in found.tables}
    found._replace(figures={}).write(output)
    assert undescribed_columns(tmp_path) == {}
    forms = pd.read_csv(output["forms"])
    assert list(forms.grain) == [grain.name for grain in grains]
    assert pd.read_csv(output["statistics"]).source[0] == "this set"
    table = pd.read_csv(output["correlations"], index_col=0)
    expected = factor_correlations(form_table(grains))
    assert list(table.index) == list(table) == list(expected)
    assert table.to_numpy() == pytest.approx(expected.to_numpy())
    assert (
        set(found.figures) == {"sheet", "steps", "zingg", "histograms", "matrix", "scans", "changes"}
        and not found.models
    )
