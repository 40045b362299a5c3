"""The stand-alone contact query: signed distance, normal and points of any two convex shapes, from nothing.

    query(ellipsoid(3, 2, 1), ((0, 0, 0), (1, 0, 0, 0)), convex(points), (position, quaternion)).signed_distance

The signed distance is the maximum over unit directions n of  n·c − h_A(n) − h_B(−n), c from the origin of a to that
of b and h the support functions: the gap, or minus the length of the shortest translation that separates the two.
The answer is the global maximum also for deep and concentric pairs, and knows no memory and no tolerance to be set.

A sphere is a point with a radius: against a hull it is queried as a hull of one vertex.
"""

import functools
from typing import NamedTuple

import numpy as np
from numba import types

from simcore.compilation import kernel, leaf, routine
from simcore.dem.contact.pairs.ellipsoids import search_normal
from simcore.dem.contact.pairs.polyhedron_ellipsoid import search_normal as search_mixed_normal
from simcore.dem.contact.search.ellipsoid_climb import gap_along, image, settle_normal
from simcore.dem.contact.search.exact_polyhedra import query_hulls
from simcore.dem.contact.search.facets import facet_at
from simcore.dem.contact.search.pair_frame import climb_a, frame_of, to_body, to_world, vertex_a
from simcore.dem.contact.search.scratch import scratch
from simcore.dem.shapes.hulls import CONVEX, ELLIPSOID, HINT_CELLS, SPHERE, Shape, Shapes, collect_shapes
from simcore.dem.state.bodies import rotation_matrix

BESIDE = 1e-12  # of the pair's size: tangential distance of the two points that is left as it is

_take_points = scratch(types.float64, 4, 3)
_take_vertices = scratch(types.int64, 4, 2)
_take_weights = scratch(types.float64, 4)


class ContactQuery(NamedTuple):
    """What a query finds; of `query_many` every field is an array with one row for each pair."""

    signed_distance: float  # [m], positive a gap, negative an overlap
    normal: np.ndarray  # (3,) unit, from a to b
    point_a: np.ndarray  # (3,) [m], on the surface of a; point_b − point_a = signed_distance × normal
    point_b: np.ndarray  # (3,) [m], on the surface of b


class Solids(NamedTuple):
    """Placed shapes, as the compiled functions of this package read bodies."""

    kind: np.ndarray  # (n,) int64
    shape: np.ndarray  # (n,) int64, index into Shapes; a sphere's is that of the single point
    scale: np.ndarray  # (n, 3)
    radius: np.ndarray  # (n,) [m]
    rotation: np.ndarray  # (n, 3, 3)
    form_matrix: np.ndarray  # (n, 6) [m²]


def query(shape_a: Shape, pose_a, shape_b: Shape, pose_b) -> ContactQuery:
    """Signed distance [m], normal and closest (or deepest) points of two shapes of `simcore.dem.shapes.hulls`.

    pose: position (3,) [m] and quaternion (4,) (w, x, y, z), of any length but zero, from the shape's frame to the
    world's. ValueError for a pose that is not finite or has a zero quaternion.

    An overlap is the global one, the length of the shortest translation that separates the shapes; where several are
    equally short (concentric spheres) one of them is given, the same at every call.
    """
    position_a, orientation_a = _pose(pose_a, "a")
    position_b, orientation_b = _pose(pose_b, "b")
    one = np.zeros(1, np.int64)
    found = _query((shape_a, shape_b), one, position_a, orientation_a, one + 1, position_b, orientation_b)
    return ContactQuery(float(found[0][0]), *(field[0] for field in found[1:]))


def query_many(shapes, index_a, poses_a, index_b, poses_b) -> ContactQuery:
    """`query` for n pairs in one compiled loop.

    shapes: sequence of shapes; index_a, index_b (n,) say which of them a pair has. poses: positions (n, 3) [m] and
    quaternions (n, 4). Fields of the answer are arrays (n,) and (n, 3). ValueError as in `query`, IndexError for a
    shape that is not there.
    """
    position_a, orientation_a = _pose(poses_a, "a")
    position_b, orientation_b = _pose(poses_b, "b")
    index_a, index_b = (np.atleast_1d(np.asarray(index, np.int64)) for index in (index_a, index_b))
    return ContactQuery(*_query(tuple(shapes), index_a, position_a, orientation_a, index_b, position_b, orientation_b))


