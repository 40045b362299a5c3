"""Stand-alone contact query: signed distance, normal and points of any two convex shapes.

    query(ellipsoid(3, 2, 1), ((0, 0, 0), (1, 0, 0, 0)), convex(points), (position, quaternion)).signed_distance

The signed distance is the maximum over unit directions n of  n·c − h_A(n) − h_B(−n), c from the origin of a to that
of b and h the support functions. Positive: the gap. Negative: minus the length of the shortest translation that
separates the shapes. The result is the global maximum, also for deep overlaps and concentric shapes. The query needs no
remembered contact and no tolerance.

With a polyhedron, a sphere is queried as a polyhedron of one vertex, and its radius is subtracted.
"""

import functools
import reprlib
from typing import NamedTuple

import numpy as np

from simcore.compilation import kernel, leaf, routine
from simcore.dem.contact.pair import Closest, Pair, exchanged, pair_of
from simcore.dem.contact.pairs.ellipsoids import search_normal
from simcore.dem.contact.pairs.polyhedron_ellipsoid import search_normal as search_mixed_normal
from simcore.dem.contact.search.ellipsoid_climb import gap_along, settle_normal, surface_point
from simcore.dem.contact.search.exact_polyhedra import query_polyhedra
from simcore.dem.contact.search.facets import facet_at
from simcore.dem.contact.search.pair_frame import climb_a, frame_of, vertex_a
from simcore.dem.contact.search.simplex import take_simplex
from simcore.dem.shapes.polyhedra import ELLIPSOID, HINT_CELLS, POLYHEDRON, SPHERE, Shape, Shapes, collect_shapes
from simcore.dem.state.bodies import rotation_matrix
from simcore.dem.vectors import (
    Vec,
    beside,
    direction_of,
    into_axes,
    length,
    minus,
    negative,
    out_of_axes,
    plus,
    plus_scaled,
    read,
    scaled,
    write,
)

BESIDE = 1e-12  # of the pair's size: tangential distance of the two points that is accepted


class ContactQuery(NamedTuple):
    """The result of a query; in a result of `query_many` every field is an array with one row for each pair."""

    signed_distance: float  # [m], positive: the gap, negative: minus the overlap
    normal: np.ndarray  # (3,) unit, from a to b
    point_a: np.ndarray  # (3,) [m], on the surface of a; point_b − point_a = signed_distance × normal
    point_b: np.ndarray  # (3,) [m], on the surface of b


class Solids(NamedTuple):
    """Placed shapes with the fields of Bodies that the compiled functions of this package read."""

    kind: np.ndarray  # (n,) int64
    shape: np.ndarray  # (n,) int64, index into Shapes; for a sphere, the index of the single point
    scale: np.ndarray  # (n, 3)
    radius: np.ndarray  # (n,) [m]
    rotation: np.ndarray  # (n, 3, 3)
    form_matrix: np.ndarray  # (n, 6) [m²]


def query(shape_a: Shape, pose_a, shape_b: Shape, pose_b) -> ContactQuery:
    """Return signed distance [m], normal and closest (or deepest) points of two Shapes.

    pose: position (3,) [m] and quaternion (4,) (w, x, y, z), of any length but zero, from the frame of the shape to the
    world. ValueError for a pose that is not finite or has a zero quaternion, and for an argument that is no shape.

    An overlap is the length of the shortest translation that separates the shapes. If several translations are equally
    short (concentric spheres), one of them is returned, the same at every call.
    """
    _check_shapes(shape_a, shape_b)
    position_a, orientation_a = _pose(pose_a, "a")
    position_b, orientation_b = _pose(pose_b, "b")
    one = np.zeros(1, np.int64)
    fields = _query((shape_a, shape_b), one, position_a, orientation_a, one + 1, position_b, orientation_b)
    return ContactQuery(float(fields[0][0]), *(field[0] for field in fields[1:]))


def query_many(shapes, index_a, poses_a, index_b, poses_b) -> ContactQuery:
    """Query n pairs in one compiled loop; see `query`.

    shapes: sequence of shapes. index_a, index_b (n,): indices of the shapes of each pair. poses: positions (n, 3) [m]
    and quaternions (n, 4). The fields of the result are arrays (n,) and (n, 3). ValueError as in `query`, and if the
    numbers of indices and poses differ; IndexError for an index outside `shapes`.
    """
    _check_shapes(*shapes)
    position_a, orientation_a = _pose(poses_a, "a")
    position_b, orientation_b = _pose(poses_b, "b")
    index_a, index_b = (_index(index, name) for index, name in ((index_a, "index_a"), (index_b, "index_b")))
    return ContactQuery(*_query(tuple(shapes), index_a, position_a, orientation_a, index_b, position_b, orientation_b))


