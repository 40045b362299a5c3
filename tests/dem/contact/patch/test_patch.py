"""The patch of two overlapping polyhedra, compared with their exact intersection, and its motion."""

import numba
import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, HalfspaceIntersection
from scipy.spatial.transform import Rotation

from simcore.dem.contact.pair import pair_of
from simcore.dem.contact.patch.axes import View, axes_about
from simcore.dem.contact.patch.clipping import clipped_moments
from simcore.dem.contact.patch.patch import PATCH_DEPTH, closed_overlap, find_patch, read_facet
from simcore.dem.contact.patch.polytope import cut_moments
from simcore.dem.contact.patch.workspace import make_workspace
from simcore.dem.forces.coulomb_friction import tangent_of
from simcore.dem.forces.patch_torque import patch_torque
from simcore.dem.forces.spring_dashpot import contact_law, explicit_dashpot
from simcore.dem.state.touches import partner_offset
from simcore.dem.vectors import Vec, read
from tests.helpers.contact_pairs import place_pairs, update_polyhedra
from tests.helpers.patch import Patch
from tests.helpers.polyhedra import CUBE, make_box, make_pebble, make_polyhedron
from tests.helpers.rotations import IDENTITY, random_orientations


@numba.njit(error_model="numpy")
def press_patches(shapes, bodies, contacts, workspace):
    for p in range(len(contacts.body_a)):
        if contacts.touching[p] != 0:
            find_patch(shapes, bodies, contacts, p, partner_offset(bodies, contacts, p, 0.0, False), workspace, 0)


@numba.njit(error_model="numpy")
def slow_moments(shapes, bodies, contacts, workspace, p):
    """Return the moments of pair p by the general method alone, without short cuts for single corners and edges."""
    offset = partner_offset(bodies, contacts, p, 0.0, False)
    pair = pair_of(bodies, contacts.body_a[p], contacts.body_b[p], offset)
    axes = axes_about(read(contacts.direction, p))
    tops = (contacts.facet[p, 0], contacts.facet[p, 3])
    return clipped_moments(shapes, bodies, pair, axes, tops, workspace, 0)


def press_pairs(bases, scale, orientation, offsets):
    """Return bodies, shapes and contacts of pairs whose overlaps are evaluated as patches."""
    bodies, shapes, contacts = place_pairs(bases, scale, orientation, offsets)
    update_polyhedra(shapes, bodies, contacts, 0.0)
    press_patches(shapes, bodies, contacts, make_workspace(shapes, 1))
    return bodies, shapes, contacts


def half_spaces(base, bodies, i):
    """Return the planes (m, 4) of body i, relative to the position of the first body of its pair."""
    turn = Rotation.from_quat(bodies.orientation[i], scalar_first=True)
    corners = turn.apply(base.vertices * bodies.scale[i]) + bodies.position[i] - bodies.position[i - i % 2]
    sides = corners[base.faces]
    normals = np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return np.column_stack([normals, -(normals * sides[:, 0]).sum(axis=1)])


def intersection_moments(planes):
    """Return the centroid and the second moments (3, 3) of the volume within half spaces, from its vertices."""
    centre = linprog(
        [0.0, 0.0, 0.0, -1.0],
        A_ub=np.column_stack([planes[:, :3], np.ones(len(planes))]),
        b_ub=-planes[:, 3],
        bounds=[(None, None)] * 3 + [(0.0, None)],
    ).x
    # Qhull needs a point well inside, here the centre of the largest inscribed sphere, because the overlap is flat.
    points = HalfspaceIntersection(planes, centre[:3]).intersections
    hull = ConvexHull(points)
    middle = points.mean(axis=0)
    corners = points[hull.simplices] - middle
    volume = np.abs(np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])))
    share = volume / volume.sum()
    off = (share[:, None] * corners.sum(axis=1) / 4.0).sum(axis=0)
    second = sum(
        s / 20.0 * (np.einsum("ij,ik->jk", c, c) + np.outer(c.sum(axis=0), c.sum(axis=0)))
        for s, c in zip(share, corners, strict=True)
    )
    return middle + off, second - np.outer(off, off)


