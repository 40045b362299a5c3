"""The contact search of Rettinger et al. (2022), compared with a plain version and with the true overlap.

The plain version stores a list of faces, tests for each of them whether a new point is in front of it, and goes through
every corner of a polyhedron. The packings of Rettinger et al. consist of pebbles with 300 faces and a size of 6.7 mm,
which overlap by 1e-7 m.
"""

import dataclasses
from itertools import combinations

import numba
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.studies.inflated import find, touching_pairs
from simcore.dem.contact.find_contact import check_polyhedra, find_inflated, search_polyhedra
from simcore.dem.contact.pairs.inflated import MARGIN, MAX_FACES, TOLERANCE
from simcore.dem.contact.query import place_solids, table_of
from simcore.dem.from_scene import compose
from simcore.dem.shapes.polyhedra import ELLIPSOID, MIXED, POLYHEDRON, SPHERE, convex
from tests.helpers.contact_pairs import place_pairs, update_polyhedra
from tests.helpers.few_spheres import set_up_few_spheres
from tests.helpers.polyhedra import make_pebble

OVERLAP = 1e-7
PAIRS = 60
START = np.array([0.0, 0.6, 0.8])  # the search's first direction


def support(a, b, n):
    """Return the point of the rounded Minkowski difference of corners a, b (n, 3) farthest along the unit vector n."""
    return a[np.argmax(a @ n)] - b[np.argmin(b @ n)] + 2.0 * MARGIN * n


def nearest(simplex):
    """Return the corners of the part of a simplex nearest to the origin, and its nearest point.

    It returns None if the origin is inside the simplex.
    """
    points = np.array(simplex)
    if len(points) == 4:
        weights = np.linalg.solve(np.vstack([points.T, np.ones(4)]), [0.0, 0.0, 0.0, 1.0])
        if (weights >= 0.0).all():
            return None
    best = (np.inf, None, None)
    for n in (1, 2, 3):
        for part in combinations(range(len(points)), n):
            corners = points[list(part)]
            edges = (corners[1:] - corners[0]).T
            others = np.linalg.lstsq(edges, -corners[0], rcond=None)[0] if n > 1 else np.zeros(0)
            weights = np.array([1.0 - others.sum(), *others])
            point = weights @ corners
            if (weights >= 0.0).all() and point @ point < best[0]:
                best = (point @ point, list(corners), point)
    return best[1:]


def plane(points, face):
    """Return the outward unit normal of a face and the distance of its plane from the origin, which is inside."""
    p, q, s = (points[k] for k in face)
    n = np.cross(q - p, s - p)
    n /= np.linalg.norm(n)
    return n, n @ p


def slow_search(a, b, direction, room=MAX_FACES):
    """Return overlap, 0 if none is found, and normal of corners a, b (n, 3); room: maximum number of faces."""
    points = [support(a, b, direction)]
    found = (points, points[0])
    while found is not None:
        points, v = found
        n = -v / np.linalg.norm(v)
        found = nearest([*points, support(a, b, n)])
        points = [*points, support(a, b, n)]
    centre = np.mean(points, axis=0)
    faces = []
    for face in combinations(range(4), 3):
        n = np.cross(points[face[1]] - points[face[0]], points[face[2]] - points[face[0]])
        faces.append(face if n @ (points[face[0]] - centre) > 0.0 else face[::-1])
    made, upper = 4, np.inf
    while True:
        planes = [plane(points, face) for face in faces]
        normal, distance = min(planes, key=lambda of: of[1])
        new = support(a, b, normal)
        upper = min(upper, new @ normal)
        if upper <= (1.0 + TOLERANCE) * distance:
            break
        seen = [k for k, (n, d) in enumerate(planes) if n @ new > d]
        edges = {(faces[k][c], faces[k][(c + 1) % 3]) for k in seen for c in range(3)}
        rim = [edge for edge in edges if edge[::-1] not in edges]
        made += len(rim)
        if made > room:
            break
        points.append(new)
        faces = [face for k, face in enumerate(faces) if k not in seen]
        faces += [(u, v, len(points) - 1) for u, v in rim]
    return max(distance - 2.0 * MARGIN, 0.0), normal


@pytest.fixture(scope="module")
def pebbles():
    """Return pairs of pebbles: polyhedra, index, rotations, offsets, true normals, overlaps found, normals found."""
    rng = np.random.default_rng(5)
    hulls = [convex(make_pebble(seed, n=152).vertices * 3.35e-3) for seed in range(8)]
    return find_pairs(hulls, PAIRS, rng)


def find_pairs(hulls, n, rng):
    index = rng.integers(len(hulls), size=2 * n)
    turns, offset, normal, right = touching_pairs(hulls, index, OVERLAP, rng)
    rotation = Rotation.from_quat(turns, scalar_first=True).as_matrix()
    center = np.einsum("nij,nj->ni", rotation, np.array([hull.center for hull in hulls])[index])
    apart = offset + center[1::2] - center[0::2]
    overlap, along = np.empty(n), np.empty((n, 3))
    find(table_of(tuple(hulls))[0], place_solids(tuple(hulls), index, rotation), apart, overlap, along)
    assert right.all()
    return hulls, index, rotation, apart, normal, overlap, along


