"""Search for the contact of two polyhedra by the Minkowski difference M = A − (B + r).

M is evaluated only through its support points m = a − b − r, a and b vertices. It contains the origin if the bodies
overlap.

    pair_frame   the pair in the axes of body a, in which all searches compute
    gjk          walks to the point of M nearest to the origin, whose distance is the gap. A direction in which M is
                 below zero proves that the bodies are apart, however it was found.
    epa          grows a polytope inside M at its facet nearest to the origin until that facet belongs to M, whose
                 distance is the overlap. It starts from the last tetrahedron of GJK. Because facet distances are
                 signed, the start need not contain the origin: a facet with the origin outside is the nearest of all
                 and is pushed out first. EPA therefore also decides cases between touching and apart that GJK cannot
                 decide.
    facets       tests all facets of M. It is used for deep overlaps, which have more facets near the origin than the
                 capacity of EPA, and if rounding would open the polytope of EPA. It always has a result.
"""

from typing import NamedTuple

from simcore.compilation import leaf, routine
from simcore.dem.contact.search.epa import FacetDistance, expand
from simcore.dem.contact.search.facets import facet_at, least_depth
from simcore.dem.contact.search.gjk import walk_to_origin
from simcore.dem.contact.search.pair_frame import Facet, Support, frame_of
from simcore.dem.contact.search.simplex import take_simplex
from simcore.dem.shapes.polyhedra import support_vertex_along, vertex_of
from simcore.dem.vectors import Vec, into_axes, minus, negative, out_of_axes, read, triple


class Separation(NamedTuple):
    """Signed distance of two polyhedra, in world axes."""

    distance: float  # [m], positive: a certain gap; negative: minus the overlap
    normal: Vec  # from a to b
    facet: Facet  # of M along the normal; for a pair apart the part of M nearest to the origin: one to three corners
    lead: float  # [m], overlap of the next facet minus this one, among the faces of the search


@leaf
def world_difference(shapes, bodies, pair, a, b):
    """Return the point m = a − b − r of vertices a and b, in world axes."""
    return minus(minus(vertex_of(shapes, bodies, pair.a, a), vertex_of(shapes, bodies, pair.b, b)), pair.offset)


@leaf
def world_support(shapes, bodies, pair, a, b, normal):
    """Return the support point of M along n, in world axes; the climbs start from vertices a and b."""
    a = support_vertex_along(shapes, bodies, pair.a, a, normal)
    b = support_vertex_along(shapes, bodies, pair.b, b, negative(normal))
    return Support(a, b, world_difference(shapes, bodies, pair, a, b))


@leaf
def search_pair(shapes, bodies, pair, a, b, normal, slack):
    """Search the Separation of two polyhedra by GJK and, if they overlap, by the facet nearest to the origin.

    The search starts from the normal and the vertices a and b. A gap is at least (1 − slack) times the distance; below
    about 1e-7 of the size, where rounding ends the search early, it may be smaller.
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
    """Search the facet of M nearest to the origin by EPA, or over all facets if EPA fails: FacetDistance in axes of f.

    The search starts from the normal and vertices a and b. n: number of points of the simplex of GJK, 0 for none.
    """
    complete, nearest = expand(shapes, f, a, b, normal, simplex, n)
    if complete:
        return nearest
    deepest = least_depth(shapes, f, normal)
    n = facet_at(shapes, f, deepest.a, deepest.b, deepest.normal, simplex)
    k, m, v = min(1, n - 1), min(2, n - 1), simplex.vertices
    if n == 3:  # counterclockwise from outside, as the check of a remembered facet expects it
        p, q, s = read(simplex.points, 0), read(simplex.points, 1), read(simplex.points, 2)
        if triple(minus(q, p), minus(s, p), deepest.normal) < 0.0:
            k, m = 2, 1
    facet = Facet(v[0, 0], v[k, 0], v[m, 0], v[0, 1], v[k, 1], v[m, 1])
    return FacetDistance(deepest.overlap, deepest.normal, facet, 0.0)
