"""GJK: the point of the Minkowski difference M next to the origin (Gilbert, Johnson & Keerthi 1988)."""

import numpy as np
from numba import types

from simcore.compilation import leaf, routine
from simcore.dem.contact.search.pair_frame import difference, support, support_afar
from simcore.dem.contact.search.scratch import scratch

GJK_ITERATIONS = 128  # round hulls of 1300 vertices need 20; a bound, not a budget
NEAR = 1e-3  # of the pair's size: nearer, directions come from the simplex's features, not from its nearest point
GAP_TOLERANCE = 1e-13  # of the pair's size: how far the certain gap may fall short of the nearest point's distance

SHARPENINGS = 8

_take_fresh = scratch(types.float64, 4)
_take_near = scratch(types.float64, 4, 3)
_take_near_vertices = scratch(types.int64, 4, 2)


@leaf
def edge_of(points, p, q):
    """Vector from point p to point q."""
    return points[q, 0] - points[p, 0], points[q, 1] - points[p, 1], points[q, 2] - points[p, 2]


@leaf
def along(points, p, dx, dy, dz):
    return points[p, 0] * dx + points[p, 1] * dy + points[p, 2] * dz


@leaf
def segment_weights(points, p, q):
    """Barycentric weights of the point of segment p, q next to the origin."""
    dx, dy, dz = edge_of(points, p, q)
    length2 = dx * dx + dy * dy + dz * dz
    if length2 == 0.0:
        return 1.0, 0.0
    t = min(max(-along(points, p, dx, dy, dz) / length2, 0.0), 1.0)
    return 1.0 - t, t


@leaf
def _side_distance2(points, p, q):
    u, v = segment_weights(points, p, q)
    x, y, z = (
        u * points[p, 0] + v * points[q, 0],
        u * points[p, 1] + v * points[q, 1],
        u * points[p, 2] + v * points[q, 2],
    )
    return x * x + y * y + z * z, u, v


@routine
def _nearest_side(points, p, q, s):
    """As `triangle_weights`, where rounding leaves the triangle no inside: the nearest of its sides."""
    d_s, p_s, q_s = _side_distance2(points, p, q)
    d_q, p_q, s_q = _side_distance2(points, p, s)
    d_p, q_p, s_p = _side_distance2(points, q, s)
    if d_s <= d_q and d_s <= d_p:
        return p_s, q_s, 0.0
    if d_q <= d_p:
        return p_q, 0.0, s_q
    return 0.0, q_p, s_p


@routine
def triangle_weights(points, p, q, s):
    """Barycentric weights of the point of triangle p, q, s next to the origin (regions of Ericson 2005, 5.1.5)."""
    ex, ey, ez = edge_of(points, p, q)
    fx, fy, fz = edge_of(points, p, s)
    e_p, f_p = -along(points, p, ex, ey, ez), -along(points, p, fx, fy, fz)
    if e_p <= 0.0 and f_p <= 0.0:
        return 1.0, 0.0, 0.0
    e_q, f_q = -along(points, q, ex, ey, ez), -along(points, q, fx, fy, fz)
    if e_q >= 0.0 and f_q <= e_q:
        return 0.0, 1.0, 0.0
    area_s = e_p * f_q - e_q * f_p
    if area_s <= 0.0 and e_p >= 0.0 and e_q <= 0.0:
        t = e_p / (e_p - e_q) if e_p != e_q else 0.0
        return 1.0 - t, t, 0.0
    e_s, f_s = -along(points, s, ex, ey, ez), -along(points, s, fx, fy, fz)
    if f_s >= 0.0 and e_s <= f_s:
        return 0.0, 0.0, 1.0
    area_q = e_s * f_p - e_p * f_s
    if area_q <= 0.0 and f_p >= 0.0 and f_s <= 0.0:
        t = f_p / (f_p - f_s) if f_p != f_s else 0.0
        return 1.0 - t, 0.0, t
    area_p = e_q * f_s - e_s * f_q
    if area_p <= 0.0 and f_q >= e_q and e_s >= f_s:
        total = (f_q - e_q) + (e_s - f_s)
        t = (f_q - e_q) / total if total != 0.0 else 0.0
        return 0.0, 1.0 - t, t
    total = area_p + area_q + area_s
    if total > 0.0 and area_p >= 0.0 and area_q >= 0.0 and area_s >= 0.0:
        return area_p / total, area_q / total, area_s / total
    return _nearest_side(points, p, q, s)


