"""The error of a mean of values with known errors."""

import numpy as np
import pandas as pd
import pytest

from simcore.evaluation.confidence import error_of_mean


def test_it_is_that_of_independent_values():
    rng = np.random.default_rng(0)
    errors = np.array([0.001, 0.002, 0.004])
    means = (errors * rng.standard_normal((40_000, 3))).mean(axis=1)
    assert error_of_mean(pd.Series(errors)) == pytest.approx(means.std(), rel=0.02)  # 0.35 % is its scatter


def test_an_unknown_error_makes_that_of_the_mean_unknown():
    assert np.isnan(error_of_mean(pd.Series([0.001, np.nan])))
