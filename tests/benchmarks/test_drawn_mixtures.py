"""The 104 statistics of form of the committed mixtures follow from their grains, which are drawn again."""

import re

import numpy as np
import pandas as pd
import pytest

from benchmarks.studies.drawn_mixtures import drawn_mixtures, read_rows
from simcore.grains.statistics import STATISTICS
from simcore.models.regression import correlate
from simcore.paths import REFERENCE, ROOT

COMMITTED = REFERENCE / "models" / "form_mixture_correlations.csv"
DECIMALS = 6  # of the statistics in the rows


@pytest.fixture(scope="module")
def rows():
    return read_rows()


@pytest.fixture(scope="module")
def drawn(rows):
    return drawn_mixtures(rows)


def test_the_statistics_of_the_drawn_grains_are_those_of_the_rows(rows, drawn):
    assert drawn.shape == (len(rows), 104)
    for name in STATISTICS:
        np.testing.assert_allclose(drawn[name], rows[name], rtol=0, atol=0.5001 * 10**-DECIMALS, err_msg=name)


def test_the_correlations_are_those_of_the_drawn_grains(rows, drawn):
    """The packings of a set are averaged by hand, instead of by the function that makes the table."""
    table = pd.read_csv(COMMITTED).set_index("feature")
    sets = [rows[name] for name in ("mean_FL", "std_FL", "mean_EL", "std_EL")]
    means = drawn.assign(n=rows["n"]).groupby(sets).mean()
    expected = correlate(means.drop(columns="n"), means["n"])
    assert set(table.index) == set(drawn) and len(means) == 52
    np.testing.assert_allclose(table["r"], expected[table.index], rtol=1e-5)
    assert list(table["rank"]) == list(range(1, 105))
    assert (table["r"].abs().diff().dropna() <= 0).all()


def test_a_packing_that_no_configuration_lists_is_refused(rows):
    with pytest.raises(ValueError, match=r"workstation.yaml do not list the packing .*'mean_FL': 0.45"):
        drawn_mixtures(rows.head(1).assign(mean_FL=0.45))


def test_the_texts_have_the_highest_correlation_and_that_of_the_mean_equancy():
    table = pd.read_csv(COMMITTED).query("case == 'U1'").set_index("feature")
    best, equancy = table.loc["mu_1/KIS"], table.loc["mu_EQ_inv"]
    assert best["rank"] == 1 and equancy["rank"] == 10
    findings, mixtures = (
        (ROOT / "docs" / page).read_text(encoding="utf-8")
        for page in ("reference/findings.md", "appendices/mixtures_of_form.md")
    )
    ours = f"{best.r:.3f}, the mean of the inverse of Krumbein's sphericity; µ_EQ⁻¹ is tenth"
    assert f"| {ours} | {equancy.r22_r:.3f}, µ_EQ⁻¹ |" in findings
    words = {"mean of KIS⁻¹": "mu_1/KIS", "mean of IRI⁻¹": "mu_1/IRI", "mean of EQ⁻¹": "mu_1/EQ"}
    for name, feature in words.items():
        row = rf"\| {name}[^|]* \| {table.loc[feature, 'rank']} \| {table.loc[feature, 'r']:.3f} \| \|"
        assert re.search(row, mixtures), row
    assert f"| µ_EQ⁻¹ | {equancy['rank']} | {equancy.r:.3f} | {equancy.r22_r:.3f} |" in mixtures
