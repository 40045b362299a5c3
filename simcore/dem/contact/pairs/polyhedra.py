"""Contacts of two convex polyhedra, from the remembered contact.

In one step a grain moves about 1e-4 of its size. The remembered contact of an overlapping pair is the three support
pairs of its facet of the Minkowski difference. The check computes the plane of the facet again and climbs the edge
graphs from its vertices. If no support point is beyond the plane, the projection of the origin is well inside and the
overlap is not so deep that the far side may be nearer, the facet is taken as the minimum of the overlap; the test of
the far side is no proof (docs/explanation/constants_contact.md). Otherwise the pair is searched anew. For a pair apart
the simplex nearest to the origin is remembered. The pair is not checked before the bodies can have closed the gap; the
same simplex then mostly still shows a gap.
"""

from typing import NamedTuple

import numpy as np
from numba import types

from simcore.compilation import leaf, routine
from simcore.dem.contact.pairs.remembered_gaps import STILL_GAP, remember_apart, still_apart
from simcore.dem.contact.search.pair_frame import Facet
from simcore.dem.contact.search.polyhedra import search_pair, world_difference, world_support
from simcore.dem.contact.search.scratch import scratch
from simcore.dem.contact.search.simplex import segment_weights, triangle_weights
from simcore.dem.shapes.polyhedra import hint_along, vertex_of
from simcore.dem.vectors import (
    ZERO,
    Contact,
    Vec,
    across,
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
    write,
)

_take_points = scratch(types.float64, 4, 3)
CHECK_TOLERANCE = 1e-11  # of the pair's size; wider than that of the search, so that results of the search pass
INSIDE_TOLERANCE = 1e-9  # barycentric
GAP_SLACK = 0.1  # a step needs a certain gap only; its last tenth is not worth further iterations
# Distance in units of the overlap: if the projection of the origin is farther from the sides, no facet on this side of
# the difference is nearer (docs/explanation/constants_contact.md).
CERTAIN_REACH = 2.0

INVALID, APART, OVERLAPPING, UNCERTAIN = 0, 1, 2, 3


class Judgement(NamedTuple):
    """The result of the check of a remembered facet."""

    verdict: int  # INVALID, APART (the overlap is minus a certain gap), OVERLAPPING or UNCERTAIN
    contact: Contact


class SimplexGap(NamedTuple):
    """The gap of a pair apart, from the simplex nearest to the origin."""

    gap: float  # [m], certain
    distance: float  # [m], of the simplex: an upper bound of the gap
    normal: Vec


@leaf
def facet_contact(shapes, bodies, pair, facet):
    """Check a remembered facet: Judgement.

    UNCERTAIN: the facet is a local minimum of the overlap, but another facet may show less. Either the projection of
    the origin is nearer to a side of the facet than CERTAIN_REACH times the overlap, or the centres of the bodies are
    nearer to each other along the normal than the overlap, so that the far side may be the nearest one.
    """
    at_0, at_1, at_2 = (
        vertex_of(shapes, bodies, pair.a, facet.a0),
        vertex_of(shapes, bodies, pair.a, facet.a1),
        vertex_of(shapes, bodies, pair.a, facet.a2),
    )
    # The corners p, q, s of the facet, its sides from p, and its normal
    p = minus(minus(at_0, vertex_of(shapes, bodies, pair.b, facet.b0)), pair.offset)
    q = minus(minus(at_1, vertex_of(shapes, bodies, pair.b, facet.b1)), pair.offset)
    s = minus(minus(at_2, vertex_of(shapes, bodies, pair.b, facet.b2)), pair.offset)
    e, f = minus(q, p), minus(s, p)
    normal = cross(e, f)
    area = length(normal)
    if not area > 1e-13 * pair.size * pair.size:
        return Judgement(INVALID, Contact(0.0, ZERO, ZERO))
    normal = over(normal, area)
    depth = dot(normal, plus(plus(p, q), s)) / 3.0
    reach = dot(world_support(shapes, bodies, pair, facet.a0, facet.b0, normal).point, normal)
    if reach <= 0.0:  # includes 0, so that the remembered lead of the facet is not taken for a gap
        return Judgement(APART, Contact(reach, normal, ZERO))
    if reach - depth > CHECK_TOLERANCE * pair.size:
        return Judgement(INVALID, Contact(0.0, normal, ZERO))
    # Barycentric weights of the origin's projection: areas projected along the normal
    w0, w1 = triple(q, s, normal) / area, triple(s, p, normal) / area
    w2 = 1.0 - w0 - w1
    if min(w0, w1, w2) < -INSIDE_TOLERANCE:
        return Judgement(INVALID, Contact(reach, normal, ZERO))
    far = CERTAIN_REACH * reach
    verdict = OVERLAPPING
    if dot(pair.offset, normal) < reach:
        verdict = UNCERTAIN
    if _too_near(w0 * area, far, minus(s, q)) or _too_near(w1 * area, far, f) or _too_near(w2 * area, far, e):
        verdict = UNCERTAIN
    point = plus_scaled(plus_scaled(scaled(w0, at_0), w1, at_1), w2, at_2)
    return Judgement(verdict, Contact(reach, normal, minus_scaled(point, 0.5 * reach, normal)))


@leaf
def _too_near(double_area, far, side):
    """Return whether a point that spans a triangle of this doubled area with the side is nearer to it than `far`."""
    return not (double_area > 0.0 and double_area * double_area >= far * far * squared(side))