def _check_shapes(*shapes):
    """Raise ValueError unless all are Shapes."""
    for shape in shapes:
        if not isinstance(shape, Shape):
            given = reprlib.repr(shape)
            raise ValueError(
                f"query: {given} is no shape; make one with simcore.sphere, simcore.ellipsoid or simcore.convex."
            )


def _index(index, name: str):
    """Return indices (n,) of shapes; ValueError unless they are whole numbers."""
    index = np.atleast_1d(np.asarray(index))
    if index.dtype.kind not in "iu" or index.ndim != 1:
        raise ValueError(
            f"query_many: {name} has the type {index.dtype} and the form {index.shape}; give whole numbers, (n,)."
        )
    return index.astype(np.int64)


def _pose(pose, name: str):
    """Return positions (n, 3) and unit quaternions (n, 4)."""
    try:
        position, quaternion = (np.atleast_2d(np.asarray(part, np.float64)) for part in pose)
    except (TypeError, ValueError):
        raise ValueError(
            f"pose {name}: {reprlib.repr(pose)} is no pair of a position (3,) and a quaternion (4,), such as "
            "((0, 0, 0), (1, 0, 0, 0))."
        ) from None
    if position.shape[1:] != (3,) or quaternion.shape != (len(position), 4):
        raise ValueError(
            f"pose {name}: give a position (3,) and a quaternion (4,), or n of each. "
            f"The shapes are {position.shape} and {quaternion.shape}."
        )
    if not np.isfinite(position).all():
        wrong = position[~np.isfinite(position).all(axis=1)][0]
        raise ValueError(f"pose {name}: the position {wrong} is not finite. Give finite coordinates in metres.")
    largest = np.abs(quaternion).max(axis=1, keepdims=True)
    wrong = ~(np.isfinite(largest[:, 0]) & (largest[:, 0] > 0.0))
    if wrong.any():
        raise ValueError(
            f"pose {name}: the quaternion {quaternion[wrong][0]} is not an orientation. Its components must be finite "
            "and not all zero; (1, 0, 0, 0) is no rotation."
        )
    quaternion = quaternion / largest  # the square of a tiny or a huge component could underflow or overflow
    return position, quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True)


@functools.lru_cache(maxsize=32)
def table_of(shapes: tuple[Shape, ...]):
    """Return (Shapes of all polyhedra with a single point at the end, index of each shape in it)."""
    hulls = {}
    for shape in shapes:
        if shape.kind == POLYHEDRON:
            hulls.setdefault(id(shape.base), (len(hulls), shape.base))
    table = collect_shapes([base for _, base in hulls.values()]) if hulls else None
    start, vertices, neighbor_start, neighbors, hints = table or (
        np.zeros(1, np.int64), np.zeros((0, 3)), np.zeros(1, np.int64), np.zeros(0, np.int64),
        np.zeros((0, HINT_CELLS), np.int32),
    )  # fmt: skip
    table = Shapes(
        np.append(start, start[-1] + 1),
        np.vstack([vertices, np.zeros((1, 3))]),
        np.append(neighbor_start, neighbor_start[-1]),
        neighbors,
        np.vstack([hints, np.full((1, HINT_CELLS), start[-1], np.int32)]),
    )
    return table, np.array([hulls[id(s.base)][0] if s.kind == POLYHEDRON else len(hulls) for s in shapes], np.int64)


def place_solids(shapes, index, rotation):
    """Return Solids of the shapes with these indices, rotated by these matrices (n, 3, 3)."""
    _, index_in_table = table_of(shapes)
    kind = np.array([shape.kind for shape in shapes], np.int64)[index]
    scale = np.array([shape.scale for shape in shapes])[index]
    full = np.einsum("nij,nj,nkj->nik", rotation, scale**2, rotation)
    return Solids(
        kind,
        index_in_table[index],
        scale,
        np.array([shape.radius for shape in shapes])[index],
        rotation,
        full[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]].copy(),
    )