@routine
def nearest_on_simplex(points, n, weights):
    """Fill the weights of the simplex point next to the origin; True where a tetrahedron contains the origin."""
    weights[0], weights[1], weights[2], weights[3] = 0.0, 0.0, 0.0, 0.0
    if n == 1:
        weights[0] = 1.0
        return False
    if n == 2:
        weights[0], weights[1] = segment_weights(points, 0, 1)
        return False
    if n == 3:
        weights[0], weights[1], weights[2] = triangle_weights(points, 0, 1, 2)
        return False
    best = np.inf
    inside = True
    for apex in range(4):
        p, q, s = (apex + 1) & 3, (apex + 2) & 3, (apex + 3) & 3
        ex, ey, ez = edge_of(points, p, q)
        fx, fy, fz = edge_of(points, p, s)
        nx, ny, nz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
        origin_side = -along(points, p, nx, ny, nz)
        apex_side = along(points, apex, nx, ny, nz) + origin_side
        if origin_side * apex_side > 0.0:
            continue  # the origin lies on the inner side of this face
        inside = False
        u, v, w = triangle_weights(points, p, q, s)
        x = u * points[p, 0] + v * points[q, 0] + w * points[s, 0]
        y = u * points[p, 1] + v * points[q, 1] + w * points[s, 1]
        z = u * points[p, 2] + v * points[q, 2] + w * points[s, 2]
        distance2 = x * x + y * y + z * z
        if distance2 < best:
            best = distance2
            weights[apex] = 0.0
            weights[p], weights[q], weights[s] = u, v, w
    return inside


@leaf
def _normal_to_edge(points, p, q, x, y, z):
    """The part of a vector normal to edge p, q; twice, since the first pass leaves rounding of the vector's length."""
    ex, ey, ez = edge_of(points, p, q)
    length2 = ex * ex + ey * ey + ez * ez
    for _ in range(2):
        t = (x * ex + y * ey + z * ez) / length2
        x, y, z = x - t * ex, y - t * ey, z - t * ez
    return x, y, z


@leaf
def _triangle_normal(points, p, q, s):
    """Normal of points p, q, s towards the origin's side, not normalised."""
    ex, ey, ez = edge_of(points, p, q)
    fx, fy, fz = edge_of(points, p, s)
    x, y, z = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
    if along(points, p, x, y, z) > 0.0:
        return -x, -y, -z
    return x, y, z


@leaf
def _feature_normal(points, n, nx, ny, nz):
    """The direction n made normal to the simplex of two or three points.

    From the nearest point it is known to eps size / distance only, whatever the feature's own normal.
    """
    if n == 2:
        x, y, z = _normal_to_edge(points, 0, 1, nx, ny, nz)
    else:
        x, y, z = _triangle_normal(points, 0, 1, 2)
    length = np.sqrt(x * x + y * y + z * z)
    if not length > 0.0:
        return nx, ny, nz
    return x / length, y / length, z / length


