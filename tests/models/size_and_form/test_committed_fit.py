"""The committed comparison of candidates belongs to the committed rows of packed beds.

If a test fails after new rows, run python -m benchmarks.studies.size_and_form_fit --write.
"""

import numpy as np
import pandas as pd
import pytest

from benchmarks.studies.size_and_form_fit import TABLES, read_rows, usable_beds
from simcore.evaluation.confidence import student_quantile
from simcore.models.size_and_form.comparison import PREFERENCE
from simcore.models.size_and_form.fit import predict_beds
from simcore.models.size_and_form.sized_model import CANDIDATE, NOT_FITTED, UNFITTED
from simcore.paths import REFERENCE


@pytest.fixture(scope="module")
def committed():
    tables = (pd.read_csv(REFERENCE / "models" / f"size_and_form_{name}.csv", keep_default_na=False) for name in TABLES)
    return dict(zip(TABLES, tables, strict=True))


def test_beds_and_their_one_class_porosities_follow_from_the_rows(committed):
    beds, table = usable_beds(read_rows()), committed["beds"]
    assert table["bed"].tolist() == beds.names.tolist()
    np.testing.assert_allclose(table["n_one_class"], beds.one_class, atol=2e-6)
    np.testing.assert_allclose(table["n"], beds.n, atol=2e-6)
    unfitted = predict_beds(CANDIDATE, beds, UNFITTED)
    np.testing.assert_allclose(table[f"predicted_{NOT_FITTED}"], unfitted, atol=2e-6)


def test_errors_follow_from_the_predictions(committed):
    """Mean absolute errors are between the least and the largest error, and one model is chosen."""
    beds, table = committed["beds"], committed["candidates"]
    assert (table["chosen"] == "yes").sum() == 1 and set(PREFERENCE) < set(table["model"])
    for row in table.itertuples():
        errors = (beds[f"predicted_{row.model}"] - beds["n"]).abs()
        assert errors.min() < row.error_by_family < errors.max()
        assert row.error_by_family <= row.rms_error + 1e-9


def test_parameters_are_those_of_the_fits(committed):
    fitted = committed["candidates"].set_index("model")["fitted"]
    for row in committed["parameters"].itertuples():
        assert f"{row.parameter} = {row.value:.3f}" in fitted[row.model]
    families = committed["beds"]["family"].nunique()
    free = committed["parameters"].query("at_bound != 'yes'")
    half = student_quantile(0.95, families - 1) * free["std_error"]
    for column, expected in (("lower_95", free["value"] - half), ("upper_95", free["value"] + half)):
        np.testing.assert_allclose(free[column].astype(float), expected, atol=5e-6)
