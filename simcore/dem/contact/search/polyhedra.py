"""Polyhedron against polyhedron from nothing, by the Minkowski difference M = A − (B + r).

M is evaluated only through its support points m = a − b − r, a and b vertices, and contains the origin where the bodies
overlap.

    pair_frame   the pair in the axes of body a: all searches compute there
    gjk          walks to the point of M next to the origin: the gap. A direction in which M stays below zero is a
                 certificate of separation, whatever happened on the way.
    epa          grows a polytope inside M, always at the facet next to the origin, until that facet belongs to M: the
                 overlap. It starts from the tetrahedron that GJK ended with. With signed facet distances it needs no
                 start that contains the origin: a facet that has the origin outside is the nearest of all and is
                 pushed out first. So it also decides the cases between touching and not touching that GJK cannot.
    facets       goes through all facets of M: for deep pairs, which have more facets near the origin than EPA has room
                 for, and where rounding tears its polytope. It cannot fail.
"""

from typing import NamedTuple

from simcore.compilation import leaf, routine
from simcore.dem.contact.search.epa import FacetDistance, expand
from simcore.dem.contact.search.facets import facet_at, least_depth
from simcore.dem.contact.search.gjk import walk_to_origin
from simcore.dem.contact.search.pair_frame import Facet, Support, frame_of
from simcore.dem.contact.search.simplex import take_simplex
from simcore.dem.shapes.hulls import support_vertex_along, vertex_of
from simcore.dem.vectors import Vec, into_axes, minus, negative, out_of_axes


class Separation(NamedTuple):
    """Signed distance of two polyhedra, in world axes."""

    distance: float  # [m], positive: a certain gap; negative: minus the overlap
    normal: Vec  # from a to b
    facet: Facet  # of M along the normal; of a pair apart the part of M next to the origin: one to three corners
    lead: float  # [m], how much more overlap other facets show, as far as the search saw them


@leaf
def world_difference(shapes, bodies, pair, a, b):
    """The point m = a − b − r of vertices a and b, in world axes."""
    return minus(minus(vertex_of(shapes, bodies, pair.a, a), vertex_of(shapes, bodies, pair.b, b)), pair.offset)


@leaf
def world_support(shapes, bodies, pair, a, b, normal):
    """Support point of M along n, in world axes; vertices a and b are where the climbs start."""
    a = support_vertex_along(shapes, bodies, pair.a, a, normal)
    b = support_vertex_along(shapes, bodies, pair.b, b, negative(normal))
    return Support(a, b, world_difference(shapes, bodies, pair, a, b))


@leaf
def search_pair(shapes, bodies, pair, a, b, normal, slack):
    """Separation of two polyhedra by GJK, and by the facet next to the origin where they overlap.

    The normal and the vertices a and b start the search. A gap is not less than (1 − slack) of the distance; below some
    1e-7 of the size, where rounding ends the search early, it may be shorter.
    """
    simplex = take_simplex()
    f = frame_of(bodies, pair)
    end = walk_to_origin(shapes, f, a, b, into_axes(bodies.rotation, pair.a, normal), slack, simplex)
    if end.gap > 0.0:
        v = simplex.vertices
        a1, a2, b1, b2 = -1, -1, -1, -1
        if end.n > 1:
            a1, b1 = v[1, 0], v[1, 1]
        if end.n > 2:
            a2, b2 = v[2, 0], v[2, 1]
        facet = Facet(v[0, 0], a1, a2, v[0, 1], b1, b2)
        return Separation(end.gap, out_of_axes(bodies.rotation, pair.a, end.normal), facet, 0.0)
    deepest = facet_distance(shapes, f, end.a, end.b, end.normal, simplex, end.n)
    normal = out_of_axes(bodies.rotation, pair.a, deepest.normal)
    return Separation(-deepest.overlap, normal, deepest.facet, deepest.lead)


@routine
def facet_distance(shapes, f, a, b, normal, simplex, n):
    """The facet of M next to the origin by EPA, and by all facets where EPA gives up: FacetDistance in the axes of f.

    The normal and vertices a and b are where it starts; n: points of the simplex that GJK left, 0 for none.
    """
    complete, nearest = expand(shapes, f, a, b, normal, simplex, n)
    if complete:
        return nearest
    deepest = least_depth(shapes, f, normal)
    n = facet_at(shapes, f, deepest.a, deepest.b, deepest.normal, simplex)
    k, m, v = min(1, n - 1), min(2, n - 1), simplex.vertices
    facet = Facet(v[0, 0], v[k, 0], v[m, 0], v[0, 1], v[k, 1], v[m, 1])
    return FacetDistance(deepest.overlap, deepest.normal, facet, 0.0)