def _pose(pose, name: str):
    """Positions (n, 3) and unit quaternions (n, 4)."""
    position, quaternion = (np.atleast_2d(np.asarray(part, np.float64)) for part in pose)
    if position.shape[1:] != (3,) or quaternion.shape != (len(position), 4):
        raise ValueError(
            f"pose {name}: a position (3,) and a quaternion (4,) are needed, "
            f"their shapes are {position.shape} and {quaternion.shape}"
        )
    if not np.isfinite(position).all():
        raise ValueError(f"pose {name}: position {position[~np.isfinite(position).all(axis=1)][0]} is not finite")
    largest = np.abs(quaternion).max(axis=1, keepdims=True)
    wrong = ~(np.isfinite(largest[:, 0]) & (largest[:, 0] > 0.0))
    if wrong.any():
        raise ValueError(
            f"pose {name}: quaternion {quaternion[wrong][0]} gives no orientation; (1, 0, 0, 0) is none turned"
        )
    quaternion = quaternion / largest  # the square of a tiny or a huge one would leave the range of numbers
    return position, quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True)


@functools.lru_cache(maxsize=32)
def _table(shapes: tuple[Shape, ...]):
    """(Shapes of all hulls with a single point at the end, index of each shape there)."""
    hulls = {}
    for shape in shapes:
        if shape.kind == CONVEX:
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
    return table, np.array([hulls[id(s.base)][0] if s.kind == CONVEX else len(hulls) for s in shapes], np.int64)


def place(shapes, index, rotation):
    """Solids of the shapes with these indices, turned by these matrices (n, 3, 3)."""
    _, where = _table(shapes)
    kind = np.array([shape.kind for shape in shapes], np.int64)[index]
    scale = np.array([shape.scale for shape in shapes])[index]
    full = np.einsum("nij,nj,nkj->nik", rotation, scale**2, rotation)
    return Solids(
        kind,
        where[index],
        scale,
        np.array([shape.radius for shape in shapes])[index],
        rotation,
        full[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]].copy(),
    )


def _query(shapes, index_a, position_a, orientation_a, index_b, position_b, orientation_b):
    table, _ = _table(shapes)
    n = len(position_a)
    if not len(index_a) == len(index_b) == len(position_b) == n:
        raise ValueError("query_many: indices and poses must be as many for a as for b")
    index = np.stack([index_a, index_b], axis=1).ravel()
    if len(index) and not (0 <= index.min() and index.max() < len(shapes)):
        raise IndexError(f"query_many: a shape's index must be 0 to {len(shapes) - 1}")
    rotation = rotation_matrix(np.stack([orientation_a, orientation_b], axis=1).reshape(-1, 4))
    solids = place(shapes, index, rotation)
    center = np.einsum("nij,nj->ni", rotation, np.array([shape.center for shape in shapes])[index])
    # Far from the world's origin the difference of positions is exact; it is formed first.
    offset = (position_b - position_a) + (center[1::2] - center[0::2])
    distance, normal, point_a, point_b = np.empty(n), np.empty((n, 3)), np.empty((n, 3)), np.empty((n, 3))
    query_pairs(table, solids, offset, distance, normal, point_a, point_b)
    return distance, normal, position_a + (center[0::2] + point_a), position_b + (center[1::2] + point_b)


@kernel
def query_pairs(shapes, solids, offset, distance, normal, point_a, point_b):
    """Query solids 2k and 2k + 1 at offset k of their centres; the points are from the centres."""
    for k in range(len(offset)):
        _query_pair(shapes, solids, k, offset, distance, normal, point_a, point_b)


@routine
def _query_pair(shapes, solids, k, offset, distance, normal, point_a, point_b):
    i, j = 2 * k, 2 * k + 1
    rx, ry, rz = offset[k, 0], offset[k, 1], offset[k, 2]
    swapped = solids.kind[i] != CONVEX and solids.kind[j] == CONVEX
    if swapped:
        i, j = j, i
        rx, ry, rz = -rx, -ry, -rz
    size = solids.radius[i] + solids.radius[j]
    if solids.kind[i] == SPHERE and solids.kind[j] == SPHERE:
        value, nx, ny, nz, ax, ay, az, bx, by, bz = _query_spheres(solids, i, j, rx, ry, rz)
    elif solids.kind[i] != CONVEX:
        value, nx, ny, nz, ax, ay, az, bx, by, bz = _query_ellipsoids(solids, i, j, rx, ry, rz, size)
    elif solids.kind[j] == ELLIPSOID:
        value, nx, ny, nz, ax, ay, az, bx, by, bz = _query_mixed(shapes, solids, i, j, rx, ry, rz, size)
    else:
        value, nx, ny, nz, ax, ay, az, bx, by, bz = query_hulls(shapes, solids, i, j, rx, ry, rz, size)
        if solids.kind[j] == SPHERE:
            radius = solids.scale[j, 0]
            value -= radius
            bx, by, bz = -radius * nx, -radius * ny, -radius * nz
    if swapped:
        nx, ny, nz = -nx, -ny, -nz
        ax, ay, az, bx, by, bz = bx, by, bz, ax, ay, az
    distance[k] = value
    normal[k, 0], normal[k, 1], normal[k, 2] = nx, ny, nz
    point_a[k, 0], point_a[k, 1], point_a[k, 2] = ax, ay, az
    point_b[k, 0], point_b[k, 1], point_b[k, 2] = bx, by, bz