def shallow_pairs(n, seed, depth, vertices=12):
    """Return pairs of pebbles whose overlap is about `depth` times the pair's size; vertices: the least number."""
    rng = np.random.default_rng(seed)
    bases = [make_pebble(k, vertices + 7 * (k % 5)) for k in range(10)]
    bases = [bases[k % 10] for k in rng.permutation(2 * n)]
    scale, orientation = np.ones((2 * n, 3)), random_orientations(2 * n, rng)
    offsets = rng.standard_normal((n, 3))
    offsets *= 1.0 / np.linalg.norm(offsets, axis=1, keepdims=True)
    for _ in range(4):
        bodies, shapes, contacts = place_pairs(bases, scale, orientation, offsets)
        update_polyhedra(shapes, bodies, contacts, 0.0)
        size = bodies.radius[0::2] + bodies.radius[1::2]
        offsets += (contacts.overlap * contacts.touching - depth * size)[:, None] * contacts.direction
    return bases, scale, orientation, offsets


def compare(bases, bodies, contacts, tolerance):
    compared = 0
    for p in np.flatnonzero(contacts.touching):
        planes = np.vstack([half_spaces(bases[k], bodies, k) for k in (2 * p, 2 * p + 1)])
        centroid, second = intersection_moments(planes)
        n, size = contacts.direction[p], bodies.radius[2 * p] + bodies.radius[2 * p + 1]
        tangential = np.eye(3) - np.outer(n, n)
        extent = np.sqrt(np.trace(tangential @ second))
        assert np.linalg.norm(tangential @ (contacts.point[p] - centroid)) <= tolerance * extent + 1e-9 * size, p
        xx, yy, zz, xy, xz, yz = contacts.spread[p]
        spread = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        assert np.abs(spread - tangential @ second @ tangential).max() <= tolerance * extent**2 + 1e-9 * size**2, p
        compared += 1
    return compared


def test_pebbles_against_their_intersection():
    """The reference is exact up to its own condition number."""
    for depth in (1e-6, 1e-5, 0.9 * PATCH_DEPTH):
        bases, scale, orientation, offsets = shallow_pairs(120, 1, depth)
        bodies, shapes, contacts = press_pairs(bases, scale, orientation, offsets)
        assert compare(bases, bodies, contacts, 1e-7) > 100
    single = (contacts.facet[:, [1, 2]] == contacts.facet[:, [0]]).all(axis=1)
    assert 20 < single[contacts.touching > 0].sum() < 100  # contacts of a corner of a with a face, and others


def test_overhanging_and_turned_cubes():
    """The overlapping part of two faces may be any part of either face."""
    rng = np.random.default_rng(2)
    n = 60
    base = make_polyhedron(CUBE)
    offsets = np.column_stack([rng.uniform(-0.9, 0.9, (n, 2)), 1.0 - PATCH_DEPTH * rng.uniform(0.2, 1.2, n)])
    tilt = Rotation.from_rotvec(
        np.column_stack([0.3 * PATCH_DEPTH * rng.standard_normal((n, 2)), rng.uniform(-0.8, 0.8, n)])
    )
    orientation = np.tile(IDENTITY, (2 * n, 1))
    orientation[1::2] = tilt.as_quat(scalar_first=True)
    bodies, shapes, contacts = press_pairs([base] * (2 * n), np.ones((2 * n, 3)), orientation, offsets)
    assert compare([base] * (2 * n), bodies, contacts, 1e-7) > 50


