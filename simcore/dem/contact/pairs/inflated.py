"""Two polyhedra as the source study's program finds their contact: to compare with it, for no other result.

Its GJK and EPA (waLBerla: `GeneralContactDetection.h`, `EPA.cpp`) blow up both bodies by MARGIN, an absolute length, so
that the Minkowski difference M has rounded edges and corners, and make at most MAX_FACES faces, those given up since
counted too. Where these do not suffice, the face of the polytope next to the origin is what is found. It lies inside M:
it shows less overlap than there is, along another normal, or none at all, the oftener the longer the grains are:
`python -m benchmarks.studies.inflated`, results/reference/inflated.csv.
"""

import numpy as np
from numba import types

from simcore.compilation import leaf, routine
from simcore.dem.contact.search.gjk import along, nearest_on_simplex
from simcore.dem.contact.search.pair_frame import frame_of, support, support_afar, to_body, to_world, vertex_a, vertex_b
from simcore.dem.contact.search.polytope import Polytope, insert_point, nearest_face, start_polytope
from simcore.dem.contact.search.scratch import scratch

MARGIN = 1e-4  # [m], of each body
MAX_FACES = 100  # made in all
TOLERANCE = 1e-6  # of the distance from the origin to the rounded M
GJK_ITERATIONS = 64  # a bound, not a budget

_VERTICES = 4 + MAX_FACES // 3
_FACES = 2 * MAX_FACES  # in use: the last insertion is made whole, and counted then

_take_simplex = scratch(types.float64, 4, 3)
_take_simplex_vertices = scratch(types.int64, 4, 2)
_take_weights = scratch(types.float64, 4)
_take_points = scratch(types.float64, _VERTICES, 3)
_take_vertices = scratch(types.int64, _VERTICES, 2)
_take_faces = scratch(types.int64, _FACES, 3)
_take_adjacent = scratch(types.int64, _FACES, 3)
_take_normals = scratch(types.float64, _FACES, 3)
_take_distances = scratch(types.float64, _FACES)
_take_seen = scratch(types.int64, _FACES)
_take_stack = scratch(types.int64, _FACES)
_take_free = scratch(types.int64, _FACES)
_take_rim = scratch(types.int64, _FACES, 4)
_take_from_vertex = scratch(types.int64, _VERTICES)


@leaf
def _put(points, vertices, k, a, b, x, y, z, nx, ny, nz):
    """Support point k of the rounded M along the unit vector n."""
    points[k, 0], points[k, 1], points[k, 2] = x + 2.0 * MARGIN * nx, y + 2.0 * MARGIN * ny, z + 2.0 * MARGIN * nz
    vertices[k, 0], vertices[k, 1] = a, b


@routine
def _enclose_origin(shapes, f, nx, ny, nz, points, vertices):
    """GJK from direction n: fills the tetrahedron of support points round the origin, True where there is one."""
    weights = _take_weights()
    a, b, x, y, z = support_afar(shapes, f, nx, ny, nz)
    _put(points, vertices, 0, a, b, x, y, z, nx, ny, nz)
    vx, vy, vz = points[0, 0], points[0, 1], points[0, 2]
    n = 1
    for _ in range(GJK_ITERATIONS):
        distance = np.sqrt(vx * vx + vy * vy + vz * vz)
        if not distance > 0.0:
            return False
        nx, ny, nz = -vx / distance, -vy / distance, -vz / distance
        a, b, x, y, z = support_afar(shapes, f, nx, ny, nz)
        _put(points, vertices, n, a, b, x, y, z, nx, ny, nz)
        if along(points, n, nx, ny, nz) < 0.0:
            return False
        if nearest_on_simplex(points, n + 1, weights):
            return True
        vx, vy, vz = 0.0, 0.0, 0.0
        kept = 0
        for k in range(n + 1):
            if weights[k] > 0.0:
                x, y, z = points[k, 0], points[k, 1], points[k, 2]
                vx, vy, vz = vx + weights[k] * x, vy + weights[k] * y, vz + weights[k] * z
                points[kept, 0], points[kept, 1], points[kept, 2] = x, y, z
                vertices[kept, 0], vertices[kept, 1] = vertices[k, 0], vertices[k, 1]
                kept += 1
        n = kept
        if n == 4:  # the origin on a side, by rounding
            return True
    return False


