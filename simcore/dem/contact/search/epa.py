"""EPA: the facet of the Minkowski difference M next to the origin (van den Bergen 2001)."""

import numpy as np
from numba import types

from simcore.compilation import leaf, routine
from simcore.dem.contact.search.gjk import along
from simcore.dem.contact.search.pair_frame import support
from simcore.dem.contact.search.polytope import Polytope, insert_point, nearest_face, start_polytope, volume_of
from simcore.dem.contact.search.scratch import scratch

MAX_VERTICES = 128  # pairs that just touch need 10 to 20
MAX_FACES = 2 * MAX_VERTICES
TOLERANCE = 1e-12  # of the pair's size: how far M may reach beyond a facet that counts as its own
FLAT = 1e-9  # of the size³: a tetrahedron of less volume is no start

_take_points = scratch(types.float64, MAX_VERTICES, 3)
_take_vertices = scratch(types.int64, MAX_VERTICES, 2)
_take_faces = scratch(types.int64, MAX_FACES, 3)
_take_adjacent = scratch(types.int64, MAX_FACES, 3)
_take_normals = scratch(types.float64, MAX_FACES, 3)
_take_distances = scratch(types.float64, MAX_FACES)
_take_seen = scratch(types.int64, MAX_FACES)
_take_stack = scratch(types.int64, MAX_FACES)
_take_free = scratch(types.int64, MAX_FACES)
_take_rim = scratch(types.int64, MAX_FACES, 4)
_take_from_vertex = scratch(types.int64, MAX_VERTICES)


@leaf
def _put(points, vertices, k, a, b, x, y, z):
    points[k, 0], points[k, 1], points[k, 2] = x, y, z
    vertices[k, 0], vertices[k, 1] = a, b


@leaf
def _farther(shapes, f, a, b, nx, ny, nz, px, py, pz):
    """Of the supports along n and −n the one farther from the plane through p: (a, b, m)."""
    a1, b1, x1, y1, z1 = support(shapes, f, a, b, nx, ny, nz)
    a2, b2, x2, y2, z2 = support(shapes, f, a, b, -nx, -ny, -nz)
    up = nx * (x1 - px) + ny * (y1 - py) + nz * (z1 - pz)
    down = -(nx * (x2 - px) + ny * (y2 - py) + nz * (z2 - pz))
    if up >= down:
        return a1, b1, x1, y1, z1
    return a2, b2, x2, y2, z2


@routine
def _start_tetrahedron(shapes, f, a, b, nx, ny, nz, points, vertices):
    """Points 0 to 3 from a direction: there and back, then as far sideways as M reaches."""
    a, b, x, y, z = support(shapes, f, a, b, nx, ny, nz)
    _put(points, vertices, 0, a, b, x, y, z)
    a, b, x, y, z = support(shapes, f, a, b, -nx, -ny, -nz)
    _put(points, vertices, 1, a, b, x, y, z)
    ex, ey, ez = x - points[0, 0], y - points[0, 1], z - points[0, 2]
    if abs(ex) <= abs(ey) and abs(ex) <= abs(ez):
        sx, sy, sz = 0.0, -ez, ey
    elif abs(ey) <= abs(ez):
        sx, sy, sz = ez, 0.0, -ex
    else:
        sx, sy, sz = -ey, ex, 0.0
    length = np.sqrt(sx * sx + sy * sy + sz * sz)
    a, b, x, y, z = _farther(
        shapes, f, a, b, sx / length, sy / length, sz / length, points[0, 0], points[0, 1], points[0, 2]
    )
    _put(points, vertices, 2, a, b, x, y, z)
    fx, fy, fz = x - points[0, 0], y - points[0, 1], z - points[0, 2]
    sx, sy, sz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
    length = np.sqrt(sx * sx + sy * sy + sz * sz)
    a, b, x, y, z = _farther(
        shapes, f, a, b, sx / length, sy / length, sz / length, points[0, 0], points[0, 1], points[0, 2]
    )
    _put(points, vertices, 3, a, b, x, y, z)


@leaf
def least_weight(points, p, q, s, nx, ny, nz):
    """Least barycentric weight of the origin's projection along n on triangle p, q, s: negative outside."""
    px, py, pz = points[p, 0], points[p, 1], points[p, 2]
    qx, qy, qz = points[q, 0], points[q, 1], points[q, 2]
    sx, sy, sz = points[s, 0], points[s, 1], points[s, 2]
    u = (qy * sz - qz * sy) * nx + (qz * sx - qx * sz) * ny + (qx * sy - qy * sx) * nz
    v = (sy * pz - sz * py) * nx + (sz * px - sx * pz) * ny + (sx * py - sy * px) * nz
    w = (py * qz - pz * qy) * nx + (pz * qx - px * qz) * ny + (px * qy - py * qx) * nz
    return min(u, v, w) / (u + v + w)


