"""Contact between two bodies, as one quantity: the signed distance.

It is the maximum over unit directions n of  n·r − h_A(n) − h_B(−n),  r from the centre of a to that of b, h the
support functions: positive a gap, negative the overlap, and n points from a to b. Every module works with the
relative position r, formed first, and with tolerances relative to the pair's size.

Within a step, from what the last step left:

    sphere       closed form
    ellipsoid    Newton iteration for the common normal, from the last normal
    potential    the same for ellipsoids by each one's least potential on the other's surface (a scene may choose it)
    polyhedron   check of the facet of the Minkowski difference that was found last
    mixed        hull against ellipsoid: climb to the common normal, from the last normal and vertex
    gap          pairs apart: how long a gap once seen is certain
    patch        where overlapping polyhedra press: centroid and second moments of their overlap
    wall         floor and cylinder

The climbs themselves: ellipsoid_climb, mixed_climb.

The search from nothing that they fall back on:

    minkowski    polyhedra: GJK (`gjk`) and EPA (`epa`), and all facets (`facets`) where these give up
    deep         ellipsoids so deep in another one or in a hull that there may be a shorter way out
    scratch      arrays on the stack, so that no search allocates

Stand-alone, for any two shapes: `query`, `query_many`; `brute` is the reference that they are tested against.
"""

from simcore.dem.contact.query import ContactQuery, query, query_many

__all__ = ["ContactQuery", "query", "query_many"]
