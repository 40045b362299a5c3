"""Angle at which the curves of a density per solid angle cross, of packings that are anisotropic to different degrees.

Where all that changes from form to form is the strength of one P2 term, all curves cross where P2 vanishes, at 54.7°
against the vertical. With further terms the angle is that at which the curve stays while P2 changes.
"""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from simcore.evaluation.axis_statistics import MAGIC_ANGLE


class Crossing(NamedTuple):
    angle: float  # [rad], nan where the curves do not cross
    std_error: float  # [rad]
    slopes: np.ndarray  # (l,), change of <P_l> with <P_2>, the first 1


def crossing_angle(fabrics, direction="contact_normal"):
    """Crossing of the curves of two or more fabrics (of fabric_over_seeds), one a form.

    f(theta) = sum of (2 l + 1) <P_l> P_l(cos theta), up to the order known (6). A straight line through <P_l> over
    <P_2> of the forms gives its slope s_l, and the curves cross where sum of (2 l + 1) s_l P_l(cos theta) = 0; of two
    forms exactly there. Of several roots that nearest to 54.7° is taken. The standard error is a jackknife over the
    seeds of each form. ValueError if <P_2> is the same in all.
    """
    if len(fabrics) < 2:
        raise ValueError("crossing_angle: one curve crosses nothing; give the fabrics of two forms at least")
    orders = fabrics[0]["order"].values
    of_seeds = [data["legendre_of_seed"].sel(direction=direction).transpose("seed", "order").values for data in fabrics]
    means = np.array([values.mean(axis=0) for values in of_seeds])
    angle, slopes = _crossing(means, orders)
    variance = 0.0
    for form, values in enumerate(of_seeds):
        n = len(values)
        moved = means.copy()
        angles = np.empty(n)
        for seed in range(n):
            moved[form] = (values.sum(axis=0) - values[seed]) / (n - 1)
            angles[seed], _ = _crossing(moved, orders)
        variance += (n - 1) * np.mean((angles - angles.mean()) ** 2)
    return Crossing(angle, float(np.sqrt(variance)), slopes)


def _crossing(means, orders):
    """Angle [rad] and slopes (l,) of mean moments (forms, l)."""
    centred = means - means.mean(axis=0)
    second = centred[:, list(orders).index(2)]
    if not np.ptp(second) > 0.0:
        raise ValueError("crossing_angle: <P_2> is the same in all fabrics, so their curves do not cross at one angle")
    slopes = second @ centred / (second @ second)
    series = np.zeros(orders.max() + 1)
    series[orders] = (2 * orders + 1) * slopes
    roots = legendre.legroots(series)
    height = np.real(roots[(np.abs(np.imag(roots)) < 1e-9) & (np.real(roots) > 0.0) & (np.real(roots) < 1.0)])
    angles = np.arccos(height)
    return (float(angles[np.argmin(np.abs(angles - MAGIC_ANGLE))]) if len(angles) else np.nan), slopes
