"""Empirical predictors of river engineering: porosity from a sieve curve alone, without form or state of packing.

They are shown beside the models of this project. Their equations were read in public source code, not in the
publications, so that their ranges are unknown; `range` repeats what that code states. The median d50 is in mm in all
formulas, and mass is uniform in log D within a class.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from simcore.models.packing_models.curves import log2_deviation, passing, quantile


class Predictor(NamedTuple):
    """A predictor: porosity of a SieveCurve."""

    name: str
    source: str  # the publication to which the equation is attributed
    range: str  # in which it holds
    porosity: Callable  # porosity(SieveCurve) -> float


def _d50(curve):
    return 1e3 * quantile(curve, 0.5)


def frings(curve):
    """Return n = 0.353 - 0.068 σφ + 0.146 p, with p the share of the mass finer than 0.5 mm."""
    return 0.353 - 0.068 * log2_deviation(curve) + 0.146 * passing(curve, 0.5e-3)


def wooster(curve):
    """Return n = 0.621 exp(-0.457 σg), with the geometric standard deviation σg = 2^σφ.

    # ASSUME: σg = 2^σφ. The program Sediment Analyst puts σφ in its place, which gives 0.39 to 0.58 for the gravels of
    # Rettinger et al.; that a geometric standard deviation belongs there is from memory. The program MUSTANG attributes
    # another formula to the same publication, 0.42 σg^-0.458 with σg = 2^σφ.
    """
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


_UNKNOWN = "unknown: the publication was not read"
PREDICTORS = (
    Predictor(
        "Frings 2011", "Frings et al. (2011), Water Resources Research, doi:10.1029/2010WR009690", _UNKNOWN, frings
    ),
    Predictor(
        "Wooster 2008", "Wooster et al. (2008), Water Resources Research, doi:10.1029/2006WR005815",
        f"{_UNKNOWN}; the program MUSTANG keeps 2^σφ between 1 and 4", wooster,
    ),
    Predictor(
        "Carling and Reader 1982",
        "Carling and Reader (1982), Earth Surface Processes and Landforms, doi:10.1002/esp.3290070407",
        _UNKNOWN, carling_reader,
    ),
    Predictor(
        "Wu and Wang 2006",
        "Wu and Wang (2006), Journal of Hydraulic Engineering, doi:10.1061/(ASCE)0733-9429(2006)132:8(858)",
        _UNKNOWN, wu_wang,
    ),
    Predictor("Komura", "Komura, as modified by Simmons; the publication is not known to us", _UNKNOWN, komura),
)  # fmt: skip