@leaf
def _count_new(polytope, n_faces, mark):
    new = 0
    for k in range(n_faces):
        if polytope.seen[k] == mark and polytope.distances[k] < np.inf:
            new += 1
    return new


@leaf
def _contact_point(shapes, f, points, vertices, p, q, s, nx, ny, nz):
    """Midway between the points of a and b, of the bodies as they are, that meet on face p, q, s below the origin."""
    px, py, pz = points[p, 0], points[p, 1], points[p, 2]
    qx, qy, qz = points[q, 0], points[q, 1], points[q, 2]
    sx, sy, sz = points[s, 0], points[s, 1], points[s, 2]
    u = (qy * sz - qz * sy) * nx + (qz * sx - qx * sz) * ny + (qx * sy - qy * sx) * nz
    v = (sy * pz - sz * py) * nx + (sz * px - sx * pz) * ny + (sx * py - sy * px) * nz
    w = (py * qz - pz * qy) * nx + (pz * qx - px * qz) * ny + (px * qy - py * qx) * nz
    x, y, z = f.rx, f.ry, f.rz
    for corner, weight in ((p, u / (u + v + w)), (q, v / (u + v + w)), (s, w / (u + v + w))):
        ax, ay, az = vertex_a(shapes, f, vertices[corner, 0])
        bx, by, bz = vertex_b(shapes, f, vertices[corner, 1])
        x, y, z = x + weight * (ax + bx), y + weight * (ay + by), z + weight * (az + bz)
    return 0.5 * x, 0.5 * y, 0.5 * z


@routine
def search_inflated(shapes, bodies, i, j, rx, ry, rz):
    """Overlapping pair i, j: (whether a contact is found, overlap [m], normal a to b (3), point relative to a (3)).

    r: offset from the centre of a to that of b. World axes.
    """
    simplex, simplex_vertices = _take_simplex(), _take_simplex_vertices()
    points, vertices = _take_points(), _take_vertices()
    polytope = Polytope(
        points, _take_faces(), _take_adjacent(), _take_normals(), _take_distances(),
        _take_seen(), _take_stack(), _take_free(), _take_rim(), _take_from_vertex(),
    )  # fmt: skip
    size = bodies.radius[i] + bodies.radius[j]
    f = frame_of(bodies, i, j, rx, ry, rz)
    nx, ny, nz = to_body(bodies.rotation, i, 0.0, 0.6, 0.8)
    if not _enclose_origin(shapes, f, nx, ny, nz, simplex, simplex_vertices):
        return False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(4):
        points[k, 0], points[k, 1], points[k, 2] = simplex[k, 0], simplex[k, 1], simplex[k, 2]
        vertices[k, 0], vertices[k, 1] = simplex_vertices[k, 0], simplex_vertices[k, 1]
    start_polytope(polytope, size)
    n_faces, n_free, made = 4, 0, 4
    upper, distance = np.inf, 0.0
    p, q, s = 0, 0, 0
    for mark in range(1, _VERTICES - 3):
        nearest, least = nearest_face(polytope, n_faces)
        if not (least < np.inf and least <= upper):
            break
        distance = least
        nx, ny, nz = polytope.normals[nearest, 0], polytope.normals[nearest, 1], polytope.normals[nearest, 2]
        p, q, s = polytope.faces[nearest, 0], polytope.faces[nearest, 1], polytope.faces[nearest, 2]
        a, b, x, y, z = support(shapes, f, vertices[p, 0], vertices[p, 1], nx, ny, nz)
        w = 3 + mark
        _put(points, vertices, w, a, b, x, y, z, nx, ny, nz)
        upper = min(upper, along(points, w, nx, ny, nz))
        if upper <= (1.0 + TOLERANCE) * least:
            break
        done, n_faces, n_free = insert_point(polytope, w, nearest, n_faces, n_free, mark, size)
        if not done:
            break
        made += _count_new(polytope, n_faces, mark)
        if made > MAX_FACES:
            break
    overlap = distance - 2.0 * MARGIN
    if not overlap > 0.0:
        return False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    x, y, z = _contact_point(shapes, f, points, vertices, p, q, s, nx, ny, nz)
    nx, ny, nz = to_world(bodies.rotation, i, nx, ny, nz)
    x, y, z = to_world(bodies.rotation, i, x, y, z)
    return True, overlap, nx, ny, nz, x, y, z
