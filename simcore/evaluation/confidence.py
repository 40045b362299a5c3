"""Quantiles for the half widths of confidence intervals."""

from functools import lru_cache

from scipy.special import stdtrit  # scipy.stats has the same values but loads slowly


@lru_cache(maxsize=64)
def student_quantile(level, freedom) -> float:
    """Return Student's t that a value exceeds in magnitude with the probability 1 - level."""
    return float(stdtrit(freedom, 0.5 + 0.5 * level))
