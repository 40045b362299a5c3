"""Packing size and one-class porosity of nonspherical grains from their sphericity.

Equations: Yu, Zou and Standish (1996). ψ is Wadell's sphericity, the surface
of the sphere of equal volume over the surface of the grain. In a mixture of grains of one form the packing size is the
same multiple of the size for all classes, so that only the one-class porosity depends on form.
"""

import numpy as np


def packing_size(size, sphericity):
    """Return the equivalent packing size; size: diameter of the sphere of equal volume, in any unit."""
    sphericity = _check(sphericity)
    return np.asarray(size, float) * sphericity**-2.785 * np.exp(2.946 * (1 - sphericity))


def cylinder_porosity(sphericity):
    """Return the one-class porosity on the branch of cylinders; 0.40 for spheres."""
    sphericity = _check(sphericity)
    return 0.40 ** (sphericity**5.58 * np.exp(5.89 * (1 - sphericity)))


def disc_porosity(sphericity):
    """Return the one-class porosity on the branch of discs; 0.40 for spheres."""
    sphericity = _check(sphericity)
    return 0.40 ** (sphericity**0.60 * np.exp(0.23 * (1 - sphericity) ** 0.45))


def _check(sphericity):
    sphericity = np.asarray(sphericity, float)
    if not np.all((sphericity > 0) & (sphericity <= 1)):
        raise ValueError(f"packing_size: the sphericity {sphericity} is not in (0, 1]; correct it")
    return sphericity
