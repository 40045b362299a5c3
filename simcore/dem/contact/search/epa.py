"""EPA: search for the facet of the Minkowski difference M that is nearest to the origin (van den Bergen 2001)."""

from typing import NamedTuple

import numpy as np

from simcore.compilation import leaf, routine
from simcore.dem.contact.search.pair_frame import Facet, support
from simcore.dem.contact.search.polytope import (
    insert_point,
    nearest_face,
    polytope_scratch,
    shadows,
    start_polytope,
    volume_of,
)
from simcore.dem.contact.search.simplex import along, copy_point, edge_of, put_support
from simcore.dem.vectors import Vec, cross, dot, length, minus, negative, over, read, sideways

MAX_VERTICES = 128  # a capacity (docs/explanation/constants_contact.md#capacities-and-bounds-of-iterations)
TOLERANCE = 1e-12  # of the pair's size: how far M may extend beyond a face that is accepted as a facet of M
FLAT = 1e-9  # of the size³: a tetrahedron with less than this as six times its volume is not used as a start

_take_polytope = polytope_scratch(MAX_VERTICES, 2 * MAX_VERTICES)


class FacetDistance(NamedTuple):
    """The facet of M nearest to the origin."""

    overlap: float  # [m], negative: a certain gap along the normal
    normal: Vec  # from a to b
    facet: Facet
    lead: float  # [m], overlap of the next facet minus this one, among the faces of the search


@leaf
def _farther(shapes, f, a, b, normal, point):
    """Return the support along n or −n, whichever is farther from the plane through the point."""
    above = support(shapes, f, a, b, normal)
    below = support(shapes, f, a, b, negative(normal))
    if dot(normal, minus(above.point, point)) >= -dot(normal, minus(below.point, point)):
        return above
    return below


@routine
def _start_tetrahedron(shapes, f, a, b, normal, polytope):
    """Store support points 0 to 3: along the direction and against it, then the farther ones sideways."""
    m = support(shapes, f, a, b, normal)
    put_support(polytope, 0, m)
    m = support(shapes, f, m.a, m.b, negative(normal))
    put_support(polytope, 1, m)
    points = polytope.points
    side = sideways(edge_of(points, 0, 1))
    m = _farther(shapes, f, m.a, m.b, over(side, length(side)), read(points, 0))
    put_support(polytope, 2, m)
    side = cross(edge_of(points, 0, 1), edge_of(points, 0, 2))
    m = _farther(shapes, f, m.a, m.b, over(side, length(side)), read(points, 0))
    put_support(polytope, 3, m)


@leaf
def _least_weight(polytope, k, normal):
    """Return the least barycentric weight of the origin's projection along n on face k; negative outside."""
    faces = polytope.faces
    u, v, w = shadows(polytope.points, faces[k, 0], faces[k, 1], faces[k, 2], normal)
    return min(u, v, w) / (u + v + w)


@leaf
def _lowest_corner(polytope, k, normal):
    """Return the least height along n of the corners of face k."""
    lowest = np.inf
    for corner in range(3):
        lowest = min(lowest, along(polytope.points, polytope.faces[k, corner], normal))
    return lowest


@routine
def _facet_below(polytope, n_faces, nearest, tolerance):
    """Return the face that contains the origin's projection, among the faces in the plane of the nearest one.

    A facet of M need not be a triangle: the facet of two edges is a parallelogram, of which EPA may find the other
    triangle first.
    """
    distances, normal = polytope.distances, read(polytope.normals, nearest)
    best, largest = nearest, _least_weight(polytope, nearest, normal)
    if largest >= 0.0:
        return best
    for k in range(n_faces):
        if distances[k] > distances[nearest] + tolerance:
            continue
        # An equally near face may be in another plane (concentric bodies); its corners are then not in this plane.
        if _lowest_corner(polytope, k, normal) < distances[nearest] - 4.0 * tolerance:
            continue
        weight = _least_weight(polytope, k, normal)
        if weight > largest:
            best, largest = k, weight
    return best


@leaf
def _lead(polytope, n_faces, least, normal, tolerance):
    """Return the distance of the nearest face outside the plane with normal n at distance `least`, minus `least`."""
    second = np.inf
    for k in range(n_faces):
        if polytope.distances[k] < second and _lowest_corner(polytope, k, normal) < least - 4.0 * tolerance:
            second = polytope.distances[k]
    return max(second - least, 0.0)


@leaf
def _corners(polytope, k):
    """Return the vertices of a and b whose differences are the corners of face k."""
    vertices, p, q, s = polytope.vertices, polytope.faces[k, 0], polytope.faces[k, 1], polytope.faces[k, 2]
    return Facet(vertices[p, 0], vertices[q, 0], vertices[s, 0], vertices[p, 1], vertices[q, 1], vertices[s, 1])


@routine
def expand(shapes, f, a, b, normal, simplex, n_simplex):
    """Search the facet of M nearest to the origin: (complete, FacetDistance), in the axes of the frame f.

    The search starts from the simplex of GJK if that is a tetrahedron, else from the direction n and vertices a, b. It
    is not complete if the capacity of the polytope is exhausted or rounding would open its surface. The lead is that
    of the next face of the polytope.
    """
    polytope = _take_polytope()
    volume = 0.0
    if n_simplex == 4:
        for k in range(4):
            copy_point(polytope, k, simplex, k)
        volume = volume_of(polytope.points)
    if not abs(volume) > FLAT * f.size**3:
        _start_tetrahedron(shapes, f, a, b, normal, polytope)
    start_polytope(polytope, f.size)
    n_faces, n_free = 4, 0
    tolerance = TOLERANCE * f.size

    for mark in range(1, MAX_VERTICES - 3):
        nearest, least = nearest_face(polytope, n_faces)
        if not least < np.inf:
            break
        normal = read(polytope.normals, nearest)
        start = polytope.faces[nearest, 0]
        m = support(shapes, f, polytope.vertices[start, 0], polytope.vertices[start, 1], normal)
        reach = dot(m.point, normal)
        if reach - least <= tolerance:
            facet = _corners(polytope, _facet_below(polytope, n_faces, nearest, tolerance))
            return True, FacetDistance(reach, normal, facet, _lead(polytope, n_faces, least, normal, tolerance))
        w = 3 + mark
        put_support(polytope, w, m)
        done, n_faces, n_free = insert_point(polytope, w, nearest, n_faces, n_free, mark, f.size)
        if not done:
            break
    return False, FacetDistance(0.0, normal, Facet(-1, -1, -1, -1, -1, -1), 0.0)
