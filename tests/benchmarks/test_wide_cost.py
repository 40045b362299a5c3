"""The table of cost for wide sieve curves: pairs of one seed, and the rule that accepts a setting."""

import numpy as np
import pandas as pd
import pytest

from benchmarks.studies.wide_cost import COLUMNS, compare_means, compare_r22, cost_table, paired, read_tables, verdict
from simcore.paths import REFERENCE


def rows(porosities, cpu_s, first_seed=1):
    seeds = range(first_seed, first_seed + len(porosities))
    return pd.DataFrame({"case": "U5", "mass_kg": 1.4, "seed": seeds, "n": porosities, "n_error": 0.01, "grains": 1000,
                         "cpu_s": cpu_s})  # fmt: skip


TABLES = {
    "wide_quota": rows([0.30, 0.31, 0.33], [100.0, 110.0, 120.0]),
    "wide_short": rows([0.31, 0.34, 0.20], [55.0, 60.0, 65.0], first_seed=2),
    "wide_random": rows([0.30, 0.30], [101.0, 102.0]),
}
GATHERED = pd.DataFrame(
    [(study, "synthetic", row.cpu_s, 1e6 * row.cpu_s) for study, table in TABLES.items() for row in table.itertuples()],
    columns=["study", "source", "cpu_s", "grain_steps"],
)


def test_one_row_a_packing_with_its_grain_steps():
    table = cost_table(TABLES, GATHERED)
    assert list(table.columns) == COLUMNS and len(table) == 8
    np.testing.assert_allclose(table["grain_steps"], 1e6 * table["cpu_s"])
    assert set(table["shapes"]) == {"synthetic"}


def test_the_committed_table_is_that_of_the_committed_rows():
    made = cost_table(read_tables(), pd.read_csv(REFERENCE / "gathered.csv"))
    pd.testing.assert_frame_equal(made, pd.read_csv(REFERENCE / "wide_cost.csv"))


def test_means_of_packings_of_other_grains():
    (row,) = compare_means(cost_table(TABLES, GATHERED)).itertuples()
    assert (row.settings, row.case, row.beds) == ("wide_random", "U5", 2)
    assert row.difference == pytest.approx(0.30 - 0.94 / 3) and row.cost == pytest.approx(101.5 / 110.0)
    assert row.error == pytest.approx(
        np.std([0.30, 0.31, 0.33], ddof=1) / np.sqrt(3)
    )  # both random porosities are 0.30


def test_random_draws_of_the_preset_are_compared_with_its_quota():
    tables = {
        "wide_both": rows([0.3], [50.0]),
        "wide_both_random": rows([0.32], [60.0]),
        "wide_quota": rows([0.4], [90.0]),
    }
    (row,) = compare_means(pd.concat([table.assign(settings=name) for name, table in tables.items()])).itertuples()
    assert row.difference == pytest.approx(0.02) and row.cost == pytest.approx(1.2)


def test_pairs_with_the_settings_of_r22_have_the_same_grains():
    table = cost_table(TABLES, GATHERED)
    rows = pd.DataFrame({"case": "U5", "polyhedron_contact": "point", "steps_per_contact_time": [40.0, 40.0, 10.0],
                         "dashpot": "explicit", "seed": [1, 2, 2], "n": [0.31, 0.35, 0.0], "grains": [1000, 999, 1000],
                         "cpu_s": [50.5, 1.0, 1.0]})  # fmt: skip
    (row,) = compare_r22(table, rows).itertuples()
    assert row.seed == 1 and row.difference == pytest.approx(-0.01) and row.cost == pytest.approx(2.0)


def test_a_row_that_was_not_gathered_is_an_error():
    with pytest.raises(ValueError, match=r"0 packings of wide_short that took 65.0 s.*seed 4"):
        cost_table(TABLES, GATHERED[GATHERED["cpu_s"] != 65.0])


def test_pairs_have_the_same_seed():
    table = paired(cost_table(TABLES, GATHERED))
    assert list(table["settings"]) == ["wide_short"]  # wide_random has other grains
    row = table.iloc[0]
    assert row["pairs"] == 2 and row["difference"] == pytest.approx(0.005)  # 0.31 - 0.31 and 0.34 - 0.33
    assert row["error"] == pytest.approx(0.005) and row["cost"] == pytest.approx(115.0 / 230.0)
    assert row["verdict"] == "open: 2 of 3 pairs"


@pytest.mark.parametrize(
    "difference, error, pairs, required, expected",
    [
        (-0.0029, 0.0014, 3, 3, "accepted"),
        (-0.0031, 0.0014, 3, 3, "not accepted"),
        (0.0, 0.0016, 3, 3, "not accepted"),
        (0.0, np.nan, 1, 1, "not accepted"),
        (0.0, 0.0001, 3, 8, "open: 3 of 8 pairs"),
    ],
)
def test_the_rule(difference, error, pairs, required, expected):
    assert verdict(difference, error, pairs, required) == expected
