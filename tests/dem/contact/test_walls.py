"""Contacts with floor and cylinder: the deepest point, compared with all vertices and with the surface."""

import numba
import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from simcore.dem.contact.patch.workspace import make_workspace
from simcore.dem.contact.walls import (
    cylinder_convex,
    cylinder_ellipsoid,
    cylinder_patch,
    cylinder_sphere,
    floor_convex,
    floor_ellipsoid,
    floor_patch,
    floor_sphere,
)
from simcore.dem.shapes.polyhedra import POLYHEDRON, collect_shapes
from simcore.dem.state.bodies import CYLINDER, FLOOR, make_bodies
from simcore.dem.state.contacts import Box
from simcore.dem.state.features import Features
from simcore.dem.step.candidate_pairs import list_candidates
from tests.helpers.contact_pairs import UNIT_SPHERE
from tests.helpers.polyhedra import make_box, make_pebble

WALL = 1.5  # radius of the cylinder


@numba.njit(error_model="numpy")
def meet_walls(shapes, bodies, walls, wall_radius, kind):
    for w in range(len(walls.body)):
        floor = walls.wall[w] == FLOOR
        if kind == 0:
            if floor:
                floor_sphere(bodies, walls, w)
            else:
                cylinder_sphere(bodies, walls, w, wall_radius)
        elif kind == 1:
            if floor:
                floor_ellipsoid(bodies, walls, w)
            else:
                cylinder_ellipsoid(bodies, walls, w, wall_radius)
        elif floor:
            floor_convex(shapes, bodies, walls, w)
        else:
            cylinder_convex(shapes, bodies, walls, w, wall_radius)


def place(bases, kind, scale, position, orientation, shape=None):
    n = len(position)
    still = np.zeros((n, 3))
    shape = np.zeros(n, int) if shape is None else shape
    bodies = make_bodies(bases, shape, scale, position, orientation, still, still, density=1.0)
    shapes = collect_shapes(bases)
    features = Features(POLYHEDRON, True, cylinder=True, periodic=False, patch=True)
    walls = list_candidates(bodies, shapes, Box(0.0, WALL), 100.0, features).walls
    meet_walls(shapes, bodies, walls, WALL, kind)
    return bodies, Met(walls)


class Met:
    """Contacts of bodies with both walls: overlap (n, 2), 0 if apart, and the deepest point relative to the centre."""

    def __init__(self, walls):
        assert len(walls.body) == 2 * (walls.body.max() + 1)  # with a wide skin every body is near both walls
        self.overlap = walls.overlap.reshape(-1, 2)
        self.point = (walls.point - 0.5 * walls.overlap[:, None] * walls.normal).reshape(-1, 2, 3)


def random_places(rng, n):
    position = rng.uniform(-1.2, 1.2, (n, 3))
    position[::9, :2] = 0.0
    return position, Rotation.random(n, rng=rng).as_quat(scalar_first=True)


def check_points(placed, wall, true):
    """Assert that overlaps are the true ones and that the points are as deep; return the rows that touch."""
    bodies, met = placed
    overlap = met.overlap[:, wall]
    rows = np.flatnonzero(true > 1e-12)
    assert (overlap[true < -1e-12] <= 0.0).all()
    np.testing.assert_allclose(overlap[rows], true[rows], atol=1e-12)
    point = bodies.position + met.point[:, wall]
    depth = -point[:, 2] if wall == FLOOR else np.hypot(point[:, 0], point[:, 1]) - WALL
    np.testing.assert_allclose(depth[rows], true[rows], atol=1e-12)
    assert len(rows) > 20
    return rows


def test_spheres():
    rng = np.random.default_rng(1)
    position, orientation = random_places(rng, 200)
    radius = rng.uniform(0.2, 0.8, 200)
    placed = place([UNIT_SPHERE], 0, np.repeat(radius[:, None], 3, axis=1), position, orientation)
    check_points(placed, FLOOR, radius - position[:, 2])
    check_points(placed, CYLINDER, np.hypot(position[:, 0], position[:, 1]) + radius - WALL)


