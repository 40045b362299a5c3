"""EPA: the facet of the Minkowski difference M next to the origin (van den Bergen 2001)."""

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

MAX_VERTICES = 128  # a capacity (docs/constants_contact.md#capacities-and-bounds-of-iterations)
TOLERANCE = 1e-12  # of the pair's size: how far M may reach beyond a facet that counts as its own
FLAT = 1e-9  # of the size³: a tetrahedron of less volume is no start

_take_polytope = polytope_scratch(MAX_VERTICES, 2 * MAX_VERTICES)


class FacetDistance(NamedTuple):
    """The facet of M next to the origin."""

    overlap: float  # [m], negative: a certain gap along the normal
    normal: Vec  # from a to b
    facet: Facet
    lead: float  # [m], by which other facets show more than this one, as far as the search saw them


@leaf
def _farther(shapes, f, a, b, normal, point):
    """Of the supports along n and −n the one farther from the plane through the point."""
    above = support(shapes, f, a, b, normal)
    below = support(shapes, f, a, b, negative(normal))
    if dot(normal, minus(above.point, point)) >= -dot(normal, minus(below.point, point)):
        return above
    return below


@routine
def _start_tetrahedron(shapes, f, a, b, normal, polytope):
    """Points 0 to 3 from a direction: along it and back, then as far sideways as M reaches."""
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
    """Least barycentric weight of the origin's projection along n on face k: negative outside."""
    faces = polytope.faces
    u, v, w = shadows(polytope.points, faces[k, 0], faces[k, 1], faces[k, 2], normal)
    return min(u, v, w) / (u + v + w)


@leaf
def _lowest_corner(polytope, k, normal):
    """Least height along n of the corners of face k."""
    lowest = np.inf
    for corner in range(3):
        lowest = min(lowest, along(polytope.points, polytope.faces[k, corner], normal))
    return lowest


@routine
def _facet_below(polytope, n_faces, nearest, tolerance):
    """Of the faces in the plane of the nearest one, that which contains the origin's projection.

    A facet of M is a triangle only by chance: that of two edges is a parallelogram, and EPA meets its triangles in
    any order.
    """
    distances, normal = polytope.distances, read(polytope.normals, nearest)
    best, largest = nearest, _least_weight(polytope, nearest, normal)
    if largest >= 0.0:
        return best
    for k in range(n_faces):
        if distances[k] > distances[nearest] + tolerance:
            continue
        # A face as near may also lie elsewhere (concentric bodies): then its corners are not in the plane.
        if _lowest_corner(polytope, k, normal) < distances[nearest] - 4.0 * tolerance:
            continue
        weight = _least_weight(polytope, k, normal)
        if weight > largest:
            best, largest = k, weight
    return best


@leaf
def _lead(polytope, n_faces, least, normal, tolerance):
    """Distance of the nearest face that is not in the plane of normal n at `least`, less that."""
    second = np.inf
    for k in range(n_faces):
        if polytope.distances[k] < second and _lowest_corner(polytope, k, normal) < least - 4.0 * tolerance:
            second = polytope.distances[k]
    return max(second - least, 0.0)


@leaf
def _corners(polytope, k):
    """The vertices of a and b that the corners of face k come from."""
    vertices, p, q, s = polytope.vertices, polytope.faces[k, 0], polytope.faces[k, 1], polytope.faces[k, 2]
    return Facet(vertices[p, 0], vertices[q, 0], vertices[s, 0], vertices[p, 1], vertices[q, 1], vertices[s, 1])


@routine
def expand(shapes, f, a, b, normal, simplex, n_simplex):
    """The facet of M next to the origin: (complete, FacetDistance), in the axes of the frame f.

    Starts from GJK's simplex where that is a tetrahedron, else from the direction n and vertices a, b. Not complete:
    the polytope ran out of room or could not be kept closed. lead: of the polytope's next face.
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