@leaf
def _query_spheres(solids, i, j, rx, ry, rz):
    radius_a, radius_b = solids.scale[i, 0], solids.scale[j, 0]
    distance = np.sqrt(rx * rx + ry * ry + rz * rz)
    nx, ny, nz = 1.0, 0.0, 0.0  # concentric: any direction is the shortest way out
    if distance > 0.0:
        nx, ny, nz = rx / distance, ry / distance, rz / distance
    return (
        distance - radius_a - radius_b, nx, ny, nz,
        radius_a * nx, radius_a * ny, radius_a * nz, -radius_b * nx, -radius_b * ny, -radius_b * nz,
    )  # fmt: skip


@leaf
def _surface_point(solids, i, nx, ny, nz):
    """Point of ellipsoid i farthest along n, from its centre."""
    x, y, z = image(solids.form_matrix, i, nx, ny, nz)
    height = np.sqrt(nx * x + ny * y + nz * z)
    return x / height, y / height, z / height


@routine
def _query_ellipsoids(solids, i, j, rx, ry, rz, size):
    m = solids.form_matrix
    _, nx, ny, nz = search_normal(m, i, j, solids.rotation, rx, ry, rz, size, np.inf)
    nx, ny, nz = settle_normal(m, i, j, rx, ry, rz, nx, ny, nz)
    value = gap_along(m, i, j, rx, ry, rz, nx, ny, nz)
    ax, ay, az = _surface_point(solids, i, nx, ny, nz)
    bx, by, bz = _surface_point(solids, j, -nx, -ny, -nz)
    return value, nx, ny, nz, ax, ay, az, bx, by, bz


@leaf
def _beside(x, y, z, nx, ny, nz):
    """Length of the part of a vector normal to n."""
    along = x * nx + y * ny + z * nz
    x, y, z = x - along * nx, y - along * ny, z - along * nz
    return np.sqrt(x * x + y * y + z * z)


@routine
def _query_mixed(shapes, solids, i, j, rx, ry, rz, size):
    """Hull i and ellipsoid j."""
    value, nx, ny, nz, ax, ay, az, v, _, _ = search_mixed_normal(shapes, solids, i, j, rx, ry, rz, size, np.inf)
    bx, by, bz = _surface_point(solids, j, -nx, -ny, -nz)
    beside = _beside(rx + bx - ax, ry + by - ay, rz + bz - az, nx, ny, nz)
    if beside > BESIDE * size:
        # The climb ended on a face or an edge without all its corners: the point of that face beside the ellipsoid's
        points, vertices, weights = _take_points(), _take_vertices(), _take_weights()
        f = frame_of(solids, i, j, rx + bx, ry + by, rz + bz)
        lone = len(shapes.vertices) - 1  # the single point at the end of the table
        mx, my, mz = to_body(solids.rotation, i, nx, ny, nz)
        n = facet_at(shapes, f, size, climb_a(shapes, f, v, mx, my, mz), lone, mx, my, mz, points, vertices, weights)
        x, y, z = 0.0, 0.0, 0.0
        for k in range(n):
            vx, vy, vz = vertex_a(shapes, f, vertices[k, 0])
            x, y, z = x + weights[k] * vx, y + weights[k] * vy, z + weights[k] * vz
        x, y, z = to_world(solids.rotation, i, x, y, z)
        if _beside(rx + bx - x, ry + by - y, rz + bz - z, nx, ny, nz) < beside:
            ax, ay, az = x, y, z
    return value, nx, ny, nz, ax, ay, az, bx, by, bz
