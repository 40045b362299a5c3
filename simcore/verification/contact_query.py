"""Error of depth and normal of touching pairs, against the time of a query.

Pairs of polyhedra and pairs of ellipsoids overlap by 1e-3 of their size. Our query has no tolerance. It is measured
without a previous result, and after a small motion with the remembered contact. It is compared with the best of n
directions, a simple baseline, and with `coal` (GJK and EPA) at decreasing tolerances if that package is installed.

The references are independent of these methods. For polyhedra: the facets of the convex hull of all differences of
their vertices (Qhull). For ellipsoids: Newton's iteration in extended precision from the best of many directions.
"""

import importlib.util
import time
from typing import NamedTuple

import numba
import numpy as np
import pandas as pd
from scipy.spatial import ConvexHull

from simcore.dem.contact.find_contact import check_ellipsoids, check_polyhedra, search_ellipsoids, search_polyhedra
from simcore.dem.contact.pair import pair_of
from simcore.dem.contact.query import place_solids, query_many, query_pairs, table_of
from simcore.dem.shapes.polyhedra import ELLIPSOID, POLYHEDRON, Base, collect_shapes, convex, ellipsoid, unit_sphere
from simcore.dem.state.bodies import make_bodies, rotation_matrix
from simcore.dem.state.contacts import Box
from simcore.dem.state.features import Features
from simcore.dem.step.candidate_pairs import list_candidates
from simcore.dem.vectors import read, write
from simcore.verification import brute_force as brute

SEMI_AXES = np.array([1.0, 0.75, 0.5])  # [m]
DEPTH, MOTION = 1e-3, 1e-4  # relative to the pair's size
PAIRS, POINTS, REPEATS, ROUNDS = 48, 40, 5, 20
DIRECTIONS = (64, 256, 1024, 4096, 16384)
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-10, 1e-12)
OUR_STYLE, AGAIN, SCAN, COAL = "ours, from nothing", "ours, a motion later", "best of n directions", "coal (GJK + EPA)"
NO_SETTING = "exact"

# Not cached: the disk cache detects changes only of the file itself, but these functions call the core.
_compiled = numba.njit(error_model="numpy")


class Pairs(NamedTuple):
    """n pairs of bodies a and b of one kind, each pair in two poses; arrays of 2 n alternate between a and b."""

    kind: int  # of simcore.dem.shapes.polyhedra
    shapes: tuple  # (2 n)
    scale: np.ndarray  # (2 n, 3) [m]; ones for polyhedra
    size: np.ndarray  # (n,) [m], sum of the radii
    quaternion: np.ndarray  # (2, n, 2, 4): pose, pair, body
    offset: np.ndarray  # (2, n, 3) [m]: pose, pair; from a to b


class Truth(NamedTuple):
    """Reference depth (n,) and unit normal (n, 3) from a to b, with bounds of their errors."""

    depth: np.ndarray
    normal: np.ndarray
    depth_error: float  # relative to the pair's size
    normal_error: float  # [rad]


def make_pairs(kind, n=PAIRS, points=POINTS, seed=1) -> Pairs:
    """Return pairs in random orientations that overlap by DEPTH; the second pose differs by MOTION."""
    rng = np.random.default_rng(seed)
    if kind == POLYHEDRON:
        clouds = rng.normal(size=(2 * n, points, 3))
        shapes = tuple(convex(c / np.linalg.norm(c, axis=1, keepdims=True) * SEMI_AXES) for c in clouds)
        scale = np.ones((2 * n, 3))
    else:
        scale = SEMI_AXES * rng.uniform(0.7, 1.0, (2 * n, 3))
        shapes = tuple(ellipsoid(*s) for s in scale)
    first = rng.normal(size=(n, 2, 4))
    second = first / np.linalg.norm(first, axis=-1, keepdims=True) + 0.5 * MOTION * rng.normal(size=(n, 2, 4))
    quaternion = np.stack([q / np.linalg.norm(q, axis=-1, keepdims=True) for q in (first, second)])
    size = np.array([shape.radius for shape in shapes]).reshape(n, 2).sum(axis=1)
    direction = rng.normal(size=(n, 3))
    offset = size[:, None] * direction / np.linalg.norm(direction, axis=1, keepdims=True)
    zero, index = np.zeros((n, 3)), 2 * np.arange(n)
    for _ in range(3):  # move to the depth along the normal, which hardly turns then
        q = quaternion[0]
        contact = query_many(shapes, index, (zero, q[:, 0]), index + 1, (offset, q[:, 1]))
        offset = offset - (DEPTH * size + contact.signed_distance)[:, None] * contact.normal
    drift = 0.1 * DEPTH * size[:, None] * rng.uniform(-1.0, 1.0, (n, 3))
    return Pairs(kind, shapes, scale, size, quaternion, np.stack([offset, offset + drift]))


