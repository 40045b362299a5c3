"""The point of a simplex nearest to the origin, compared with the nearest points of all its faces."""

from itertools import combinations

import numpy as np
import pytest

from simcore.dem.contact.search.simplex import Simplex, has_point, keep_weighted, nearest_on_simplex, weighted_point


def nearest_by_faces(points):
    """Return the distance of a simplex from the origin: the least over faces with their own nearest point inside."""
    best = np.inf
    for n in range(1, len(points) + 1):
        for face in combinations(points, n):
            corners = np.array(face)
            edges = (corners[1:] - corners[0]).T
            others = np.linalg.lstsq(edges, -corners[0], rcond=None)[0] if n > 1 else np.zeros(0)
            weights = np.array([1.0 - others.sum(), *others])
            if (weights >= 0.0).all():
                best = min(best, np.linalg.norm(weights @ corners))
    return best


@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_the_weights_give_the_nearest_point(n):
    rng = np.random.default_rng(n)
    around = 0
    for _ in range(200):
        points = np.zeros((4, 3))
        points[:n] = rng.standard_normal((n, 3)) + rng.uniform(0.0, 1.5) * np.array([1.0, 0.0, 0.0])
        weights = np.empty(4)
        contains = nearest_on_simplex(points, n, weights)
        wanted = nearest_by_faces(points[:n])
        around += contains
        if contains:
            assert n == 4 and wanted < 1e-12
        else:
            assert abs(weights[:n].sum() - 1.0) < 1e-14 and (weights >= 0.0).all() and (weights[n:] == 0.0).all()
            assert abs(np.linalg.norm(weighted_point(points, weights, n)) - wanted) < 1e-13
    assert (around > 10) == (n == 4)


def test_points_of_no_weight_are_dropped_with_their_vertices():
    points = np.arange(12.0).reshape(4, 3)
    simplex = Simplex(points, np.arange(8).reshape(4, 2), np.zeros(4))
    assert has_point(simplex, 4, 6, 7) and not has_point(simplex, 3, 6, 7) and not has_point(simplex, 4, 7, 6)
    assert keep_weighted(simplex, np.array([0.0, 0.25, 0.0, 0.75]), 4) == 2
    assert points[:2].tolist() == [[3.0, 4.0, 5.0], [9.0, 10.0, 11.0]]
    assert simplex.vertices[:2].tolist() == [[2, 3], [6, 7]] and simplex.weights[:2].tolist() == [0.25, 0.75]
