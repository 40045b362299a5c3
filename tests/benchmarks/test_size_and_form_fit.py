"""Checks beside the fit of size and form: errors on known beds, and coarse grains in the two halves of a bed."""

import numpy as np
import pandas as pd
import pytest

from benchmarks.studies.size_and_form_fit import describe_halves, known_errors
from simcore.models.size_and_form.fit import Fit
from simcore.models.size_and_form.sized_model import CANDIDATE, UNFITTED
from simcore.paths import REFERENCE


def test_errors_on_known_beds_are_those_of_the_committed_table():
    """The candidate without fitted parameters has the errors of size_and_form_known.csv."""
    fit = Fit(CANDIDATE, UNFITTED, np.zeros((3, 3)), np.zeros(0), ())
    errors = known_errors({CANDIDATE: fit})[CANDIDATE]
    table = pd.read_csv(REFERENCE / "size_and_form_known.csv")
    squares = table["error_H, K = 4.1"] ** 2
    expected = np.sqrt(squares.groupby(table["set"]).mean())
    for name in ("measured", "packed", "published"):
        assert errors[name] == pytest.approx(expected[name], abs=1e-4)


def test_halves_are_compared_in_standard_errors():
    rows = pd.DataFrame({"coarse_upper": [0.56, 0.44], "coarse_lower": [0.5, 0.5]})
    rows = rows.assign(coarse_upper_error=0.03, coarse_lower_error=0.04, case="U5")
    one_class = rows[:1].assign(case="U1", coarse_upper=1.0)
    text = "coarse grains of 2 wide beds, upper less lower half: mean +0.00 ± 0.71 standard errors, rms 1.20; "
    assert describe_halves(pd.concat([rows, one_class])) == text + "of the volume +0.000 ± 0.060"
