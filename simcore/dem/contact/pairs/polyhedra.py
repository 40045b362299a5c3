"""Convex polyhedron against convex polyhedron, from the remembered contact.

In one step a grain moves about 1e-4 of its size. An overlapping pair remembers the three support pairs of its facet of
the Minkowski difference: the plane is rebuilt, the edge graphs are climbed from its vertices, and where no support
point lies beyond and the origin's projection stays well inside, the facet is still the minimum of the overlap.
Otherwise the pair is searched from nothing. A separated pair remembers the simplex next to the origin, and is not
checked before the bodies can have closed the gap; then the same simplex mostly still shows one.
"""

from typing import NamedTuple

import numpy as np
from numba import types

from simcore.compilation import leaf, routine
from simcore.dem.contact.pairs.gap_memory import STILL_GAP, remember_apart, still_apart
from simcore.dem.contact.search.pair_frame import Facet
from simcore.dem.contact.search.polyhedra import search_pair, world_difference, world_support
from simcore.dem.contact.search.scratch import scratch
from simcore.dem.contact.search.simplex import segment_weights, triangle_weights
from simcore.dem.shapes.hulls import vertex_of
from simcore.dem.vectors import (
    ZERO,
    Contact,
    Vec,
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
CHECK_TOLERANCE = 1e-11  # of the pair's size; wider than the search's, so that what it returns passes
INSIDE_TOLERANCE = 1e-9  # barycentric
GAP_SLACK = 0.1  # a step only needs a certain gap; the last tenth of its length is not worth iterations
CERTAIN_REACH = 2.0  # of the overlap: farther from its sides a facet is the nearest (docs/constants_contact.md)

INVALID, APART, OVERLAPPING, UNCERTAIN = 0, 1, 2, 3


class Judgement(NamedTuple):
    """What a remembered facet shows."""

    verdict: int  # INVALID, APART (the overlap is minus a certain gap), OVERLAPPING or UNCERTAIN
    contact: Contact


class SimplexGap(NamedTuple):
    """What the simplex next to the origin shows of a pair apart."""

    gap: float  # [m], certain
    distance: float  # [m], of the simplex: an upper bound of the gap
    normal: Vec


@leaf
def facet_contact(shapes, bodies, pair, facet):
    """Judge a remembered facet.

    UNCERTAIN: a local minimum of the overlap so near to a side of the facet that another facet may show less: the
    origin's projection is nearer to it than CERTAIN_REACH times the overlap.
    """
    at_0, at_1, at_2 = (
        vertex_of(shapes, bodies, pair.a, facet.a0),
        vertex_of(shapes, bodies, pair.a, facet.a1),
        vertex_of(shapes, bodies, pair.a, facet.a2),
    )
    # The corners of the facet, its sides from the first, and its normal
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
    if reach <= 0.0:  # 0 too: a contact that ended must not keep the lead of its facet as if it were a gap
        return Judgement(APART, Contact(reach, normal, ZERO))
    if reach - depth > CHECK_TOLERANCE * pair.size:
        return Judgement(INVALID, Contact(0.0, normal, ZERO))
    # Barycentric weights of the origin's projection: areas seen along the normal
    w0, w1 = triple(q, s, normal) / area, triple(s, p, normal) / area
    w2 = 1.0 - w0 - w1
    if min(w0, w1, w2) < -INSIDE_TOLERANCE:
        return Judgement(INVALID, Contact(reach, normal, ZERO))
    far = CERTAIN_REACH * reach
    verdict = OVERLAPPING
    if _too_near(w0 * area, far, minus(s, q)) or _too_near(w1 * area, far, f) or _too_near(w2 * area, far, e):
        verdict = UNCERTAIN
    point = plus_scaled(plus_scaled(scaled(w0, at_0), w1, at_1), w2, at_2)
    return Judgement(verdict, Contact(reach, normal, minus_scaled(point, 0.5 * reach, normal)))


@leaf
def _too_near(double_area, far, side):
    """Whether the point that spans such a triangle with the side is nearer to it than `far`."""
    return not (double_area > 0.0 and double_area * double_area >= far * far * squared(side))


@leaf
def _read_facet(contacts, p):
    """The remembered facet of candidate pair p, as int64: of one type with what a search returns, compiled once."""
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
    """Candidate pair p from its remembered contact: (whether that is certain, Contact).

    The pair is apart where the overlap is not positive. Not certain: the pair has to be searched, from the direction
    and the vertices that are still remembered.
    """
    if contacts.touching[p] != 0:
        if contacts.facet[p, 1] < 0:
            return False, Contact(0.0, ZERO, ZERO)
        verdict, contact = facet_contact(shapes, bodies, pair, _read_facet(contacts, p))
        if verdict == APART:  # the facet stays, as the simplex next to the origin
            remember_apart(bodies, contacts, p, pair, -contact.overlap)
        if verdict == UNCERTAIN and still_apart(bodies, contacts, p, pair):
            verdict = OVERLAPPING  # the search compared it with the others, and they cannot have caught up
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
    """Gap from the remembered simplex of the Minkowski difference, which was next to the origin: SimplexGap."""
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
    """Contact of candidate pair p by GJK and EPA."""
    a, b = _vertex(contacts, p, 0), _vertex(contacts, p, 3)
    if a < 0:
        a, b = shapes.vertex_start[bodies.shape[pair.a]], shapes.vertex_start[bodies.shape[pair.b]]
    normal = read(contacts.direction, p)
    if normal.x == 0.0 and normal.y == 0.0 and normal.z == 0.0:
        normal = direction_of(pair.offset)
    result = search_pair(shapes, bodies, pair, a, b, normal, GAP_SLACK)
    _write_facet(contacts, p, result.facet)
    if result.distance >= 0.0:
        remember_apart(bodies, contacts, p, pair, result.distance)
        return Contact(-result.distance, result.normal, ZERO)
    # Support heights change by no more than the bodies move: half the lead for each of the two facets.
    remember_apart(bodies, contacts, p, pair, 0.5 * result.lead)
    overlap = -result.distance
    return Contact(overlap, result.normal, facet_point(shapes, bodies, pair, overlap, result.normal, result.facet))


@leaf
def facet_point(shapes, bodies, pair, overlap, normal, facet):
    """Contact point relative to a on a facet that the search returned: the origin's projection, kept inside it."""
    verdict, contact = facet_contact(shapes, bodies, pair, facet)
    if verdict == OVERLAPPING or verdict == UNCERTAIN:
        return contact.point
    # Rounding put the projection outside a thin facet: the corner that it lies next to is as good.
    least = _aside2(world_difference(shapes, bodies, pair, facet.a0, facet.b0), normal)
    corner = facet.a0
    for a, b in ((facet.a1, facet.b1), (facet.a2, facet.b2)):
        distance2 = _aside2(world_difference(shapes, bodies, pair, a, b), normal)
        if distance2 < least:
            least, corner = distance2, a
    return minus_scaled(vertex_of(shapes, bodies, pair.a, corner), 0.5 * overlap, normal)


@leaf
def _aside2(point, normal):
    """Squared distance of a point from the line through the origin along the unit vector n."""
    along = dot(point, normal)
    return squared(point) - along * along
