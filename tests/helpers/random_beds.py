"""Grains at random places in a periodic box, for tests that need places and forms but no mechanics."""

import numpy as np

from tests.helpers.packings import make_packing
from tests.helpers.polyhedra import make_pebble
from tests.helpers.rotations import random_orientations

WIDTH, HEIGHT = 0.03, 0.05  # [m]
KINDS = ("sphere", "ellipsoid", "polyhedron")


def strew(kind, n=12, seed=0, domain="periodic", **options):
    """Return a packing of n grains of 4 to 8 mm that may overlap; many extend through the sides of the box."""
    rng = np.random.default_rng(seed)
    position = rng.uniform([0.0, 0.0, 0.004], [WIDTH, WIDTH, HEIGHT], (n, 3))
    scale = np.sort(rng.uniform(2e-3, 4e-3, (n, 3)), axis=1)
    if kind == "sphere":
        scale = scale[:, 2]
    vertices = make_pebble(3, axes=(0.8, 1.0, 1.2)).vertices if kind == "polyhedron" else None
    orientation = random_orientations(n, seed + 1)
    return make_packing(position, scale, orientation, vertices, width=WIDTH, domain=domain, **options)
