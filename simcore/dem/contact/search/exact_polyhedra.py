"""Query of two polyhedra, one of which may be a single point: distance to rounding, normal and closest points."""

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

UNSURE = 1e-12  # of the pair's size: accepted difference between the lower and upper bound of a gap
BESIDE = 1e-13  # of the pair's size: accepted distance of the point of M from the line along the normal


@leaf
def _weigh_triangle(simplex):
    """Store the weights of the triangle's point nearest to the origin; return the number of points with a weight."""
    weights = simplex.weights
    weights[0], weights[1], weights[2] = triangle_weights(simplex.points, 0, 1, 2)
    return keep_weighted(simplex, weights, 3)


@leaf
def _project_facet(shapes, f, facet, normal, simplex):
    """Store the weights of the facet's point nearest to the origin's projection along the normal.

    Return the number of points with a weight.
    """
    v = simplex.vertices
    v[0, 0], v[1, 0], v[2, 0] = facet.a0, facet.a1, facet.a2
    v[0, 1], v[1, 1], v[2, 1] = facet.b0, facet.b1, facet.b2
    for k in range(3):
        write(simplex.points, k, across(difference(shapes, f, v[k, 0], v[k, 1]), normal))
    return _weigh_triangle(simplex)


@leaf
def _aside(shapes, f, normal, simplex, n):
    """Return the distance of the point Σ w m of M from the line along n through the origin."""
    point = Vec(0.0, 0.0, 0.0)
    for k in range(n):
        m = difference(shapes, f, simplex.vertices[k, 0], simplex.vertices[k, 1])
        point = plus_scaled(point, simplex.weights[k], m)
    return beside(point, normal)


@leaf
def _search_facet(shapes, f, end, simplex):
    """Return the approach by the facet of M nearest to the origin, used if GJK certified no gap.

    Its gap is minus the overlap.
    """
    deepest = facet_distance(shapes, f, end.a, end.b, end.normal, simplex, end.n)
    n = _project_facet(shapes, f, deepest.facet, deepest.normal, simplex)
    gap, distance = -deepest.overlap, 0.0
    if gap > 0.0:  # a gap too small for GJK: the nearest feature may be an edge or a corner of the facet
        for k in range(3):
            write(simplex.points, k, difference(shapes, f, simplex.vertices[k, 0], simplex.vertices[k, 1]))
        n = _weigh_triangle(simplex)
        distance = length(weighted_point(simplex.points, simplex.weights, n))
    return Approach(gap, deepest.normal, end.a, end.b, distance, n)


@leaf
def _sharpen_gap(shapes, f, end, simplex, fresh):
    """Return the approach with a certain gap that equals the distance to rounding."""
    end = sharpen(shapes, f, simplex, end)
    if end.distance - end.gap > UNSURE * f.size:  # GJK did not find all corners of a face; EPA finds its normal
        nearest = facet_distance(shapes, f, end.a, end.b, end.normal, fresh, 0)
        if -nearest.overlap > end.gap:
            facet = nearest.facet
            return Approach(-nearest.overlap, nearest.normal, facet.a0, facet.b0, end.distance, end.n)
    return end


@routine
def query_polyhedra(shapes, bodies, pair):
    """Return the closest points of two polyhedra, in world axes."""
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
