"""Angle at which curves of density per solid angle cross, for packings that differ in the degree of anisotropy.

If the curves of different forms differ only in the strength of one P2 term, all cross where P2 vanishes, at 54.7° from
the vertical. With further terms the crossing is at the angle where the density does not change with P2.
"""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from simcore.evaluation.axis_statistics import MAGIC_ANGLE


class Crossing(NamedTuple):
    """Angle to the vertical at which the densities of directions of several forms cross."""

    angle: float  # [rad], nan where the curves do not cross
    std_error: float  # [rad]
    slopes: np.ndarray  # (l,), change of <P_l> with <P_2>; the first is 1


def crossing_angle(fabrics, direction="contact_normal"):
    """Return the Crossing of the curves of two or more fabrics (from fabric_over_seeds), one per form.

    The density is f(theta) = sum of (2 l + 1) <P_l> P_l(cos theta), up to the available order (6). s_l is the slope of
    a straight line fitted to <P_l> over <P_2> of the forms. The curves cross where the sum of (2 l + 1) s_l
    P_l(cos theta) is 0; for two forms this is exact. Of several roots the nearest to 54.7° is used. The standard error
    is a jackknife over the seeds of each form. ValueError with fewer than two fabrics, or if <P_2> is the same in all.
    """
    if len(fabrics) < 2:
        raise ValueError("crossing_angle: a crossing needs two curves; give the fabrics of at least two forms")
    orders = fabrics[0]["order"].values
    of_seeds = [data["legendre_of_seed"].sel(direction=direction).transpose("seed", "order").values for data in fabrics]
    means = np.array([values.mean(axis=0) for values in of_seeds])
    angle, slopes = _crossing(means, orders)
    variance = 0.0
    for form, values in enumerate(of_seeds):
        n = len(values)
        reduced = means.copy()
        angles = np.empty(n)
        for seed in range(n):
            reduced[form] = (values.sum(axis=0) - values[seed]) / (n - 1)
            angles[seed], _ = _crossing(reduced, orders)
        variance += (n - 1) * np.mean((angles - angles.mean()) ** 2)
    return Crossing(angle, float(np.sqrt(variance)), slopes)


def _crossing(means, orders):
    """Return the crossing angle [rad] and the slopes (l,) of mean moments (forms, l)."""
    centred = means - means.mean(axis=0)
    second = centred[:, list(orders).index(2)]
    if not np.ptp(second) > 0.0:
        raise ValueError(
            "crossing_angle: <P_2> is the same in all fabrics, so their curves do not cross at one angle; give fabrics "
            "of different anisotropy"
        )
    slopes = second @ centred / (second @ second)
    series = np.zeros(orders.max() + 1)
    series[orders] = (2 * orders + 1) * slopes
    roots = legendre.legroots(series)
    height = np.real(roots[(np.abs(np.imag(roots)) < 1e-9) & (np.real(roots) > 0.0) & (np.real(roots) < 1.0)])
    angles = np.arccos(height)
    return (float(angles[np.argmin(np.abs(angles - MAGIC_ANGLE))]) if len(angles) else np.nan), slopes
