"""One-class porosity of a bed from form statistics of all its grains, or of the grains of each sieve class."""

import numpy as np

from simcore.models.unified import unified_features

LEAST, LARGEST = 0.2, 0.6  # one-class porosities that the candidates accept


def one_class_porosity(model, statistics, curve):
    """Return the one-class porosity: a number for all grains, or an array (k,) by class of the SieveCurve.

    model: PorosityModel of beds of one class, with the features of simcore.models.unified. statistics: DataFrame with
    columns mu_EQ, sigma_EQ, mu_EL, sigma_EL, and one row for all grains or one per class, from fine to coarse. A class
    without mass may have nan. ValueError if the number of rows fits neither, or a class with mass has no statistics.
    """
    rows, classes = len(statistics), len(curve.mass_fractions)
    if rows not in (1, classes):
        raise ValueError(
            f"{curve.name}: {rows} rows of form statistics do not fit {classes} classes; give one row, or one per class"
        )
    n = np.asarray(model.predict(unified_features(statistics)), float)
    if rows == 1 and classes > 1:
        return check_one_class(float(n[0]))
    with_mass = curve.mass_fractions > 0
    if not np.all(np.isfinite(n[with_mass])):
        missing = np.flatnonzero(with_mass & ~np.isfinite(n))[0]
        raise ValueError(
            f"{curve.name}: class {missing + 1} has mass but no form statistics; give them, or all grains'"
        )
    # The value of a class without mass has no effect.
    return check_one_class(np.where(with_mass, n, n[with_mass].mean()))


def check_one_class(porosity):
    """Return the one-class porosity, a number or an array; ValueError outside LEAST to LARGEST."""
    if not np.all((np.asarray(porosity) >= LEAST) & (np.asarray(porosity) <= LARGEST)):
        raise ValueError(
            f"one-class porosity {np.round(porosity, 4)} is outside {LEAST} to {LARGEST}, where no bed of one class of "
            "grains was packed; correct the form statistics"
        )
    return porosity
