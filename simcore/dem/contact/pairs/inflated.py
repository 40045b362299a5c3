"""Contacts of two polyhedra as the program of Rettinger et al. (2022) finds them; only for a comparison with it.

Its GJK and EPA (waLBerla: `GeneralContactDetection.h`, `EPA.cpp`) inflate both bodies by MARGIN, an absolute length, so
that the Minkowski difference M has rounded edges and corners. They create at most MAX_FACES faces, including faces that
are removed later. If these do not suffice, the result is the face of the polytope nearest to the origin, which is
inside M: it shows too small an overlap along another normal, or none at all, more often the longer the grains are. See
`python -m benchmarks.studies.inflated`, results/reference/inflated.csv.
"""

from typing import NamedTuple

import numpy as np
from numba import types

from simcore.compilation import leaf, routine
from simcore.dem.contact.search.pair_frame import Support, frame_of, support, support_afar, vertex_a, vertex_b
from simcore.dem.contact.search.polytope import (
    insert_point,
    nearest_face,
    polytope_scratch,
    shadows,
    start_polytope,
)
from simcore.dem.contact.search.scratch import scratch
from simcore.dem.contact.search.simplex import (
    along,
    copy_point,
    keep_weighted,
    nearest_on_simplex,
    put_support,
    take_simplex,
    weighted_point,
)
from simcore.dem.vectors import (
    ZERO,
    Contact,
    Vec,
    into_axes,
    length,
    negative,
    out_of_axes,
    over,
    plus,
    plus_scaled,
    read,
    scaled,
)

MARGIN = 1e-4  # [m], of each body
MAX_FACES = 100  # maximum number of faces created
TOLERANCE = 1e-6  # of the distance from the origin to the rounded M
GJK_ITERATIONS = 64  # an upper bound that is not reached in practice

_VERTICES = 4 + MAX_FACES // 3

# The capacity is twice MAX_FACES, because the faces of the last insertion are counted after it is complete.
_take_polytope = polytope_scratch(_VERTICES, 2 * MAX_FACES)
_take_weights = scratch(types.float64, 4)


class Nearest(NamedTuple):
    """The face of the polytope in the rounded M that is nearest to the origin."""

    distance: float  # [m]
    normal: Vec
    p: int  # points of the face
    q: int
    s: int


@leaf
def _rounded(m, normal):
    """Return the support point of the rounded M along the unit vector n, from that of M."""
    return Support(m.a, m.b, plus_scaled(m.point, 2.0 * MARGIN, normal))


@routine
def _enclose_origin(shapes, f, normal, simplex):
    """Search with GJK from direction n for a tetrahedron of support points around the origin; return whether it exists.

    The tetrahedron is stored in the simplex.
    """
    weights, points = _take_weights(), simplex.points
    put_support(simplex, 0, _rounded(support_afar(shapes, f, normal), normal))
    nearest, n = read(points, 0), 1
    for _ in range(GJK_ITERATIONS):
        distance = length(nearest)
        if not distance > 0.0:
            return False
        normal = over(negative(nearest), distance)
        put_support(simplex, n, _rounded(support_afar(shapes, f, normal), normal))
        if along(points, n, normal) < 0.0:
            return False
        if nearest_on_simplex(points, n + 1, weights):
            return True
        nearest = weighted_point(points, weights, n + 1)
        n = keep_weighted(simplex, weights, n + 1)
        if n == 4:  # the origin is on a side, to rounding
            return True
    return False


@leaf
def _count_new(polytope, n_faces, mark):
    """Return the number of faces that the insertion with this mark created."""
    new = 0
    for k in range(n_faces):
        if polytope.mark[k] == mark and polytope.distances[k] < np.inf:
            new += 1
    return new


@leaf
def _grow(shapes, f, polytope):
    """Grow the polytope inside the rounded M from its tetrahedron until it is accurate, or too large: Nearest."""
    start_polytope(polytope, f.size)
    n_faces, n_free, made = 4, 0, 4
    upper, nearest = np.inf, Nearest(0.0, ZERO, 0, 0, 0)
    for mark in range(1, _VERTICES - 3):
        face, distance = nearest_face(polytope, n_faces)
        if not (distance < np.inf and distance <= upper):
            break
        normal, p = read(polytope.normals, face), polytope.faces[face, 0]
        nearest = Nearest(distance, normal, p, polytope.faces[face, 1], polytope.faces[face, 2])
        m = support(shapes, f, polytope.vertices[p, 0], polytope.vertices[p, 1], normal)
        put_support(polytope, 3 + mark, _rounded(m, normal))
        upper = min(upper, along(polytope.points, 3 + mark, normal))
        if upper <= (1.0 + TOLERANCE) * distance:
            break
        done, n_faces, n_free = insert_point(polytope, 3 + mark, face, n_faces, n_free, mark, f.size)
        if not done:
            break
        made += _count_new(polytope, n_faces, mark)
        if made > MAX_FACES:
            break
    return nearest


@leaf
def _contact_point(shapes, f, polytope, nearest):
    """Return the contact point: midway between the points of a and b (not inflated) of the origin's projection."""
    vertices, p, q, s = polytope.vertices, nearest.p, nearest.q, nearest.s
    u, v, w = shadows(polytope.points, p, q, s, nearest.normal)
    point = f.offset
    for corner, weight in ((p, u / (u + v + w)), (q, v / (u + v + w)), (s, w / (u + v + w))):
        both = plus(vertex_a(shapes, f, vertices[corner, 0]), vertex_b(shapes, f, vertices[corner, 1]))
        point = plus_scaled(point, weight, both)
    return scaled(0.5, point)


@routine
def search_inflated(shapes, bodies, pair):
    """Search the contact of an overlapping pair: (whether there is a contact, Contact)."""
    simplex, polytope, rotation = take_simplex(), _take_polytope(), bodies.rotation
    f = frame_of(bodies, pair)
    if not _enclose_origin(shapes, f, into_axes(rotation, pair.a, Vec(0.0, 0.6, 0.8)), simplex):
        return False, Contact(0.0, ZERO, ZERO)
    for k in range(4):
        copy_point(polytope, k, simplex, k)
    nearest = _grow(shapes, f, polytope)
    overlap = nearest.distance - 2.0 * MARGIN
    if not overlap > 0.0:
        return False, Contact(0.0, ZERO, ZERO)
    point = out_of_axes(rotation, pair.a, _contact_point(shapes, f, polytope, nearest))
    return True, Contact(overlap, out_of_axes(rotation, pair.a, nearest.normal), point)
