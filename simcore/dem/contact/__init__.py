"""Contacts between bodies, described by the signed distance.

The signed distance is the maximum over unit directions n of  n·r − h_A(n) − h_B(−n),  r from the centre of a to that of
b, h the support functions. Positive: the gap. Negative: minus the overlap. The normal n points from a to b. Every
module first forms the relative position r, and uses tolerances relative to the size of the pair (`pair.Pair`).

`find_contact` updates the contacts of a step. For each kind of pair a module in `pairs/` checks the remembered contact:

    spheres               closed form
    ellipsoids            Newton's iteration for the common normal, from the last normal
    ellipsoid_potentials  the least potential of one ellipsoid on the surface of the other (an option of a scene)
    polyhedra             check of the remembered facet of the Minkowski difference
    polyhedron_ellipsoid  check of the remembered corner, edge or face, from the last normal
    inflated              polyhedra as the program of Rettinger et al. (2022) finds them
    remembered_gaps       pairs apart: for what range of motion a gap is certain

`search/` finds a contact without a remembered one:

    ellipsoid_climb             climb to the common normal of two ellipsoids
    polyhedron_ellipsoid_climb  climb to the common normal of a polyhedron and an ellipsoid
    polyhedra                   GJK (`gjk`) and EPA (`epa`), and all facets (`facets`) where EPA gives up
    deep_overlap                overlaps of ellipsoids so deep that another direction may show a smaller one
    exact_polyhedra             distance and points of two polyhedra to rounding, for queries
    pair_frame, simplex, polytope, scratch   data structures of these searches

`patch/` integrates over the overlap of polyhedra; `walls` finds contacts with the floor and the cylinder.
`query` and `query_many` are stand-alone queries for any two shapes; `simcore.verification.brute_force` checks them.
"""
