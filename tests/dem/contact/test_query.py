"""The stand-alone query: known values, symmetries and rejected input."""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from simcore.dem.contact.query import query, query_many
from simcore.dem.shapes.polyhedra import convex, ellipsoid, sphere
from tests.helpers.polyhedra import CUBE, TETRAHEDRON
from tests.helpers.rotations import IDENTITY, X45, Y45, Z45, turn_about, turn_about_axis

ORIGIN = ((0.0, 0.0, 0.0), IDENTITY)
PHI = 0.5 * (1.0 + np.sqrt(5.0))
GOLDEN = (PHI, 1.0, 1.0 / PHI)
SIZES = (1e-6, 1e-3, 1.0, 1e3)
# Distances are given to 12 digits after the point; coordinates are of order the pair's size (at most 200).
GIVEN = 1e-12


def needle(a, b, c):
    return CUBE * [a, b, c]


POLYTOPES = {
    "libccd issue 25": (2.0 * CUBE, IDENTITY, 2.0 * CUBE, IDENTITY, (0, 0, 1.9), -0.1),
    "corner edge": (CUBE, IDENTITY, CUBE, Z45, (1.2, 0, 0), 0.7 - np.sqrt(0.5)),
    "corner edge deep": (CUBE, IDENTITY, CUBE, Z45, (1.0, 0, 0), 0.5 - np.sqrt(0.5)),
    "edges crossed, apart": (CUBE, X45, CUBE, Y45, (0, 0, 1.5), 0.085786437627),
    "edges crossed": (CUBE, X45, CUBE, Y45, (0, 0, 1.3), -0.114213562373),
    "concentric cubes": (CUBE, IDENTITY, CUBE, IDENTITY, (0, 0, 0), -1.0),
    "concentric cubes turned": (CUBE, IDENTITY, CUBE, Z45, (0, 0, 0), -1.0),
    "cube in cube": (CUBE, IDENTITY, 0.1 * CUBE, IDENTITY, (0, 0, 0), -0.55),
    "tetrahedron in itself": (TETRAHEDRON, IDENTITY, TETRAHEDRON, IDENTITY, (0, 0, 0), -np.sqrt(0.5)),
    "tetrahedron in its mirror": (TETRAHEDRON, IDENTITY, -TETRAHEDRON, IDENTITY, (0, 0, 0), -1.0 / np.sqrt(6.0)),
    "plates": (needle(1, 1, 0.01), IDENTITY, needle(1, 1, 0.01), IDENTITY, (0.5, 0.5, 0.009), -0.001),
    "needles": (needle(1, 0.01, 0.01), IDENTITY, needle(0.01, 1, 0.01), IDENTITY, (0, 0, 0.009), -0.001),
}
ELLIPSOIDS = {
    "spheres apart": ((1, 1, 1), (1, 1, 1), IDENTITY, (2.5, 0, 0), 0.5),
    "spheres": ((1, 1, 1), (1, 1, 1), IDENTITY, (1.9, 0, 0), -0.1),
    "apart": ((3, 2, 1), (1, 2, 3), IDENTITY, (4.2, 0, 0), 0.2),
    "overlapping": ((3, 2, 1), (1, 2, 3), IDENTITY, (3.9, 0, 0), -0.1),
    "flat, apart": ((2, 1, 0.5), (2, 1, 0.5), IDENTITY, (3, 1.5, 0.7), 0.474311020117),
    "flat": ((2, 1, 0.5), (2, 1, 0.5), IDENTITY, (2, 1, 0.5), -0.191232822332),
    "golden, tangent": (GOLDEN, GOLDEN, IDENTITY, (1, 1, 1), 0.0),
    "golden, 90°": (GOLDEN, GOLDEN, turn_about_axis("z", 90), (2.5, 0.3, 0.2), -0.066910098505),
    "golden, 1 rad": (GOLDEN, GOLDEN, turn_about((1, 1, 1), 1.0), (2, 0.4, 0.3), -0.333256337445),
    "roundish": ((1.25, 1, 0.8), (1.25, 1, 0.8), turn_about((1, 2, 3), 0.7), (2, 0.1, -0.2), -0.379003101929),
    "needles, apart": ((100, 1, 1), (100, 1, 1), turn_about_axis("z", 90), (0, 0, 2.01), 0.01),
    "needles": ((100, 1, 1), (100, 1, 1), turn_about_axis("z", 90), (0, 0, 1.99), -0.01),
    "needles, 30°": ((100, 1, 1), (100, 1, 1), turn_about_axis("z", 30), (190, 25, 0), 22.910655128466),
    "discs": ((100, 100, 1), (100, 100, 1), IDENTITY, (199.9, 0, 0), -0.059994665896),
    "discs crossed": ((100, 100, 1), (100, 100, 1), turn_about_axis("x", 90), (0, 0, 100.9), -0.1),
    "concentric": ((3, 2, 1), (3, 2, 1), IDENTITY, (0, 0, 0), -2.0),
    "sphere on top": ((3, 2, 1), (0.5, 0.5, 0.5), IDENTITY, (0, 0, 1.4), -0.1),
    "sphere inside": ((3, 2, 1), (0.5, 0.5, 0.5), IDENTITY, (2.9, 0, 0), -0.6),
    "sphere": ((3, 2, 1), (0.5, 0.5, 0.5), IDENTITY, (2.5, 1, 0.2), -0.518207879616),
}


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", POLYTOPES)
def test_known_polytopes(name, size):
    points_a, turn_a, points_b, turn_b, offset, distance = POLYTOPES[name]
    a, b = convex(points_a * size), convex(points_b * size)
    position = np.array(offset) * size
    found = query(a, ((0, 0, 0), turn_a), b, (position, turn_b))
    assert found.signed_distance / size == pytest.approx(distance, abs=GIVEN)
    check_points(found, size)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", ELLIPSOIDS)
