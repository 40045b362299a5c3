"""Convex polyhedron against ellipsoid: by the common normal, from the remembered contact or from nothing.

The smooth body makes the contact a point that moves continuously, also where it rolls from a face over an edge: there
is no patch. The ellipsoid's point along the normal is where they touch; the polyhedron's is less certain on flat faces.

A pair remembers its normal and the corner, edge or face of the polyhedron that is touched. Within a step they change
little: the normal of a face follows from its vertices, of an edge or a corner by one or two steps of Newton's
iteration. Where the point still lies inside and no other vertex reaches farther, that is again the maximum of
f(n) = n·r − h_polyhedron(n) − h_ellipsoid(n). Else the climb goes on from there (`polyhedron_ellipsoid_climb`).

A gap is concave in n and has one maximum. A maximum that is an overlap below the ellipsoid's rolling radius is the
global one (`deep_overlap` says why), so a new contact needs no search as long as it is shallow; a deeper one is
searched at every step.

Either body of a pair may be the polyhedron; where it is body b, all is computed with the bodies exchanged.
"""

import numpy as np

from simcore.compilation import leaf, routine
from simcore.dem.contact.pair import exchanged
from simcore.dem.contact.pairs.gap_memory import STILL_GAP, remember_apart
from simcore.dem.contact.search.deep_overlap import least_of_mixed, rolling_radius
from simcore.dem.contact.search.ellipsoid_climb import Summit, image, solved, surface_point
from simcore.dem.contact.search.polyhedron_ellipsoid_climb import Feature, climb_feature, gap_and_vertex
from simcore.dem.shapes.hulls import base_direction_of, climb_from_hint, is_hull, vertex_of
from simcore.dem.vectors import (
    ZERO,
    Contact,
    basis,
    cross,
    direction_of,
    dot,
    length,
    minus,
    minus_scaled,
    negative,
    over,
    plus,
    plus_scaled,
    read,
    scaled,
    squared,
    triple,
)

ENOUGH_GAP = 0.02  # of the pair's size: a step needs no digits of a wider gap
# Of the pair's size, as of ellipsoids: tangential distance of the two points that is left. f is flat there: its error
# is the square of that over the radius of curvature.
BESIDE = 1e-11
CHECK_TOLERANCE = 1e-12  # of the pair's size: by how much another vertex may reach farther; rounding is some 1e-15
INSIDE_TOLERANCE = 1e-9  # barycentric
ITERATIONS = 5  # of Newton's iteration; more is a case for the climb (docs/constants_contact.md)


@routine
def search_normal(shapes, bodies, pair, enough):
    """The feature at the global maximum of f from nothing, of polyhedron a and ellipsoid b.

    A gap f > enough ends the search early.
    """
    normal = direction_of(pair.offset)
    d = base_direction_of(bodies, pair.a, normal)
    v = climb_from_hint(shapes, bodies.shape[pair.a], d.x, d.y, d.z)
    top = climb_feature(shapes, bodies, pair, v, normal, enough)
    certain = rolling_radius(bodies.form_matrix, bodies.rotation, pair.b)
    if top.value > enough or (top.converged and top.value >= -certain):
        return top
    top = least_of_mixed(shapes, bodies, pair, certain, top)
    return Feature(top.value, top.normal, top.converged, top.point, top.a0, -1, -1)


@leaf
def on_corner(m, pair, corner, normal):
    """The ellipsoid on a corner of the polyhedron, from n: Summit of that corner's f."""
    offset = minus(pair.offset, corner)
    for k in range(ITERATIONS + 1):
        point, height = surface_point(m, pair.b, normal)
        slope = minus(offset, point)
        value = dot(slope, normal)
        p, q = basis(normal)
        gp, gq = dot(slope, p), dot(slope, q)
        if abs(gp) + abs(gq) <= BESIDE * pair.size:
            return Summit(value, normal, True)
        at_p, at_q = dot(point, p), dot(point, q)
        image_p, image_q = image(m, pair.b, p), image(m, pair.b, q)
        kpp = (dot(p, image_p) - at_p * at_p) / height + value
        kpq = (dot(q, image_p) - at_p * at_q) / height
        kqq = (dot(q, image_q) - at_q * at_q) / height + value
        sp, sq = solved(kpp, kqq, kpq, gp, gq)
        step = plus_scaled(scaled(sp, p), sq, q)
        if k == ITERATIONS or not squared(step) < 1e-2:
            break
        normal = direction_of(plus(normal, step))
    return Summit(0.0, normal, False)


@leaf
def on_edge(m, pair, corner, edge, normal):
    """The ellipsoid on an edge of the polyhedron that begins at a corner, from n: Summit of f about the edge.

    Not converged either where the ellipsoid's point is beyond the ends of the edge.
    """
    offset, reach = minus(pair.offset, corner), length(edge)
    for k in range(ITERATIONS + 1):
        normal = direction_of(minus_scaled(normal, dot(normal, edge) / (reach * reach), edge))
        point, height = surface_point(m, pair.b, normal)
        slope = minus(offset, point)
        value = dot(slope, normal)
        p = over(cross(edge, normal), reach)
        gp = dot(slope, p)
        if abs(gp) <= BESIDE * pair.size:
            w = dot(slope, edge) / (reach * reach)
            return Summit(value, normal, min(w, 1.0 - w) >= -INSIDE_TOLERANCE)
        at_p = dot(point, p)
        step = scaled(gp / ((dot(p, image(m, pair.b, p)) - at_p * at_p) / height + value), p)
        if k == ITERATIONS or not squared(step) < 1e-2:
            break
        normal = direction_of(plus(normal, step))
    return Summit(0.0, normal, False)