# -- references ---------------------------------------------------------------------------------------------


def true_contacts(pairs: Pairs, pose=0) -> Truth:
    """Return the reference depth and normal of the pairs, with bounds of their errors."""
    solve = _facets if pairs.kind == POLYHEDRON else _newton
    return solve(pairs, pose)


def _centers(pairs, pose):
    """Return rotations (n, 2, 3, 3) and offsets of the centres of mass (n, 3) [m]."""
    n = len(pairs.size)
    rotation = rotation_matrix(pairs.quaternion[pose].reshape(-1, 4)).reshape(n, 2, 3, 3)
    center = np.array([shape.center for shape in pairs.shapes]).reshape(n, 2, 3)
    moved = np.einsum("npij,npj->npi", rotation, center)
    return rotation, pairs.offset[pose] + moved[:, 1] - moved[:, 0]


def _facets(pairs, pose):
    """Return the nearest facet of A − B, the convex hull (by Qhull) of all differences of vertices, as Truth."""
    rotation, offset = _centers(pairs, pose)
    depth, normal = np.empty(len(offset)), np.empty((len(offset), 3))
    for k in range(len(offset)):
        a, b = (pairs.shapes[2 * k + body].base.vertices @ rotation[k, body].T for body in range(2))
        hull = ConvexHull((a[:, None] - b[None] - offset[k]).reshape(-1, 3))
        nearest = np.argmax(hull.equations[:, 3])
        normal[k] = hull.equations[nearest, :3]
        # The bound of this direction is exact except for rounding; the offset of Qhull is affected by merged facets.
        depth[k] = (a @ normal[k]).max() - (b @ normal[k]).min() - offset[k] @ normal[k]
    rounding = 8.0 * np.finfo(float).eps
    # The normal comes from differences of vertices some tenths of the size apart, which amplifies rounding.
    return Truth(depth, normal, rounding, 10.0 * rounding)


def _newton(pairs, pose):
    """Return the direction of minimum overlap, by Newton's iteration in extended precision, as Truth."""
    rotation, offset = _centers(pairs, pose)
    n = len(offset)
    table, _ = table_of(pairs.shapes)
    solids = place_solids(pairs.shapes, np.arange(2 * n), rotation.reshape(-1, 3, 3))
    spiral = brute.spiral_directions(1024)
    bounds = np.stack([brute.shown_along(table, solids, offset, np.tile(d, (n, 1))) for d in spiral])
    wide = np.longdouble
    axes = pairs.scale.reshape(n, 2, 3).astype(wide)
    # The rotation is computed again in extended precision: the float64 matrix is orthogonal only to 1e-16.
    w, x, y, z = np.moveaxis(pairs.quaternion[pose].astype(wide), -1, 0)
    norm = w * w + x * x + y * y + z * z
    rows = [
        [norm - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), norm - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), norm - 2 * (x * x + y * y)],
    ]
    turned = np.moveaxis(np.array(rows) / norm, (0, 1), (-2, -1))
    form = np.einsum("npij,npj,npkj->npik", turned, axes**2, turned)
    depth, normal, last = np.empty(n), np.empty((n, 3)), 0.0
    for k in range(n):
        d = spiral[np.argmax(bounds[:, k])].astype(wide)
        for _ in range(60):
            across = np.array([np.cross(d, e) for e in np.eye(3)[np.argsort(np.abs(d))[:2]]], wide)
            across[0] /= np.sqrt(across[0] @ across[0])
            across[1] = np.cross(d, across[0])
            height = [np.sqrt(d @ m @ d) for m in form[k]]
            slope = offset[k] - sum(m @ d / h for m, h in zip(form[k], height, strict=True))
            bend = sum(m / h - np.outer(m @ d, m @ d) / h**3 for m, h in zip(form[k], height, strict=True))
            value = slope @ d
            gradient, hessian = across @ slope, across @ bend @ across.T + value * np.eye(2)
            determinant = hessian[0, 0] * hessian[1, 1] - hessian[0, 1] * hessian[1, 0]
            step = np.array([
                hessian[1, 1] * gradient[0] - hessian[0, 1] * gradient[1],
                hessian[0, 0] * gradient[1] - hessian[1, 0] * gradient[0],
            ]) / determinant  # fmt: skip
            length = np.sqrt(step @ step)
            d = d + across.T @ (step if length < 0.2 else step * (wide(0.2) / length))
            d = d / np.sqrt(d @ d)
            if length < 1e-17:
                break
        depth[k], normal[k] = -float(value), d.astype(float)
        last = max(last, float(length))
    return Truth(depth, normal, 2.0 * np.finfo(float).eps, last + np.finfo(float).eps)


