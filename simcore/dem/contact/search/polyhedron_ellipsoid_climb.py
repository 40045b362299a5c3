"""Convex hull against ellipsoid by the common normal.

f(n) = n·r − h_hull(n) − h_ellipsoid(n) is the least of smooth functions, one for each vertex v of the hull:
f_v(n) = n·(r − v) − h_ellipsoid(n). At its maximum one, two or three of them are equal: the ellipsoid touches a
corner, an edge or a face. Newton's iteration is then a sequence of small problems: maximise the least of the f_v, each
with its slope and all with the ellipsoid's curvature, over the vertices that matter. The vertices are found on the way:
where a step leads to another support vertex that spoils it, that vertex joins in.
"""

import numpy as np
from numba import types

from simcore.compilation import leaf, routine
from simcore.dem.contact.search.ellipsoid_climb import image, support_height, tangents
from simcore.dem.contact.search.scratch import scratch
from simcore.dem.shapes.hulls import support_vertex, vertex_offset

TOLERANCE = 1e-12  # of the pair's size: tangential distance of the two surface points that is left
GAIN = 1e-15  # of the pair's size: a step that promises less is the last
ITERATIONS = 60
CORNERS = 4

_take_vertices = scratch(types.int64, CORNERS)
_take_slopes = scratch(types.float64, CORNERS, 3)
_take_weights = scratch(types.float64, CORNERS)


@leaf
def gap_along(shapes, bodies, i, j, rx, ry, rz, v, nx, ny, nz):
    """f(n) and the hull's support vertex there, climbing from vertex v."""
    v = support_vertex(shapes, bodies, i, v, nx, ny, nz)
    x, y, z = vertex_offset(shapes, bodies, i, v)
    height = support_height(bodies.form_matrix, j, nx, ny, nz)
    return nx * (rx - x) + ny * (ry - y) + nz * (rz - z) - height, v


@routine
def _balance(slopes, n, weights):
    """Weights λ of the least Σ λ f + ½ |Σ λ t|² with λ >= 0, Σ λ = 1; slopes: rows f, t. Returns that least value.

    It is the dual of the small problem, with t in axes in which the curvature is one. A convex function over a simplex
    is least at a corner or at the stationary point of an edge or a triangle: all are tried.
    """
    best = np.inf
    for k in range(n):
        value = slopes[k, 0] + 0.5 * (slopes[k, 1] ** 2 + slopes[k, 2] ** 2)
        if value < best:
            best = value
            for c in range(n):
                weights[c] = 0.0
            weights[k] = 1.0
    for k in range(n):
        for m in range(k):
            df, dp, dq = slopes[k, 0] - slopes[m, 0], slopes[k, 1] - slopes[m, 1], slopes[k, 2] - slopes[m, 2]
            mu = -(df + dp * slopes[m, 1] + dq * slopes[m, 2]) / (dp * dp + dq * dq)
            if mu > 0.0 and mu < 1.0:
                p, q = slopes[m, 1] + mu * dp, slopes[m, 2] + mu * dq
                value = slopes[m, 0] + mu * df + 0.5 * (p * p + q * q)
                if value < best:
                    best = value
                    for c in range(n):
                        weights[c] = 0.0
                    weights[k], weights[m] = mu, 1.0 - mu
            for o in range(m):
                ef, ep, eq = slopes[o, 0] - slopes[m, 0], slopes[o, 1] - slopes[m, 1], slopes[o, 2] - slopes[m, 2]
                # Both t along d and e vanish: solved for the point p, q itself, then for the weights
                bd = -(df + dp * slopes[m, 1] + dq * slopes[m, 2])
                be = -(ef + ep * slopes[m, 1] + eq * slopes[m, 2])
                det = dp * eq - dq * ep
                sp, sq = (bd * eq - be * dq) / det, (dp * be - ep * bd) / det  # d·s = bd, e·s = be
                mu, nu = (sp * eq - sq * ep) / det, (dp * sq - dq * sp) / det  # s = mu d + nu e
                if mu > 0.0 and nu > 0.0 and mu + nu < 1.0:
                    p, q = slopes[m, 1] + sp, slopes[m, 2] + sq
                    value = slopes[m, 0] + mu * df + nu * ef + 0.5 * (p * p + q * q)
                    if value < best:
                        best = value
                        for c in range(n):
                            weights[c] = 0.0
                        weights[k], weights[o], weights[m] = mu, nu, 1.0 - mu - nu
    return best