def test_a_sphere_wider_than_the_cylinder_on_its_axis():
    _, met = place([UNIT_SPHERE], 0, [[1.6] * 3], [[0.0, 0.0, 5.0]], [[1.0, 0, 0, 0]])
    assert met.overlap[0, CYLINDER] == pytest.approx(0.1)
    assert np.hypot(*met.point[0, CYLINDER, :2]) == pytest.approx(1.6)


def test_hulls_against_all_their_vertices():
    rng = np.random.default_rng(2)
    bases = [make_pebble(seed, n=40) for seed in range(5)]
    n = 200
    position, orientation = random_places(rng, n)
    shape, scale = rng.integers(0, 5, n), rng.uniform(0.4, 1.6, (n, 3))
    placed = place(bases, 2, scale, position, orientation, shape)
    corners = [position[i] + (bases[shape[i]].vertices * scale[i]) @ placed[0].rotation[i].T for i in range(n)]
    check_points(placed, FLOOR, np.array([-c[:, 2].min() for c in corners]))
    check_points(placed, CYLINDER, np.array([np.hypot(c[:, 0], c[:, 1]).max() for c in corners]) - WALL)


def deepest_in_cylinder(scale, rotation, position):
    """Return the overlap with the cylinder by brute force: the farthest of many surface points, refined."""
    u = np.random.default_rng(0).standard_normal((2000, 3))
    u /= np.linalg.norm(u, axis=1, keepdims=True)

    def shortfall(v):
        v = v / np.linalg.norm(v)
        point = position + rotation @ (scale * v)
        return -np.hypot(point[0], point[1])

    distance = np.hypot(*(position + (u * scale) @ rotation.T)[:, :2].T)
    best = max(
        -minimize(shortfall, u[k], method="BFGS", options={"gtol": 1e-12}).fun for k in np.argsort(distance)[-3:]
    )
    return max(best, distance.max()) - WALL


@pytest.mark.parametrize("flattest", [0.4, 0.03])
def test_ellipsoids_against_their_surface(flattest):
    rng = np.random.default_rng(3)
    n = 120
    position, orientation = random_places(rng, n)
    scale = 1.4 * np.exp(rng.uniform(np.log(flattest), 0.0, (n, 3)))
    placed = bodies, met = place([UNIT_SPHERE], 1, scale, position, orientation)
    # The lowest point has a closed form, the support height along −z.
    check_points(placed, FLOOR, np.linalg.norm(bodies.rotation[:, 2] * scale, axis=1) - position[:, 2])
    true = np.array([deepest_in_cylinder(scale[i], bodies.rotation[i], position[i]) for i in range(n)])
    # The brute force is short by the error of the minimiser, which is of second order in 1e-7.
    overlap = met.overlap[:, CYLINDER]
    assert ((overlap > 1e-9) == (true > 1e-9)).all()
    rows = np.flatnonzero(true > 1e-9)
    np.testing.assert_allclose(overlap[rows], true[rows], atol=1e-9)
    point = bodies.position[rows] + met.point[rows, CYLINDER]
    np.testing.assert_allclose(np.hypot(point[:, 0], point[:, 1]) - WALL, overlap[rows], atol=1e-12)
    local = np.einsum("nji,nj->ni", bodies.rotation[rows], met.point[rows, CYLINDER]) / scale[rows]
    np.testing.assert_allclose(np.linalg.norm(local, axis=1), 1.0, atol=1e-12)  # on the surface
    assert len(rows) > 20


