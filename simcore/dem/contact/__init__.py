"""Contact between two bodies, as one quantity: the signed distance.

It is the maximum over unit directions n of  n·r − h_A(n) − h_B(−n),  r from the centre of a to that of b, h the
support functions: positive a gap, negative the overlap, and n points from a to b. Every module works with the
relative position r, formed first, and with tolerances relative to the pair's size.

    sphere       closed form
    ellipsoid    Newton iteration for the common normal, from the last normal
    polyhedron   check of the facet of the Minkowski difference that was found last
    minkowski    GJK and EPA: the search from nothing that the check falls back on
    wall         floor and cylinder
"""
