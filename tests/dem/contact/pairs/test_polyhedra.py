"""Polyhedron contacts, compared with the exact distance from the hull of the Minkowski difference.

Depth and gap are sums of products of coordinates of the pair's size, in some ten operations (rotation, offset, plane,
mean). Double precision then gives 1e-13 of the size, some hundred eps, and this is asserted. The contact law needs only
1e-9.
"""

import itertools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from simcore.dem.contact.pairs.polyhedra import GAP_SLACK
from simcore.dem.shapes.polyhedra import climb, collect_shapes, hint
from tests.helpers.contact_pairs import certain_gap, place_pairs, signed_distance, update_polyhedra
from tests.helpers.polyhedra import CUBE, TETRAHEDRON, make_box, make_polyhedron
from tests.helpers.rotations import IDENTITY, X45, Y45, Z45, random_orientations

EPS = np.finfo(float).eps
ROUNDING = 1e-13  # of the pair's size: 450 eps


def directions(n, rng):
    d = rng.standard_normal((n, 3))
    return d / np.linalg.norm(d, axis=1, keepdims=True)


def differences(bases, bodies):
    """Yield the points of the Minkowski difference of every pair, and the pair's size."""
    for k in range(len(bodies.mass) // 2):
        corners = [
            (bases[i].vertices * bodies.scale[i])
            @ Rotation.from_quat(bodies.orientation[i], scalar_first=True).as_matrix().T
            for i in (2 * k, 2 * k + 1)
        ]
        r = bodies.position[2 * k + 1] - bodies.position[2 * k]
        points = (corners[0][:, None] - corners[1][None] - r).reshape(-1, 3)
        yield points, bodies.radius[2 * k] + bodies.radius[2 * k + 1]


def compare(bases, bodies, contacts):
    """Compare every contact with the exact distance; return how many pairs touch."""
    for k, (points, size) in enumerate(differences(bases, bodies)):
        distance = signed_distance(points)
        normal = contacts.direction[k]
        reach = (points @ normal).max()  # extent of the difference along the normal: an upper bound of the depth
        assert abs(np.linalg.norm(normal) - 1.0) < 1e-14
        if contacts.touching[k]:
            assert abs(contacts.overlap[k] + distance) <= ROUNDING * size
            assert abs(reach - contacts.overlap[k]) <= ROUNDING * size, "the normal does not belong to the depth"
        else:
            assert distance > -ROUNDING * size, "an overlap was missed"
            gap = certain_gap(contacts, k)
            assert gap <= distance + ROUNDING * size, "a gap that is not certain"
            # A direction has an error of eps size / distance, and its gap is short by this share of the size. The gap
            # is within the slack only if eps size² / distance is less than the slack of the distance.
            if distance > np.sqrt(10.0 * EPS / GAP_SLACK) * size:
                assert gap >= (1.0 - GAP_SLACK) * distance
    return int(contacts.touching.sum())


@pytest.fixture(scope="module")
def clouds():
    """Return 800 polyhedra with 8 to 40 vertices: on spheres, in cubes, or normally distributed."""
    rng = np.random.default_rng(1)
    hulls = []
    for k in range(800):
        points = rng.standard_normal((rng.integers(8, 41), 3))
        if k % 3 == 0:
            points /= np.linalg.norm(points, axis=1, keepdims=True)
        elif k % 3 == 1:
            points = rng.uniform(-1.0, 1.0, points.shape)
        hulls.append(make_polyhedron(points / np.abs(points).max()))
    return hulls


def test_a_climb_from_a_hint_ends_at_the_farthest_vertex(clouds):
    shapes, rng = collect_shapes(clouds[:60]), np.random.default_rng(8)
    for shape, direction in itertools.product(range(60), directions(20, rng)):
        start = hint(shapes, shape, *direction)
        assert shapes.vertex_start[shape] <= start < shapes.vertex_start[shape + 1]
        heights = clouds[shape].vertices @ direction
        assert heights[start - shapes.vertex_start[shape]] > heights.max() - 0.5 * np.ptp(heights), "not near it"
        assert climb(shapes, start, *direction) == shapes.vertex_start[shape] + np.argmax(heights)
    assert hint(shapes, 7, 0.0, 0.0, 0.0) == shapes.vertex_start[7]


@pytest.mark.parametrize("size, common", [(1.0, 0.0), (1e-6, 0.0), (1e-3, 1e3), (1e3, 0.0)])
def test_random_hulls_of_every_size_agree_with_the_oracle(clouds, size, common):
    rng = np.random.default_rng(2)
    n = len(clouds) // 2
    scale = np.exp(rng.uniform(np.log(0.4), np.log(1.5), (2 * n, 3)))
    offsets = directions(n, rng) * rng.uniform(0.0, 2.5, (n, 1))
    offsets[::7] *= 1e-3  # nearly concentric
    bodies, shapes, contacts = place_pairs(clouds, scale, random_orientations(2 * n, rng), offsets, size, common)
    update_polyhedra(shapes, bodies, contacts, 0.0)
    touching = compare(clouds, bodies, contacts)
    assert 0.3 * n < touching < 0.8 * n


def test_hulls_that_just_touch_are_decided_right(clouds):
    """Pairs are moved until their distance is ±1e-2 to ±1e-9 of their size."""
    rng = np.random.default_rng(3)
    n = 100
    bases, scale = clouds[: 2 * n], np.ones((2 * n, 3))
    orientation = random_orientations(2 * n, rng)
    offsets = directions(n, rng)
    bodies, _, _ = place_pairs(bases, scale, orientation, offsets)
    for k, (points, size) in enumerate(differences(bases, bodies)):
        # Along a fixed direction the distance is monotonic beyond the first touch, so the offset is found by bisection.
        unit = offsets[k]
        wanted = (-1.0) ** k * 10.0 ** -rng.uniform(2, 9) * size
        low, high = 0.0, 4.0
        while high - low > 1e-12:
            middle = 0.5 * (low + high)
            if signed_distance(points - (middle - 1.0) * unit) < wanted:
                low = middle
            else:
                high = middle
        offsets[k] = high * unit
    bodies, shapes, contacts = place_pairs(bases, scale, orientation, offsets)
    update_polyhedra(shapes, bodies, contacts, 0.0)
    assert compare(bases, bodies, contacts) == n // 2


S = np.sqrt(0.5)
KNOWN = {
    # name: (points a, points b, scale, orientation a, orientation b, offset, distance, normal or None)
    "libccd issue 25": (CUBE, CUBE, 2.0, IDENTITY, IDENTITY, (0, 0, 1.9), -0.1, (0, 0, 1)),
    "corner edge": (CUBE, CUBE, 1.0, IDENTITY, Z45, (1.2, 0, 0), 0.7 - S, None),
    "corner edge deep": (CUBE, CUBE, 1.0, IDENTITY, Z45, (1.0, 0, 0), 0.5 - S, (1, 0, 0)),
    "edges crossed, apart": (CUBE, CUBE, 1.0, X45, Y45, (0, 0, 1.5), 0.085786437627, None),
    "edges crossed": (CUBE, CUBE, 1.0, X45, Y45, (0, 0, 1.3), -0.114213562373, (0, 0, 1)),
    "concentric cubes": (CUBE, CUBE, 1.0, IDENTITY, IDENTITY, (0, 0, 0), -1.0, None),
    "concentric cubes turned": (CUBE, CUBE, 1.0, IDENTITY, Z45, (0, 0, 0), -1.0, None),
    "cube in cube": (CUBE, 0.1 * CUBE, 1.0, IDENTITY, IDENTITY, (0, 0, 0), -0.55, None),
    "tetrahedron in itself": (TETRAHEDRON, TETRAHEDRON, 1.0, IDENTITY, IDENTITY, (0, 0, 0), -np.sqrt(0.5), None),
    "tetrahedron in its mirror": (
        TETRAHEDRON, -TETRAHEDRON, 1.0, IDENTITY, IDENTITY, (0, 0, 0), -1.0 / np.sqrt(6.0), None,
    ),
    "plates": (
        CUBE * [1, 1, 0.01], CUBE * [1, 1, 0.01], 1.0, IDENTITY, IDENTITY, (0.5, 0.5, 0.009), -0.001, (0, 0, 1),
    ),
    "needles crossed": (
        CUBE * [1, 0.01, 0.01], CUBE * [0.01, 1, 0.01], 1.0, IDENTITY, IDENTITY, (0, 0, 0.009), -0.001, (0, 0, 1),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", KNOWN)
def test_known_pairs(name):
    points_a, points_b, scale, turn_a, turn_b, offset, distance, normal = KNOWN[name]
    bases = [make_polyhedron(points_a), make_polyhedron(points_b)]
    scales = np.full((2, 3), scale)
    bodies, shapes, contacts = place_pairs(bases, scales, [turn_a, turn_b], [offset])
    update_polyhedra(shapes, bodies, contacts, 0.0)
    # The references have 12 digits.
    if distance < 0.0:
        assert contacts.touching[0] == 1
        assert contacts.overlap[0] == pytest.approx(-distance, abs=1e-12)
    else:
        assert contacts.touching[0] == 0
        assert (1.0 - GAP_SLACK) * distance <= certain_gap(contacts, 0) <= distance + 1e-12
    if normal is not None:
        np.testing.assert_allclose(contacts.direction[0], normal, atol=1e-14)
    compare(bases, bodies, contacts)


@pytest.mark.parametrize("scale", [(1, 1, 1), (1, 1, 0.01), (1, 0.01, 0.01)], ids=["cubes", "plates", "needles"])
def test_parallel_faces_edges_and_corners(scale):
    """Aligned blocks on a grid of offsets, all turned together, have only degenerate facets."""
    rng = np.random.default_rng(4)
    base = make_polyhedron(CUBE)
    n = 200
    together = Rotation.random(n, rng=rng)
    offsets = together.apply(rng.integers(-4, 5, (n, 3)) * 0.3 * np.array(scale))
    orientation = np.repeat(together.as_quat(scalar_first=True), 2, axis=0)
    bodies, shapes, contacts = place_pairs([base] * (2 * n), np.tile(scale, (2 * n, 1)), orientation, offsets)
    update_polyhedra(shapes, bodies, contacts, 0.0)
    assert 0 < compare([base] * (2 * n), bodies, contacts) < n


def test_a_pair_seen_from_the_other_body(clouds):
    """Same overlap, opposite normal, same contact point, when a and b change places."""
    rng = np.random.default_rng(5)
    n = 200
    bases, scale = clouds[: 2 * n], np.ones((2 * n, 3))
    orientation = random_orientations(2 * n, rng)
    offsets = directions(n, rng) * rng.uniform(0.3, 1.2, (n, 1))
    swap = np.arange(2 * n) ^ 1
    observed = []
    for order, r in ((np.arange(2 * n), offsets), (swap, -offsets)):
        bodies, shapes, contacts = place_pairs([bases[k] for k in order], scale[order], orientation[order], r)
        update_polyhedra(shapes, bodies, contacts, 0.0)
        observed.append((bodies, contacts))
    (bodies, one), (_, other) = observed
    assert (one.touching == other.touching).all()
    touching = one.touching > 0
    size = (bodies.radius[0::2] + bodies.radius[1::2])[touching]
    assert touching.sum() > 0.5 * n
    assert (np.abs(one.overlap - other.overlap)[touching] <= ROUNDING * size).all()
    # The nearest facet is unique unless two facets are equally near, which does not occur here.
    np.testing.assert_allclose(one.direction[touching], -other.direction[touching], atol=1e-9)
    np.testing.assert_allclose(one.point[touching], (offsets + other.point)[touching], atol=1e-9)


def test_turning_and_moving_a_pair_changes_nothing(clouds):
    rng = np.random.default_rng(6)
    n = 200
    bases, scale = clouds[: 2 * n], np.ones((2 * n, 3))
    orientation = random_orientations(2 * n, rng)
    offsets = directions(n, rng) * rng.uniform(0.3, 1.2, (n, 1))
    turn = Rotation.random(rng=rng)
    turned_orientation = (turn * Rotation.from_quat(orientation, scalar_first=True)).as_quat(scalar_first=True)
    bodies, shapes, here = place_pairs(bases, scale, orientation, offsets)
    update_polyhedra(shapes, bodies, here, 0.0)
    bodies, shapes, there = place_pairs(bases, scale, turned_orientation, turn.apply(offsets), common=100.0)
    update_polyhedra(shapes, bodies, there, 0.0)
    touching = here.touching > 0
    assert (here.touching == there.touching).all() and touching.any()
    # At positions of 100 times the size, rounding errors are 100 eps.
    np.testing.assert_allclose(here.overlap[touching], there.overlap[touching], atol=1e-12)
    np.testing.assert_allclose(turn.apply(here.direction[touching]), there.direction[touching], atol=1e-9)


def test_the_contact_point_is_midway_between_points_of_both_bodies(clouds):
    """Half an overlap along the normal there is a point of a, and half an overlap against it a point of b."""
    rng = np.random.default_rng(7)
    n = 200
    bases, scale = clouds[: 2 * n], np.ones((2 * n, 3))
    orientation = random_orientations(2 * n, rng)
    offsets = directions(n, rng) * rng.uniform(0.3, 1.5, (n, 1))
    bodies, shapes, contacts = place_pairs(bases, scale, orientation, offsets)
    update_polyhedra(shapes, bodies, contacts, 0.0)
    rows = np.flatnonzero(contacts.touching)
    assert len(rows) > 50
    for k in rows:
        half = 0.5 * contacts.overlap[k] * contacts.direction[k]
        for body, point in ((2 * k, contacts.point[k] + half), (2 * k + 1, contacts.point[k] - half - offsets[k])):
            base = bases[body]
            local = Rotation.from_quat(orientation[body], scalar_first=True).inv().apply(point)
            corners = base.vertices[base.faces]
            outward = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            outward /= np.linalg.norm(outward, axis=1, keepdims=True)
            assert (((local - corners[:, 0]) * outward).sum(axis=1) <= 1e-12).all()


def test_memory_answers_as_a_search_does(clouds):
    """After small moves of shallow contacts, the remembered facet or gap gives what a new search gives."""
    rng = np.random.default_rng(8)
    n = 300
    bases, scale = clouds[: 2 * n], np.ones((2 * n, 3))
    orientation = random_orientations(2 * n, rng)
    offsets = 0.5 * directions(n, rng)
    for _ in range(3):  # push the pairs apart along their normals until little of the overlap is left
        bodies, shapes, contacts = place_pairs(bases, scale, orientation, offsets)
        update_polyhedra(shapes, bodies, contacts, 0.0)
        size = bodies.radius[0::2] + bodies.radius[1::2]
        offsets += (contacts.overlap * contacts.touching - 2e-3 * size)[:, None] * contacts.direction
    searched, compared = 0, 0
    for _ in range(30):
        step = 2e-4 * rng.standard_normal((2 * n, 3))
        bodies.position[:] += step
        searched += update_polyhedra(shapes, bodies, contacts, 0.0)
        offsets = bodies.position[1::2] - bodies.position[0::2]
        fresh_bodies, _, fresh = place_pairs(bases, scale, orientation, offsets)
        update_polyhedra(shapes, fresh_bodies, fresh, 0.0)
        # Whether a pair touches may differ by rounding.
        one, other = contacts.touching > 0, fresh.touching > 0
        overlap = np.where(one, contacts.overlap, fresh.overlap)
        assert (overlap[one != other] <= ROUNDING * size[one != other]).all()
        both = one & other
        excess = (contacts.overlap - fresh.overlap) / size
        # A remembered facet is a local minimum of the overlap, so its overlap is never below the global minimum. It is
        # another facet only where the contact is not small compared with its facet, which is rare for shallow contacts.
        assert (excess[both] >= -ROUNDING).all()
        same = both & (excess <= ROUNDING)
        assert same.sum() > 0.99 * both.sum()
        alike = (contacts.direction[same] * fresh.direction[same]).sum(axis=1) > 1.0 - 1e-9
        assert alike.all()
        compared += same.sum()
    assert compared > 30 * n / 4
    assert searched < 0.3 * 30 * n, "remembered contacts were hardly ever reused"


def test_a_corner_that_slides_over_an_edge_keeps_the_least_overlap():
    """A spike in a cube's top slides over the edge: the overlap falls with the distance that is left to the side.

    The remembered top face stays a local minimum until the spike has left it. If it were used that long, the contact
    would lose all its elastic energy at once.
    """
    spike = make_polyhedron(np.array([[0, 0, 0], [0.2, 0, 1], [0.1, 0.1, 1], [0.1, -0.1, 1.0]]))  # leans outward
    apex = spike.vertices[:, 2].argmin()
    depth, way = 0.02, np.linspace(-0.06, 0.01, 71)
    bodies, shapes, contacts = place_pairs([make_polyhedron(CUBE), spike], np.ones((2, 3)), [IDENTITY] * 2, [[0, 0, 9]])
    start = bodies.position[0] + [0.5, 0.1, 0.5 - depth] - spike.vertices[apex]
    searched = []
    for x in way:
        bodies.position[1] = start + [x, 0.0, 0.0]
        searched.append(update_polyhedra(shapes, bodies, contacts, 0.0))
        overlap = max(min(depth, -x), 0.0)
        assert contacts.overlap[0] * contacts.touching[0] == pytest.approx(overlap, abs=ROUNDING)
    # Farther from the edge than CERTAIN_REACH times the depth, the remembered facet is used after the first search.
    assert not any(searched[1:20])


def test_a_plate_that_is_pressed_through_its_twin_leaves_it_on_the_far_side():
    """A remembered facet must not outlive the contact: past the middle the far side shows less overlap."""
    plate = make_box((1.0, 1.0, 0.05))
    bodies, shapes, contacts = place_pairs([plate] * 2, np.ones((2, 3)), [IDENTITY] * 2, [(0.05, 0.02, 3.0)])
    touched = 0
    for z in np.linspace(0.051, -0.15, 2001):
        bodies.position[1] = bodies.position[0] + [0.05, 0.02, z]
        update_polyhedra(shapes, bodies, contacts, 0.0)
        ((points, size),) = differences([plate] * 2, bodies)
        overlap = max(-signed_distance(points), 0.0)
        assert abs(max(contacts.overlap[0], 0.0) - overlap) <= ROUNDING * size
        touched += int(contacts.touching[0])
    assert touched > 500 and not contacts.touching[0]


def test_the_point_of_nearly_concentric_hulls_is_inside_both():
    """EPA fails at such depths, and the search over all facets gives the facet. The point was a corner of it."""
    rng = np.random.default_rng(6)
    n, bases = 12, []
    for k in range(2):
        points = np.random.default_rng(k).standard_normal((1300, 3))
        bases.append(make_polyhedron(points / np.linalg.norm(points, axis=1, keepdims=True)))
    bases = bases * n
    orientation = random_orientations(2 * n, rng)
    bodies, shapes, contacts = place_pairs(bases, np.ones((2 * n, 3)), orientation, 0.1 * directions(n, rng))
    update_polyhedra(shapes, bodies, contacts, 0.0)
    assert contacts.touching.all() and contacts.overlap.min() > 1.85
    for k, point in enumerate(contacts.point):
        for i, sign in ((2 * k, 1.0), (2 * k + 1, -1.0)):
            at = point - (bodies.position[i] - bodies.position[2 * k])
            surface = at + sign * 0.5 * contacts.overlap[k] * contacts.direction[k]
            corners = (bases[i].vertices @ bodies.rotation[i].T)[bases[i].faces]
            normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            normals /= np.linalg.norm(normals, axis=1, keepdims=True)
            beyond = ((surface - corners[:, 0]) * normals).sum(axis=1).max()
            assert abs(beyond) < 1e-12  # on the surface of each body, half of the overlap away
