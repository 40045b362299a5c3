"""The README is short, its commands run, and its table of results follows from the committed tables."""

import re

import numpy as np
import pandas as pd
import pytest

from simcore.paths import REFERENCE, ROOT
from simcore.report.committed import findings
from tests.helpers.page_blocks import PageRun

README = (ROOT / "README.md").read_text(encoding="utf-8")
ROWS = [
    [cell.strip() for cell in line.strip("|").split("|")]
    for line in README.split("## How good is it?")[1].split("## Limits")[0].splitlines()
    if line.startswith("|")
][2:]


def numbers(text):
    """Return the numbers of a cell, with typographic minus signs read as such."""
    return [float(number.replace("−", "-")) for number in re.findall(r"[-+−]?\d+(?:\.\d+)?", text)]


@pytest.fixture(scope="module")
def tables():
    return findings(REFERENCE)[0]


def row(start):
    """Return the numbers in the columns of Scree and of Rettinger et al."""
    (cells,) = [cells for cells in ROWS if cells[0].startswith(start)]
    assert (REFERENCE / cells[3].strip("`")).exists()
    return numbers(cells[1]), numbers(cells[2])


def test_it_has_at_most_120_lines_and_the_two_commands_of_the_makefile():
    assert len(README.splitlines()) <= 120
    assert "```\nmake\nmake test\n```" in README
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert re.search(r"^all: environment$", makefile, re.M) and re.search(r"^test: environment$", makefile, re.M)


def test_its_commands_run_and_print_what_it_shows(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    PageRun(tmp_path).run(README.split("## From Python")[0])  # tests/package/test_public_names.py runs the rest


def test_every_row_of_the_results_is_compared():
    assert len(ROWS) == 12


def test_results_of_single_forms(tables):
    mean = tables["single_form_mean_form"].query("case == 'U1'").set_index("source")
    assert row("Porosity at the mean form") == (
        [pytest.approx(mean.n["synthetic"], abs=5e-4)],
        [pytest.approx(mean.r22_n["synthetic"], abs=5e-4)],
    )
    fits = tables["single_form"].query("case == 'U1' and term == 'EL_inv'").set_index("source")
    published = pd.read_csv(REFERENCE / "r22" / "table9_second_factor_mae.csv").set_index("case").EL_inv["U1"] / 1e3
    assert row("Mean error of the formula") == (
        [pytest.approx(fits.mean_absolute_error["synthetic"], abs=5e-5)],
        [pytest.approx(published, abs=5e-5)],
    )
    scans = tables["single_form_porosities"].query("source == 'scans' and case == 'U1'")
    model = pd.read_csv(REFERENCE / "r22" / "models.csv").query("model == 'single_form' and case == 'U1'").iloc[0]
    rest = scans.n - (model.intercept + model.EQ_inv / scans.EQ + model.EL_inv / scans.EL)
    assert row("63 scanned grains")[0] == [
        pytest.approx(rest.mean(), abs=5e-4),
        pytest.approx(rest.std() / np.sqrt(len(rest)), abs=5e-4),
    ]


def test_results_of_mixtures_and_of_the_rhine(tables):
    drawn = tables["application"].query("choice == 'random'").iloc[0]
    packed = row("The Rhine's gravel")
    assert packed == (
        [pytest.approx(drawn.n, abs=5e-5), pytest.approx(drawn.n_seed_error, abs=5e-5)],
        [pytest.approx(drawn.r22_n, abs=5e-4)],
    )
    predicted = tables["application_predictions"].query("kind == 'discrete'").iloc[0]
    assert row("The same, predicted") == (
        [pytest.approx(predicted.unified_predicted, abs=5e-4)],
        [pytest.approx(predicted.r22_predicted, abs=5e-4)],
    )
    long = tables["form_mixture_porosities"].query("mean_EL <= 0.5 and std_EL == 0.2").difference
    assert row("Very long grains")[0] == [
        pytest.approx(long.mean(), abs=5e-4),
        pytest.approx(long.std() / np.sqrt(len(long)), abs=5e-4),
    ]


def test_the_error_of_the_model_of_wide_sieve_curves():
    table = pd.read_csv(REFERENCE / "models" / "size_and_form_candidates.csv")
    chosen = table[table["chosen"] == "yes"]
    assert row("Mean error of [the model of wide")[0] == [pytest.approx(chosen["error_by_family"].item(), abs=5e-5)]


def test_results_against_experiments_and_known_outcomes(tables):
    validation = tables["validation"].set_index("case")
    assert row("U1 in a cylinder") == (
        [pytest.approx(validation.n["U1"], abs=5e-4), pytest.approx(validation.n_std_error["U1"], abs=5e-4)],
        [pytest.approx(validation.r22_n["U1"], abs=5e-4)],
    )
    assert "the laboratory measured 0.371" in README and validation.experiment_n["U1"] == 0.371
    ours, theirs = validation.experiment_error_percent, validation.r22_error_percent
    assert row("Seven sieve curves") == (
        [pytest.approx(ours.min(), abs=0.051), pytest.approx(ours.max(), abs=0.051)],
        [pytest.approx(theirs.min(), abs=0.051), pytest.approx(theirs.max(), abs=0.051)],
    )
    spheres = tables["near_spheres"].query("shape_kind == 'sphere'").iloc[0]
    assert row("Equal spheres")[0] == [
        pytest.approx(spheres.n, abs=5e-4),
        pytest.approx(spheres.n_std_error, abs=5e-4),
    ]
    inside = pd.read_csv(REFERENCE / "verification_packings.csv").inside
    assert row("Values of packings that are known")[0] == [inside.sum(), len(inside)]
    forms = pd.read_csv(REFERENCE / "single_form.csv").query("case == 'U1' and source == 'synthetic'")
    cpu = forms[forms.representation == "polyhedron"].cpu_s.mean()
    assert row("CPU time of a packing of one form, 1200 grains")[0] == [pytest.approx(cpu, abs=0.5)]
