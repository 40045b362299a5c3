"""Rule for samples that lie outside the range to which a model was fitted.

The range of a model is stated in quantities: the features of our models; for the models of Rettinger et al. (2022) the
published ranges of the statistics of FL and EL, and the features that follow from these. The distance d of a sample is
how far its value lies outside, in widths of the quantity's range, for the quantity where this is largest:

    d = 0               inside
    0 < d <= NEAR       just outside: the interval is that by least squares, which grows with leverage
    NEAR < d <= FAR     the half-width of the interval is also multiplied by 1 + WIDENING (d - NEAR)
    d > FAR             the model is not evaluated

Farther outside, the interval by least squares alone would contain too few new packings, because the true porosity is
not linear. `python -m benchmarks.studies.extrapolation` measures how many, with fits that do not know the packings at
the ends of a range: intervals of 95 % contain 86 to 90 % of the packings just outside, and 83 to 90 % of those inside.
The limit FAR also excludes samples of nearly equal grains from models that contain 1/sigma, because their 1/sigma is
far above its range.
"""

from typing import NamedTuple

import numpy as np

NEAR, FAR = 0.1, 0.5
WIDENING = 1.5


class RangedValue(NamedTuple):
    """A sample's value of a quantity, and the smallest and the largest value of that quantity in the fit."""

    name: str
    value: float
    low: float
    high: float

    @property
    def distance(self):
        """Distance of the value from the range, in widths of the range; 0 inside."""
        return float(distance_outside(self.value, self.low, self.high))

    @property
    def limits(self):
        """Values (low, high) between which a model is evaluated."""
        reach = FAR * (self.high - self.low)
        return self.low - reach, self.high + reach


def distance_outside(values, low, high):
    """Return the distances of values from the range low to high, in its widths; arrays that broadcast; 0 inside.

    The distance is infinite where a value is infinite or not a number, or where it differs from a range without width.
    """
    low, high = np.asarray(low, float), np.asarray(high, float)
    # A value of the fit itself must count as inside, also after it was written to a file and read again.
    slack = 1e-9 * np.maximum(np.abs(low), np.abs(high))
    beyond = np.maximum(low - values, values - high)
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = np.where(beyond > slack, beyond / (high - low), 0.0)
    return np.where(np.isnan(values), np.inf, distance)


def widening(distance):
    """Return the factor that multiplies an interval's half-width at these distances (see distance_outside); array."""
    return 1.0 + WIDENING * np.maximum(np.minimum(distance, 1e300) - NEAR, 0.0)