@routine
def climb_feature(shapes, bodies, i, j, rx, ry, rz, size, v, nx, ny, nz, enough):
    """Local maximum of f from n: (f, normal i to j (3), converged, point of the hull (3), active vertices (3)).

    Hull i and ellipsoid j; v: vertex to climb from. Active are the vertices of the corner, edge or face touched,
    -1 for those that it has not; the point is their convex combination, from the hull's centre. A gap f > enough ends
    the climb early.
    """
    m = bodies.form_matrix
    vertices, slopes, weights = _take_vertices(), _take_slopes(), _take_weights()
    value, v = gap_along(shapes, bodies, i, j, rx, ry, rz, v, nx, ny, nz)
    vertices[0] = v
    n = 1
    a0, a1, a2 = v, -1, -1
    wx, wy, wz = vertex_offset(shapes, bodies, i, v)
    last = np.inf
    for _ in range(ITERATIONS):
        if value > enough:
            break
        ax, ay, az = image(m, j, nx, ny, nz)
        height = np.sqrt(nx * ax + ny * ay + nz * az)
        ax, ay, az = ax / height, ay / height, az / height
        px, py, pz, qx, qy, qz = tangents(nx, ny, nz)
        # Curvature of the ellipsoid, and of the sphere of directions; shifted where f has no maximum
        apx, apy, apz = image(m, j, px, py, pz)
        aqx, aqy, aqz = image(m, j, qx, qy, qz)
        ap, aq = ax * px + ay * py + az * pz, ax * qx + ay * qy + az * qz
        kpp = ((px * apx + py * apy + pz * apz) - ap * ap) / height + value
        kqq = ((qx * aqx + qy * aqy + qz * aqz) - aq * aq) / height + value
        kpq = ((px * aqx + py * aqy + pz * aqz) - ap * aq) / height
        mean, spread = 0.5 * (kpp + kqq), np.sqrt(0.25 * (kpp - kqq) ** 2 + kpq * kpq)
        least, most = mean - spread, max(abs(mean - spread), abs(mean + spread))
        if least < 1e-6 * most:
            kpp += 1e-2 * most - least
            kqq += 1e-2 * most - least
        # K = L Lᵀ
        lpp = np.sqrt(kpp)
        lpq = kpq / lpp
        lqq = np.sqrt(kqq - lpq * lpq)
        gain, residual, moved = 0.0, 0.0, False
        x, y, z, trial, u = nx, ny, nz, value, v
        promised = np.inf
        for _ in range(30):
            for k in range(n):
                cx, cy, cz = vertex_offset(shapes, bodies, i, vertices[k])
                gx, gy, gz = rx - ax - cx, ry - ay - cy, rz - az - cz
                tp = (gx * px + gy * py + gz * pz) / lpp
                slopes[k, 0] = gx * nx + gy * ny + gz * nz - value
                slopes[k, 1] = tp
                slopes[k, 2] = ((gx * qx + gy * qy + gz * qz) - lpq * tp) / lqq
            gain = _balance(slopes, n, weights)
            tp, tq = 0.0, 0.0
            wx, wy, wz = 0.0, 0.0, 0.0
            for k in range(n):
                tp += weights[k] * slopes[k, 1]
                tq += weights[k] * slopes[k, 2]
                cx, cy, cz = vertex_offset(shapes, bodies, i, vertices[k])
                wx, wy, wz = wx + weights[k] * cx, wy + weights[k] * cy, wz + weights[k] * cz
            residual = abs(lpp * tp) + abs(lpq * tp + lqq * tq)
            sq = tq / lqq
            sp = (tp - lpq * sq) / lpp
            length = np.sqrt(sp * sp + sq * sq)
            share = 1.0
            if length > 0.5:
                share = 0.5 / length
                sp, sq = share * sp, share * sq
            # A vertex that joined and took nothing from the promise spoils the step by curvature, not by slope: then
            # the step is too long.
            open_to_more = gain < promised * (1.0 - 1e-9)
            promised = gain
            fresh = False
            for _ in range(40):
                x, y, z = nx + sp * px + sq * qx, ny + sp * py + sq * qy, nz + sp * pz + sq * qz
                norm = np.sqrt(x * x + y * y + z * z)
                x, y, z = x / norm, y / norm, z / norm
                trial, u = gap_along(shapes, bodies, i, j, rx, ry, rz, v, x, y, z)
                fresh = True
                for k in range(n):
                    if vertices[k] == u:
                        fresh = False
                # A step must bring its share of the promise, or it would leap to and fro over a sharp rim.
                moved = trial >= value + 0.1 * share * gain - 1e-15 * size
                if moved or (fresh and open_to_more):
                    break
                fresh = False
                sp, sq, share = 0.5 * sp, 0.5 * sq, 0.5 * share
            kept = 0
            fresh_now = fresh or moved  # the support vertex of where the step leads stays in any case
            for k in range(n):
                if weights[k] > 0.0:
                    fresh_now = fresh_now and vertices[k] != u
                    vertices[kept] = vertices[k]
                    kept += 1
            n = kept
            a0, a1, a2 = vertices[0], -1, -1
            if n > 1:
                a1 = vertices[1]
            if n > 2:
                a2 = vertices[2]
            if fresh_now:
                vertices[n] = u
                n += 1
            if moved or not fresh:
                break
        if gain <= GAIN * size and (residual <= TOLERANCE * size or residual > 0.5 * last or not moved):
            return value, nx, ny, nz, True, wx, wy, wz, a0, a1, a2
        if not moved:
            return value, nx, ny, nz, False, wx, wy, wz, a0, a1, a2
        if gain <= GAIN * size:  # nothing left to gain, but the points of flat ellipsoids still move
            last = residual
        value, nx, ny, nz, v = trial, x, y, z, u
    return value, nx, ny, nz, value > enough, wx, wy, wz, a0, a1, a2