@leaf
def on_face(m, pair, corner, edge, other, normal):
    """The ellipsoid on a face of the polyhedron with two edges that begin at a corner: Summit of f, on n's side.

    Not converged where the ellipsoid's point is beyond the sides of the face.
    """
    across = cross(edge, other)
    area = length(across)
    if not area > 1e-13 * pair.size * pair.size:
        return Summit(0.0, normal, False)
    if dot(across, normal) < 0.0:
        area = -area
    normal = over(across, area)
    point, _ = surface_point(m, pair.b, normal)
    slope = minus(minus(pair.offset, corner), point)
    w1, w2 = triple(slope, other, normal) / area, triple(edge, slope, normal) / area
    return Summit(dot(slope, normal), normal, min(w1, min(w2, 1.0 - w1 - w2)) >= -INSIDE_TOLERANCE)


@routine
def check_feature(shapes, bodies, pair, a, normal):
    """Whether polyhedron a still touches ellipsoid b with its vertices a (3): the feature there, from n.

    Not converged: another vertex reaches farther, or the ellipsoid's point has left the corner, edge or face.
    """
    m, a0, a1, a2 = bodies.form_matrix, a[0], a[1], a[2]
    corner = vertex_of(shapes, bodies, pair.a, a0)
    if a1 < 0:
        top = on_corner(m, pair, corner, normal)
    elif a2 < 0:
        top = on_edge(m, pair, corner, minus(vertex_of(shapes, bodies, pair.a, a1), corner), normal)
    else:
        edge = minus(vertex_of(shapes, bodies, pair.a, a1), corner)
        other = minus(vertex_of(shapes, bodies, pair.a, a2), corner)
        top = on_face(m, pair, corner, edge, other, normal)
    if not top.converged:
        return Feature(0.0, top.normal, False, ZERO, a0, a1, a2)
    value, _ = gap_and_vertex(shapes, bodies, pair, a0, top.normal)
    return Feature(value, top.normal, top.value - value <= CHECK_TOLERANCE * pair.size, ZERO, a0, a1, a2)


@leaf
def recheck(shapes, bodies, contacts, p, pair):
    """Candidate pair p from its remembered contact: (whether that is certain, Contact).

    The pair is apart where the overlap is not positive. Not certain: nothing is remembered, the overlap need not be the
    least, or the climb did not converge; then the pair has to be searched.
    """
    a = np.int64(contacts.facet[p, 0]), np.int64(contacts.facet[p, 1]), np.int64(contacts.facet[p, 2])
    if a[0] < 0:
        return False, Contact(0.0, ZERO, ZERO)
    normal, last = read(contacts.direction, p), contacts.overlap[p]
    swapped = not is_hull(shapes, bodies, pair.a)
    ordered = pair
    if swapped:
        ordered, normal = exchanged(pair), negative(normal)
    enough, top = np.inf, Feature(0.0, normal, False, ZERO, a[0], a[1], a[2])
    if contacts.touching[p] != 0:
        top = check_feature(shapes, bodies, ordered, a, normal)
    else:  # a direction that still shows much of the gap searched last needs no better one
        enough = -STILL_GAP * last
    if not top.converged:
        top = climb_feature(shapes, bodies, ordered, a[0], top.normal, enough)
    certain = top.value > 0.0 or (
        top.converged and top.value >= -rolling_radius(bodies.form_matrix, bodies.rotation, ordered.b)
    )
    contact = _conclude(bodies, contacts, p, pair, swapped, top)
    overlap = contact.overlap
    if top.value > enough:
        overlap = min(overlap, last)
    return certain, Contact(overlap, contact.normal, contact.point)


@routine
def search_contact(shapes, bodies, contacts, p, pair):
    """Contact of candidate pair p, from nothing."""
    swapped = not is_hull(shapes, bodies, pair.a)
    ordered = pair
    if swapped:
        ordered = exchanged(pair)
    top = search_normal(shapes, bodies, ordered, ENOUGH_GAP * pair.size)
    contact = _conclude(bodies, contacts, p, pair, swapped, top)
    if not top.value >= -rolling_radius(bodies.form_matrix, bodies.rotation, ordered.b):
        contacts.facet[p, 0] = -1  # the next step would not trust it
    return contact


@leaf
def _conclude(bodies, contacts, p, pair, swapped, top):
    """Contact from the feature at the maximum of f, of the bodies exchanged where swapped. A gap is remembered."""
    contacts.facet[p, 0], contacts.facet[p, 1], contacts.facet[p, 2] = top.a0, top.a1, top.a2
    ordered, normal = pair, top.normal
    if swapped:
        ordered, normal = exchanged(pair), negative(normal)
    on_ellipsoid, _ = surface_point(bodies.form_matrix, ordered.b, top.normal)
    # From the polyhedron's centre to the middle between the two points, which are an overlap apart
    point = minus_scaled(minus(ordered.offset, on_ellipsoid), 0.5 * top.value, top.normal)
    if swapped:
        point = minus(point, ordered.offset)
    if top.value >= 0.0:
        remember_apart(bodies, contacts, p, pair, top.value)
    return Contact(-top.value, normal, point)