def test_known_ellipsoids(name, size):
    semi_a, semi_b, turn_b, offset, distance = ELLIPSOIDS[name]
    extent = max(semi_a) + max(semi_b)
    a = ellipsoid(*np.array(semi_a) * size)
    b = ellipsoid(*np.array(semi_b) * size)
    pose_b = (np.array(offset) * size, turn_b)
    found = query(a, ORIGIN, b, pose_b)
    assert found.signed_distance / size == pytest.approx(distance, abs=GIVEN * extent)
    check_points(found, size * extent)
    if len(set(semi_b)) == 1:
        as_sphere = query(a, ORIGIN, sphere(semi_b[0] * size), pose_b)
        assert as_sphere.signed_distance / size == pytest.approx(distance, abs=GIVEN * extent)


def check_points(found, size):
    """Assert that the normal has length 1 and that the points are the signed distance apart along it.

    The tolerance covers sums of coordinates (100 eps) and the slope that Newton's iteration leaves (1e-11).
    """
    assert abs(np.linalg.norm(found.normal) - 1.0) < 1e-14
    step = found.point_b - found.point_a - found.signed_distance * found.normal
    assert np.abs(step).max() <= 2e-11 * size


def test_shapes_that_hold_each_other():
    """Spheres and ellipsoids have the distances from a polyhedron that follow from symmetry."""
    cube = convex(CUBE)
    for depth, position in ((-0.1, 1.4), (0.25, 1.75), (-1.5, 0.0)):
        for ball in (sphere(1.0), ellipsoid(1.0, 1.0, 1.0)):
            found = query(cube, ORIGIN, ball, ((0, 0, position), (2.0, 0, 0, 0)))
            assert found.signed_distance == pytest.approx(depth, abs=1e-14)
            check_points(found, 2.0)
    corner = np.full(3, 0.5 + 1.1 / np.sqrt(3.0))
    found = query(sphere(1.0), (corner, IDENTITY), cube, ORIGIN)
    assert found.signed_distance == pytest.approx(0.1, abs=1e-14)
    np.testing.assert_allclose(found.normal, -np.full(3, np.sqrt(1 / 3)), atol=1e-14)
    np.testing.assert_allclose(found.point_b, [0.5, 0.5, 0.5], atol=1e-14)
    # An upright ellipsoid in the middle of a plate separates through the plate's face.
    plate = convex(CUBE * [4, 4, 0.1])
    found = query(plate, ORIGIN, ellipsoid(0.3, 0.3, 2.0), ((0, 0, 1.0), IDENTITY))
    assert found.signed_distance == pytest.approx(-1.05, abs=1e-14)


