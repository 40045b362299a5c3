"""The table of packing models on the measured gravels, and its committed file."""

import numpy as np
import pandas as pd
import pytest

from benchmarks.studies.size_models import ENDS, TABLE, size_models_table
from simcore.paths import REFERENCE

KEYS = ["model", "K", "given", "classes"]


@pytest.fixture(scope="module")
def table():
    return size_models_table()


def test_the_committed_table_is_what_the_command_makes(table):
    committed = pd.read_csv(REFERENCE / TABLE)
    assert list(committed) == list(table) and committed[KEYS].astype(str).equals(table[KEYS].astype(str))
    numbers = [column for column in table if column not in KEYS]
    np.testing.assert_allclose(committed[numbers], table[numbers], atol=1.1e-4)


def test_packing_models_are_exact_for_u1_and_predictors_are_not(table):
    given_u1 = table["given"].str.contains("porosity of U1")
    assert (table["error_U1"][given_u1] == 0).all() and given_u1.sum() == 14
    assert (table["error_U1"][table["given"] == "curve"].abs() > 1e-3).all()
    others = table.filter(regex="error_[UB][3570]").drop(columns="error_U1", errors="ignore")
    assert others.shape[1] == 6
    np.testing.assert_allclose(table["rms_error"], np.sqrt((others**2).mean(axis=1, skipna=False)), atol=1e-4)


def test_errors_of_unfitted_models(table):
    """The best published model has an rms error of 0.006.

    All published models transfer more of the effect of form from U1 to U7 and B50 than Rettinger et al. (2022) found.
    """
    published = table[(table["classes"] == "one size") & (table["model"] != "compressible with f and g of linear")]
    assert published.loc[published["rms_error"].idxmin(), "model"] == "linear"
    assert published["rms_error"].min() == pytest.approx(0.0060, abs=1e-4)
    assert published["slope_U7"].between(0.90, 0.985).all() and published["slope_B50"].between(0.83, 0.945).all()
    study = table[table["given"] == "form"].iloc[0]
    assert (study["slope_U7"], study["slope_B50"]) == pytest.approx((0.69, 0.51), abs=5e-3)
    assert ENDS[0] < 0.342 < ENDS[1]