@routine
def _facet_below(points, faces, normals, distances, n_faces, nearest, tolerance):
    """Of the faces in the plane of the nearest one, that which holds the origin's projection.

    A facet of M is a triangle only by chance: that of two edges is a parallelogram, and EPA meets its triangles in
    any order.
    """
    nx, ny, nz = normals[nearest, 0], normals[nearest, 1], normals[nearest, 2]
    best = nearest
    most = least_weight(points, faces[nearest, 0], faces[nearest, 1], faces[nearest, 2], nx, ny, nz)
    if most >= 0.0:
        return best
    for k in range(n_faces):
        if distances[k] > distances[nearest] + tolerance:
            continue
        p, q, s = faces[k, 0], faces[k, 1], faces[k, 2]
        # A face as near may also lie elsewhere (concentric bodies): then its corners are not in the plane.
        lowest = min(along(points, p, nx, ny, nz), along(points, q, nx, ny, nz), along(points, s, nx, ny, nz))
        if lowest < distances[nearest] - 4.0 * tolerance:
            continue
        least = least_weight(points, p, q, s, nx, ny, nz)
        if least > most:
            best, most = k, least
    return best


@leaf
def _lead(points, faces, distances, n_faces, least, nx, ny, nz, tolerance):
    """Distance of the nearest face that is not in the plane of normal n at `least`, less that."""
    second = np.inf
    for k in range(n_faces):
        if distances[k] < second:
            lowest = np.inf
            for c in range(3):
                lowest = min(lowest, along(points, faces[k, c], nx, ny, nz))
            if lowest < least - 4.0 * tolerance:
                second = distances[k]
    return max(second - least, 0.0)


@routine
def expand(shapes, f, size, a, b, nx, ny, nz, simplex, simplex_vertices, n_simplex):
    """Signed facet distance: (found, overlap, normal (3), facet a0 a1 a2 b0 b1 b2, lead).

    lead: how much farther the next face of the polytope lies, and so what other facets show more than this one.
    Starts from GJK's simplex where that is a tetrahedron, else from direction n and vertices a, b. A negative overlap
    is a certain gap along the normal. Not found: the polytope ran out of room or could not be kept closed.
    """
    points, vertices = _take_points(), _take_vertices()
    polytope = Polytope(
        points, _take_faces(), _take_adjacent(), _take_normals(), _take_distances(),
        _take_seen(), _take_stack(), _take_free(), _take_rim(), _take_from_vertex(),
    )  # fmt: skip
    faces, normals, distances = polytope.faces, polytope.normals, polytope.distances

    volume = 0.0
    if n_simplex == 4:
        for k in range(4):
            _put(
                points, vertices, k, simplex_vertices[k, 0], simplex_vertices[k, 1],
                simplex[k, 0], simplex[k, 1], simplex[k, 2],
            )  # fmt: skip
        volume = volume_of(points)
    if not abs(volume) > FLAT * size**3:
        _start_tetrahedron(shapes, f, a, b, nx, ny, nz, points, vertices)
    start_polytope(polytope, size)
    n_faces, n_free = 4, 0
    tolerance = TOLERANCE * size

    for mark in range(1, MAX_VERTICES - 3):
        nearest, least = nearest_face(polytope, n_faces)
        if not least < np.inf:
            break
        nx, ny, nz = normals[nearest, 0], normals[nearest, 1], normals[nearest, 2]
        start = faces[nearest, 0]
        a, b, x, y, z = support(shapes, f, vertices[start, 0], vertices[start, 1], nx, ny, nz)
        reach = x * nx + y * ny + z * nz
        if reach - least <= tolerance:
            nearest = _facet_below(points, faces, normals, distances, n_faces, nearest, tolerance)
            p, q, s = faces[nearest, 0], faces[nearest, 1], faces[nearest, 2]
            return (
                True, reach, nx, ny, nz,
                vertices[p, 0], vertices[q, 0], vertices[s, 0], vertices[p, 1], vertices[q, 1], vertices[s, 1],
                _lead(points, faces, distances, n_faces, least, nx, ny, nz, tolerance),
            )  # fmt: skip

        w = 3 + mark
        _put(points, vertices, w, a, b, x, y, z)
        done, n_faces, n_free = insert_point(polytope, w, nearest, n_faces, n_free, mark, size)
        if not done:
            break
    return False, 0.0, nx, ny, nz, -1, -1, -1, -1, -1, -1, 0.0
