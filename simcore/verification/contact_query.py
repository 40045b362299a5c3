"""Depth and normal of touching pairs, against the time of a query.

Pairs of pebbles and of ellipsoids overlap by 1e-3 of their size. Ours has no tolerance to be set: it is asked from
nothing, and again after a small motion with what it remembers. Beside it stand the best of n directions, which anyone
can write, and `coal` (GJK and EPA) at falling tolerances where that package can be imported.

References, independent of both: of hulls the facets of the convex hull of all differences of their vertices (Qhull); of
ellipsoids Newton's iteration in extended precision from the best of many directions.
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
from simcore.dem.shapes.hulls import ELLIPSOID, POLYHEDRON, Base, collect_shapes, convex, ellipsoid, unit_sphere
from simcore.dem.state.bodies import make_bodies, rotation_matrix
from simcore.dem.state.contacts import Box
from simcore.dem.state.features import Features
from simcore.dem.step.candidate_pairs import list_candidates
from simcore.dem.vectors import read, write
from simcore.verification import brute_force as brute

SEMI_AXES = np.array([1.0, 0.75, 0.5])  # [m]
DEPTH, MOTION = 1e-3, 1e-4  # of the pair's size
PAIRS, POINTS, REPEATS, ROUNDS = 48, 40, 5, 20
DIRECTIONS = (64, 256, 1024, 4096, 16384)
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-10, 1e-12)
OUR_STYLE, AGAIN, SCAN, COAL = "ours, from nothing", "ours, a motion later", "best of n directions", "coal (GJK + EPA)"
NO_SETTING = "exact"

# Uncached: a cache on disk notices changes of its own file only, and these call the core.
_compiled = numba.njit(error_model="numpy")


class Pairs(NamedTuple):
    """n pairs of one kind. shapes: those of the bodies a and b by turns; poses: of the pair's two poses."""

    kind: int  # of simcore.dem.shapes.hulls
    shapes: tuple  # (2 n)
    scale: np.ndarray  # (2 n, 3) [m]; ones of hulls
    size: np.ndarray  # (n,) [m], sum of the radii
    quaternion: np.ndarray  # (2, n, 2, 4): pose, pair, body
    offset: np.ndarray  # (2, n, 3) [m]: pose, pair; of b from a


class Truth(NamedTuple):
    """Depth (n,) and unit normal (n, 3) from a to b, and how far both may be off."""

    depth: np.ndarray
    normal: np.ndarray
    depth_error: float  # of the pair's size
    normal_error: float  # [rad]


def make_pairs(kind, n=PAIRS, points=POINTS, seed=1) -> Pairs:
    """Pairs in random turns, pressed into each other by DEPTH; the second pose differs by MOTION."""
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
    way = rng.normal(size=(n, 3))
    offset = size[:, None] * way / np.linalg.norm(way, axis=1, keepdims=True)
    zero, index = np.zeros((n, 3)), 2 * np.arange(n)
    for _ in range(3):  # to the depth along the normal, which turns little then
        q = quaternion[0]
        found = query_many(shapes, index, (zero, q[:, 0]), index + 1, (offset, q[:, 1]))
        offset = offset - (DEPTH * size + found.signed_distance)[:, None] * found.normal
    drift = 0.1 * DEPTH * size[:, None] * rng.uniform(-1.0, 1.0, (n, 3))
    return Pairs(kind, shapes, scale, size, quaternion, np.stack([offset, offset + drift]))


# -- references ---------------------------------------------------------------------------------------------


def true_contacts(pairs: Pairs, pose=0) -> Truth:
    """Depth and normal of the pairs, with what is left unknown of them."""
    find = _facets if pairs.kind == POLYHEDRON else _newton
    return find(pairs, pose)


def _centers(pairs, pose):
    """Rotations (n, 2, 3, 3), and offsets of the centres of mass (n, 3) [m]."""
    n = len(pairs.size)
    rotation = rotation_matrix(pairs.quaternion[pose].reshape(-1, 4)).reshape(n, 2, 3, 3)
    center = np.array([shape.center for shape in pairs.shapes]).reshape(n, 2, 3)
    moved = np.einsum("npij,npj->npi", rotation, center)
    return rotation, pairs.offset[pose] + moved[:, 1] - moved[:, 0]


def _facets(pairs, pose):
    """Nearest facet of A − B, whose hull Qhull takes of all differences of vertices."""
    rotation, offset = _centers(pairs, pose)
    depth, normal = np.empty(len(offset)), np.empty((len(offset), 3))
    for k in range(len(offset)):
        a, b = (pairs.shapes[2 * k + body].base.vertices @ rotation[k, body].T for body in range(2))
        hull = ConvexHull((a[:, None] - b[None] - offset[k]).reshape(-1, 3))
        nearest = np.argmax(hull.equations[:, 3])
        normal[k] = hull.equations[nearest, :3]
        # What the direction shows is exact but for rounding; Qhull's own offset carries its merging of facets.
        depth[k] = (a @ normal[k]).max() - (b @ normal[k]).min() - offset[k] @ normal[k]
    rounding = 8.0 * np.finfo(float).eps
    # A normal from differences of corners some tenths of the size apart
    return Truth(depth, normal, rounding, 10.0 * rounding)


