r"""A convex polytope that grows by one vertex at a time, for expanding-polytope searches.

It starts as a tetrahedron (`start_polytope`). A new vertex w replaces the faces below it by a fan to their rim:

            w                       w
                                   / \          :::  faces whose plane w lies beyond
         .:::::.                  /   \          R   rim: the ring of edges between these faces and the others
       R ------- R      ->      R       R
      /           \            /         \

The searches differ in how they select the next vertex and in when they end.
"""

from typing import NamedTuple

import numpy as np
from numba import types

from simcore.compilation import leaf, routine
from simcore.dem.contact.search.scratch import scratch_tuple
from simcore.dem.vectors import Vec, cross, dot, length, minus, plus, read, scaled, triple, write


class Polytope(NamedTuple):
    """Closed surface of outward triangles. The arrays have a fixed capacity; numbers in use are separate arguments."""

    points: np.ndarray  # (n, 3)
    vertices: np.ndarray  # (n, 2) int64: for polyhedra, the vertices a and b whose difference is the point
    faces: np.ndarray  # (m, 3) int64
    adjacent: np.ndarray  # (m, 3) int64: face beyond the edge from corner k to k + 1
    normals: np.ndarray  # (m, 3)
    distances: np.ndarray  # (m,) signed distance of the plane from the origin; infinite for an empty slot or a sliver
    mark: np.ndarray  # (m,) int64: number of the last insertion that created the face or found it below its vertex
    stack: np.ndarray  # (m,) int64
    free: np.ndarray  # (m,) int64, empty slots
    rim: np.ndarray  # (m, 4) int64: edges of the rim: start, end, face outside, its slot
    from_vertex: np.ndarray  # (n,) int64: edge of the rim that starts there


def polytope_scratch(max_vertices, max_faces):
    """Return a function for compiled code that returns a polytope of this capacity on the stack (see `scratch`)."""
    number, index = types.float64, types.int64
    return scratch_tuple(
        Polytope,
        points=(number, max_vertices, 3),
        vertices=(index, max_vertices, 2),
        faces=(index, max_faces, 3),
        adjacent=(index, max_faces, 3),
        normals=(number, max_faces, 3),
        distances=(number, max_faces),
        mark=(index, max_faces),
        stack=(index, max_faces),
        free=(index, max_faces),
        rim=(index, max_faces, 4),
        from_vertex=(index, max_vertices),
    )


@leaf
def _set_face(polytope, k, p, q, s, size):
    """Store face k with vertices p, q, s, its unit outward normal and the signed distance of its plane."""
    points, faces, distances = polytope.points, polytope.faces, polytope.distances
    faces[k, 0], faces[k, 1], faces[k, 2] = p, q, s
    at_p, at_q, at_s = read(points, p), read(points, q), read(points, s)
    normal = cross(minus(at_q, at_p), minus(at_s, at_p))
    area = length(normal)
    if area <= 1e-13 * size * size:
        # A sliver has no reliable plane. It is never the nearest face and never below a new vertex, but it keeps the
        # polytope closed.
        write(polytope.normals, k, Vec(0.0, 0.0, 0.0))
        distances[k] = np.inf
        return
    normal = scaled(1.0 / area, normal)
    write(polytope.normals, k, normal)
    # The mean over the three vertices has about half the rounding error of a single one.
    distances[k] = dot(normal, plus(plus(at_p, at_q), at_s)) / 3.0


@leaf
def volume_of(points):
    """Return six times the signed volume of the tetrahedron of points 0 to 3."""
    apex = read(points, 0)
    return triple(minus(read(points, 1), apex), minus(read(points, 2), apex), minus(read(points, 3), apex))


@leaf
def shadows(points, p, q, s, normal):
    """Return the doubled areas, projected along n, of the origin with the sides q s, s p and p q of a triangle.

    Divided by their sum they are the barycentric weights of the origin's projection.
    """
    at_p, at_q, at_s = read(points, p), read(points, q), read(points, s)
    return triple(at_q, at_s, normal), triple(at_s, at_p, normal), triple(at_p, at_q, normal)


@routine
def start_polytope(polytope, size):
    """Store the faces of the tetrahedron of points 0 to 3 in slots 0 to 3."""
    adjacent = polytope.adjacent
    if volume_of(polytope.points) > 0.0:  # p, q, s is ordered so that its normal points away from point 3
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
        polytope.mark[k] = 0


