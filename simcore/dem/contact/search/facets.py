"""Search over all facets of the Minkowski difference M of two polyhedra, without building M.

A facet of M belongs to a face of a, to a face of b, or to an edge of each. On the sphere of normals an edge is the arc
between the normals of its two faces, and a vertex is the region between the arcs of its edges. The facets of two edges
are the crossings of an arc of a with an arc of b. The search therefore follows each arc of a across the regions of b,
from vertex to neighbouring vertex. Its cost is linear in the number of edges and crossings, and it stores nothing.

The search compares support values of M. Along any direction, whatever its rounding, the support value is an upper bound
of the depth, so that rounding may misplace a crossing but not the depth along its direction. A crossing may be missed
by rounding if it is at the end of an arc; that end is the normal of a face, which is tried too.
"""

from typing import NamedTuple

import numpy as np

from simcore.compilation import leaf, routine
from simcore.dem.contact.search.pair_frame import Support, climb_a, climb_b, difference, support, vertex_a, vertex_b
from simcore.dem.contact.search.simplex import (
    has_point,
    keep_weighted,
    put_support,
    segment_weights,
    triangle_weights,
    weighted_point,
)
from simcore.dem.vectors import (
    Vec,
    across,
    basis,
    dot,
    length,
    minus,
    negative,
    over,
    plus,
    scaled,
)

TIE = 1e-11  # of the pair's size: vertices within this distance below a support plane count as on it


class Depth(NamedTuple):
    """The depth along a direction."""

    overlap: float  # [m], support value of M: an upper bound of the overlap; negative: a certain gap
    normal: Vec
    a: int  # supports along the normal
    b: int


class Arc(NamedTuple):
    """The normals from that of one face of an edge to that of the other, counterclockwise; all normal to the edge."""

    p: Vec  # basis p, q of the plane normal to the edge
    q: Vec
    first_p: float
    first_q: float
    last_p: float
    last_q: float


@leaf
def _vertex(shapes, f, of_b, v):
    """Return vertex v of b or of a, relative to its centre."""
    if of_b:
        return vertex_b(shapes, f, v)
    return vertex_a(shapes, f, v)


@leaf
def _in_plane(arc, p, q):
    """Return the direction with components p and q in the plane of an arc."""
    return plus(scaled(p, arc.p), scaled(q, arc.q))


@routine
def _arc(shapes, f, of_b, u, v):
    """Return the arc of normals of edge u, v of a or of b.

    Projected along the edge the body is a wedge, whose sides are the extreme vectors to the neighbours.
    """
    at_u = _vertex(shapes, f, of_b, u)
    edge = minus(_vertex(shapes, f, of_b, v), at_u)
    p, q = basis(over(edge, length(edge)))
    lp, lq, rp, rq = 0.0, 0.0, 0.0, 0.0
    for end in range(2):
        here, there = (u, v) if end == 0 else (v, u)
        for k in range(shapes.neighbor_start[here], shapes.neighbor_start[here + 1]):
            w = shapes.neighbors[k]
            if w == there:
                continue
            side = minus(_vertex(shapes, f, of_b, w), at_u)
            cp, cq = dot(side, p), dot(side, q)
            if lp == 0.0 and lq == 0.0:
                lp, lq, rp, rq = cp, cq, cp, cq
            else:
                if lp * cq - lq * cp > 0.0:
                    lp, lq = cp, cq
                if rp * cq - rq * cp < 0.0:
                    rp, rq = cp, cq
    # The outward normals are to the left of the left side and to the right of the right side.
    left, right = np.sqrt(lp * lp + lq * lq), np.sqrt(rp * rp + rq * rq)
    return Arc(p, q, -lq / left, lp / left, rq / right, -rp / right)


@leaf
def _consider(shapes, f, a, b, normal, best):
    """Return the best depth or that along n, whichever is less."""
    size = length(normal)
    if not size > 0.5:  # a degenerate edge, whose normal is nan
        return best
    normal = over(normal, size)
    m = support(shapes, f, a, b, normal)
    reach = dot(m.point, normal)
    if reach < best.overlap:
        return Depth(reach, normal, m.a, m.b)
    return best


@leaf
def _next_region(shapes, f, arc, b, lp, lq):
    """Return where the arc, from its direction l on, leaves the region of vertex b: (next vertex, direction (2)).

    The next vertex is -1 if the arc ends inside the region.
    """
    at_b = vertex_b(shapes, f, b)
    after, ep, eq = -1, arc.last_p, arc.last_q
    for k in range(shapes.neighbor_start[b], shapes.neighbor_start[b + 1]):
        w = shapes.neighbors[k]
        edge = minus(vertex_b(shapes, f, w), at_b)
        dp, dq = dot(edge, arc.p), dot(edge, arc.q)
        size = np.sqrt(dp * dp + dq * dq)
        hp, hq = -dq / size, dp / size
        # The crossing must not be before the present direction (vertices of one face are crossed in the same direction,
        # and the way back to the last vertex is at 180°), and it must be before the best crossing so far.
        turn = lp * hq - lq * hp
        ahead = turn > 1e-14 or (turn >= -1e-14 and lp * hp + lq * hq > 0.0)
        if ahead and hp * eq - hq * ep > 0.0:
            after, ep, eq = w, hp, hq
    return after, ep, eq