def test_hard_case_the_grain_lies_across_the_cylinder():
    """Without an offset along the longer axis of the projection both ends are equally deep; small offsets agree."""
    upright = [1.0, 0.0, 0.0, 0.0]
    for y in (0.0, 1e-14, 1e-9, 0.05):
        # The projection has semi-axes 1.6 and 0.4: λ stays at the larger eigenvalue while y p2 < p1 − p2.
        _, met = place([UNIT_SPHERE], 1, [[1.6, 0.4, 0.3]], [[0.0, y, 5.0]], [upright])
        t = np.linspace(0.0, 2.0 * np.pi, 400001)
        true = np.hypot(1.6 * np.cos(t), y + 0.4 * np.sin(t)).max() - WALL
        assert met.overlap[0, CYLINDER] == pytest.approx(true, abs=1e-10)
    for x in (1e-15, 1e-12, -1e-10, 1e-8):
        near = place([UNIT_SPHERE], 1, [[1.6, 0.4, 0.3]], [[x, 0.02, 5.0]], [upright])[1].overlap[0, CYLINDER]
        exact = place([UNIT_SPHERE], 1, [[1.6, 0.4, 0.3]], [[0.0, 0.02, 5.0]], [upright])[1].overlap[0, CYLINDER]
        # To first order the distance grows by the offset times the cosine of its direction. The rest is rounding.
        height = 0.02 * 0.16 / (1.6**2 - 0.16)
        cosine = 1.6 * np.sqrt(1.0 - (height / 0.4) ** 2) / (exact + WALL)
        assert near == pytest.approx(exact + abs(x) * cosine, abs=1e-13)
    # If the projection is a circle on the axis, every direction is equally deep.
    _, met = place([UNIT_SPHERE], 1, [[1.6, 1.6, 0.3]], [[0.0, 0.0, 5.0]], [upright])
    assert met.overlap[0, CYLINDER] == pytest.approx(0.1)
    assert np.hypot(*met.point[0, CYLINDER, :2]) == pytest.approx(1.6)


def test_a_tilted_needle_touches_with_its_end():
    """The radial direction of the centre is not enough: it misses 27 µm for long grains of Rettinger et al."""
    tilt = Rotation.from_euler("y", 60, degrees=True).as_quat(scalar_first=True)
    bodies, met = place([UNIT_SPHERE], 1, [[0.05, 0.05, 1.5]], [[0.0, 0.6, 5.0]], [tilt])
    true = deepest_in_cylinder(np.array([0.05, 0.05, 1.5]), bodies.rotation[0], bodies.position[0])
    radial = np.linalg.norm(bodies.rotation[0, 1] * bodies.scale[0]) + 0.6 - WALL
    assert radial < -0.5
    assert -0.1 < true < 0.0
    assert met.overlap[0, CYLINDER] == 0.0
    nearer, nearer_met = place([UNIT_SPHERE], 1, [[0.05, 0.05, 1.5]], [[0.3, 0.6, 5.0]], [tilt])
    assert nearer_met.overlap[0, CYLINDER] == pytest.approx(
        deepest_in_cylinder(np.array([0.05, 0.05, 1.5]), bodies.rotation[0], np.array([0.3, 0.6, 5.0])), abs=1e-9
    )
    assert nearer_met.overlap[0, CYLINDER] > 0.0


@numba.njit(error_model="numpy")
def patch_at_floor(shapes, bodies, walls, workspace):
    for w in range(len(walls.body)):
        if walls.wall[w] == FLOOR and floor_convex(shapes, bodies, walls, w):
            floor_patch(shapes, bodies, walls, w, workspace, 0)


def below_floor(vertices, faces):
    """Return (centroid (2,), second moments (2, 2)) of the part of a polyhedron below z = 0, from its hull."""
    edges = np.array(
        sorted({tuple(sorted(edge)) for face in faces for edge in zip(face, np.roll(face, 1), strict=True)})
    )
    low, high = vertices[edges[:, 0]], vertices[edges[:, 1]]
    crossing = (low[:, 2] > 0) != (high[:, 2] > 0)
    low, high = low[crossing], high[crossing]
    cut = low + (low[:, 2] / (low[:, 2] - high[:, 2]))[:, None] * (high - low)
    part = ConvexHull(np.concatenate([vertices[vertices[:, 2] <= 0], cut]))
    middle = part.points.mean(axis=0)
    volume, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for corners in part.points[part.simplices] - middle:
        size = abs(np.linalg.det(corners)) / 6
        total = corners.sum(axis=0)
        volume, first = volume + size, first + size * total / 4
        second += size / 20 * (corners.T @ corners + np.outer(total, total))
    centroid = first / volume
    return (centroid + middle)[:2], (second / volume - np.outer(centroid, centroid))[:2, :2]


