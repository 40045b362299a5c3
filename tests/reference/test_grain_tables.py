"""The committed tables of the synthetic grains are those of today's code."""

import pandas as pd

from benchmarks.studies.grain_tables import FOLDER, grain_tables


def test_committed_tables_are_those_of_the_grains():
    """If this test fails, run python -m benchmarks.studies.grain_tables --write."""
    tables = grain_tables()
    assert {path.stem for path in FOLDER.glob("*.csv")} == set(tables)
    for name, table in tables.items():
        committed = pd.read_csv(FOLDER / f"{name}.csv")
        assert [str(column) for column in table] == [column.replace("Unnamed: 0", "") for column in committed], name
        # The signs of the principal components, and the last component, are round-off.
        if name != "components":
            committed.columns = table.columns
            pd.testing.assert_frame_equal(
                committed, table.reset_index(drop=True), rtol=1e-4, atol=1e-6, check_dtype=False
            )


def test_the_form_statistics_are_those_of_the_rhine():
    statistics = pd.read_csv(FOLDER / "statistics.csv").set_index("source")
    names = ["mu_FL", "sigma_FL", "mu_EL", "sigma_EL"]
    assert statistics.loc["this set", names].tolist() == statistics.loc["paper Fig. 2", names].tolist()
