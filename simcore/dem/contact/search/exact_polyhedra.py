"""Two polyhedra, of which one may be a single point, from nothing: distance to the last digits, normal, points."""

from simcore.compilation import leaf, routine
from simcore.dem.contact.pair import Closest
from simcore.dem.contact.search.facets import facet_at
from simcore.dem.contact.search.gjk import GAP_TOLERANCE, Approach, sharpen, walk_to_origin
from simcore.dem.contact.search.pair_frame import (
    difference,
    frame_of,
    support,
    support_afar,
    vertex_a,
    vertex_b,
)
from simcore.dem.contact.search.polyhedra import facet_distance
from simcore.dem.contact.search.simplex import (
    keep_weighted,
    take_simplex,
    triangle_weights,
    weighted_point,
)
from simcore.dem.vectors import (
    Vec,
    across,
    beside,
    direction_of,
    into_axes,
    length,
    out_of_axes,
    plus_scaled,
    write,
)

UNSURE = 1e-12  # of the pair's size: between the bounds of a gap from below and above
BESIDE = 1e-13  # of the pair's size: how far from the normal's line through the origin M's point may lie


@leaf
def _weigh_triangle(simplex):
    """Weigh three points by the point of their triangle next to the origin; returns how many have a weight."""
    weights = simplex.weights
    weights[0], weights[1], weights[2] = triangle_weights(simplex.points, 0, 1, 2)
    return keep_weighted(simplex, weights, 3)


@leaf
def _project_facet(shapes, f, facet, normal, simplex):
    """Weigh the corners of a facet with this normal by the point next to the origin's projection, as above."""
    v = simplex.vertices
    v[0, 0], v[1, 0], v[2, 0] = facet.a0, facet.a1, facet.a2
    v[0, 1], v[1, 1], v[2, 1] = facet.b0, facet.b1, facet.b2
    for k in range(3):
        write(simplex.points, k, across(difference(shapes, f, v[k, 0], v[k, 1]), normal))
    return _weigh_triangle(simplex)


@leaf
def _aside(shapes, f, normal, simplex, n):
    """Distance of the point Σ w m of M from the line along n through the origin."""
    point = Vec(0.0, 0.0, 0.0)
    for k in range(n):
        m = difference(shapes, f, simplex.vertices[k, 0], simplex.vertices[k, 1])
        point = plus_scaled(point, simplex.weights[k], m)
    return beside(point, normal)


@leaf
def _search_facet(shapes, f, end, simplex):
    """The approach where GJK certified no gap, by the facet of M next to the origin; its gap is minus the overlap."""
    deepest = facet_distance(shapes, f, end.a, end.b, end.normal, simplex, end.n)
    n = _project_facet(shapes, f, deepest.facet, deepest.normal, simplex)
    gap, distance = -deepest.overlap, 0.0
    if gap > 0.0:  # too small for GJK: the nearest feature may be an edge or a corner of the facet
        for k in range(3):
            write(simplex.points, k, difference(shapes, f, simplex.vertices[k, 0], simplex.vertices[k, 1]))
        n = _weigh_triangle(simplex)
        distance = length(weighted_point(simplex.points, simplex.weights, n))
    return Approach(gap, deepest.normal, end.a, end.b, distance, n)


@leaf
def _sharpen_gap(shapes, f, end, simplex, fresh):
    """The approach with a gap as good as the distance, to rounding."""
    end = sharpen(shapes, f, simplex, end)
    if end.distance - end.gap > UNSURE * f.size:  # a face whose corners GJK never met together: EPA finds its normal
        nearest = facet_distance(shapes, f, end.a, end.b, end.normal, fresh, 0)
        if -nearest.overlap > end.gap:
            facet = nearest.facet
            return Approach(-nearest.overlap, nearest.normal, facet.a0, facet.b0, end.distance, end.n)
    return end


@routine
def query_polyhedra(shapes, bodies, pair):
    """Closest points of two polyhedra, in world axes."""
    simplex, fresh, rotation = take_simplex(), take_simplex(), bodies.rotation
    f = frame_of(bodies, pair)
    normal = Vec(1.0, 0.0, 0.0)
    if length(pair.offset) > 0.0:
        normal = into_axes(rotation, pair.a, direction_of(pair.offset))
    m = support_afar(shapes, f, normal)
    end = walk_to_origin(shapes, f, m.a, m.b, normal, 0.0, simplex)
    if end.gap <= 0.0:
        end = _search_facet(shapes, f, end, simplex)
    if end.gap > 0.0 and end.distance - end.gap > GAP_TOLERANCE * f.size:
        end = _sharpen_gap(shapes, f, end, simplex, fresh)
    n, aside = end.n, _aside(shapes, f, end.normal, simplex, end.n)
    if aside > BESIDE * f.size:
        m = support(shapes, f, end.a, end.b, end.normal)
        n_fresh = facet_at(shapes, f, m.a, m.b, end.normal, fresh)
        if _aside(shapes, f, end.normal, fresh, n_fresh) < aside:
            simplex, n = fresh, n_fresh
    point_a, point_b = Vec(0.0, 0.0, 0.0), Vec(0.0, 0.0, 0.0)
    for k in range(n):
        point_a = plus_scaled(point_a, simplex.weights[k], vertex_a(shapes, f, simplex.vertices[k, 0]))
        point_b = plus_scaled(point_b, simplex.weights[k], vertex_b(shapes, f, simplex.vertices[k, 1]))
    return Closest(
        end.gap,
        out_of_axes(rotation, pair.a, end.normal),
        out_of_axes(rotation, pair.a, point_a),
        out_of_axes(rotation, pair.a, point_b),
    )
