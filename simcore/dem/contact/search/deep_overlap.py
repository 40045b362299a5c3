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
from numba import types

from simcore.compilation import leaf, routine
from simcore.dem.contact.search.ellipsoid_climb import climb_normal, image, support_height
from simcore.dem.contact.search.polyhedron_ellipsoid_climb import climb_feature
from simcore.dem.contact.search.polytope import Polytope, insert_point, nearest_face, start_polytope, volume_of
from simcore.dem.contact.search.scratch import scratch
from simcore.dem.shapes.hulls import support_vertex, vertex_offset

MAX_VERTICES = 320  # a pair with one least overlap needs 60 to 120; rings of equal ones any number
MAX_FACES = 2 * MAX_VERTICES
ROLLING = 0.99
CERTAIN = 2e-9  # of the pair's size: how far the bounds may be apart

_take_points = scratch(types.float64, MAX_VERTICES, 3)
_take_faces = scratch(types.int64, MAX_FACES, 3)
_take_adjacent = scratch(types.int64, MAX_FACES, 3)
_take_normals = scratch(types.float64, MAX_FACES, 3)
_take_distances = scratch(types.float64, MAX_FACES)
_take_seen = scratch(types.int64, MAX_FACES)
_take_stack = scratch(types.int64, MAX_FACES)
_take_free = scratch(types.int64, MAX_FACES)
_take_rim = scratch(types.int64, MAX_FACES, 4)
_take_from_vertex = scratch(types.int64, MAX_VERTICES)


@leaf
def _semi_axis(m, rotation, i, axis):
    return support_height(m, i, rotation[i, 0, axis], rotation[i, 1, axis], rotation[i, 2, axis])


@leaf
def rolling_radius(m, rotation, i):
    """Least radius of curvature of ellipsoid i, (shortest semi-axis)² / longest; of a sphere a little less, so that
    something is left without it."""
    a, b, c = _semi_axis(m, rotation, i, 0), _semi_axis(m, rotation, i, 1), _semi_axis(m, rotation, i, 2)
    return min(a, min(b, c)) ** 2 / max(a, max(b, c)) * ROLLING


@leaf
def unit(x, y, z):
    """The vector's direction, or x where it has none."""
    length = np.sqrt(x * x + y * y + z * z)
    if length > 0.0:
        return x / length, y / length, z / length
    return 1.0, 0.0, 0.0


@leaf
def start_normal(m, i, j, rotation, rx, ry, rz):
    """Direction to start from: the normal of the ellipsoid with (M_i + M_j), much like both together, towards r.

    The inverse is applied by the cofactors of the sum.
    """
    a, b, c = m[i, 0] + m[j, 0], m[i, 1] + m[j, 1], m[i, 2] + m[j, 2]
    d, e, f = m[i, 3] + m[j, 3], m[i, 4] + m[j, 4], m[i, 5] + m[j, 5]
    x = (b * c - f * f) * rx + (e * f - c * d) * ry + (d * f - b * e) * rz
    y = (e * f - c * d) * rx + (a * c - e * e) * ry + (d * e - a * f) * rz
    z = (d * f - b * e) * rx + (d * e - a * f) * ry + (a * b - d * d) * rz
    # Towards r: an overlap seen from behind is a local maximum of no use, so the rounding of thin pairs is kept out.
    if not x * rx + y * ry + z * rz > 0.0:
        return unit(rx, ry, rz)
    return unit(x, y, z)


@routine
def climb_from(m, i, j, rx, ry, rz, size, nx, ny, nz, enough):
    """`climb_normal`, as a call."""
    return climb_normal(m, i, j, rx, ry, rz, size, nx, ny, nz, enough)


@leaf
def _support_of_pair(m, i, j, rx, ry, rz, nx, ny, nz):
    """Support point of M along n, of two ellipsoids."""
    ax, ay, az = image(m, i, nx, ny, nz)
    bx, by, bz = image(m, j, nx, ny, nz)
    a, b = np.sqrt(nx * ax + ny * ay + nz * az), np.sqrt(nx * bx + ny * by + nz * bz)
    return ax / a + bx / b - rx, ay / a + by / b - ry, az / a + bz / b - rz


@leaf
def _support_of_mixed(shapes, bodies, m, i, j, rx, ry, rz, v, nx, ny, nz):
    """Support point of M along n, of hull i and ellipsoid j: the hull's vertex, climbed to from v, and the point."""
    v = support_vertex(shapes, bodies, i, v, nx, ny, nz)
    ax, ay, az = vertex_offset(shapes, bodies, i, v)
    bx, by, bz = image(m, j, nx, ny, nz)
    b = np.sqrt(nx * bx + ny * by + nz * bz)
    return v, ax + bx / b - rx, ay + by / b - ry, az + bz / b - rz