@routine
def walk_to_origin(shapes, f, size, a, b, nx, ny, nz, slack, points, vertices, weights):
    """GJK: (certain gap, direction (3), its supports a and b, distance of the nearest point, simplex points).

    Starts along n from vertices a and b. Ends where the gap is not less than (1 − slack) of the distance, or where
    rounding ends the progress. The simplex stands in points (4, 3), vertices (4, 2) and weights (4), its nearest point
    being Σ w m; of four points it contains the origin and the distance is zero. A gap <= 0 certifies nothing.
    """
    fresh = _take_fresh()
    a, b, x, y, z = support(shapes, f, a, b, nx, ny, nz)
    best_gap = -(x * nx + y * ny + z * nz)
    best_x, best_y, best_z, best_a, best_b = nx, ny, nz, a, b
    points[0, 0], points[0, 1], points[0, 2], vertices[0, 0], vertices[0, 1] = x, y, z, a, b
    weights[0] = 1.0
    n = 1
    vx, vy, vz = x, y, z
    distance = np.sqrt(vx * vx + vy * vy + vz * vz)
    for _ in range(GJK_ITERATIONS):
        if distance <= 1e-14 * size or best_gap >= (1.0 - slack) * distance:
            break
        nx, ny, nz = -vx / distance, -vy / distance, -vz / distance
        if distance < NEAR * size and n > 1:
            nx, ny, nz = _feature_normal(points, n, nx, ny, nz)
        a, b, x, y, z = support_afar(shapes, f, nx, ny, nz)
        gap = -(x * nx + y * ny + z * nz)
        if gap > best_gap:
            best_gap = gap
            best_x, best_y, best_z, best_a, best_b = nx, ny, nz, a, b
        repeated = False
        for k in range(n):
            if vertices[k, 0] == a and vertices[k, 1] == b:
                repeated = True
        if repeated:
            break
        points[n, 0], points[n, 1], points[n, 2], vertices[n, 0], vertices[n, 1] = x, y, z, a, b
        if nearest_on_simplex(points, n + 1, fresh):
            n, distance = 4, 0.0
            break
        x, y, z = 0.0, 0.0, 0.0
        for k in range(n + 1):
            x, y, z = x + fresh[k] * points[k, 0], y + fresh[k] * points[k, 1], z + fresh[k] * points[k, 2]
        nearer = np.sqrt(x * x + y * y + z * z)
        if not nearer < distance:  # rounding: the simplex as it was is the better one
            break
        vx, vy, vz, distance = x, y, z, nearer
        kept = 0
        for k in range(n + 1):
            if fresh[k] > 0.0:
                if kept < k:
                    points[kept, 0], points[kept, 1], points[kept, 2] = points[k, 0], points[k, 1], points[k, 2]
                    vertices[kept, 0], vertices[kept, 1] = vertices[k, 0], vertices[k, 1]
                weights[kept] = fresh[k]
                kept += 1
        n = kept
    return best_gap, best_x, best_y, best_z, best_a, best_b, distance, n


@routine
def sharpen(shapes, f, size, distance, points, vertices, n, gap, nx, ny, nz, a, b):
    """The gap along the best of the directions normal to the simplex's features and those beside it, as GJK's.

    GJK takes its direction from the nearest point, whose rounding is that of the size; over a gap g it is wrong by
    eps size / g, and shows a gap that is short by eps size² / g. The normal of a feature is not, whatever the gap.
    Where the nearest point lies on a feature's rim to rounding, GJK ends without the rest of the feature: so the
    support along the best direction joins, and all corners, edges and triangles are tried again.
    """
    near, near_vertices = _take_near(), _take_near_vertices()
    for k in range(n):
        near[k, 0], near[k, 1], near[k, 2] = points[k, 0], points[k, 1], points[k, 2]
        near_vertices[k, 0], near_vertices[k, 1] = vertices[k, 0], vertices[k, 1]
    for _ in range(SHARPENINGS):
        known = False
        for k in range(n):
            if near_vertices[k, 0] == a and near_vertices[k, 1] == b:
                known = True
        if not known and n < 4:
            near[n, 0], near[n, 1], near[n, 2] = difference(shapes, f, a, b)
            near_vertices[n, 0], near_vertices[n, 1] = a, b
            n += 1
        improved = 0
        for subset in range(1, 1 << n):
            p, q, s = -1, -1, -1
            count = 0
            for k in range(n):
                if subset >> k & 1:
                    p, q, s = q, s, k
                    count += 1
            x, y, z = -near[s, 0], -near[s, 1], -near[s, 2]
            if count == 2:
                x, y, z = _normal_to_edge(near, q, s, x, y, z)
            elif count == 3:
                x, y, z = _triangle_normal(near, p, q, s)
            elif count == 4:
                continue
            length = np.sqrt(x * x + y * y + z * z)
            if not length > 0.0:
                continue
            x, y, z = x / length, y / length, z / length
            c, d, mx, my, mz = support(shapes, f, a, b, x, y, z)
            trial = -(mx * x + my * y + mz * z)
            if trial > gap:
                gap, nx, ny, nz, a, b = trial, x, y, z, c, d
                improved = subset
        if improved == 0 or distance - gap <= GAP_TOLERANCE * size:
            break
        kept = 0
        for k in range(n):
            if improved >> k & 1:
                near[kept, 0], near[kept, 1], near[kept, 2] = near[k, 0], near[k, 1], near[k, 2]
                near_vertices[kept, 0], near_vertices[kept, 1] = near_vertices[k, 0], near_vertices[k, 1]
                kept += 1
        n = kept
    return gap, nx, ny, nz, a, b