def corners(pairs, k):
    """Return the corners (n, 3) of both bodies of pair k, relative to the centre of a."""
    hulls, index, rotation, apart = pairs[:4]
    a, b = (hulls[index[i]].base.vertices * hulls[index[i]].scale @ rotation[i].T for i in (2 * k, 2 * k + 1))
    return a, b + apart[k]


def test_pair_by_pair_as_a_plain_search(pebbles):
    overlap, along = pebbles[5:]
    for k in range(PAIRS):
        slow, normal = slow_search(*corners(pebbles, k), START)
        # The distances of 2e-4 m result from some ten operations on coordinates of 1e-2 m.
        assert overlap[k] == pytest.approx(slow, abs=1e-14), k
        if slow > 0.0:
            np.testing.assert_allclose(along[k], normal, atol=1e-9)


def test_fine_hulls_are_found_too_shallow_or_not_at_all(pebbles):
    overlap = pebbles[5]
    # The polytope is inside the bodies, and a converged search is short by at most TOLERANCE times 2 MARGIN.
    assert overlap.max() <= OVERLAP * (1.0 + 1e-6)
    short = overlap < OVERLAP - 4.0 * MARGIN * TOLERANCE
    assert 0.2 < short.mean() < 0.8
    assert 0.0 < (overlap == 0.0).mean() < 0.4


def test_it_is_the_room_that_is_short(pebbles):
    """With ten times as many faces, the plain search finds more of the overlap, mostly all of it."""
    overlap, right = pebbles[5], 0
    short = [k for k in range(PAIRS) if overlap[k] < 0.99 * OVERLAP][:10]
    for k in short:
        found, _ = slow_search(*corners(pebbles, k), START, room=10 * MAX_FACES)
        assert overlap[k] < found < OVERLAP
        right += found > OVERLAP - 4.0 * MARGIN * TOLERANCE
    assert right >= 0.6 * len(short) > 0


@numba.njit(error_model="numpy")
def step(shapes, bodies, contacts):
    """Update contacts as a step does before it computes forces; return how many contacts were lost."""
    lost = 0
    for p in range(len(contacts.body_a)):
        check_polyhedra(shapes, bodies, contacts, p, 0.0, False)
        if contacts.pending[p] != 0:
            search_polyhedra(shapes, bodies, contacts, p, 0.0, False)
        if contacts.touching[p] != 0:
            find_inflated(shapes, bodies, contacts, p, 0.0, False)
            lost += contacts.touching[p] == 0
    return lost


def test_a_lost_contact_forgets_its_springs_and_is_looked_for_again(pebbles):
    hulls, index, rotation, apart = pebbles[:4]
    of_body = [hulls[k] for k in index]
    bodies, shapes, contacts = place_pairs(
        [hull.base for hull in of_body],
        np.array([hull.scale for hull in of_body]),
        Rotation.from_matrix(rotation).as_quat(scalar_first=True),
        apart,
    )
    update_polyhedra(shapes, bodies, contacts, 0.0)
    # Bodies are placed on a grid, so positions and offsets are rounded to 1e-16 m.
    np.testing.assert_allclose(contacts.overlap, OVERLAP, rtol=1e-6)
    contacts.spring[:] = 1e-9
    exact = contacts.point.copy()
    lost = step(shapes, bodies, contacts)
    gone = contacts.touching == 0
    assert lost == gone.sum() > 0
    np.testing.assert_array_equal(gone, pebbles[5] == 0.0)
    assert (contacts.spring[gone] == 0.0).all() and (contacts.spring[~gone] != 0.0).all()
    # Where the overlap is right, so is the point, apart from the effect of the normal's angle α over 2 MARGIN. This
    # angle reduces the depth by 2 MARGIN α² / 2.
    right = ~gone & (contacts.overlap > OVERLAP - 4.0 * MARGIN * TOLERANCE)
    off = np.linalg.norm(contacts.point - exact, axis=1)[right]
    assert right.sum() > 20 and off.max() < 2.0 * MARGIN * np.sqrt(8.0 * TOLERANCE)
    # Nothing has moved, so the next step loses the same contacts, and the exact search finds all of them.
    assert step(shapes, bodies, contacts) == lost
    np.testing.assert_array_equal(contacts.touching == 0, gone)
    update_polyhedra(shapes, bodies, contacts, 0.0)
    assert (contacts.touching != 0).all()


def test_only_polyhedra_have_it():
    scene = set_up_few_spheres(numerics={"polyhedron_contact": "point"}).scene
    inflated = dataclasses.replace(scene.numerics, polyhedron_contact="inflated")
    assert compose(dataclasses.replace(scene, kind=POLYHEDRON, numerics=inflated)).features.inflated
    assert not compose(scene).features.inflated
    for kind in (SPHERE, ELLIPSOID, MIXED):
        with pytest.raises(
            ValueError, match="numerics.polyhedron_contact: inflated works only if all grains are polyhedra"
        ):
            dataclasses.replace(scene, kind=kind, numerics=inflated)