def _make_least(hull: bool):
    """Search for the least overlap: of hull i and ellipsoid j, or of two ellipsoids."""

    @routine
    def least(shapes, bodies, m, i, j, rx, ry, rz, size, roll, v, value, nx, ny, nz):
        """(f, normal (3), point of the hull (3), its vertex), f = −overlap at its global maximum.

        value, n, v: f, direction and support vertex where a climb has ended, to start from. A gap ends the search.
        roll: radius of a ball that rolls inside M; the polytope grows in M less that ball.
        """
        points, distances = _take_points(), _take_distances()
        polytope = Polytope(
            points, _take_faces(), _take_adjacent(), _take_normals(), distances,
            _take_seen(), _take_stack(), _take_free(), _take_rim(), _take_from_vertex(),
        )  # fmt: skip
        best, bx, by, bz, u = value, nx, ny, nz, v
        hx, hy, hz = 0.0, 0.0, 0.0
        converged = True
        if hull:
            best, bx, by, bz, converged, hx, hy, hz, u, _, _ = climb_feature(
                shapes, bodies, i, j, rx, ry, rz, size, v, nx, ny, nz, np.inf
            )
        # A tetrahedron: along n and back, then as far to either side as M reaches
        w, sx, sy, sz = 0, bx, by, bz
        ex, ey, ez = 0.0, 0.0, 0.0
        for step in range(6):
            if hull:
                v, x, y, z = _support_of_mixed(shapes, bodies, m, i, j, rx, ry, rz, v, sx, sy, sz)
            else:
                x, y, z = _support_of_pair(m, i, j, rx, ry, rz, sx, sy, sz)
            x, y, z = x - roll * sx, y - roll * sy, z - roll * sz
            if step == 3 or step == 5:
                above = (points[w, 0] - points[0, 0]) * sx + (points[w, 1] - points[0, 1]) * sy
                above += (points[w, 2] - points[0, 2]) * sz
                below = (x - points[0, 0]) * sx + (y - points[0, 1]) * sy + (z - points[0, 2]) * sz
                if abs(below) > abs(above):
                    points[w, 0], points[w, 1], points[w, 2] = x, y, z
            else:
                points[w, 0], points[w, 1], points[w, 2] = x, y, z
            if step == 1:
                ex, ey, ez = x - points[0, 0], y - points[0, 1], z - points[0, 2]
                if abs(ex) <= abs(ey) and abs(ex) <= abs(ez):
                    sx, sy, sz = unit(0.0, -ez, ey)
                elif abs(ey) <= abs(ez):
                    sx, sy, sz = unit(ez, 0.0, -ex)
                else:
                    sx, sy, sz = unit(-ey, ex, 0.0)
                w = 2
            elif step == 3:
                fx, fy, fz = points[2, 0] - points[0, 0], points[2, 1] - points[0, 1], points[2, 2] - points[0, 2]
                sx, sy, sz = unit(ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx)
                w = 3
            else:
                sx, sy, sz = -sx, -sy, -sz
                if step == 0:
                    w = 1
        start_polytope(polytope, size)
        n_faces, n_free = 4, 0
        for mark in range(1, MAX_VERTICES - 3):
            face, bound = nearest_face(polytope, n_faces)
            if not bound + roll < -best - CERTAIN * size or not volume_of(points) != 0.0:
                break
            nx, ny, nz = polytope.normals[face, 0], polytope.normals[face, 1], polytope.normals[face, 2]
            if hull:
                v, x, y, z = _support_of_mixed(shapes, bodies, m, i, j, rx, ry, rz, v, nx, ny, nz)
                value, px, py, pz, converged, cx, cy, cz, c, _, _ = climb_feature(
                    shapes, bodies, i, j, rx, ry, rz, size, v, nx, ny, nz, np.inf
                )
            else:
                x, y, z = _support_of_pair(m, i, j, rx, ry, rz, nx, ny, nz)
                value, px, py, pz, converged = climb_from(m, i, j, rx, ry, rz, size, nx, ny, nz, np.inf)
            if value > best:
                best, bx, by, bz = value, px, py, pz
                if hull:
                    hx, hy, hz, u = cx, cy, cz, c
            if best > 0.0 and converged:
                break
            w = 3 + mark
            points[w, 0], points[w, 1], points[w, 2] = x - roll * nx, y - roll * ny, z - roll * nz
            done, n_faces, n_free = insert_point(polytope, w, face, n_faces, n_free, mark, size)
            if not done:
                break
        return best, bx, by, bz, hx, hy, hz, u

    return least


least_of_ellipsoids = _make_least(False)
least_of_mixed = _make_least(True)