@leaf
def _follow_arc(shapes, f, arc, u, b, count_b, best):
    """Return the best depth over the ends of an arc of a and its crossings with arcs of b, and the last vertex of b.

    u: vertex of the edge of a. b: vertex of b from which the climb starts. count_b: number of vertices of b.
    """
    lp, lq = arc.first_p, arc.first_q
    normal = _in_plane(arc, lp, lq)
    b = climb_b(shapes, f, b, negative(normal))
    best = _consider(shapes, f, u, b, normal, best)
    best = _consider(shapes, f, u, b, _in_plane(arc, arc.last_p, arc.last_q), best)
    for _ in range(count_b):
        after, ep, eq = _next_region(shapes, f, arc, b, lp, lq)
        if after < 0:
            break
        best = _consider(shapes, f, u, after, _in_plane(arc, ep, eq), best)
        b, lp, lq = after, ep, eq
    return best, b


@routine
def least_depth(shapes, f, normal):
    """Return the least support value of M over the normals of all its facets and over n, any direction: Depth."""
    start, neighbors = shapes.neighbor_start, shapes.neighbors
    first_a, last_a = shapes.vertex_start[f.shape_a], shapes.vertex_start[f.shape_a + 1]
    first_b, last_b = shapes.vertex_start[f.shape_b], shapes.vertex_start[f.shape_b + 1]
    m = support(shapes, f, first_a, first_b, normal)
    best = Depth(dot(m.point, normal), normal, m.a, m.b)
    b = best.b
    for u in range(first_a, last_a):
        for k in range(start[u], start[u + 1]):
            if neighbors[k] >= u:
                arc = _arc(shapes, f, False, u, neighbors[k])
                best, b = _follow_arc(shapes, f, arc, u, b, last_b - first_b, best)
    a = best.a
    for u in range(first_b, last_b):
        for k in range(start[u], start[u + 1]):
            if neighbors[k] >= u:
                arc = _arc(shapes, f, True, u, neighbors[k])
                for end in range(2):
                    p, q = (arc.first_p, arc.first_q) if end == 0 else (arc.last_p, arc.last_q)
                    outward = minus(scaled(-p, arc.p), scaled(q, arc.q))
                    a = climb_a(shapes, f, a, outward)
                    best = _consider(shapes, f, a, u, outward, best)
    return best


@leaf
def _tied(shapes, f, of_b, v, normal, lowest, way):
    """Return the vertex of a or b farthest along `way` among those at least at `lowest` along n, by a climb from v."""
    best = dot(_vertex(shapes, f, of_b, v), way)
    for _ in range(len(shapes.vertices)):
        higher = v
        for k in range(shapes.neighbor_start[v], shapes.neighbor_start[v + 1]):
            at_w = _vertex(shapes, f, of_b, shapes.neighbors[k])
            if dot(at_w, normal) >= lowest and dot(at_w, way) > best:
                best, higher = dot(at_w, way), shapes.neighbors[k]
        if higher == v:
            break
        v = higher
    return v


@routine
def facet_at(shapes, f, a, b, normal, simplex):
    """Search the triangle in the facet of M along n that contains the origin's projection, or is nearest to it.

    Returns the number of its corners. a, b: supports along n. The corners are stored in the simplex, whose points are
    the parts normal to n. This is GJK in the plane, over the vertices that are on the facet within TIE.
    """
    points, weights = simplex.points, simplex.weights
    against = negative(normal)
    lowest_a = dot(vertex_a(shapes, f, a), normal) - TIE * f.size
    lowest_b = dot(vertex_b(shapes, f, b), against) - TIE * f.size
    n = 0
    nearest, distance = Vec(0.0, 0.0, 0.0), np.inf
    for _ in range(64):
        if n > 0:
            a = _tied(shapes, f, False, a, normal, lowest_a, negative(nearest))
            b = _tied(shapes, f, True, b, against, lowest_b, nearest)
            if has_point(simplex, n, a, b):
                break
        put_support(simplex, n, Support(a, b, across(difference(shapes, f, a, b), normal)))
        n += 1
        if n == 1:
            weights[0] = 1.0
        elif n == 2:
            weights[0], weights[1] = segment_weights(points, 0, 1)
        else:
            weights[0], weights[1], weights[2] = triangle_weights(points, 0, 1, 2)
        nearest = weighted_point(points, weights, n)
        last, distance = distance, length(nearest)
        if distance <= 1e-14 * f.size or distance >= last:
            break
        if n == 3:
            n = keep_weighted(simplex, weights, n)
            if n == 3:  # the origin's projection is inside; the remaining distance is rounding
                break
    return n