def _newton(pairs, pose):
    """The direction that shows the least overlap, in extended precision."""
    rotation, offset = _centers(pairs, pose)
    n = len(offset)
    table, _ = table_of(pairs.shapes)
    solids = place_solids(pairs.shapes, np.arange(2 * n), rotation.reshape(-1, 3, 3))
    spiral = brute.spiral_directions(1024)
    shown = np.stack([brute.shown_along(table, solids, offset, np.tile(d, (n, 1))) for d in spiral])
    wide = np.longdouble
    axes = pairs.scale.reshape(n, 2, 3).astype(wide)
    # The quaternion's matrix again, in extended precision: that of float64 is orthogonal to 1e-16 only
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
        d = spiral[np.argmax(shown[:, k])].astype(wide)
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


# -- methods: each gives (depth (n,), normal (n, 3), CPU times of one query (repeats,) [s]) -------------------


def _timed(work, repeats, queries):
    work()
    spent = []
    for _ in range(repeats):
        began = time.process_time()
        work()
        spent.append((time.process_time() - began) / queries)
    return np.array(spent)


def ask(pairs: Pairs, repeats=REPEATS, rounds=ROUNDS):
    """Our query, from nothing."""
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


def ask_again(pairs: Pairs, repeats=REPEATS, rounds=ROUNDS):
    """What a step does: the pairs go between their two poses, and each query starts from what the last one found."""
    n = len(pairs.size)
    if pairs.kind == POLYHEDRON:
        bases = [Base(str(k), *shape.base[1:]) for k, shape in enumerate(pairs.shapes)]
        index = np.arange(2 * n)
    else:
        bases, index = [unit_sphere()], np.zeros(2 * n, int)
    shapes, still = collect_shapes(bases), np.zeros((2 * n, 3))
    apart = 10.0 * pairs.size.max() * np.arange(n)  # no pair meets another
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
        raise RuntimeError("the neighbour list is not that of the pairs")
    check = _make_checks(pairs.kind)
    spent = _timed(lambda: check(shapes, *poses, contacts, 10 * rounds), repeats, 20 * rounds * n)
    return contacts.overlap.copy(), contacts.direction.copy(), spent


@_compiled
def _scan(shapes, solids, offset, directions, depth, normal):
    for k in range(len(offset)):
        depth[k] = np.inf
        pair = pair_of(solids, 2 * k, 2 * k + 1, read(offset, k))
        for d in range(len(directions)):
            shown = -brute.shown(shapes, solids, pair, read(directions, d))
            if shown < depth[k]:
                depth[k] = shown
                write(normal, k, read(directions, d))


def scan(pairs: Pairs, directions, repeats=REPEATS):
    """The least overlap that evenly spread directions show."""
    rotation, offset = _centers(pairs, 0)
    n = len(offset)
    table, _ = table_of(pairs.shapes)
    solids = place_solids(pairs.shapes, np.arange(2 * n), rotation.reshape(-1, 3, 3))
    depth, normal, spread = np.empty(n), np.empty((n, 3)), brute.spiral_directions(directions)
    spent = _timed(lambda: _scan(table, solids, offset, spread, depth, normal), repeats, n)
    return depth, normal, spent


def has_coal() -> bool:
    """Whether the optional library is there to be asked."""
    return importlib.util.find_spec("coal") is not None


def ask_coal(pairs: Pairs, tolerance, repeats=REPEATS, rounds=ROUNDS):
    """coal's query from its default guess; nan where it ends without an answer.

    Of its time that of a call on two spheres is taken off, which is Python's own. Iterations stay at coal's defaults:
    it clears room for all of them at each call.
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


def study(directions=DIRECTIONS, tolerances=TOLERANCES, repeats=REPEATS, pairs=PAIRS, again=True) -> pd.DataFrame:
    """Rows for figures.work_precision: largest errors over the pairs, relative to their size, and of the normal [rad].

    again: also our query with a memory, whose compiling takes a minute. A setting at which a query ended without an
    answer has no row.
    """
    rows = []
    for case, kind in (("polyhedra", POLYHEDRON), ("ellipsoids", ELLIPSOID)):
        made = make_pairs(kind, pairs)
        truths = [true_contacts(made, pose) for pose in range(2)]
        runs = [(OUR_STYLE, NO_SETTING, truths[0], ask(made, repeats))]
        if again:
            runs.append((AGAIN, NO_SETTING, truths[0], ask_again(made, repeats)))
        runs += [(SCAN, f"{n}", truths[0], scan(made, n, repeats)) for n in directions]
        if has_coal():
            runs += [(COAL, f"{t:g}", truths[0], ask_coal(made, t, repeats)) for t in tolerances]
        for method, setting, truth, (depth, normal, spent) in runs:
            if not np.isfinite(depth).all():
                continue
            across = np.linalg.norm(np.cross(normal, truth.normal), axis=1)
            turned = np.arctan2(across, (normal * truth.normal).sum(axis=1))
            for quantity, error, known in (
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
                        "error": max(error.max(), 1e-17),  # of zero there is no logarithm
                        "cpu_s": cpu,
                        "reference_error": known,
                    }
                    for repeat, cpu in enumerate(spent)
                ]
    return pd.DataFrame(rows)
