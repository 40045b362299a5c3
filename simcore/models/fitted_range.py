"""One rule for what lies outside the range to which a model was fitted.

The range of a model is stated in quantities: the features of our models; for the models of Rettinger et al. (2022) the
published ranges of the statistics of FL and EL, and the features that follow from these. The distance d of a sample is
how far its value lies outside, in widths of the quantity's range, for the quantity where this is largest:

    d = 0               inside
    0 < d <= NEAR       just outside: the interval by least squares grows with leverage, and contains as much as inside
    NEAR < d <= FAR     the half-width of the interval is multiplied by 1 + WIDENING (d - NEAR) as well
    d > FAR             the model is not evaluated

By least squares alone the interval contains too few new packings farther out, as the true porosity is not linear;
`python -m benchmarks.studies.extrapolation` measures how many. The last line also keeps models that contain 1/sigma
from grains that are nearly alike: 1/sigma is then far above its range.
"""

from typing import NamedTuple

import numpy as np

NEAR, FAR = 0.1, 0.5
WIDENING = 1.5


class RangedValue(NamedTuple):
    """A sample's value of a quantity, and the least and the largest value of that quantity in the fit."""

    name: str
    value: float
    low: float
    high: float

    @property
    def distance(self):
        """How far the value lies outside, in widths of the range; 0 inside."""
        return float(distance_outside(self.value, self.low, self.high))

    @property
    def limits(self):
        """Between what values a model is evaluated, (low, high)."""
        reach = FAR * (self.high - self.low)
        return self.low - reach, self.high + reach


def distance_outside(values, low, high):
    """Return how far values lie outside the range from low to high, in its widths, 0 inside; arrays that broadcast.

    Infinite where a value is infinite or not a number, or where it differs from a range without width.
    """
    low, high = np.asarray(low, float), np.asarray(high, float)
    # A value of the fit itself, written and read again, is inside.
    slack = 1e-9 * np.maximum(np.abs(low), np.abs(high))
    beyond = np.maximum(low - values, values - high)
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = np.where(beyond > slack, beyond / (high - low), 0.0)
    return np.where(np.isnan(values), np.inf, distance)


def widening(distance):
    """Return the factor of an interval's half-width at a distance from distance_outside; array."""
    return 1.0 + WIDENING * np.maximum(np.minimum(distance, 1e300) - NEAR, 0.0)