@pytest.mark.parametrize("depth", [0.1, 1e-5])
def test_the_patch_on_the_floor_is_the_part_below_it(depth):
    """Random pebbles, and boxes that lie on a face, an edge or a corner or are slightly tilted.

    A deeper polyhedron is compared as if it were lifted to 1e-4 of the radius of its bounding sphere.
    """
    rng = np.random.default_rng(5)
    base = [make_pebble(5, 60), make_box((2.0, 1.5, 1.0))]
    quarter, tilt = Rotation.from_rotvec([np.pi / 4, 0.0, 0.0]), Rotation.from_rotvec([0.3 * depth, 0.2 * depth, 0.0])
    turns = [Rotation.random(rng=rng) for _ in range(20)] + [Rotation.identity(), quarter, tilt, quarter * tilt]
    shape = np.array([0] * 12 + [1] * 12)
    points, faces = [each.vertices for each in base], [each.faces for each in base]
    placed = [turn.apply(points[k]) for turn, k in zip(turns, shape, strict=True)]
    height = np.array([-vertices[:, 2].min() - depth for vertices in placed])
    position = np.stack([0.1 * np.arange(24), np.zeros(24), height], axis=1)
    orientation = np.array([turn.as_quat(scalar_first=True) for turn in turns])
    still = np.zeros((24, 3))
    bodies = make_bodies(base, shape, np.ones((24, 3)), position, orientation, still, still, density=1.0)
    shapes = collect_shapes(base)
    walls = list_candidates(
        bodies, shapes, Box(0.0), 100.0, Features(POLYHEDRON, True, periodic=False, patch=True)
    ).walls
    patch_at_floor(shapes, bodies, walls, make_workspace(shapes, 1))
    for w, i in enumerate(walls.body):
        lift = max(depth - 1e-4 * bodies.radius[i], 0.0)
        centroid, moments = below_floor(placed[i] + [0.0, 0.0, height[i] + lift], faces[shape[i]])
        size = np.ptp(placed[i], axis=0).max()
        np.testing.assert_allclose(walls.point[w, :2], centroid, atol=1e-7 * size)
        xx, yy, xy = walls.spread[w, [0, 1, 3]]
        np.testing.assert_allclose([[xx, xy], [xy, yy]], moments, atol=1e-7 * size**2)
        assert walls.point[w, 2] == pytest.approx(-height[i] - 0.5 * depth, abs=1e-12)
    assert len(walls.body) == 24


@numba.njit(error_model="numpy")
def patch_at_cylinder(shapes, bodies, walls):
    for w in range(len(walls.body)):
        if walls.wall[w] == CYLINDER:
            cylinder_convex(shapes, bodies, walls, w, WALL)
            cylinder_patch(shapes, bodies, walls, w, WALL)


def test_a_bar_across_the_cylinder_has_a_patch_without_leftovers():
    """With both ends equally deep it touches at a point; moments of the step before, along the bar, must not remain."""
    base, still = make_box((2.0 * WALL + 0.02, 0.1, 0.1)), np.zeros((1, 3))
    bodies = make_bodies(
        [base], [0], np.ones((1, 3)), [[0.0, 0.0, 5.0]], [[1.0, 0.0, 0.0, 0.0]], still, still, density=1.0
    )
    shapes = collect_shapes([base])
    features = Features(POLYHEDRON, True, cylinder=True, periodic=False, patch=True)
    walls = list_candidates(bodies, shapes, Box(0.0, WALL), 100.0, features).walls
    (row,) = np.flatnonzero(walls.wall == CYLINDER)
    bodies.position[0, 0] = 1e-3
    patch_at_cylinder(shapes, bodies, walls)
    assert walls.spread[row, 0] > 1.0
    bodies.position[0, 0] = 0.0
    patch_at_cylinder(shapes, bodies, walls)
    assert (walls.spread[row] == 0.0).all()
    assert abs(walls.point[row, 0]) > WALL
