"""Share of the difference to Rettinger et al. in beds of long grains that a stretched lattice explains."""

import numpy as np
import pandas as pd
import pytest

from benchmarks.studies.long_grains import JUDGED, SETS, by_r22, campaign, explained
from simcore.reference.columns import find_column


def made(changes):
    """Return pairs with these changes, and rows of the campaign with a difference of 0.04 in each judged set."""
    sets = pd.DataFrame([(FL, EL, 0.2, 0.2) for FL, EL in JUDGED], columns=SETS)
    rows = sets.assign(seed=1, difference=0.04)
    other = rows.iloc[:1].assign(**{SETS[2]: 0.1, SETS[3]: 0.1, "difference": 0.5})
    pairs = sets.assign(change=changes, change_error=0.004)
    return pairs[pairs["change"] != 0], pd.concat([rows, other, rows.assign(seed=2)])


def test_the_share_is_that_of_all_judged_sets_also_of_those_that_are_not_stretched():
    share, error = explained(*made([-0.03, -0.02, 0.0, -0.014]))
    assert share == pytest.approx(0.064 / 0.16) and error == pytest.approx(np.sqrt(3) * 0.004 / 0.16)


def test_the_campaign_has_every_judged_set_and_is_compared_with_the_published_model():
    rows = campaign()
    for FL, EL in JUDGED:
        assert ((rows[SETS] == [FL, EL, 0.2, 0.2]).all(axis=1) & (rows["seed"] == 1)).sum() == 1
    first = rows.iloc[0]
    expected = 0.287 + 0.032 / first["mu_EQ"] - 0.003 / first["sigma_EQ"] + 0.011 / first["mu_EL"]
    assert by_r22(rows).iloc[0] == pytest.approx(expected) and first["difference"] == pytest.approx(
        first["n"] - expected
    )


def test_the_stretch_of_the_lattice_is_a_column_of_the_rows():
    assert find_column("difference_long_lattice", "stretch_z").key == "generation.stretch_z"