# -- methods: all return (depth (n,), normal (n, 3), CPU times of one query (repeats,) [s]) ------------------


def _timed(work, repeats, queries):
    work()
    spent = []
    for _ in range(repeats):
        began = time.process_time()
        work()
        spent.append((time.process_time() - began) / queries)
    return np.array(spent)


def query_from_nothing(pairs: Pairs, repeats=REPEATS, rounds=ROUNDS):
    """Measure our query without a previous result."""
    rotation, offset = _centers(pairs, 0)
    n = len(offset)
    table, _ = table_of(pairs.shapes)
    solids = place_solids(pairs.shapes, np.arange(2 * n), rotation.reshape(-1, 3, 3))
    distance, normal, point_a, point_b = np.empty(n), np.empty((n, 3)), np.empty((n, 3)), np.empty((n, 3))

    def work():
        for _ in range(rounds):
            query_pairs(table, solids, offset, distance, normal, point_a, point_b)

    spent = _timed(work, repeats, rounds * n)
    return -distance, normal, spent


def _make_checks(kind):
    @_compiled
    def check(shapes, first, second, contacts, rounds):
        for turn in range(2 * rounds):
            bodies = second if turn % 2 == 0 else first
            for p in range(len(contacts.body_a)):
                if kind == POLYHEDRON:
                    check_polyhedra(shapes, bodies, contacts, p, 0.0, False)
                    if contacts.pending[p] != 0:
                        search_polyhedra(shapes, bodies, contacts, p, 0.0, False)
                else:
                    check_ellipsoids(shapes, bodies, contacts, p, 0.0, False)
                    if contacts.pending[p] != 0:
                        search_ellipsoids(shapes, bodies, contacts, p, 0.0, False)

    return check


def query_again(pairs: Pairs, repeats=REPEATS, rounds=ROUNDS):
    """Measure our query as in a time step: pairs alternate between two poses, and queries reuse the previous result."""
    n = len(pairs.size)
    if pairs.kind == POLYHEDRON:
        bases = [Base(str(k), *shape.base[1:]) for k, shape in enumerate(pairs.shapes)]
        index = np.arange(2 * n)
    else:
        bases, index = [unit_sphere()], np.zeros(2 * n, int)
    shapes, still = collect_shapes(bases), np.zeros((2 * n, 3))
    apart = 10.0 * pairs.size.max() * np.arange(n)  # pairs do not touch each other
    poses = []
    for pose in range(2):
        _, offset = _centers(pairs, pose)
        position = np.zeros((n, 2, 3))
        position[:, 1] = offset
        position[:, :, 2] += apart[:, None]
        turned = pairs.quaternion[pose].reshape(-1, 4)
        poses.append(make_bodies(bases, index, pairs.scale, position.reshape(-1, 3), turned, still, still, 1.0))
    features = Features(pairs.kind, friction=False, periodic=False)
    contacts = list_candidates(poses[0], shapes, Box(0.0), 0.01, features).contacts
    if not (len(contacts.body_a) == n and (contacts.body_a == 2 * np.arange(n)).all()):
        raise RuntimeError("query_again: the neighbour list contains other pairs than those that are measured")
    check = _make_checks(pairs.kind)
    spent = _timed(lambda: check(shapes, *poses, contacts, 10 * rounds), repeats, 20 * rounds * n)
    return contacts.overlap.copy(), contacts.direction.copy(), spent


@_compiled
def _scan(shapes, solids, offset, directions, depth, normal):
    for k in range(len(offset)):
        depth[k] = np.inf
        pair = pair_of(solids, 2 * k, 2 * k + 1, read(offset, k))
        for d in range(len(directions)):
            overlap = -brute.shown(shapes, solids, pair, read(directions, d))
            if overlap < depth[k]:
                depth[k] = overlap
                write(normal, k, read(directions, d))


def scan(pairs: Pairs, directions, repeats=REPEATS):
    """Measure the minimum overlap over evenly spread directions."""
    rotation, offset = _centers(pairs, 0)
    n = len(offset)
    table, _ = table_of(pairs.shapes)
    solids = place_solids(pairs.shapes, np.arange(2 * n), rotation.reshape(-1, 3, 3))
    depth, normal, spread = np.empty(n), np.empty((n, 3)), brute.spiral_directions(directions)
    spent = _timed(lambda: _scan(table, solids, offset, spread, depth, normal), repeats, n)
    return depth, normal, spent