def test_the_general_way_is_exact_at_any_depth_and_deep_pairs_are_taken_apart():
    bases, scale, orientation, offsets = shallow_pairs(60, 4, 0.1)
    bodies, shapes, contacts = press_pairs(bases, scale, orientation, offsets)
    workspace, seen = make_workspace(shapes, 1), 0
    apart = offsets + (contacts.overlap - PATCH_DEPTH * (bodies.radius[0::2] + bodies.radius[1::2]))[:, None] * (
        contacts.direction
    )
    _, _, thin = press_pairs(bases, scale, orientation, apart)
    for p in np.flatnonzero(contacts.touching & thin.touching):
        planes = np.vstack([half_spaces(bases[k], bodies, k) for k in (2 * p, 2 * p + 1)])
        _, second = intersection_moments(planes)
        m0, mx, my, mxx, mxy, myy = slow_moments(shapes, bodies, contacts, workspace, p)
        n = contacts.direction[p]
        trace = np.trace(second) - n @ second @ n
        assert (mxx + myy) / m0 - (mx**2 + my**2) / m0**2 == pytest.approx(trace, rel=1e-7)
        if thin.direction[p] @ n > 1.0 - 1e-12:  # the least overlap of the thinner pair may be at another place
            across = (contacts.point[p] - thin.point[p]) - ((contacts.point[p] - thin.point[p]) @ n) * n
            assert np.linalg.norm(across) < 1e-9
            np.testing.assert_allclose(contacts.spread[p], thin.spread[p], rtol=1e-6, atol=1e-12)
            seen += 1
    assert seen > 20


def test_the_short_cut_for_corners_is_the_general_way():
    bases, scale, orientation, offsets = shallow_pairs(200, 3, 0.9 * PATCH_DEPTH)
    bodies, shapes, contacts = press_pairs(bases, scale, orientation, offsets)
    workspace = make_workspace(shapes, 1)
    seen = 0
    for p in np.flatnonzero(contacts.touching):
        m0, mx, my, mxx, mxy, myy = slow_moments(shapes, bodies, contacts, workspace, p)
        trace = (mxx + myy) / m0 - (mx**2 + my**2) / m0**2
        size = bodies.radius[2 * p] + bodies.radius[2 * p + 1]
        # Second moments are differences of squares, which are at most the size squared.
        assert abs(trace - contacts.spread[p, :3].sum()) <= 1e-6 * trace + 1e-13 * size**2
        seen += 1
    assert seen > 150


@numba.njit(error_model="numpy")
def cut_and_clipped(shapes, bodies, contacts, workspace, p):
    """Return (moments of pair p by cuts through the pyramid, their reference point, moments of the general method).

    The moments are None if the pair has no such pyramid or a closed form.
    """
    offset = partner_offset(bodies, contacts, p, 0.0, False)
    pair = pair_of(bodies, contacts.body_a[p], contacts.body_b[p], offset)
    axes, facet = axes_about(read(contacts.direction, p)), read_facet(contacts.facet, p)
    view = View(axes, contacts.overlap[p], 1.0)
    shape, _ = closed_overlap(shapes, bodies, pair, view, facet, workspace, 0)
    if shape.exact or shape.n_corners == 0:
        return None
    moments, origin = cut_moments(shapes, bodies, pair, axes, facet, shape.n_corners, workspace, 0)
    return moments, origin, clipped_moments(shapes, bodies, pair, axes, (facet[0][0], facet[1][0]), workspace, 0)


