"""The packing models without changes: the geometric mean of a class is the size of all its grains."""

import numpy as np

from simcore.models.packing_models.compressible import compressible
from simcore.models.packing_models.linear import linear
from simcore.models.packing_models.linear_mixture import linear_mixture
from simcore.models.packing_models.rods import rods

# Compaction index of poured and of vibrated beds, attributed to de Larrard (1999); not read in the publication.
POURED_COMPACTION, VIBRATED_COMPACTION = 4.1, 4.75


def one_size(model):
    """Return porosity(curve, one_class) -> float of a packing model of sizes, fractions and one-class porosities."""

    def porosity(curve, one_class):
        with_mass = curve.mass_fractions > 0
        sizes = np.sqrt(curve.bounds[1:] * curve.bounds[:-1])[with_mass]
        return float(model(sizes, curve.mass_fractions[with_mass], one_class))

    return porosity


# Porosity of a SieveCurve from its one-class porosity, dict by name; no parameter is fitted.
LITERATURE = {
    "linear": one_size(linear),
    "linear mixture": one_size(linear_mixture),
    f"compressible, K = {VIBRATED_COMPACTION}": one_size(lambda *classes: compressible(*classes, VIBRATED_COMPACTION)),
    "rods": one_size(rods),
}
