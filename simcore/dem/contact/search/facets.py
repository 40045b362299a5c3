"""All facets of the Minkowski difference M of two polyhedra, without building it.

A facet of M belongs to a face of a, to a face of b, or to an edge of each. On the sphere of normals an edge is the arc
between the normals of its two faces, and a vertex the region between its edges' arcs; the facets of two edges are
where an arc of a crosses one of b. So: follow each arc of a across the regions of b, from vertex to neighbouring
vertex. The cost is linear in edges and crossings, and nothing is stored.

The support value of M along any direction is an upper bound of the depth, whatever the rounding of the direction, and
it is what is compared: so rounding can misjudge a crossing, but never the depth that its direction shows. And where a
crossing is missed because it lies at an arc's end by rounding, that end is a face's normal, and is tried too.
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

TIE = 1e-11  # of the pair's size: vertices this close below a support plane count as on it


class Depth(NamedTuple):
    """What a direction shows."""

    overlap: float  # [m], support value of M: an upper bound of the overlap; negative: a certain gap
    normal: Vec
    a: int  # supports along the normal
    b: int


class Arc(NamedTuple):
    """Normals between those of an edge's two faces, counterclockwise from the first; all normal to the edge."""

    p: Vec  # basis of the plane normal to the edge
    q: Vec
    first_p: float
    first_q: float
    last_p: float
    last_q: float


@leaf
def _vertex(shapes, f, of_b, v):
    if of_b:
        return vertex_b(shapes, f, v)
    return vertex_a(shapes, f, v)


@leaf
def _in_plane(arc, p, q):
    """The direction of components p and q in the plane of an arc."""
    return plus(scaled(p, arc.p), scaled(q, arc.q))


@routine
def _arc(shapes, f, of_b, u, v):
    """Arc of normals of edge u, v of a or of b.

    Seen along the edge the body is a corner, and its sides are the extreme ones of the vectors to the neighbours.
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
    # Outward: to the left of the left side, to the right of the right one
    left, right = np.sqrt(lp * lp + lq * lq), np.sqrt(rp * rp + rq * rq)
    return Arc(p, q, -lq / left, lp / left, rq / right, -rp / right)


@leaf
def _consider(shapes, f, a, b, normal, best):
    """The less of the best depth and that along n."""
    size = length(normal)
    if not size > 0.5:  # a degenerate edge: nan
        return best
    normal = over(normal, size)
    m = support(shapes, f, a, b, normal)
    reach = dot(m.point, normal)
    if reach < best.overlap:
        return Depth(reach, normal, m.a, m.b)
    return best


@leaf
def _next_region(shapes, f, arc, b, lp, lq):
    """Where the arc, from its direction l, leaves the region of vertex b: (neighbour that takes over, direction (2)).

    -1: nowhere before the arc's end.
    """
    at_b = vertex_b(shapes, f, b)
    after, ep, eq = -1, arc.last_p, arc.last_q
    for k in range(shapes.neighbor_start[b], shapes.neighbor_start[b + 1]):
        w = shapes.neighbors[k]
        edge = minus(vertex_b(shapes, f, w), at_b)
        dp, dq = dot(edge, arc.p), dot(edge, arc.q)
        size = np.sqrt(dp * dp + dq * dq)
        hp, hq = -dq / size, dp / size
        # Not before the present direction (vertices of one face follow each other in the same one; the way back to the
        # last vertex lies at 180°), and before the best so far
        turn = lp * hq - lq * hp
        ahead = turn > 1e-14 or (turn >= -1e-14 and lp * hp + lq * hq > 0.0)
        if ahead and hp * eq - hq * ep > 0.0:
            after, ep, eq = w, hp, hq
    return after, ep, eq


@leaf
def _follow_arc(shapes, f, arc, u, b, count_b, best):
    """Best depth over the normals of an edge of a from vertex u: its ends and its crossings with b's arcs, and b there.

    b: vertex of b to climb from; count_b: number of vertices of b.
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
    """Least support value of M over all its facets' normals, and over n, any direction: Depth."""
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
    """Vertex of a or b that is farthest along a way among those that reach `lowest` along n, from vertex v."""
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
    """Triangle in M's facet along n that contains the origin's projection, or comes nearest: number of its corners.

    a, b: supports along n. Fills the simplex; its points are the parts normal to n. This is GJK in the plane, over the
    vertices that reach the facet within TIE.
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
            if n == 3:  # the origin's projection lies within: what is left is rounding
                break
    return n