@pytest.mark.parametrize(("depth", "vertices"), [(1e-5, 600), (1e-4, 300), (1e-3, 100), (1e-2, 20)])
def test_cuts_through_the_pyramid_are_the_general_way(depth, vertices):
    """All six moments agree, and after each cut the polytope is closed: no boundary of a face leaves and stays away."""
    bases, scale, orientation, offsets = shallow_pairs(300, 7, depth, vertices)
    bodies, shapes, contacts = place_pairs(bases, scale, orientation, offsets)
    update_polyhedra(shapes, bodies, contacts, 0.0)
    workspace, seen = make_workspace(shapes, 1), 0
    for p in np.flatnonzero(contacts.touching):
        result = cut_and_clipped(shapes, bodies, contacts, workspace, p)
        if result is None:
            continue
        (d, dx, dy, dxx, dxy, dyy), (x, y), (m0, mx, my, mxx, mxy, myy) = result
        extent = np.sqrt((mxx + myy) / m0 - (mx**2 + my**2) / m0**2)
        size = bodies.radius[2 * p] + bodies.radius[2 * p + 1]
        assert d == pytest.approx(m0, rel=1e-6)
        slack = 1e-6 * extent + 1e-13 * size
        np.testing.assert_allclose([dx / d + x, dy / d + y], [mx / m0, my / m0], rtol=0, atol=slack)
        second = [dxx / d - (dx / d) ** 2, dxy / d - dx * dy / d**2, dyy / d - (dy / d) ** 2]
        expected = [mxx / m0 - (mx / m0) ** 2, mxy / m0 - mx * my / m0**2, myy / m0 - (my / m0) ** 2]
        np.testing.assert_allclose(second, expected, rtol=0, atol=1e-6 * extent**2 + 1e-13 * size**2)
        seen += 1
    assert seen > 10
    assert (workspace.way_out == -1).all() and (workspace.way_in == -1).all()


def aimed_pairs(base_a, base_b, n, seed, depth):
    """Return orientations and offsets of pairs whose corners and faces meet at a side of a triangle of b.

    In half of them a face of a is nearly parallel to the triangle, and in half of them the side includes its ends.
    depth: of the overlap before other parts of the bodies meet, over the pair's size.
    """
    rng = np.random.default_rng(seed)
    normals = [np.cross(*(c[:, k] - c[:, 0] for k in (1, 2))) for c in (b.vertices[b.faces] for b in (base_a, base_b))]
    normals = [normal / np.linalg.norm(normal, axis=1, keepdims=True) for normal in normals]
    deep = depth * sum(np.linalg.norm(base.vertices, axis=1).max() for base in (base_a, base_b))
    orientation, offsets = np.empty((2 * n, 4)), np.empty((n, 3))
    for k in range(n):
        turn_b, f = Rotation.random(random_state=rng), rng.integers(len(base_b.faces))
        down = -turn_b.apply(normals[1][f])
        turn_a = Rotation.random(random_state=rng)
        if k % 2:
            up = turn_a.apply(normals[0][rng.integers(len(base_a.faces))])
            turn_a = Rotation.align_vectors([down], [up])[0] * turn_a
            turn_a = Rotation.from_rotvec(10.0 ** rng.uniform(-6, -0.5) * rng.standard_normal(3)) * turn_a
        start, end = turn_b.apply(base_b.vertices[base_b.faces[f, :2]])
        aside = rng.standard_normal(3)
        at = start + rng.choice([0.0, rng.random()]) * (end - start) + 3.0 * deep * (aside - (aside @ down) * down)
        corners = turn_a.apply(base_a.vertices)
        tip = corners[np.argmax(corners @ down)]
        orientation[[2 * k, 2 * k + 1]] = [turn.as_quat(scalar_first=True) for turn in (turn_a, turn_b)]
        offsets[k] = tip - at - deep * down
    return orientation, offsets


def make_prism(sides, height):
    """Return a prism over a regular polygon of radius 1, whose top and bottom are many coplanar triangles."""
    angle = 2.0 * np.pi * np.arange(sides) / sides
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    return make_polyhedron(np.vstack([np.insert(ring, 2, z, axis=1) for z in (-height / 2, height / 2)]))


# A corner of one cube presses into the other near a corner. The planes of both triangles of a face cut the overlap.
TWO_CUBES = (
    np.array(
        [
            [0.8320134664133487, -0.016726044638309085, 0.21615540191604238, -0.510637516600685],
            [0.308160025219673, 0.39806442590849683, 0.6825232651304483, 0.5298529081154707],
        ]
    ),
    np.array([[-1.0028678435199558, -0.1727014217493918, 0.2914403940705041]]),
)


