"""Deep overlaps of an ellipsoid with an ellipsoid or a polyhedron: the global minimum among several local ones.

An overlap h(n), the support value of the Minkowski difference M, may have several local minima over the directions n.
As in EPA, a polytope grows inside M at its face nearest to the origin; in addition, a local climb starts from every
such face. The nearest face bounds the overlap from below and the best climb bounds it from above. Where the bounds
meet, the result is the global minimum for any M. A ball that rolls inside M is subtracted first (`roll`), because the
rest needs fewer faces.

Shallow overlaps do not need this search. M is a union of translates of an ellipsoid with semi-axes a >= b >= c, so that
a ball of radius c²/a rolls inside along its whole boundary (Blaschke); for two ellipsoids the radius is the sum of
both. At a stationary point whose overlap is not larger than that radius, the ball about the origin with the radius of
the overlap is inside the rolling ball, and therefore inside M: no direction has a smaller overlap.
"""

import numpy as np

from simcore.compilation import leaf, routine
from simcore.dem.contact.search.ellipsoid_climb import climb_normal, support_height, surface_point
from simcore.dem.contact.search.polyhedron_ellipsoid_climb import climb_feature
from simcore.dem.contact.search.polytope import (
    insert_point,
    nearest_face,
    polytope_scratch,
    start_polytope,
    volume_of,
)
from simcore.dem.shapes.polyhedra import support_vertex_along, vertex_of
from simcore.dem.vectors import (
    Vec,
    cross,
    direction_of,
    dot,
    minus,
    minus_scaled,
    negative,
    plus,
    read,
    sideways,
    write,
)

MAX_VERTICES = 320  # a capacity (docs/explanation/constants_contact.md#capacities-and-bounds-of-iterations)
ROLLING = 0.99  # of the rolling radius, so that a sphere minus the ball is not empty
CERTAIN = 2e-9  # of the pair's size: accepted distance between the bounds

_take_polytope = polytope_scratch(MAX_VERTICES, 2 * MAX_VERTICES)


@leaf
def _semi_axis(m, rotation, i, axis):
    """Return the length of a semi-axis of ellipsoid i."""
    return support_height(m, i, Vec(rotation[i, 0, axis], rotation[i, 1, axis], rotation[i, 2, axis]))


@leaf
def rolling_radius(m, rotation, i):
    """Return the least radius of curvature of ellipsoid i, (shortest semi-axis)² / longest, times ROLLING."""
    a, b, c = _semi_axis(m, rotation, i, 0), _semi_axis(m, rotation, i, 1), _semi_axis(m, rotation, i, 2)
    return min(a, min(b, c)) ** 2 / max(a, max(b, c)) * ROLLING


@leaf
def start_normal(m, pair):
    """Return a start direction: the normal towards r of the ellipsoid with M_a + M_b, which resembles both together.

    The inverse is applied by the cofactors of the sum.
    """
    i, j, r = pair.a, pair.b, pair.offset
    a, b, c = m[i, 0] + m[j, 0], m[i, 1] + m[j, 1], m[i, 2] + m[j, 2]
    d, e, f = m[i, 3] + m[j, 3], m[i, 4] + m[j, 4], m[i, 5] + m[j, 5]
    normal = Vec(
        (b * c - f * f) * r.x + (e * f - c * d) * r.y + (d * f - b * e) * r.z,
        (e * f - c * d) * r.x + (a * c - e * e) * r.y + (d * e - a * f) * r.z,
        (d * f - b * e) * r.x + (d * e - a * f) * r.y + (a * b - d * d) * r.z,
    )
    # The direction must point towards r, because the far side has a useless local maximum; thin pairs may round there.
    if not dot(normal, r) > 0.0:
        return direction_of(r)
    return direction_of(normal)


@routine
def climb_from(m, pair, normal, enough):
    """Call `climb_normal`; this routine is compiled as a function of its own, not inlined."""
    return climb_normal(m, pair, normal, enough)


