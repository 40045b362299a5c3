"""One table of the columns of all tables of studies."""

import pandas as pd
import pytest

from simcore.campaign.gathering import COLUMNS as GATHERED
from simcore.campaign.gathering import ORDER, RESULT
from simcore.campaign.study_tables import summarise
from simcore.paths import REFERENCE
from simcore.reference.columns import (
    COLUMN_OF_KEY,
    COLUMNS,
    COMMITTED_NAMES,
    FORM,
    SPECIFIED_FORM,
    study_names,
)
from simcore.scene.specification import resolve

STUDY_NAMES = {column.name for column in COLUMNS}
NAMES = STUDY_NAMES | set(COMMITTED_NAMES.values())
OF_DEPOSITS = "deposits"  # has columns of its own, of simcore.campaign.deposits


def test_each_column_stands_there_once_and_has_a_meaning():
    names = [column.name for column in COLUMNS]
    assert len(set(names)) == len(names) and all(column.meaning for column in COLUMNS)
    for of in (COLUMN_OF_KEY, study_names()):
        assert len(set(of.values())) == len(of)
    assert (
        study_names("EQ") == {"mu_EQ": "EQ"}
        and {"EQ", "EL"} <= set(FORM)
        and set(SPECIFIED_FORM) <= set(COMMITTED_NAMES)
    )


@pytest.mark.parametrize("name", sorted(set(GATHERED) - {OF_DEPOSITS}))
def test_each_column_of_the_committed_rows_is_in_the_table(name):
    path = REFERENCE / f"{name}.csv"
    header = set(pd.read_csv(path, nrows=0)) if path.exists() else set()
    assert header | set(GATHERED[name][0]) | set(GATHERED[name][1]) | set(ORDER.get(name, RESULT)) <= NAMES


def test_each_column_of_means_over_seeds_is_in_the_table():
    columns = {"study": "s", "case": "U1", "seed": [1, 2], "cpu_s": 9.0, "n": 0.4, "n_std_error": 0.01, "grains": 9}
    rows = pd.DataFrame(columns | dict.fromkeys([*FORM, "n_exact", "coordination_number"], 0.5))
    assert set(summarise(rows, ["case", "seed"])) <= STUDY_NAMES


def test_the_keys_that_columns_vary_are_keys_of_a_specification():
    spread = {"mean": 0.6, "std": 0.1}
    form = {"kind": "polyhedron", "choice": "form_distribution", "flatness": spread, "elongation": spread}
    bare = {"name": "any", "domain": {"width": "1 m", "height": "1 m"}, "sizes": {"case": "U1"}, "shapes": form}
    specification = resolve(bare | {"amount": {"grains": 9}})
    for key in COLUMN_OF_KEY:
        group = specification
        for part in key.split("."):
            assert part in group, key
            group = group[part]
