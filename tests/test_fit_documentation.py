"""The example in docs/how_to/fit_a_table.md is what the command prints, and its table is made as the page says."""

import re

import numpy as np
import pandas as pd

from simcore.__main__ import main
from simcore.grains.measured_beds import read_measured_beds
from simcore.paths import REFERENCE, ROOT


def test_the_example_is_what_the_command_prints(capsys, monkeypatch):
    monkeypatch.chdir(ROOT)
    text = (ROOT / "docs" / "how_to" / "fit_a_table.md").read_text(encoding="utf-8")
    command, output = re.findall(r"^```(?:text)?\n(.*?)\n```", text, re.DOTALL | re.MULTILINE)
    assert main(command.removeprefix("scree ").split()) == 0
    told = capsys.readouterr()
    assert told.out.rstrip("\n") == output and told.err == ""


def test_the_table_of_the_example_is_that_of_committed_packings():
    rows = pd.read_csv(REFERENCE / "born_above_bed" / "form_mixture.csv")
    rows = rows[(rows.sigma_FL_nominal == 0.2) & (rows.sigma_EL_nominal == 0.1)]
    beds, _ = read_measured_beds(ROOT / "examples" / "measured.csv", "U1")
    assert len(beds) == len(rows) == 13
    for bed, row in zip(beds, rows.itertuples(), strict=True):
        given = (bed.n, bed.n_error, bed.sample.mu_EL, bed.sample.sigma_EL)
        np.testing.assert_allclose(given, (row.n, row.n_error, row.mu_EL, row.sigma_EL), atol=0.51e-4)
        # EQ is the product of two rounded means.
        np.testing.assert_allclose((bed.sample.mu_EQ, bed.sample.sigma_EQ), (row.mu_EQ, row.sigma_EQ), atol=2e-4)
