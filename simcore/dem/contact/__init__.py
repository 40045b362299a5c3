"""Contact between two bodies, as one quantity: the signed distance.

It is the maximum over unit directions n of  n·r − h_A(n) − h_B(−n),  r from the centre of a to that of b, h the
support functions: positive a gap, negative the overlap, and n points from a to b. Every module works with the
relative position r, formed first, and with tolerances relative to the pair's size (`pair.Pair`).

`finding` updates the contacts of a step. For each kind of pair a module in `pairs/` checks the remembered contact:

    spheres               closed form
    ellipsoids            Newton's iteration for the common normal, from the last normal
    ellipsoid_potentials  the same by each one's least potential on the other's surface (a scene may choose it)
    polyhedra             check of the remembered facet of the Minkowski difference
    polyhedron_ellipsoid  check of the remembered corner, edge or face, from the last normal
    inflated              polyhedra as the program of Rettinger et al. (2022) finds them
    gap_memory            pairs apart: how long a gap is certain

`search/` finds a contact from nothing:

    ellipsoid_climb             climb to the common normal of two ellipsoids
    polyhedron_ellipsoid_climb  the same of a polyhedron and an ellipsoid
    polyhedra                   GJK (`gjk`) and EPA (`epa`), and all facets (`facets`) where these give up
    deep_overlap                ellipsoids so deep in another body that there may be a shorter way out
    exact_polyhedra             distance and points of two polyhedra to the last digits, for queries
    pair_frame, simplex, polytope, scratch   what these compute with

`patch/` integrates over the overlap of polyhedra; `walls` finds contacts with the floor and the cylinder.
Stand-alone, for any two shapes: `query`, `query_many`; `simcore.verification.brute_force` is their reference.
"""

from simcore.dem.contact.query import ContactQuery, query, query_many

__all__ = ["ContactQuery", "query", "query_many"]
