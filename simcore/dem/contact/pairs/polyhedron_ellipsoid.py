"""Contacts of a convex polyhedron and an ellipsoid by their common normal.

Because the ellipsoid is smooth, the contact is a point that moves continuously, also where the ellipsoid rolls from a
face over an edge; there is no patch contact. The contact point is midway between the two surfaces, on the line along
the normal through the point of the ellipsoid, because that of the polyhedron is less certain on flat faces.

The remembered contact consists of the normal and the corner, edge or face of the polyhedron that is touched. They
change little within a step. The normal of a face follows from its vertices, that of an edge or a corner from one or two
steps of Newton's iteration. If the point is still inside and no other vertex reaches farther, the result is the maximum
of f(n) = n·r − h_polyhedron(n) − h_ellipsoid(n). Otherwise the climb continues from there
(`polyhedron_ellipsoid_climb`).

A gap is concave in n and has one maximum. A maximum whose overlap is below the rolling radius of the ellipsoid is the
global one (`deep_overlap` explains why). A shallow new contact therefore needs no search; a deeper one is searched at
every step.

Either body of a pair may be the polyhedron; if it is body b, the computation exchanges the bodies.
"""

import numpy as np

from simcore.compilation import leaf, routine
from simcore.dem.contact.pair import exchanged
from simcore.dem.contact.pairs.remembered_gaps import STILL_GAP, remember_apart
from simcore.dem.contact.search.deep_overlap import least_of_mixed, rolling_radius
from simcore.dem.contact.search.ellipsoid_climb import Summit, image, solved, surface_point
from simcore.dem.contact.search.polyhedron_ellipsoid_climb import Feature, climb_feature, gap_and_vertex
from simcore.dem.shapes.polyhedra import base_direction_of, climb_from_hint, is_polyhedron, vertex_of
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

ENOUGH_GAP = 0.02  # of the pair's size: a step needs no accurate value of a wider gap
# Of the pair's size, as for ellipsoids: tangential distance of the two points that is accepted. f is flat there: its
# error is the square of this distance divided by the radius of curvature.
BESIDE = 1e-11
CHECK_TOLERANCE = 1e-12  # of the pair's size: by how much another vertex may reach farther; rounding is about 1e-15
INSIDE_TOLERANCE = 1e-9  # barycentric
# Maximum number of Newton steps, after which the climb takes over (docs/explanation/constants_contact.md)
ITERATIONS = 5


@routine
def search_normal(shapes, bodies, pair, enough):
    """Search the feature at the global maximum of f, of polyhedron a and ellipsoid b.

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
    """Find the contact of the ellipsoid with a corner of the polyhedron, from n: Summit of f of that corner."""
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
    """Find the contact of the ellipsoid with an edge of the polyhedron from a corner, from n: Summit of f of the edge.

    It is also not converged if the point of the ellipsoid is beyond the ends of the edge.
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
    """Find the contact of the ellipsoid with a face of the polyhedron, on the side of n: Summit of f.

    edge, other: two edges of the face from the corner. The result is not converged if the point of the ellipsoid is
    beyond the sides of the face.
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
    """Check whether polyhedron a still touches ellipsoid b with its vertices a (3): the feature there, from n.

    It is not converged if another vertex reaches farther or the point of the ellipsoid has left the corner, edge or
    face.
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
    """Check candidate pair p from its remembered contact: (whether the result is certain, Contact).

    The pair is apart if the overlap is not positive. The result is not certain if there is no remembered contact, the
    overlap may not be the least one, or the climb did not converge; the pair must then be searched.
    """
    a = np.int64(contacts.facet[p, 0]), np.int64(contacts.facet[p, 1]), np.int64(contacts.facet[p, 2])
    if a[0] < 0:
        return False, Contact(0.0, ZERO, ZERO)
    normal, last = read(contacts.direction, p), contacts.overlap[p]
    swapped = not is_polyhedron(shapes, bodies, pair.a)
    ordered = pair
    if swapped:
        ordered, normal = exchanged(pair), negative(normal)
    enough, top = np.inf, Feature(0.0, normal, False, ZERO, a[0], a[1], a[2])
    if contacts.touching[p] != 0:
        top = check_feature(shapes, bodies, ordered, a, normal)
    else:  # a direction that shows much of the gap of the last search suffices
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
    """Search the contact of candidate pair p, without a remembered contact."""
    swapped = not is_polyhedron(shapes, bodies, pair.a)
    ordered = pair
    if swapped:
        ordered = exchanged(pair)
    top = search_normal(shapes, bodies, ordered, ENOUGH_GAP * pair.size)
    contact = _conclude(bodies, contacts, p, pair, swapped, top)
    if not top.value >= -rolling_radius(bodies.form_matrix, bodies.rotation, ordered.b):
        contacts.facet[p, 0] = -1  # so that the next step searches again
    return contact


@leaf
def _conclude(bodies, contacts, p, pair, swapped, top):
    """Return the contact of the feature at the maximum of f, whose bodies are exchanged if swapped; remember a gap."""
    contacts.facet[p, 0], contacts.facet[p, 1], contacts.facet[p, 2] = top.a0, top.a1, top.a2
    ordered, normal = pair, top.normal
    if swapped:
        ordered, normal = exchanged(pair), negative(normal)
    on_ellipsoid, _ = surface_point(bodies.form_matrix, ordered.b, top.normal)
    # Vector from the centre of the polyhedron to the middle between the two points, which are `overlap` apart
    point = minus_scaled(minus(ordered.offset, on_ellipsoid), 0.5 * top.value, top.normal)
    if swapped:
        point = minus(point, ordered.offset)
    if top.value >= 0.0:
        remember_apart(bodies, contacts, p, pair, top.value)
    return Contact(-top.value, normal, point)
