"""Quantiles for the half widths of confidence intervals, and the error of a mean of values with known errors."""

from functools import lru_cache

import numpy as np
from scipy.special import stdtrit  # scipy.stats has the same values but loads slowly


@lru_cache(maxsize=64)
def student_quantile(level, freedom) -> float:
    """Return Student's t that a value exceeds in magnitude with the probability 1 - level."""
    return float(stdtrit(freedom, 0.5 + 0.5 * level))


def error_of_mean(errors) -> float:
    """Return the standard error of the mean of independent values from their standard errors (n,).

    nan if one of them is unknown (nan).
    """
    return float(np.sqrt(np.sum(np.square(np.asarray(errors, float)))) / len(errors))
