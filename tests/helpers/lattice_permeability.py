"""Published permeabilities of cubic lattices of touching spheres (Zick and Homsy, J. Fluid Mech. 115, 1982, Table 2).

The force on a sphere of radius a is F = 6 π μ a K U, with the mean velocity U over the whole cell. The pressure
gradient balances it: F = |∇p| V, with the volume V of the cell per sphere. Darcy's law U = k |∇p| / μ then gives

    k = V / (6 π a K) = V / (3 π d K),

which is 2.520e-3 d² for the simple cubic lattice, V = d³.
"""

import numpy as np

from simcore.pores.image import pore_image
from tests.helpers.packings import make_packing, sphere_lattice

DRAG = {"sc": 42.1, "bcc": 162.9, "fcc": 435.0}
POROSITY = {
    "sc": 1.0 - np.pi / 6.0,
    "bcc": 1.0 - np.sqrt(3.0) * np.pi / 8.0,
    "fcc": 1.0 - np.pi / np.sqrt(18.0),
}
EDGE = {"sc": 1.0, "bcc": 2.0 / np.sqrt(3.0), "fcc": np.sqrt(2.0)}  # of the cubic cell, in diameters


def lattice_permeability(kind, diameter):
    """Return the permeability [m²] of a lattice of touching spheres; diameter [m]."""
    cell = np.pi * diameter**3 / 6.0 / (1.0 - POROSITY[kind])
    return cell / (3.0 * np.pi * diameter * DRAG[kind])


def lattice_image(kind, count, diameter, shift=0.0):
    """Return the PoreImage of two cells of a lattice between planes of symmetry, with a margin of a diameter.

    count: voxels per diameter; diameter [m]; shift: displacement of the spheres along x, in diameters.
    """
    centres, width = sphere_lattice(kind, 2, 5)
    centres[:, 0] = (centres[:, 0] + shift) % width
    bed = make_packing(diameter * centres, 0.5 * diameter, width=diameter * width)
    low = diameter * (EDGE[kind] if kind == "sc" else 0.5 + EDGE[kind])
    return pore_image(bed, low, low + 2.0 * EDGE[kind] * diameter, diameter / count, diameter)
