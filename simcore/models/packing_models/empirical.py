"""Empirical predictors of river engineering: porosity from a sieve curve alone, without form or state of packing.

They are shown beside the models of this project. Their equations were read in public source code, not in the
publications. No limits of validity are stated there; `range` says so, and names the sediment where it is known. The
median d50 is in mm in all formulas, and mass is uniform in log D within a class.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from simcore.models.packing_models.curves import log2_deviation, passing, quantile


class Predictor(NamedTuple):
    """A predictor: porosity of a SieveCurve."""

    name: str
    source: str
    range: str
    porosity: Callable  # porosity(SieveCurve) -> float


def _d50(curve):
    return 1e3 * quantile(curve, 0.5)


def frings(curve):
    """Return n = 0.353 - 0.068 σφ + 0.146 p, with p the share of the mass finer than 0.5 mm."""
    return 0.353 - 0.068 * log2_deviation(curve) + 0.146 * passing(curve, 0.5e-3)


def wooster(curve):
    """Return n = 0.621 exp(-0.457 σg), with the geometric standard deviation σg = 2^σφ."""
    return float(0.621 * np.exp(-0.457 * 2 ** log2_deviation(curve)))


def carling_reader(curve):
    """Return n = -0.0333 + 0.4665 d50^-0.21."""
    return -0.0333 + 0.4665 / _d50(curve) ** 0.21


def wu_wang(curve):
    """Return n = 0.13 + 0.21 (d50 + 0.002)^-0.21."""
    return 0.13 + 0.21 / (_d50(curve) + 0.002) ** 0.21


def komura(curve):
    """Return n = 0.245 + 0.0864 (0.1 d50)^-0.21."""
    return 0.245 + 0.0864 / (0.1 * _d50(curve)) ** 0.21


_UNSTATED = "not stated in the source that was read"
PREDICTORS = (
    Predictor("Frings 2011", "Frings et al. (2011)", f"fluvial sand and gravel; limits {_UNSTATED}", frings),
    Predictor("Wooster 2008", "Wooster et al. (2008)", f"fine sediment in gravel; limits {_UNSTATED}", wooster),
    Predictor("Carling and Reader 1982", "Carling and Reader (1982)", _UNSTATED, carling_reader),
    Predictor("Wu and Wang 2006", "Wu and Wang (2006)", _UNSTATED, wu_wang),
    Predictor("Komura", "Komura, as modified by Simmons", _UNSTATED, komura),
)
