"""EPA: the facet of the Minkowski difference M next to the origin (van den Bergen 2001)."""

import numpy as np
from numba import types

from simcore.compilation import leaf, routine
from simcore.dem.contact.frame import support
from simcore.dem.contact.gjk import along
from simcore.dem.contact.scratch import scratch

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
def _set_face(k, p, q, s, points, faces, normals, distances, size):
    """Face k of vertices p, q, s: unit outward normal and signed distance of its plane from the origin."""
    faces[k, 0], faces[k, 1], faces[k, 2] = p, q, s
    ax, ay, az = points[q, 0] - points[p, 0], points[q, 1] - points[p, 1], points[q, 2] - points[p, 2]
    bx, by, bz = points[s, 0] - points[p, 0], points[s, 1] - points[p, 1], points[s, 2] - points[p, 2]
    nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    area = np.sqrt(nx * nx + ny * ny + nz * nz)
    if area <= 1e-13 * size * size:
        # A sliver has no reliable plane: never the nearest face and never seen from a new vertex, but the
        # polytope stays closed.
        normals[k, 0], normals[k, 1], normals[k, 2] = 0.0, 0.0, 0.0
        distances[k] = np.inf
        return
    inverse = 1.0 / area
    nx, ny, nz = nx * inverse, ny * inverse, nz * inverse
    normals[k, 0], normals[k, 1], normals[k, 2] = nx, ny, nz
    # The mean over the vertices halves the rounding of a single one.
    distances[k] = (
        nx * (points[p, 0] + points[q, 0] + points[s, 0])
        + ny * (points[p, 1] + points[q, 1] + points[s, 1])
        + nz * (points[p, 2] + points[q, 2] + points[s, 2])
    ) / 3.0


@leaf
def _volume(points):
    """Six times the signed volume of the tetrahedron of points 0 to 3."""
    ax, ay, az = points[1, 0] - points[0, 0], points[1, 1] - points[0, 1], points[1, 2] - points[0, 2]
    bx, by, bz = points[2, 0] - points[0, 0], points[2, 1] - points[0, 1], points[2, 2] - points[0, 2]
    cx, cy, cz = points[3, 0] - points[0, 0], points[3, 1] - points[0, 1], points[3, 2] - points[0, 2]
    return (ay * bz - az * by) * cx + (az * bx - ax * bz) * cy + (ax * by - ay * bx) * cz


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


@routine
def expand(shapes, f, size, a, b, nx, ny, nz, simplex, simplex_vertices, n_simplex):
    """Signed facet distance: (found, overlap, normal (3), facet a0 a1 a2 b0 b1 b2).

    Starts from GJK's simplex where that is a tetrahedron, else from direction n and vertices a, b. A negative overlap
    is a certain gap along the normal. Not found: the polytope ran out of room or could not be kept closed.
    """
    points, vertices = _take_points(), _take_vertices()
    faces, adjacent = _take_faces(), _take_adjacent()
    normals, distances = _take_normals(), _take_distances()  # distance infinite: the slot is empty, or a sliver's
    seen, stack, free = _take_seen(), _take_stack(), _take_free()
    rim = _take_rim()  # edges between what a new vertex sees and does not: start, end, face, its slot
    from_vertex = _take_from_vertex()

    volume = 0.0
    if n_simplex == 4:
        for k in range(4):
            _put(
                points, vertices, k, simplex_vertices[k, 0], simplex_vertices[k, 1],
                simplex[k, 0], simplex[k, 1], simplex[k, 2],
            )  # fmt: skip
        volume = _volume(points)
    if not abs(volume) > FLAT * size**3:
        _start_tetrahedron(shapes, f, a, b, nx, ny, nz, points, vertices)
        volume = _volume(points)
    if volume > 0.0:  # vertices p, q, s run outward, seen from outside, where 3 lies below them
        p, q, s = 0, 2, 1
    else:
        p, q, s = 0, 1, 2
    _set_face(0, p, q, s, points, faces, normals, distances, size)
    _set_face(1, q, p, 3, points, faces, normals, distances, size)
    _set_face(2, s, q, 3, points, faces, normals, distances, size)
    _set_face(3, p, s, 3, points, faces, normals, distances, size)
    for k in range(3):
        adjacent[0, k] = k + 1
        adjacent[k + 1, 0] = 0
        adjacent[k + 1, 1] = 1 + (k + 2) % 3
        adjacent[k + 1, 2] = 1 + (k + 1) % 3
    for k in range(4):
        seen[k] = 0
    n_points, n_faces, n_free = 4, 4, 0
    tolerance = TOLERANCE * size

    for mark in range(1, MAX_VERTICES - 3):
        nearest = 0
        least = np.inf
        for k in range(n_faces):
            if distances[k] < least:
                least = distances[k]
                nearest = k
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
            )  # fmt: skip

        # Faces that the new vertex sees, found by walking from the nearest, so that they hang together.
        w = n_points
        _put(points, vertices, w, a, b, x, y, z)
        n_points += 1
        n_rim, n_stack = 0, 1
        stack[0] = nearest
        seen[nearest] = mark
        free[n_free] = nearest
        n_freed = n_free + 1
        while n_stack > 0:
            n_stack -= 1
            face = stack[n_stack]
            for k in range(3):
                other = adjacent[face, k]
                if seen[other] == mark:
                    continue
                beyond = normals[other, 0] * x + normals[other, 1] * y + normals[other, 2] * z - distances[other]
                if beyond > 1e-15 * size:
                    seen[other] = mark
                    stack[n_stack] = other
                    n_stack += 1
                    free[n_freed] = other
                    n_freed += 1
                elif n_rim < MAX_FACES:
                    after = faces[face, (k + 1) % 3]
                    slot = 0
                    while slot < 2 and faces[other, slot] != after:
                        slot += 1
                    rim[n_rim, 0] = faces[face, k]
                    rim[n_rim, 1] = after
                    rim[n_rim, 2] = other
                    rim[n_rim, 3] = slot
                    n_rim += 1
        if n_rim < 3 or n_faces + n_rim > MAX_FACES:
            break
        for k in range(n_free, n_freed):
            distances[free[k]] = np.inf
        n_free = n_freed
        # The rim must be one ring: n_rim edges that lead from one to the next and back, each once.
        for k in range(n_rim):
            from_vertex[rim[k, 0]] = -1
            from_vertex[rim[k, 1]] = -1
        for k in range(n_rim):
            from_vertex[rim[k, 0]] = k
        edge, length = 0, 0
        while length < n_rim:
            edge = from_vertex[rim[edge, 1]]
            length += 1
            if edge <= 0:
                break
        if edge != 0 or length < n_rim:
            break
        first = -1
        last = -1
        for _ in range(n_rim):
            if n_free > 0:
                n_free -= 1
                face = free[n_free]
            else:
                face = n_faces
                n_faces += 1
            _set_face(face, rim[edge, 0], rim[edge, 1], w, points, faces, normals, distances, size)
            seen[face] = mark
            adjacent[face, 0] = rim[edge, 2]
            adjacent[rim[edge, 2], rim[edge, 3]] = face
            if last >= 0:
                adjacent[last, 1] = face
                adjacent[face, 2] = last
            else:
                first = face
            last = face
            edge = from_vertex[rim[edge, 1]]
        adjacent[last, 1] = first
        adjacent[first, 2] = last
    return False, 0.0, nx, ny, nz, -1, -1, -1, -1, -1, -1
