"""Numbers rounded to their errors."""

import numpy as np
import pytest

from simcore.evaluation.rounding import error_decimals, rounded, with_decimals


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (0.39843, 0.00457, "0.398 ± 0.005"),
        (0.38444, 0.00133, "0.3844 ± 0.0013"),
        (0.41, 0.0096, "0.410 ± 0.010"),
        (0.4, 0.00196, "0.400 ± 0.002"),
        (-0.0179, 0.0079, "−0.018 ± 0.008"),
        (0.25, 1e-9, "0.2500 ± 0.0000"),
        (123.4, 25.0, "123 ± 25"),
        (0.31234, np.nan, "0.312"),
        (np.nan, 0.1, ""),
        (-1e-6, np.nan, "0.000"),
    ],
)
def test_a_value_has_the_decimals_of_its_error(value, error, text):
    assert rounded(value, error) == text


def test_the_sign_of_a_positive_difference_can_be_written():
    assert rounded(0.0179, 0.0079, sign="+") == "+0.018 ± 0.008"
    assert rounded(1e-7, decimals=2, sign="+") == "0.00"
    assert [with_decimals(value, 2, "+") for value in (0.126, -0.126, -1e-7)] == ["+0.13", "−0.13", "0.00"]


def test_an_error_has_as_many_digits_as_asked():
    assert [error_decimals(0.0234, digits) for digits in (1, 2, 3)] == [2, 3, 4]
    assert error_decimals(0.0) == error_decimals(np.nan) == 4
