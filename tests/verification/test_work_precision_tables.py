"""The front of error against CPU time, and the columns that a table of runs must have."""

import numpy as np
import pandas as pd
import pytest

from simcore.verification.work_precision import observed_order, pareto_front, settings_table


def table(cost, error, reference=0.0, repeats=1):
    rows = [
        {
            "case": "a",
            "quantity": "q",
            "method": "m",
            "setting": k,
            "default": k == 0,
            "repeat": r,
            "error": e,
            "cpu_s": c * (1.0 + r),
            "reference_error": reference,
        }
        for k, (c, e) in enumerate(zip(cost, error, strict=True))
        for r in range(repeats)
    ]
    return pd.DataFrame(rows)


def test_the_front_is_what_nothing_beats():
    #                      best cost, beaten, on it, same error dearer, best error, nan
    cost, error = [1.0, 2.0, 2.0, 4.0, 8.0, 0.5], [9.0, 9.0, 3.0, 3.0, 1.0, np.nan]
    assert pareto_front(cost, error).tolist() == [True, False, True, False, True, False]


def test_equal_points_are_both_on_the_front():
    assert pareto_front([1.0, 1.0], [2.0, 2.0]).all()


def test_errors_below_that_of_the_reference_are_alike():
    """An error below that of the reference is no reason to prefer a dearer setting."""
    runs = table([1.0, 2.0, 3.0], [1e-3, 1e-9, 1e-12], reference=1e-8)
    assert settings_table(runs)["on_front"].tolist() == [True, True, False]
    assert settings_table(runs.assign(reference_error=0.0))["on_front"].all()


def test_repeats_become_medians_with_their_range():
    found = settings_table(table([1.0], [0.1], repeats=3)).iloc[0]
    assert (found["cpu_least"], found["cpu_s"], found["cpu_most"]) == (1.0, 2.0, 3.0)
    assert found["default"]


def test_cases_have_fronts_of_their_own():
    runs = pd.concat([table([1.0], [1.0]), table([2.0], [2.0]).assign(case="b")])
    assert settings_table(runs)["on_front"].all()


def test_a_missing_column_is_named():
    with pytest.raises(ValueError, match="columns cpu_s are missing"):
        settings_table(table([1.0], [1.0]).drop(columns="cpu_s"))


def test_observed_order():
    np.testing.assert_allclose(observed_order([10, 20, 60], [1.0, 0.25, 0.25 / 9]), 2.0)
