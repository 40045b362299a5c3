"""Linear packing model: the loosest of the packings that one class of grains each would control.

Equations: Yu, Zou and Standish (1996); the form with controlling classes goes
back to Stovall et al. (1986). Their functions f and g are fitted to binary packings of spheres. The result has a kink
where another class takes control. With f = g = 1 it is Furnas' limit of infinite size ratios.
"""

import numpy as np

from simcore.models.packing_models.classes import (
    check_classes,
    controlled_volumes,
    porosity_of_volume,
    size_ratios,
    specific_volume,
)


def filling(r):
    """Return f(r) of Yu, Zou and Standish: 1 at r = 0, 0 at r = 1; r: smaller over larger size."""
    return (1 - r) ** 3.3 + 2.8 * r * (1 - r) ** 2.7


def occupying(r):
    """Return g(r) of Yu, Zou and Standish: 1 at r = 0, 0 at r = 1; r: smaller over larger size."""
    return (1 - r) ** 2.0 + 0.4 * r * (1 - r) ** 3.7


def linear(sizes, fractions, porosities, stretch=1.0, functions=(filling, occupying)):
    """Return the porosity (...,) by the linear packing model; arguments (..., k) as for check_classes.

    stretch: exponent of the size ratios, as in size_ratios; 1 is the published model. functions: (f, g) of r.
    """
    sizes, fractions, porosities = check_classes(sizes, fractions, porosities)
    r, coarser = size_ratios(sizes, stretch)
    f, g = functions
    T = controlled_volumes(fractions, specific_volume(porosities), f(r), g(r), coarser)
    return porosity_of_volume(np.max(T, axis=-1))