def test_hull_against_ellipsoid_agrees_with_a_general_optimiser():
    """Gaps agree with a quadratic programme (SLSQP), and overlaps with a simplex search (Nelder and Mead).

    The programme optimises weights of the polyhedron's corners, so it does not use support functions. The simplex
    search minimises the support value from many starts.
    """
    rng = np.random.default_rng(5)
    for _ in range(12):
        points = rng.standard_normal((8, 3))
        semi = rng.uniform(0.3, 1.5, 3)
        q = rng.standard_normal(4)
        q /= np.linalg.norm(q)
        unit = rng.standard_normal(3)
        unit /= np.linalg.norm(unit)
        far = (6.0 * unit, q)
        found = query(convex(points), ORIGIN, ellipsoid(*semi), far)
        turn = Rotation.from_quat(q, scalar_first=True).as_matrix()

        def apart(x, points=points, semi=semi, turn=turn, far=far):
            """Return the squared distance of Σ w v from the ellipsoid's point at s ∘ u, u = x[8:] / |x[8:]|."""
            u = x[8:] / np.linalg.norm(x[8:])
            return np.sum((x[:8] @ points - far[0] - turn @ (semi * u)) ** 2)

        best = min(
            minimize(
                apart,
                np.concatenate([np.full(8, 1 / 8), rng.standard_normal(3)]),
                method="SLSQP",
                bounds=[(0, 1)] * 8 + [(None, None)] * 3,
                constraints={"type": "eq", "fun": lambda x: x[:8].sum() - 1.0},
                options={"ftol": 1e-15, "maxiter": 500},
            ).fun
            for _ in range(4)
        )
        # SLSQP ends where the squared distance, of order 10, is stationary to about 1e-9.
        assert found.signed_distance == pytest.approx(np.sqrt(best), abs=1e-7)

        near = (0.4 * unit, q)
        found = query(convex(points), ORIGIN, ellipsoid(*semi), near)

        def depth(n, points=points, semi=semi, turn=turn, near=near):
            n = n / np.linalg.norm(n)
            return (points @ n).max() + np.linalg.norm(semi * (turn.T @ n)) - n @ near[0]

        starts = rng.standard_normal((300, 3))
        starts = starts[np.argsort([depth(n) for n in starts])[:8]]
        best = min(
            minimize(depth, n, method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-13, "maxiter": 2000}).fun
            for n in starts
        )
        assert -found.signed_distance <= best + 1e-12
        assert -found.signed_distance == pytest.approx(best, abs=1e-8)  # fatol, and kinks where the search stalls


def some_shapes(rng):
    return (
        [sphere(r) for r in (0.05, 0.7)]
        + [ellipsoid(*s) for s in ((1, 0.7, 0.4), (1, 1, 0.02), (0.02, 1, 0.02))]
        + [convex(rng.standard_normal((n, 3)) * s) for n, s in ((6, 0.4), (20, 0.4), (60, [0.5, 0.5, 0.01]))]
        + [convex(CUBE + 3.0)]
    )


def test_exchange_rotation_and_translation():
    """The distance is stationary in the normal, so these operations change it only by rounding.

    Coordinates are moved by up to 100, so rounding errors are 1e-14. An overlap that is found through all directions
    may differ by 2e-9 of the size, which is at most 3.
    """
    rng = np.random.default_rng(6)
    shapes = some_shapes(rng)
    n = 3000
    index_a, index_b = rng.integers(len(shapes), size=(2, n))
    q_a, q_b = rng.standard_normal((2, n, 4))
    position_a = rng.uniform(-1, 1, (n, 3))
    position_b = position_a + rng.uniform(-1, 1, (n, 3))
    there = query_many(shapes, index_a, (position_a, q_a), index_b, (position_b, q_b))
    back = query_many(shapes, index_b, (position_b, q_b), index_a, (position_a, q_a))
    turn = Rotation.random(rng=rng)
    shift = np.array([100.0, -50.0, 30.0])
    turned_a, turned_b = (
        (turn * Rotation.from_quat(q, scalar_first=True)).as_quat(scalar_first=True) for q in (q_a, q_b)
    )
    moved = query_many(
        shapes, index_a, (turn.apply(position_a) + shift, turned_a), index_b, (turn.apply(position_b) + shift, turned_b)
    )
    apart = there.signed_distance > 0.0
    assert 0.1 * n < apart.sum() < 0.9 * n
    for observed in (back, moved):
        error = np.abs(observed.signed_distance - there.signed_distance)
        assert error[apart].max() < 1e-12
        assert error.max() < 1e-8
        assert np.median(error) < 1e-14
    # A gap has one normal, whose error is the tolerance of the slope over the distance.
    wide = there.signed_distance > 0.01
    np.testing.assert_allclose(back.normal[wide], -there.normal[wide], atol=1e-8)
    np.testing.assert_allclose(moved.normal[wide], turn.apply(there.normal[wide]), atol=1e-8)


def test_offsets_of_a_million_sizes():
    """The positions are exact in binary, so the relative pose, which is formed first, is exact too."""
    cube, ball = convex(CUBE), ellipsoid(1.0, 0.5, 0.25)
    far = np.array([2.0**20, -(2.0**20), 2.0**19])
    near = query(cube, ORIGIN, ball, ((0.5, 0.25, 0.625), (1, 2, 3, 4)))
    away = query(cube, (far, IDENTITY), ball, (far + [0.5, 0.25, 0.625], (1, 2, 3, 4)))
    assert away.signed_distance == near.signed_distance
    np.testing.assert_array_equal(away.normal, near.normal)


