"""The committed tables of fitted models are those of today's rows and code."""

import numpy as np
import pandas as pd
import pytest

from benchmarks.studies.fitted_models import FOLDER, model_tables
from simcore.models.fitting import fit_reference_models


@pytest.fixture(scope="module")
def tables():
    return model_tables()


def test_committed_tables_are_those_of_the_committed_rows(tables):
    """If this test fails after new rows, run python -m benchmarks.studies.fitted_models --write."""
    # tests/models/size_and_form/test_committed_fit.py tests the other tables.
    assert {path.stem for path in FOLDER.glob("*.csv") if not path.stem.startswith("size_and_form_")} == set(tables)
    for name, table in tables.items():
        committed = pd.read_csv(FOLDER / f"{name}.csv")
        pd.testing.assert_frame_equal(
            committed, table.reset_index(drop=True), rtol=1e-4, atol=1e-9, check_dtype=False, obj=name
        )


def test_intervals_of_predictions_follow_from_the_committed_tables(tables):
    """Coefficients, covariances and scatter suffice to recompute an interval by hand."""
    model = fit_reference_models().models["unified", "U1"]
    covariance = pd.read_csv(FOLDER / "covariance.csv").query("model == 'unified' and case == 'U1'")
    matrix = covariance.pivot(index="term", columns="with_term", values="covariance").loc[
        list(model.terms), list(model.terms)
    ]
    np.testing.assert_allclose(matrix, np.array(model.covariance), rtol=1e-5)
    coefficients = pd.read_csv(FOLDER / "predict.csv").query("model == 'unified' and case == 'U1'")
    coefficients = coefficients.set_index("term")["coefficient"]
    np.testing.assert_allclose(coefficients[list(model.terms)], model.coefficients, rtol=1e-5)