def _make_support(polyhedron: bool):
    @leaf
    def support(shapes, bodies, pair, roll, v, normal):
        """Return the support along n of M minus the ball: (vertex of the polyhedron, by a climb from v, the point)."""
        point_b, _ = surface_point(bodies.form_matrix, pair.b, normal)
        if polyhedron:
            v = support_vertex_along(shapes, bodies, pair.a, v, normal)
            point_a = vertex_of(shapes, bodies, pair.a, v)
        else:
            point_a, _ = surface_point(bodies.form_matrix, pair.a, normal)
        return v, minus_scaled(minus(plus(point_a, point_b), pair.offset), roll, normal)

    return support


_support_of_ellipsoids = _make_support(False)
_support_of_mixed = _make_support(True)


def _make_tetrahedron(polyhedron: bool):
    @leaf
    def tetrahedron_in(shapes, bodies, pair, roll, v, normal, points):
        """Store support points 0 to 3: along the direction and against it, then the farther ones sideways; return v."""
        if polyhedron:
            support = _support_of_mixed
        else:
            support = _support_of_ellipsoids
        v, start = support(shapes, bodies, pair, roll, v, normal)
        v, back = support(shapes, bodies, pair, roll, v, negative(normal))
        write(points, 0, start)
        write(points, 1, back)
        edge = minus(back, start)
        side = sideways(edge)
        for w in range(2, 4):
            side = direction_of(side)
            v, far = support(shapes, bodies, pair, roll, v, side)
            v, behind = support(shapes, bodies, pair, roll, v, negative(side))
            if abs(dot(minus(behind, start), side)) > abs(dot(minus(far, start), side)):
                far = behind
            write(points, w, far)
            side = cross(edge, minus(far, start))
        return v

    return tetrahedron_in


_tetrahedron_of_ellipsoids = _make_tetrahedron(False)
_tetrahedron_of_mixed = _make_tetrahedron(True)


def _make_least(polyhedron: bool):
    @routine
    def least(shapes, bodies, pair, roll, start):
        """Search the global maximum of f, which is minus the least overlap, from the end of a climb.

        A gap ends the search. start and result: a Feature for polyhedron a and ellipsoid b, a Summit for two
        ellipsoids. roll: radius of a ball that rolls inside M; the polytope grows in M minus that ball.
        """
        polytope, best, v = _take_polytope(), start, 0
        points, size = polytope.points, pair.size
        if polyhedron:
            best = climb_feature(shapes, bodies, pair, start.a0, start.normal, np.inf)
            v = _tetrahedron_of_mixed(shapes, bodies, pair, roll, start.a0, best.normal, points)
        else:
            _tetrahedron_of_ellipsoids(shapes, bodies, pair, roll, 0, best.normal, points)
        start_polytope(polytope, size)
        n_faces, n_free = 4, 0
        for mark in range(1, MAX_VERTICES - 3):
            face, bound = nearest_face(polytope, n_faces)
            if not bound + roll < -best.value - CERTAIN * size or not volume_of(points) != 0.0:
                break
            normal = read(polytope.normals, face)
            if polyhedron:
                v, point = _support_of_mixed(shapes, bodies, pair, roll, v, normal)
                top = climb_feature(shapes, bodies, pair, v, normal, np.inf)
            else:
                _, point = _support_of_ellipsoids(shapes, bodies, pair, roll, 0, normal)
                top = climb_from(bodies.form_matrix, pair, normal, np.inf)
            if top.value > best.value:
                best = top
            if best.value > 0.0 and top.converged:
                break
            write(points, 3 + mark, point)
            done, n_faces, n_free = insert_point(polytope, 3 + mark, face, n_faces, n_free, mark, size)
            if not done:
                break
        return best

    return least


least_of_ellipsoids = _make_least(False)
least_of_mixed = _make_least(True)