@leaf
def nearest_face(polytope, n_faces):
    """Return (nearest face, its distance); the distance is infinite if there is no face."""
    nearest, least = 0, np.inf
    for k in range(n_faces):
        if polytope.distances[k] < least:
            least = polytope.distances[k]
            nearest = k
    return nearest, least


@leaf
def _find_rim(polytope, w, nearest, n_free, mark, size):
    """Walk from the nearest face over the connected faces that have point w above them: (edges of the rim, n_free).

    The faces are listed as free and the edges of the rim are stored, up to the capacity.
    """
    faces, adjacent, marks = polytope.faces, polytope.adjacent, polytope.mark
    stack, free, rim = polytope.stack, polytope.free, polytope.rim
    point = read(polytope.points, w)
    n_rim, n_stack = 0, 1
    stack[0] = nearest
    marks[nearest] = mark
    free[n_free] = nearest
    n_free += 1
    while n_stack > 0:
        n_stack -= 1
        face = stack[n_stack]
        for k in range(3):
            other = adjacent[face, k]
            if marks[other] == mark:
                continue
            if dot(read(polytope.normals, other), point) - polytope.distances[other] > 1e-15 * size:
                marks[other] = mark
                stack[n_stack] = other
                n_stack += 1
                free[n_free] = other
                n_free += 1
            elif n_rim < len(faces):
                after = faces[face, (k + 1) % 3]
                slot = 0
                while slot < 2 and faces[other, slot] != after:
                    slot += 1
                rim[n_rim, 0] = faces[face, k]
                rim[n_rim, 1] = after
                rim[n_rim, 2] = other
                rim[n_rim, 3] = slot
                n_rim += 1
    return n_rim, n_free


@leaf
def _is_ring(polytope, n_rim):
    """Return whether the n_rim edges of the rim form one closed ring that contains each edge once.

    The edge that starts at each vertex of the rim is stored in from_vertex.
    """
    rim, from_vertex = polytope.rim, polytope.from_vertex
    for k in range(n_rim):
        from_vertex[rim[k, 0]] = -1
        from_vertex[rim[k, 1]] = -1
    for k in range(n_rim):
        from_vertex[rim[k, 0]] = k
    edge, count = 0, 0
    while count < n_rim:
        edge = from_vertex[rim[edge, 1]]
        count += 1
        if edge <= 0:
            break
    return edge == 0 and count >= n_rim


@leaf
def _close(polytope, w, n_rim, n_faces, n_free, mark, size):
    """Add a face from every edge of the rim to point w, in free slots first: (n_faces, n_free)."""
    adjacent, rim = polytope.adjacent, polytope.rim
    first, last, edge = -1, -1, 0
    for _ in range(n_rim):
        if n_free > 0:
            n_free -= 1
            face = polytope.free[n_free]
        else:
            face = n_faces
            n_faces += 1
        _set_face(polytope, face, rim[edge, 0], rim[edge, 1], w, size)
        polytope.mark[face] = mark
        adjacent[face, 0] = rim[edge, 2]
        adjacent[rim[edge, 2], rim[edge, 3]] = face
        if last >= 0:
            adjacent[last, 1] = face
            adjacent[face, 2] = last
        else:
            first = face
        last = face
        edge = polytope.from_vertex[rim[edge, 1]]
    adjacent[last, 1] = first
    adjacent[first, 2] = last
    return n_faces, n_free


@routine
def insert_point(polytope, w, nearest, n_faces, n_free, mark, size):
    """Extend the polytope to point w beyond face `nearest`: (done, n_faces, n_free). mark: positive, new at each call.

    It is not done if the capacity is exhausted or if rounding would open the surface.
    """
    n_rim, n_freed = _find_rim(polytope, w, nearest, n_free, mark, size)
    if n_rim < 3 or n_faces + n_rim > len(polytope.faces):
        return False, n_faces, n_free
    for k in range(n_free, n_freed):
        polytope.distances[polytope.free[k]] = np.inf
    if not _is_ring(polytope, n_rim):
        return False, n_faces, n_freed
    n_faces, n_free = _close(polytope, w, n_rim, n_faces, n_freed, mark, size)
    return True, n_faces, n_free