def test_the_frame_of_a_hull_is_its_own():
    """A polyhedron is neither recentred nor aligned: points far from the origin turn about the origin."""
    moved = convex(CUBE + [10.0, 0.0, 0.0])
    found = query(moved, ((0, 0, 0), turn_about_axis("z", 90)), convex(CUBE), ((0, 12.0, 0), IDENTITY))
    assert found.signed_distance == pytest.approx(1.0, abs=1e-14)
    np.testing.assert_allclose(found.normal, [0, 1, 0], atol=1e-14)


def test_duplicates_and_points_inside_change_nothing():
    rng = np.random.default_rng(7)
    points = np.vstack([CUBE, CUBE, 0.4 * rng.uniform(-1, 1, (50, 3))])
    assert len(convex(points).base.vertices) == 8
    found = query(convex(points), ORIGIN, convex(CUBE), ((0.1, 0.2, 0.95), IDENTITY))
    assert found.signed_distance == pytest.approx(-0.05, abs=1e-15)


@pytest.mark.parametrize("n", [150, 1300])
@pytest.mark.parametrize("offset", [0.0, 0.3])
def test_deep_round_hulls(n, offset):
    """The depth agrees with Qhull's facets if more of them are near the origin than the search can store.

    The Minkowski difference of a polyhedron P and −P is P + P: its depth at an offset is that of twice the polyhedron.
    """
    from scipy.spatial import ConvexHull

    rng = np.random.default_rng(8)
    points = rng.standard_normal((n, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    unit = np.array([0.36, 0.48, 0.8])
    hull = ConvexHull(2.0 * points)
    depth = -(hull.equations[:, :3] @ (offset * unit) + hull.equations[:, 3]).max()
    found = query(convex(points), ORIGIN, convex(-points), (offset * unit, IDENTITY))
    assert found.signed_distance == pytest.approx(-depth, abs=1e-12)


@pytest.mark.parametrize(
    "points, words",
    [
        (np.eye(3), "4"),
        (np.vstack([np.eye(3)] * 4), "4"),
        (np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.0], [0.3, 0.4, 0]]), "plane"),
        (np.outer(np.arange(5.0), [1, 2, 3]), "line"),
        (CUBE * [1, 1, 1e-12], "plane"),
        (np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, np.nan]]), "finite"),
        (np.zeros((5, 2)), "shape"),
    ],
)
def test_hulls_that_are_refused(points, words):
    with pytest.raises(ValueError, match=words):
        convex(points)


def test_arguments_of_another_type_are_refused():
    with pytest.raises(ValueError, match="query: 'ball' is no shape; make one with simcore.sphere"):
        query("ball", ORIGIN, sphere(1.0), ORIGIN)
    with pytest.raises(ValueError, match="query: 3 is no shape"):
        query_many([sphere(1.0), 3], [0], ORIGIN, [0], ORIGIN)
    with pytest.raises(ValueError, match=r"pose b: \[0, 0, 0\] is no pair of a position \(3,\) and a quaternion"):
        query(sphere(1.0), ORIGIN, sphere(1.0), [0, 0, 0])
    with pytest.raises(ValueError, match="sphere: lengths must be numbers \\[m\\], but radius = '1 mm'"):
        sphere("1 mm")


def test_lengths_and_poses_that_are_refused():
    for wrong in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(ValueError, match="radius"):
            sphere(wrong)
        with pytest.raises(ValueError, match="ellipsoid: b"):
            ellipsoid(1.0, wrong, 1.0)
    ball = sphere(1.0)
    for pose, words in (
        (((0, 0, 0), (0, 0, 0, 0)), "quaternion"),
        (((0, 0, 0), (1, np.nan, 0, 0)), "quaternion"),
        (((0, np.inf, 0), IDENTITY), "position"),
        (((0, 0), IDENTITY), "pose b"),
    ):
        with pytest.raises(ValueError, match=words):
            query(ball, ORIGIN, ball, pose)
    with pytest.raises(IndexError, match="0 to 0"):
        query_many([ball], [0], ORIGIN, [1], ORIGIN)
    huge = query(ball, ((0, 0, 0), (1e-200, 0, 0, 0)), ball, ((3, 0, 0), (0, 1e200, 0, 0)))
    assert huge.signed_distance == 1.0
