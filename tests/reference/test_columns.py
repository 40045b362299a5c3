"""Names, units and meaning of the columns of all tables."""

import shutil
from fnmatch import fnmatch

import pandas as pd
import pytest

from simcore.campaign.deposit_findings import findings as deposit_findings
from simcore.campaign.deposits import read_deposits
from simcore.campaign.gathering import COLUMNS as GATHERED
from simcore.campaign.gathering import COMPOSED, ORDER, RESULT
from simcore.campaign.study_tables import summarise
from simcore.paths import REFERENCE
from simcore.reference.columns import (
    COLUMN_OF_KEY,
    COLUMNS,
    COMMITTED_NAMES,
    FORM,
    SPECIFIED_FORM,
    SPECIFIED_MEANS,
    TABLES,
    describe_columns,
    find_column,
    study_names,
)
from simcore.reference.columns.studies import COMPOSITION
from simcore.report.committed import findings as committed_findings
from simcore.report.findings import Findings
from simcore.scene.specification import read_schema
from simcore.verification.packings import change_errors, cheapest_settings, study_errors, work_precision_of_studies
from simcore.verification.work_precision import settings_table
from tests.helpers.column_names import undescribed_columns
from tests.helpers.reference_rows import write_reference

STUDY_NAMES = {column.name for column in COLUMNS}
NAMES = STUDY_NAMES | set(COMMITTED_NAMES.values())
OF_DEPOSITS = "deposits"  # has columns of its own, of simcore.campaign.deposits


def test_each_column_is_described_once_with_a_meaning():
    names = [column.name for column in COLUMNS]
    assert len(set(names)) == len(names) and all(column.meaning for column in COLUMNS)
    groups = [group for groups in TABLES.values() for group in groups]
    assert all(column.name and column.meaning for group in groups for column in group)
    assert all(len({column.name for column in group}) == len(group) for group in groups)
    for of in (COLUMN_OF_KEY, study_names()):
        assert len(set(of.values())) == len(of)
    assert study_names("EQ") == {"mu_EQ": "EQ"} and {"EQ", "EL"} <= set(FORM)
    assert set(SPECIFIED_MEANS) < set(SPECIFIED_FORM) <= set(COMMITTED_NAMES)


@pytest.mark.parametrize("name", sorted(set(GATHERED) - {OF_DEPOSITS}))
def test_each_column_of_the_committed_rows_is_in_the_table(name):
    path = REFERENCE / f"{name}.csv"
    header = set(pd.read_csv(path, nrows=0)) if path.exists() else set()
    if name in COMPOSED:
        header = {column for column in header if not any(fnmatch(column, of.name) for of in COMPOSITION)}
    assert header | set(GATHERED[name][0]) | set(GATHERED[name][1]) | set(ORDER.get(name, RESULT)) <= NAMES


def test_each_column_of_each_committed_table_is_described(tmp_path):
    assert undescribed_columns(REFERENCE) == {}
    (tmp_path / "work_precision").mkdir()
    (tmp_path / "work_precision" / "rest.csv").write_text(",shape,case\n")
    assert undescribed_columns(tmp_path) == {"work_precision/rest.csv": ["case"]}


def test_a_name_is_described_by_the_table_in_which_it_stands():
    assert find_column("work_precision/rest.csv", "steps").meaning == "time steps per contact time"
    assert find_column("tables/mine", "steps").meaning == "number of time steps"
    assert find_column("single_form.csv", "representation") == find_column("tables/mine.csv", "kind")
    assert find_column("tables/mine_features", "mu_1/KIS_inv").name == "mu_*"
    assert find_column("tables/mine", "mu_1/KIS_inv") is None
    assert describe_columns("work_precision/packings")["cpu_s"].unit == "s"


def test_each_column_of_the_tables_of_committed_rows_is_described(tmp_path):
    rows, made = write_reference(tmp_path), tmp_path / "results" / "committed"
    for name in ("single_form", "form_mixture"):
        table = pd.read_csv(rows / f"{name}.csv").assign(n_error=0.002, grains=9, cpu_s=1.0)
        table.to_csv(rows / f"{name}.csv", index=False)
    mixtures = pd.read_csv(rows / "form_mixture.csv")
    mixtures.head(2).assign(choice="random", seed=1).to_csv(rows / "application.csv", index=False)
    shutil.copy(REFERENCE / "accuracy.csv", rows)
    shutil.copy(REFERENCE / "trends.csv", rows)
    Findings(committed_findings(rows)[0]).write_into(made)
    assert len(list(made.glob("*.csv"))) == 17
    assert undescribed_columns(made.parent) == {}


def test_each_column_of_the_tables_of_deposits_is_described(tmp_path):
    rows = read_deposits(REFERENCE / "deposits.csv")
    Findings({"packings": rows, **deposit_findings(rows)}).write_into(tmp_path / "deposits")
    assert undescribed_columns(tmp_path) == {}


def test_each_column_of_the_tables_of_precision_is_described(tmp_path):
    packings = pd.DataFrame({"study": "precision_faces", "faces": [300, 300, 100, 100], "seed": [1, 2, 1, 2]})
    packings = packings.assign(n=[0.40, 0.41, 0.42, 0.44], cpu_s=1.0, grain="G1")
    rows = [[{"varied": {"faces": 300, "seed": 1}, "is_base": True}]]
    errors = study_errors([packings], rows)
    runs = work_precision_of_studies(errors, ["precision_faces"], {"precision_faces": "faces"}, rows)
    tables = {
        "work_precision/packings": errors,
        "work_precision/cheapest_settings": cheapest_settings(errors),
        "work_precision/one_contact": runs,
        "work_precision/rotation": settings_table(runs),
        "differences": change_errors([packings], [["faces", "seed"]]),
    }
    (tmp_path / "work_precision").mkdir()
    for name, table in tables.items():
        table.to_csv(tmp_path / f"{name}.csv", index=False)
    assert undescribed_columns(tmp_path) == {}


def test_each_column_of_means_over_seeds_is_in_the_table():
    columns = {"study": "s", "case": "U1", "seed": [1, 2], "cpu_s": 9.0, "n": 0.4, "n_std_error": 0.01, "grains": 9}
    rows = pd.DataFrame(columns | dict.fromkeys([*FORM, "n_exact", "coordination_number"], 0.5))
    assert set(summarise(rows, ["case", "seed"])) <= STUDY_NAMES


def test_the_keys_that_columns_vary_are_keys_of_a_specification():
    for key in COLUMN_OF_KEY:
        group = read_schema("packing")
        for part in key.split("."):
            assert part in group["properties"], key
            group = group["properties"][part]
