"""Random and adversarial pairs of every kind, compared with references that try everything (`brute_force`).

There are 10 000 pairs, and tolerances are relative to the pair's size. Polytopes must be exact to 1e-9. Sums of
products of coordinates give some hundred eps, 1e-13, and faces with points 1e-15 to 1e-9 off their plane somewhat more,
so depths are tested to 1e-11. Ellipsoids must be exact to 1e-8, because the search through all directions ends with its
bounds 2e-9 apart.

The distance between the two points is an upper bound of a gap, and the normal gives a lower bound, so `points` is the
error of a gap. For parallel faces it is limited by the direction, which has an error of eps / g over a gap g: at g =
√eps both are 1e-8.
"""

import numpy as np
import pytest

from benchmarks.correctness import exactness

PAIRS = 909  # of each of eleven families
POLYTOPES = ("hulls", "hulls thin", "aligned solids", "nearly flat", "sphere hull")


@pytest.mark.parametrize("family", exactness.FAMILIES)
def test_pairs(family):
    rng = np.random.default_rng(list(family.encode()))
    errors = exactness.examine(exactness.draw(family, rng, PAIRS, count=60))
    distance = errors["distance"]
    assert np.isfinite(distance).all()
    assert 0.2 < (distance < 0.0).mean() < 0.95
    polytopes = family in POLYTOPES
    assert errors["normal"].max() < 1e-14
    assert errors["shown"].max() < 1e-12  # the distance along the normal is the distance
    assert np.nanmax(errors["depth"]) < (1e-11 if polytopes else 1e-8)
    assert errors["exchange"].max() < (1e-9 if polytopes else 1e-8)
    gaps = distance > 0.0
    # |point_b − point_a| exceeds a gap g by (tangential part)² / 2g, and by no more than the tangential part
    excess = np.minimum(errors["points"], errors["points"] ** 2 / np.maximum(distance, 1e-300))
    assert excess[gaps].max() < (1e-9 if polytopes else 1e-8)
    assert errors["points"].max() < 1e-6


def test_hulls_of_150_vertices():
    rng = np.random.default_rng(9)
    errors = exactness.examine(exactness.draw("hulls", rng, 24, size=150, count=12))
    assert np.nanmax(errors["depth"]) < 1e-11
    assert errors["points"].max() < 1e-9
