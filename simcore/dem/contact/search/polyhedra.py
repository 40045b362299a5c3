"""Polyhedron against polyhedron from nothing, by the Minkowski difference M = A − (B + r).

M is seen only through its support points m = a − b − r, a and b vertices, and contains the origin where the bodies
overlap.

    frame     the pair in the axes of body a: all searches compute there
    gjk       walks to the point of M next to the origin: the gap. A direction in which M stays below zero is a
              certificate of separation, whatever happened on the way.
    epa       grows a polytope inside M, always at the facet next to the origin, until that facet belongs to M itself:
              the overlap. It starts from the tetrahedron that GJK ended with. With signed facet distances it needs no
              start that contains the origin: a facet that has the origin outside is the nearest of all and is pushed
              out first. So it also decides the cases at the edge between touching and not touching that GJK cannot.
    facets    goes through all facets of M: for deep pairs, which have more facets near the origin than EPA has room
              for, and where rounding tears its polytope. It cannot fail.
"""

from numba import types

from simcore.compilation import leaf, routine
from simcore.dem.contact.search.epa import expand
from simcore.dem.contact.search.facets import facet_at, least_depth
from simcore.dem.contact.search.gjk import walk_to_origin
from simcore.dem.contact.search.pair_frame import frame_of, to_body, to_world
from simcore.dem.contact.search.scratch import scratch
from simcore.dem.shapes.hulls import support_vertex, vertex_offset

_take_points = scratch(types.float64, 4, 3)
_take_vertices = scratch(types.int64, 4, 2)
_take_weights = scratch(types.float64, 4)


@leaf
def support(shapes, bodies, i, j, rx, ry, rz, a, b, nx, ny, nz):
    """Support point of M along n, in world axes: vertices a and b, and m = a − b − r."""
    a = support_vertex(shapes, bodies, i, a, nx, ny, nz)
    b = support_vertex(shapes, bodies, j, b, -nx, -ny, -nz)
    ax, ay, az = vertex_offset(shapes, bodies, i, a)
    bx, by, bz = vertex_offset(shapes, bodies, j, b)
    return a, b, ax - bx - rx, ay - by - ry, az - bz - rz


@leaf
def separation(shapes, bodies, i, j, rx, ry, rz, size, a, b, nx, ny, nz, slack):
    """Gap by GJK: (gap, direction (3), a, b) with a gap > 0 that is certain; gap <= 0 where none was found.

    The direction given starts the search. The gap is a lower bound of the distance and not less than (1 − slack)
    times it; below some 1e-7 of the size, where rounding ends the search early, it may be shorter.
    a, b: vertices to climb from, on return the supports along the direction.
    """
    points, vertices, weights = _take_points(), _take_vertices(), _take_weights()
    f = frame_of(bodies, i, j, rx, ry, rz)
    nx, ny, nz = to_body(bodies.rotation, i, nx, ny, nz)
    gap, nx, ny, nz, a, b, _, _ = walk_to_origin(shapes, f, size, a, b, nx, ny, nz, slack, points, vertices, weights)
    nx, ny, nz = to_world(bodies.rotation, i, nx, ny, nz)
    return gap, nx, ny, nz, a, b


@leaf
def search_pair(shapes, bodies, i, j, rx, ry, rz, size, a, b, nx, ny, nz, slack):
    """`separation`, and where they overlap the facet distance from there: (signed distance, normal (3), facet, lead).

    facet: a0 a1 a2 b0 b1 b2. lead: how much more overlap the other facets show, as far as is known. The gap is certain
    and not less than (1 − slack) of the distance; with it comes, instead of the facet, the simplex of M next to the
    origin, one to three points, -1 for those that it has not.
    """
    points, vertices, weights = _take_points(), _take_vertices(), _take_weights()
    f = frame_of(bodies, i, j, rx, ry, rz)
    nx, ny, nz = to_body(bodies.rotation, i, nx, ny, nz)
    gap, nx, ny, nz, a, b, _, n = walk_to_origin(shapes, f, size, a, b, nx, ny, nz, slack, points, vertices, weights)
    a0, a1, a2, b0, b1, b2 = vertices[0, 0], -1, -1, vertices[0, 1], -1, -1
    lead = 0.0
    if n > 1:
        a1, b1 = vertices[1, 0], vertices[1, 1]
    if n > 2:
        a2, b2 = vertices[2, 0], vertices[2, 1]
    if not gap > 0.0:
        overlap, nx, ny, nz, a0, a1, a2, b0, b1, b2, lead = facet_distance(
            shapes, f, size, bodies.shape[i], bodies.shape[j], a, b, nx, ny, nz, points, vertices, weights, n
        )
        gap = -overlap
    nx, ny, nz = to_world(bodies.rotation, i, nx, ny, nz)
    return gap, nx, ny, nz, a0, a1, a2, b0, b1, b2, lead


@routine
def facet_distance(shapes, f, size, shape_a, shape_b, a, b, nx, ny, nz, points, vertices, weights, n):
    """Signed facet distance by EPA, and by all facets where it gives up: (overlap, normal (3), facet, lead).

    A negative overlap is a certain gap along the normal. Direction, in the axes of a as the normal is, and vertices a,
    b are where it starts; n: points of the simplex that GJK left, 0 for none. Facet and lead as in `search_pair`.
    """
    found, overlap, ex, ey, ez, a0, a1, a2, b0, b1, b2, lead = expand(
        shapes, f, size, a, b, nx, ny, nz, points, vertices, n
    )
    if found:
        return overlap, ex, ey, ez, a0, a1, a2, b0, b1, b2, lead
    start = shapes.vertex_start
    overlap, nx, ny, nz, a, b = least_depth(
        shapes, f, start[shape_a], start[shape_a + 1], start[shape_b], start[shape_b + 1], nx, ny, nz
    )
    n = facet_at(shapes, f, size, a, b, nx, ny, nz, points, vertices, weights)
    k, m = min(1, n - 1), min(2, n - 1)
    return (
        overlap, nx, ny, nz,
        vertices[0, 0], vertices[k, 0], vertices[m, 0], vertices[0, 1], vertices[k, 1], vertices[m, 1], 0.0,
    )  # fmt: skip
