"""Range of the porosities of beds of one sieve class."""

import numpy as np

LEAST, LARGEST = 0.2, 0.6  # one-class porosities that the candidates accept


def check_one_class(porosity):
    """Return the one-class porosity, a number or an array; ValueError outside LEAST to LARGEST."""
    if not np.all((np.asarray(porosity) >= LEAST) & (np.asarray(porosity) <= LARGEST)):
        raise ValueError(
            f"one-class porosity {np.round(porosity, 4)} is outside {LEAST} to {LARGEST}, where no bed of one class of "
            "grains was packed; correct the form statistics"
        )
    return porosity
