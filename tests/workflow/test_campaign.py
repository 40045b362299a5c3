"""A small campaign, run: its results, and what runs again after a change."""

import re

import pandas as pd
import pytest
import xarray as xr

from tests.helpers.column_names import undescribed_columns

pytestmark = pytest.mark.workflow


def test_the_models_come_from_the_packings(finished):
    workplace, _ = finished
    results = workplace.folder / "results" / "smoke"
    packings = pd.read_csv(results / "tables" / "single_form_packings.csv")
    assert len(packings) == 5
    assert packings.n.between(0.2, 0.8).all()
    model = pd.read_csv(results / "models" / "single_form.csv")
    assert model.query("model == 'single_form'").term.tolist() == ["intercept", "EQ_inv", "EL_inv"]
    with xr.open_dataset(results / "packings" / "single_form" / "U1-form01.nc") as packing:
        assert packing.attrs["converged"] == 1


def test_every_table_and_the_report_are_marked_as_tests(finished):
    workplace, _ = finished
    results = workplace.folder / "results" / "smoke"
    tables = [*(results / "tables").glob("*.csv"), *(results / "models").glob("*.csv")]
    assert len(tables) > 9
    for table in tables:
        assert (pd.read_csv(table).note == "test only").all(), table
    assert "Test only" in (results / "report.html").read_text()
    # Chromium shows a page as a base64 data URL up to 2 MB.
    assert "Test only" in (results / "tables.html").read_text()
    assert (results / "tables.html").stat().st_size < 1.4e6


def test_each_job_wrote_the_log_that_snakemake_names(finished):
    workplace, _ = finished
    logs = re.findall(r"^ +log: (\S+)$", (workplace.folder / "said.txt").read_text(), re.MULTILINE)
    assert len(logs) > 20
    assert [log for log in logs if not (workplace.folder / log).is_file()] == []


def test_each_column_of_each_table_is_described(finished):
    workplace, _ = finished
    assert undescribed_columns(workplace.folder / "results" / "smoke") == {}


def test_snakemake_looks_for_jobs_when_one_has_ended(finished):
    """The Snakefile removes the limit of starts; with it, Snakemake looks at least every second while jobs wait."""
    workplace, _ = finished
    said = (workplace.folder / "said.txt").read_text()
    jobs = said.count("Finished jobid:")
    assert jobs > 20
    assert 1 <= said.count("Ready jobs:") <= jobs + 1


def test_a_second_run_has_nothing_to_do(finished):
    workplace, arguments = finished
    status, said = workplace.run(*arguments)
    assert status == 0
    assert "Nothing to be done" in said


def test_a_changed_study_runs_again_and_no_other(finished):
    workplace, arguments = finished
    change = "studies={shaking_periodic: {varies: {shaking.duration: [0.3 s]}}}"
    jobs = workplace.plan(*arguments, "--config", change)
    assert {study for _, study in jobs if study} == {"shaking_periodic"}
    assert [rule for rule, _ in jobs].count("packing") == 1
    assert "single_form_models" not in {rule for rule, _ in jobs}


def test_a_changed_evaluation_packs_nothing(finished):
    workplace, arguments = finished
    rules = [rule for rule, _ in workplace.plan(*arguments, "--config", "porosity={cut: 5 mm}")]
    assert rules.count("porosity") == 7
    assert "packing" not in rules


def test_tables_of_a_campaign_are_kept_as_the_default_ones_but_not_of_a_test(finished):
    workplace, arguments = finished
    status, said = workplace.run(*arguments, "--", "keep_default")
    assert status != 0 and "`test_only` is set" in said
    (workplace.folder / "keep.yaml").write_text("test_only: false\n")
    status, said = workplace.run(*arguments, "keep.yaml", "--", "keep_default")
    assert status != 0 and "leave out its overlays, or set `reference` to another folder" in said
    (workplace.folder / "keep.yaml").write_text("test_only: false\nreference: kept\n")
    keep = ("keep.yaml", "--", "keep_default")
    assert "packing" not in {rule for rule, _ in workplace.plan(*arguments, *keep)}
    status, said = workplace.run(*arguments, *keep)
    assert status == 0, said
    results, kept = workplace.folder / "results" / "smoke", workplace.folder / "kept" / "default"
    for folder, name, place in (
        ("models", "single_form.csv", "models"),
        ("tables", "single_form.csv", "."),
        ("tables", "shaking_periodic.csv", "."),
        ("campaign", "cost.csv", "."),
    ):
        assert (kept / place / name).read_text() == (results / folder / name).read_text()