def _query(shapes, index_a, position_a, orientation_a, index_b, position_b, orientation_b):
    """Return the fields of ContactQuery for n pairs, as arrays."""
    table, _ = table_of(shapes)
    n = len(position_a)
    if not len(index_a) == len(index_b) == len(position_b) == n:
        raise ValueError(
            f"query_many: there are {len(index_a)} indices and {n} poses for a, and {len(index_b)} and "
            f"{len(position_b)} for b; give the same number of each."
        )
    index = np.stack([index_a, index_b], axis=1).ravel()
    if len(index) and not (0 <= index.min() and index.max() < len(shapes)):
        wrong = index[(index < 0) | (index >= len(shapes))][0]
        raise IndexError(f"query_many: there is no shape {wrong}; give indices from 0 to {len(shapes) - 1}.")
    rotation = rotation_matrix(np.stack([orientation_a, orientation_b], axis=1).reshape(-1, 4))
    solids = place_solids(shapes, index, rotation)
    center = np.einsum("nij,nj->ni", rotation, np.array([shape.center for shape in shapes])[index])
    # The difference of positions is formed first, because it is exact also far from the origin of the world.
    offset = (position_b - position_a) + (center[1::2] - center[0::2])
    distance, normal, point_a, point_b = np.empty(n), np.empty((n, 3)), np.empty((n, 3)), np.empty((n, 3))
    query_pairs(table, solids, offset, distance, normal, point_a, point_b)
    return distance, normal, position_a + (center[0::2] + point_a), position_b + (center[1::2] + point_b)


@kernel
def query_pairs(shapes, solids, offset, distance, normal, point_a, point_b):
    """Query solids 2k and 2k + 1 with offset k between their centres; points are relative to the centres."""
    for k in range(len(offset)):
        closest = _query_pair(shapes, solids, pair_of(solids, 2 * k, 2 * k + 1, read(offset, k)))
        distance[k] = closest.distance
        write(normal, k, closest.normal)
        write(point_a, k, closest.point_a)
        write(point_b, k, closest.point_b)


@routine
def _query_pair(shapes, solids, pair):
    """Return the closest points of any two solids."""
    swapped = solids.kind[pair.a] != POLYHEDRON and solids.kind[pair.b] == POLYHEDRON
    if swapped:
        pair = exchanged(pair)
    if solids.kind[pair.a] == SPHERE and solids.kind[pair.b] == SPHERE:
        closest = _query_spheres(solids, pair)
    elif solids.kind[pair.a] != POLYHEDRON:
        closest = _query_ellipsoids(shapes, solids, pair)
    elif solids.kind[pair.b] == ELLIPSOID:
        closest = _query_mixed(shapes, solids, pair)
    else:
        closest = query_polyhedra(shapes, solids, pair)
        if solids.kind[pair.b] == SPHERE:
            radius = solids.scale[pair.b, 0]
            on_sphere = scaled(-radius, closest.normal)
            closest = Closest(closest.distance - radius, closest.normal, closest.point_a, on_sphere)
    if swapped:
        return Closest(closest.distance, negative(closest.normal), closest.point_b, closest.point_a)
    return closest


@leaf
def _query_spheres(solids, pair):
    radius_a, radius_b = solids.scale[pair.a, 0], solids.scale[pair.b, 0]
    normal = direction_of(pair.offset)  # for concentric spheres every direction gives the shortest translation
    gap = length(pair.offset) - radius_a - radius_b
    return Closest(gap, normal, scaled(radius_a, normal), scaled(-radius_b, normal))


@leaf
def _surface_point(solids, i, normal):
    """Return the point of ellipsoid i farthest along n, relative to its centre."""
    point, _ = surface_point(solids.form_matrix, i, normal)
    return point


@routine
def _query_ellipsoids(shapes, solids, pair):
    m = solids.form_matrix
    normal = settle_normal(m, pair, search_normal(shapes, solids, pair, np.inf).normal)
    on_a, on_b = _surface_point(solids, pair.a, normal), _surface_point(solids, pair.b, negative(normal))
    return Closest(gap_along(m, pair, normal), normal, on_a, on_b)


@routine
def _query_mixed(shapes, solids, pair):
    """Return the closest points of polyhedron a and ellipsoid b."""
    top = search_mixed_normal(shapes, solids, pair, np.inf)
    normal, on_a = top.normal, top.point
    on_b = _surface_point(solids, pair.b, negative(normal))
    target = plus(pair.offset, on_b)
    aside = beside(minus(target, on_a), normal)
    if aside > BESIDE * pair.size:
        # The climb ended on a face or an edge without all of its corners, so that its point may be beside the nearest
        # one. The nearest point of the whole face is computed here.
        simplex = take_simplex()
        f = frame_of(solids, Pair(pair.a, pair.b, target, pair.size))
        lone = len(shapes.vertices) - 1  # the single point at the end of the table
        along = into_axes(solids.rotation, pair.a, normal)
        n = facet_at(shapes, f, climb_a(shapes, f, top.a0, along), lone, along, simplex)
        point = Vec(0.0, 0.0, 0.0)
        for k in range(n):
            point = plus_scaled(point, simplex.weights[k], vertex_a(shapes, f, simplex.vertices[k, 0]))
        point = out_of_axes(solids.rotation, pair.a, point)
        if beside(minus(target, point), normal) < aside:
            on_a = point
    return Closest(top.value, normal, on_a, on_b)
