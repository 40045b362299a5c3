"""Ratio of the permeability of the pore network to that of Zick and Homsy (1982), for lattices of touching spheres.

    python -m benchmarks.correctness.pore_lattices [VOXELS_PER_DIAMETER ...]

Without arguments it uses 20 and 40 voxels per diameter and takes about half a minute of CPU time.
"""

import sys

from simcore.pores.network import network_permeability
from tests.helpers.lattice_permeability import EDGE, lattice_image, lattice_permeability

DIAMETER = 0.01  # [m]


def main(counts):
    """Print a line for each lattice and number of voxels per diameter."""
    for kind in EDGE:
        for count in counts:
            ratio = network_permeability(lattice_image(kind, count, DIAMETER), DIAMETER) / lattice_permeability(
                kind, DIAMETER
            )
            print(f"{kind}, d/{count}: {ratio:.3f}", flush=True)


if __name__ == "__main__":
    main([int(text) for text in sys.argv[1:]] or [20, 40])
