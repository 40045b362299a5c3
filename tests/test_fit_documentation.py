"""The examples in docs/how_to/fit_a_table.md are what the commands print, and their tables follow the page."""

import re

import numpy as np
import pandas as pd
import pytest

from simcore.__main__ import main
from simcore.grains.measured_beds import read_measured_beds
from simcore.paths import REFERENCE, ROOT
from simcore.reference.r22_tables import read_r22_table, rhine_statistics


def test_the_examples_are_what_the_commands_print(capsys, monkeypatch, tmp_path):
    """Of a block with several commands, the output of the last one is shown; files are written beside examples/."""
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "docs" / "how_to" / "fit_a_table.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```(?:text)?\n(.*?)\n```", text, re.DOTALL | re.MULTILINE)
    assert len(blocks) == 6
    for commands, output in zip(blocks[::2], blocks[1::2], strict=True):
        for command in commands.splitlines():
            capsys.readouterr()
            assert main(command.removeprefix("scree ").split()) == 0
        printed = capsys.readouterr()
        assert printed.out.rstrip("\n") == output and printed.err == ""


def test_the_porosity_from_a_bulk_density_is_that_of_the_page():
    text = (ROOT / "docs" / "how_to" / "fit_a_table.md").read_text(encoding="utf-8")
    pattern = r"n = 1 − ρ_bulk/ρ_grain, for example 1 − (\d+)/(\d+) = ([\d.]+)\."
    bulk, grain, n = re.search(pattern, " ".join(text.split())).groups()
    assert f"{1 - int(bulk) / int(grain):.3f}" == n


def test_the_table_of_gravels_is_that_of_the_paper():
    rows = pd.read_csv(ROOT / "examples" / "measured_curves.csv").set_index("sieve")
    cases, forms = read_r22_table("table3_cases").set_index("case"), rhine_statistics()
    assert rows.n.to_dict() == cases.n_exp.to_dict() and rows.n_error.to_dict() == cases.n_exp_std.to_dict()
    for column, name in (("mean_FL", "mu_FL"), ("std_FL", "sigma_FL"), ("mean_EL", "mu_EL"), ("std_EL", "sigma_EL")):
        assert (rows[column] == forms[name]).all()


@pytest.mark.parametrize(
    ("table", "selection", "number"),
    [
        ("measured.csv", "sigma_FL_nominal == 0.2", 13),
        ("measured_later.csv", "sigma_FL_nominal == 0.1 and mu_FL_nominal in (0.5, 0.7)", 4),
    ],
)
def test_the_tables_of_the_examples_are_those_of_committed_packings(table, selection, number):
    rows = pd.read_csv(REFERENCE / "born_above_bed" / "form_mixture.csv")
    rows = rows.query(f"sigma_EL_nominal == 0.1 and {selection}")
    beds, _ = read_measured_beds(ROOT / "examples" / table, "U1")
    assert len(beds) == len(rows) == number
    for bed, row in zip(beds, rows.itertuples(), strict=True):
        given = (bed.n, bed.n_error, bed.sample.mu_EL, bed.sample.sigma_EL)
        np.testing.assert_allclose(given, (row.n, row.n_error, row.mu_EL, row.sigma_EL), atol=0.51e-4)
        # EQ is the product of two rounded means.
        np.testing.assert_allclose((bed.sample.mu_EQ, bed.sample.sigma_EQ), (row.mu_EQ, row.sigma_EQ), atol=2e-4)