@leaf
def _read_facet(contacts, p):
    """Return the remembered facet of candidate pair p, as int64, the type that a search returns."""
    a0, a1, a2 = _vertex(contacts, p, 0), _vertex(contacts, p, 1), _vertex(contacts, p, 2)
    return Facet(a0, a1, a2, _vertex(contacts, p, 3), _vertex(contacts, p, 4), _vertex(contacts, p, 5))


@leaf
def _vertex(contacts, p, k):
    return np.int64(contacts.facet[p, k])


@leaf
def _write_facet(contacts, p, facet):
    contacts.facet[p, 0], contacts.facet[p, 1], contacts.facet[p, 2] = facet.a0, facet.a1, facet.a2
    contacts.facet[p, 3], contacts.facet[p, 4], contacts.facet[p, 5] = facet.b0, facet.b1, facet.b2


@leaf
def recheck(shapes, bodies, contacts, p, pair):
    """Check candidate pair p from its remembered contact: (whether the result is certain, Contact).

    The pair is apart if the overlap is not positive. If the result is not certain, the pair must be searched; the
    search starts from the remembered direction and vertices.
    """
    if contacts.touching[p] != 0:
        if contacts.facet[p, 1] < 0:
            return False, Contact(0.0, ZERO, ZERO)
        verdict, contact = facet_contact(shapes, bodies, pair, _read_facet(contacts, p))
        if verdict == APART:  # the facet is kept as the simplex nearest to the origin
            remember_apart(bodies, contacts, p, pair, -contact.overlap)
        if verdict == UNCERTAIN and still_apart(bodies, contacts, p, pair):
            verdict = OVERLAPPING  # the last search compared all facets, and no other can have become nearer since
        return verdict == OVERLAPPING or verdict == APART, contact
    if contacts.facet[p, 0] < 0:
        return False, Contact(0.0, ZERO, ZERO)
    gap, distance, normal = _gap_of_simplex(shapes, bodies, contacts, p, pair)
    if gap > STILL_GAP * distance:
        remember_apart(bodies, contacts, p, pair, gap)
        return True, Contact(-gap, normal, ZERO)
    return False, Contact(0.0, normal, ZERO)


@leaf
def _gap_of_simplex(shapes, bodies, contacts, p, pair):
    """Return the gap from the remembered simplex of the Minkowski difference nearest to the origin: SimplexGap."""
    points, facet = _take_points(), contacts.facet
    n = 1
    if facet[p, 1] >= 0:
        n = 2
    if facet[p, 2] >= 0:
        n = 3
    for k in range(n):
        a, b = _vertex(contacts, p, k), _vertex(contacts, p, 3 + k)
        write(points, k, world_difference(shapes, bodies, pair, a, b))
    u, v, w = 1.0, 0.0, 0.0
    if n == 2:
        u, v = segment_weights(points, 0, 1)
    if n == 3:
        u, v, w = triangle_weights(points, 0, 1, 2)
    nearest = scaled(u, read(points, 0))
    if n > 1:
        nearest = plus_scaled(nearest, v, read(points, 1))
    if n > 2:
        nearest = plus_scaled(nearest, w, read(points, 2))
    distance = length(nearest)
    if not distance > 0.0:
        return SimplexGap(0.0, 0.0, read(contacts.direction, p))
    normal = over(negative(nearest), distance)
    m = world_support(shapes, bodies, pair, _vertex(contacts, p, 0), _vertex(contacts, p, 3), normal)
    return SimplexGap(-dot(m.point, normal), distance, normal)


@routine
def search_contact(shapes, bodies, contacts, p, pair):
    """Search the contact of candidate pair p by GJK and EPA."""
    normal = read(contacts.direction, p)
    if normal.x == 0.0 and normal.y == 0.0 and normal.z == 0.0:
        normal = direction_of(pair.offset)
    a, b = _vertex(contacts, p, 0), _vertex(contacts, p, 3)
    if a < 0:
        a = hint_along(shapes, bodies, pair.a, normal)
        b = hint_along(shapes, bodies, pair.b, negative(normal))
    result = search_pair(shapes, bodies, pair, a, b, normal, GAP_SLACK)
    _write_facet(contacts, p, result.facet)
    if result.distance >= 0.0:
        remember_apart(bodies, contacts, p, pair, result.distance)
        return Contact(-result.distance, result.normal, ZERO)
    # Support heights change by no more than the bodies move, and both facets may change: hence half the lead.
    remember_apart(bodies, contacts, p, pair, 0.5 * result.lead)
    overlap = -result.distance
    return Contact(overlap, result.normal, facet_point(shapes, bodies, pair, overlap, result.normal, result.facet))


@leaf
def facet_point(shapes, bodies, pair, overlap, normal, facet):
    """Return the contact point relative to a on a facet of the search: the projection of the origin, kept inside."""
    verdict, contact = facet_contact(shapes, bodies, pair, facet)
    if verdict == OVERLAPPING or verdict == UNCERTAIN:
        return contact.point
    # By rounding the projection is outside a thin facet, or corners are equal; the nearest point is used instead.
    points, k = _take_points(), 0
    for a, b in ((facet.a0, facet.b0), (facet.a1, facet.b1), (facet.a2, facet.b2)):
        write(points, k, across(world_difference(shapes, bodies, pair, a, b), normal))
        k += 1
    w0, w1, w2 = triangle_weights(points, 0, 1, 2)
    point = scaled(w0, vertex_of(shapes, bodies, pair.a, facet.a0))
    point = plus_scaled(point, w1, vertex_of(shapes, bodies, pair.a, facet.a1))
    point = plus_scaled(point, w2, vertex_of(shapes, bodies, pair.a, facet.a2))
    return minus_scaled(point, 0.5 * overlap, normal)
