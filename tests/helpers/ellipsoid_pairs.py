"""Pairs of ellipsoids: some with known distances, random ones, and the contact search on them."""

import numpy as np
from scipy.spatial.transform import Rotation

from tests.helpers.contact_pairs import UNIT_SPHERE, place_pairs, update_ellipsoids
from tests.helpers.rotations import IDENTITY, turn_about

PHI = 0.5 * (1.0 + np.sqrt(5.0))
GOLDEN = (PHI, 1.0, 1.0 / PHI)
NEEDLE, DISC = (100.0, 1.0, 1.0), (100.0, 100.0, 1.0)
Z90, X90, Z30 = turn_about([0, 0, 1], np.pi / 2), turn_about([1, 0, 0], np.pi / 2), turn_about([0, 0, 1], np.pi / 6)
SLANTED = turn_about([1, 1, 1], 1.0)
SPHERE, HALF = (1.0,) * 3, (0.5,) * 3
# Semi-axes of A and B, orientation of B, centre of B, signed distance
KNOWN_PAIRS = {
    "spheres apart": (SPHERE, SPHERE, IDENTITY, (2.5, 0, 0), 0.5),
    "spheres": (SPHERE, SPHERE, IDENTITY, (1.9, 0, 0), -0.1),
    "triaxial apart": ((3, 2, 1), (1, 2, 3), IDENTITY, (4.2, 0, 0), 0.2),
    "triaxial": ((3, 2, 1), (1, 2, 3), IDENTITY, (3.9, 0, 0), -0.1),
    "parallel apart": ((2, 1, 0.5), (2, 1, 0.5), IDENTITY, (3, 1.5, 0.7), 0.474311020117),
    "parallel": ((2, 1, 0.5), (2, 1, 0.5), IDENTITY, (2, 1, 0.5), -0.191232822332),
    "golden, tangent": (GOLDEN, GOLDEN, IDENTITY, (1, 1, 1), 0.0),
    "golden, turned": (GOLDEN, GOLDEN, Z90, (2.5, 0.3, 0.2), -0.066910098505),
    "golden, slanted": (GOLDEN, GOLDEN, SLANTED, (2, 0.4, 0.3), -0.333256337445),
    "flat, slanted": ((1.25, 1, 0.8), (1.25, 1, 0.8), turn_about([1, 2, 3], 0.7), (2, 0.1, -0.2), -0.379003101929),
    "needles crossed, apart": (NEEDLE, NEEDLE, Z90, (0, 0, 2.01), 0.01),
    "needles crossed": (NEEDLE, NEEDLE, Z90, (0, 0, 1.99), -0.01),
    "needles far": (NEEDLE, NEEDLE, Z30, (190, 25, 0), 22.910655128466),
    "disc rims": (DISC, DISC, IDENTITY, (199.9, 0, 0), -0.059994665896),
    "disc on rim": (DISC, DISC, X90, (0, 0, 100.9), -0.1),
    "concentric": ((3, 2, 1), (3, 2, 1), IDENTITY, (0, 0, 0), -2.0),
    "sphere on the flat side": ((3, 2, 1), HALF, IDENTITY, (0, 0, 1.4), -0.1),
    "sphere at the tip": ((3, 2, 1), HALF, IDENTITY, (2.9, 0, 0), -0.6),
    "sphere beside": ((3, 2, 1), HALF, IDENTITY, (2.5, 1, 0.2), -0.518207879616),
}


def search_pairs(semi_a, semi_b, turn_a, turn_b, offsets, size=1.0, common=0.0):
    """Return bodies and contacts of pairs of ellipsoids after a new search; arguments are (n, ...) or one value."""
    offsets = np.atleast_2d(offsets)
    n = len(offsets)
    scale, turns = np.empty((2 * n, 3)), np.empty((2 * n, 4))
    scale[0::2], scale[1::2], turns[0::2], turns[1::2] = semi_a, semi_b, turn_a, turn_b
    bodies, _, contacts = place_pairs([UNIT_SPHERE] * (2 * n), scale, turns, offsets, size, common)
    update_ellipsoids(None, bodies, contacts, 0.0)
    return bodies, contacts


def random_pairs(rng, n, flattest):
    """Return random semi-axes (2, n, 3) from `flattest` to 1, quaternions (2, n, 4) and offsets (n, 3)."""
    semi = np.exp(rng.uniform(np.log(flattest), 0.0, (2, n, 3)))
    turns = Rotation.random(2 * n, rng=rng).as_quat(scalar_first=True).reshape(2, n, 4)
    offsets = rng.standard_normal((n, 3))
    offsets /= np.linalg.norm(offsets, axis=1, keepdims=True)
    return semi, turns, offsets * rng.uniform(0.0, 1.6, (n, 1))