def has_coal() -> bool:
    """Return whether the optional package `coal` is installed."""
    return importlib.util.find_spec("coal") is not None


def query_coal(pairs: Pairs, tolerance, repeats=REPEATS, rounds=ROUNDS):
    """Measure the query of coal from its default guess; nan where it ends without a result.

    The time of a call on two spheres is subtracted, because it is the overhead of Python. The maximum numbers of
    iterations are the defaults of coal, because it clears workspace for all of them at each call.
    """
    import coal

    rotation, offset = _centers(pairs, 0)
    n = len(offset)
    solids = [_coal_shape(coal, pairs, k) for k in range(2 * n)]
    request = coal.CollisionRequest(coal.CollisionRequestFlag.CONTACT, 1)
    request.gjk_tolerance = request.epa_tolerance = tolerance
    placed = [
        (coal.Transform3s(rotation[k, 0], np.zeros(3)), coal.Transform3s(rotation[k, 1], offset[k])) for k in range(n)
    ]
    queries = [coal.ComputeCollision(solids[2 * k], solids[2 * k + 1]) for k in range(n)]
    ball = coal.Sphere(1.0)
    balls = coal.ComputeCollision(ball, ball)
    apart = coal.Transform3s(np.eye(3), np.array([1.9, 0.0, 0.0]))
    upright = coal.Transform3s(np.eye(3), np.zeros(3))
    depth, normal = np.full(n, np.nan), np.full((n, 3), np.nan)

    def work():
        for _ in range(rounds):
            for query, (a, b) in zip(queries, placed, strict=True):
                query(a, b, request, coal.CollisionResult())

    def calls():
        for _ in range(rounds):
            for _ in placed:
                balls(upright, apart, request, coal.CollisionResult())

    for k, (query, (a, b)) in enumerate(zip(queries, placed, strict=True)):
        result = coal.CollisionResult()
        query(a, b, request, result)
        if result.isCollision():
            contact = result.getContact(0)
            if abs(contact.penetration_depth) < pairs.size[k]:
                depth[k], normal[k] = -contact.penetration_depth, contact.normal
    spent = _timed(work, repeats, rounds * n) - np.median(_timed(calls, repeats, rounds * n))
    return depth, normal, spent


def _coal_shape(coal, pairs, k):
    if pairs.kind == ELLIPSOID:
        return coal.Ellipsoid(*pairs.scale[k])
    base = pairs.shapes[k].base
    points, faces = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for vertex in base.vertices:
        points.append(vertex)
    for face in base.faces:
        faces.append(coal.Triangle(*map(int, face)))
    return coal.Convex(points, faces)


# -- study --------------------------------------------------------------------------------------------------


def query_runs(directions=DIRECTIONS, tolerances=TOLERANCES, repeats=REPEATS, pairs=PAIRS, again=True) -> pd.DataFrame:
    """Return rows for figures.work_precision: largest errors over the pairs, relative to their size; of normals [rad].

    again: measure our query also with remembered contacts, which takes a minute to compile. A setting with a query that
    ended without a result has no row.
    """
    rows = []
    for case, kind in (("polyhedra", POLYHEDRON), ("ellipsoids", ELLIPSOID)):
        made = make_pairs(kind, pairs)
        truths = [true_contacts(made, pose) for pose in range(2)]
        runs = [(OUR_STYLE, NO_SETTING, truths[0], query_from_nothing(made, repeats))]
        if again:
            runs.append((AGAIN, NO_SETTING, truths[0], query_again(made, repeats)))
        runs += [(SCAN, f"{n}", truths[0], scan(made, n, repeats)) for n in directions]
        if has_coal():
            runs += [(COAL, f"{t:g}", truths[0], query_coal(made, t, repeats)) for t in tolerances]
        for method, setting, truth, (depth, normal, spent) in runs:
            if not np.isfinite(depth).all():
                continue
            across = np.linalg.norm(np.cross(normal, truth.normal), axis=1)
            turned = np.arctan2(across, (normal * truth.normal).sum(axis=1))
            for quantity, error, reference_error in (
                ("depth", np.abs(depth - truth.depth) / made.size, truth.depth_error),
                ("normal", turned, truth.normal_error),
            ):
                rows += [
                    {
                        "case": case,
                        "quantity": quantity,
                        "method": method,
                        "setting": setting,
                        "default": method == AGAIN,
                        "repeat": repeat,
                        "error": max(error.max(), 1e-17),  # zero has no logarithm
                        "cpu_s": cpu,
                        "reference_error": reference_error,
                    }
                    for repeat, cpu in enumerate(spent)
                ]
    return pd.DataFrame(rows)
