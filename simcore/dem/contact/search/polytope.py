"""A convex polytope that grows by one vertex at a time, as expanding-polytope searches need it."""

from typing import NamedTuple

import numpy as np

from simcore.compilation import leaf, routine


class Polytope(NamedTuple):
    """Closed triangle mesh, its faces outward. Lengths are capacities; how much is in use goes beside it."""

    points: np.ndarray  # (n, 3)
    faces: np.ndarray  # (m, 3) int64
    adjacent: np.ndarray  # (m, 3) int64: face beyond the edge from corner k to k + 1
    normals: np.ndarray  # (m, 3)
    distances: np.ndarray  # (m,) of the plane from the origin; infinite: the slot is empty, or a sliver's
    seen: np.ndarray  # (m,) int64
    stack: np.ndarray  # (m,) int64
    free: np.ndarray  # (m,) int64, empty slots
    rim: np.ndarray  # (m, 4) int64: edges between what a new vertex sees and does not: start, end, face, its slot
    from_vertex: np.ndarray  # (n,) int64


@leaf
def _set_face(polytope, k, p, q, s, size):
    """Face k of vertices p, q, s: unit outward normal and signed distance of its plane from the origin."""
    points, faces, normals, distances = polytope.points, polytope.faces, polytope.normals, polytope.distances
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
def volume_of(points):
    """Six times the signed volume of the tetrahedron of points 0 to 3."""
    ax, ay, az = points[1, 0] - points[0, 0], points[1, 1] - points[0, 1], points[1, 2] - points[0, 2]
    bx, by, bz = points[2, 0] - points[0, 0], points[2, 1] - points[0, 1], points[2, 2] - points[0, 2]
    cx, cy, cz = points[3, 0] - points[0, 0], points[3, 1] - points[0, 1], points[3, 2] - points[0, 2]
    return (ay * bz - az * by) * cx + (az * bx - ax * bz) * cy + (ax * by - ay * bx) * cz


@routine
def start_polytope(polytope, size):
    """Faces of the tetrahedron of points 0 to 3, slots 0 to 3."""
    adjacent = polytope.adjacent
    if volume_of(polytope.points) > 0.0:  # p, q, s run outward, seen from outside, where 3 lies below them
        p, q, s = 0, 2, 1
    else:
        p, q, s = 0, 1, 2
    _set_face(polytope, 0, p, q, s, size)
    _set_face(polytope, 1, q, p, 3, size)
    _set_face(polytope, 2, s, q, 3, size)
    _set_face(polytope, 3, p, s, 3, size)
    for k in range(3):
        adjacent[0, k] = k + 1
        adjacent[k + 1, 0] = 0
        adjacent[k + 1, 1] = 1 + (k + 2) % 3
        adjacent[k + 1, 2] = 1 + (k + 1) % 3
    for k in range(4):
        polytope.seen[k] = 0


@leaf
def nearest_face(polytope, n_faces):
    """(face, its distance); an infinite distance where there is none."""
    nearest, least = 0, np.inf
    for k in range(n_faces):
        if polytope.distances[k] < least:
            least = polytope.distances[k]
            nearest = k
    return nearest, least


@routine
def insert_point(polytope, w, nearest, n_faces, n_free, mark, size):
    """Grow the hull to point w beyond face `nearest`: (done, n_faces, n_free). mark: positive, new at each call.

    Not done where there is no room, or where rounding would tear the mesh.
    """
    faces, adjacent, normals, distances = polytope.faces, polytope.adjacent, polytope.normals, polytope.distances
    seen, stack, free, rim, from_vertex = (
        polytope.seen, polytope.stack, polytope.free, polytope.rim, polytope.from_vertex,
    )  # fmt: skip
    x, y, z = polytope.points[w, 0], polytope.points[w, 1], polytope.points[w, 2]
    capacity = len(faces)
    # Faces that the point sees, found by walking from the nearest, so that they hang together.
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
            elif n_rim < capacity:
                after = faces[face, (k + 1) % 3]
                slot = 0
                while slot < 2 and faces[other, slot] != after:
                    slot += 1
                rim[n_rim, 0] = faces[face, k]
                rim[n_rim, 1] = after
                rim[n_rim, 2] = other
                rim[n_rim, 3] = slot
                n_rim += 1
    if n_rim < 3 or n_faces + n_rim > capacity:
        return False, n_faces, n_free
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
        return False, n_faces, n_free
    first = -1
    last = -1
    for _ in range(n_rim):
        if n_free > 0:
            n_free -= 1
            face = free[n_free]
        else:
            face = n_faces
            n_faces += 1
        _set_face(polytope, face, rim[edge, 0], rim[edge, 1], w, size)
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
    return True, n_faces, n_free