@pytest.mark.parametrize(
    ("base_a", "base_b", "poses"),
    [
        (make_box(), make_box(), TWO_CUBES),
        (make_box(), make_box((1.0, 1.0, 0.05)), 1e-5),
        (make_box(), make_box((1.0, 0.1, 0.1)), 1e-4),
        (make_prism(6, 1.0), make_prism(30, 0.3), 1e-4),
        (make_pebble(5, 200), make_prism(30, 0.3), 1e-4),
        (make_pebble(5, 1300), make_pebble(6, 1300), 1e-4),
    ],
    ids=["two_cubes", "cube_plate", "cube_needle", "prisms", "pebble_prism", "pebbles"],
)
def test_triangles_in_one_plane_and_borders_of_faces(base_a, base_b, poses):
    """The cuts agree with the general way, and the order of the contacts, which share a workspace, is irrelevant."""
    orientation, offsets = poses if isinstance(poses, tuple) else aimed_pairs(base_a, base_b, 1500, 1, poses)
    n = len(offsets)
    bodies, shapes, contacts = place_pairs([base_a, base_b] * n, np.ones((2 * n, 3)), orientation, offsets)
    update_polyhedra(shapes, bodies, contacts, 0.0)
    workspace, results = make_workspace(shapes, 1), {}
    for order in (range(n), reversed(range(n))):
        for p in (p for p in order if contacts.touching[p]):
            result = cut_and_clipped(shapes, bodies, contacts, workspace, p)
            if result is None:
                continue
            assert results.setdefault(p, result) == result
            assert result[0][0] == pytest.approx(result[2][0], rel=1e-5, abs=1e-18)
    assert len(results) > n / 10
    assert (workspace.way_out == -1).all() and (workspace.way_in == -1).all()


@pytest.mark.parametrize("way", ["tilt", "slide", "turn"])
def test_the_point_moves_continuously(way):
    """With ten times as many steps of the same motion, the largest jump of the contact point is a tenth.

    A cube tilts, slides or turns on another one. The point moves farther than the cube: it crosses the face while the
    cube tilts by overlap / edge, here 1e-3.
    """
    base = make_polyhedron(CUBE)
    jumps = []
    for steps in (200, 2000):
        s = np.linspace(0.0, 1.0, steps + 1)
        m = len(s)
        offsets, turn = np.tile([0.1, 0.2, 1.0 - 1e-3], (m, 1)), np.zeros((m, 3))
        if way == "tilt":
            turn[:, 0] = 4e-3 * (s - 0.5)
        elif way == "slide":
            offsets[:, 0] = -0.9 + 1.8 * s
            turn[:] = [1e-4, 2e-4, 0.3]
        else:
            turn[:, 2] = 1.5 * s
        orientation = np.tile(IDENTITY, (2 * m, 1))
        orientation[1::2] = Rotation.from_rotvec(turn).as_quat(scalar_first=True)
        _, _, contacts = press_pairs([base] * (2 * m), np.ones((2 * m, 3)), orientation, offsets)
        assert contacts.touching.all()
        jumps.append(np.abs(np.diff(contacts.point, axis=0)).max())
        travelled = np.ptp(contacts.point, axis=0).max()
    assert travelled > 0.1 or way == "turn"
    assert jumps[1] < 0.15 * jumps[0]


def test_second_moments_that_rounding_made_negative_hold_nothing():
    """For a single vertex behind a wall they are differences of equal numbers; examples/cylinder.yaml had -2e-22 m²."""
    law, mass = contact_law(0.1, 1e-3, 0.22, 0.5), 1e-3
    patch = Patch(spread=np.array([[-2e-22, 0.0, 0.0, -1e-22, 0.0, 0.0]]), twist=np.array([1e-3]))
    damping, tangential = explicit_dashpot.py_func(law)
    tangent = tangent_of.py_func(law, tangential, mass, 5.0)
    torque = patch_torque.py_func(
        damping * mass, tangent, 2.5e-5, Vec(0.0, 0.0, 1.0), Vec(1.0, 2.0, 3.0), patch, 0, True
    )
    assert patch.twist[0] == 0.0
    assert np.abs(torque).max() < 1e-20
