"""Deep overlap in which an ellipsoid takes part: the global least of many local ones.

An overlap h(n), the support value of the Minkowski difference M, may have several local minima over the directions n.
As in EPA a polytope grows inside M at its face nearest to the origin; here the local climb starts from every such face
as well. The nearest face bounds the overlap from below, the best of the climbs from above, and where the two meet the
answer is the global one, whatever M looks like. A ball that rolls inside M is taken off before (`roll`): what is left
needs fewer faces.

Shallow pairs need none of this. M is a sum of translates of an ellipsoid with semi-axes a >= b >= c, so a ball of
radius c²/a rolls inside along all its boundary (Blaschke); two ellipsoids: the sum of both. At a stationary point with
an overlap not larger than that radius the ball about the origin of radius overlap lies within the rolling ball there,
and so in M: no direction has less.
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
from simcore.dem.shapes.hulls import support_vertex_along, vertex_of
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

MAX_VERTICES = 320  # a capacity (docs/constants_contact.md#capacities-and-bounds-of-iterations)
ROLLING = 0.99  # of the rolling radius, so that something is left of a sphere without the ball
CERTAIN = 2e-9  # of the pair's size: how far the bounds may be apart

_take_polytope = polytope_scratch(MAX_VERTICES, 2 * MAX_VERTICES)


@leaf
def _semi_axis(m, rotation, i, axis):
    return support_height(m, i, Vec(rotation[i, 0, axis], rotation[i, 1, axis], rotation[i, 2, axis]))


@leaf
def rolling_radius(m, rotation, i):
    """Least radius of curvature of ellipsoid i, (shortest semi-axis)² / longest; of a sphere a little less, so that
    something is left without it."""
    a, b, c = _semi_axis(m, rotation, i, 0), _semi_axis(m, rotation, i, 1), _semi_axis(m, rotation, i, 2)
    return min(a, min(b, c)) ** 2 / max(a, max(b, c)) * ROLLING


@leaf
def start_normal(m, pair):
    """Direction to start from: the normal of the ellipsoid with (M_a + M_b), much like both together, towards r.

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
    # Towards r: an overlap seen from behind is a local maximum of no use, so the rounding of thin pairs is kept out.
    if not dot(normal, r) > 0.0:
        return direction_of(r)
    return direction_of(normal)


@routine
def climb_from(m, pair, normal, enough):
    """`climb_normal`, as a call."""
    return climb_normal(m, pair, normal, enough)


def _make_support(polyhedron: bool):
    @leaf
    def support(shapes, bodies, pair, roll, v, normal):
        """Support point of M less the ball, along n: (the polyhedron's vertex, climbed to from v, the point)."""
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
        """Fill points 0 to 3 from a direction: along it and back, then as far to either side as M reaches; vertex v."""
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
        """The global maximum of f, minus the least overlap, from where a climb has ended. A gap ends the search.

        Of polyhedron a and ellipsoid b start and result are a Feature, of two ellipsoids a Summit. roll: radius of a
        ball that rolls inside M; the polytope grows in M less that ball.
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
