"""Support function of ellipsoids, and the climb to a direction in which the gap they show is largest.

f(n) = n·r − h_A(n) − h_B(n) with h(n) = √(nᵀ M n), M = R diag(s²) Rᵀ.
"""

import numpy as np

from simcore.compilation import leaf, routine

TOLERANCE = 1e-11  # of the pair's size: tangential distance of the two surface points that is left
ITERATIONS = 60


@leaf
def image(m, i, nx, ny, nz):
    """M n"""
    return (
        m[i, 0] * nx + m[i, 3] * ny + m[i, 4] * nz,
        m[i, 3] * nx + m[i, 1] * ny + m[i, 5] * nz,
        m[i, 4] * nx + m[i, 5] * ny + m[i, 2] * nz,
    )


@leaf
def support_height(m, i, nx, ny, nz):
    """h(n) of body i: how far it reaches along n from its centre."""
    x, y, z = image(m, i, nx, ny, nz)
    return np.sqrt(nx * x + ny * y + nz * z)


@leaf
def gap_along(m, i, j, rx, ry, rz, nx, ny, nz):
    """f(n): the gap that the direction n shows, negative where it shows an overlap."""
    return nx * rx + ny * ry + nz * rz - support_height(m, i, nx, ny, nz) - support_height(m, j, nx, ny, nz)


@leaf
def tangents(nx, ny, nz):
    """Two unit vectors that complete n to a right-handed frame (Duff et al. 2017)."""
    sign = 1.0 if nz >= 0.0 else -1.0
    a = -1.0 / (sign + nz)
    b = nx * ny * a
    return 1.0 + sign * nx * nx * a, sign * b, -sign * nx, b, sign + ny * ny * a, -ny


@leaf
def climb_normal(m, i, j, rx, ry, rz, size, nx, ny, nz, enough):
    """Local maximum of f from n: (f, normal (3), converged). A gap f > enough ends the climb early.

    Newton on the sphere. Where the Hessian does not belong to a maximum it is shifted until it does, and a step
    that loses height is halved, so every step climbs.
    """
    value = gap_along(m, i, j, rx, ry, rz, nx, ny, nz)
    for _ in range(ITERATIONS):
        ax, ay, az = image(m, i, nx, ny, nz)
        bx, by, bz = image(m, j, nx, ny, nz)
        height_a = np.sqrt(nx * ax + ny * ay + nz * az)
        height_b = np.sqrt(nx * bx + ny * by + nz * bz)
        ax, ay, az = ax / height_a, ay / height_a, az / height_a  # support points
        bx, by, bz = bx / height_b, by / height_b, bz / height_b
        gx, gy, gz = rx - ax - bx, ry - ay - by, rz - az - bz
        value = gx * nx + gy * ny + gz * nz
        px, py, pz, qx, qy, qz = tangents(nx, ny, nz)
        gp = gx * px + gy * py + gz * pz
        gq = gx * qx + gy * qy + gz * qz
        converged = abs(gp) + abs(gq) <= TOLERANCE * size
        if converged or value > enough:
            return value, nx, ny, nz, converged
        # Curvature of both surfaces: tangential part of M/h − (M n)(M n)ᵀ/h³
        apx, apy, apz = image(m, i, px, py, pz)
        bpx, bpy, bpz = image(m, j, px, py, pz)
        aqx, aqy, aqz = image(m, i, qx, qy, qz)
        bqx, bqy, bqz = image(m, j, qx, qy, qz)
        ap, aq = ax * px + ay * py + az * pz, ax * qx + ay * qy + az * qz
        bp, bq = bx * px + by * py + bz * pz, bx * qx + by * qy + bz * qz
        kpp = ((px * apx + py * apy + pz * apz) - ap * ap) / height_a
        kpp += ((px * bpx + py * bpy + pz * bpz) - bp * bp) / height_b + value
        kqq = ((qx * aqx + qy * aqy + qz * aqz) - aq * aq) / height_a
        kqq += ((qx * bqx + qy * bqy + qz * bqz) - bq * bq) / height_b + value
        kpq = ((px * aqx + py * aqy + pz * aqz) - ap * aq) / height_a
        kpq += ((px * bqx + py * bqy + pz * bqz) - bp * bq) / height_b
        mean, spread = 0.5 * (kpp + kqq), np.sqrt(0.25 * (kpp - kqq) ** 2 + kpq * kpq)
        least, most = mean - spread, max(abs(mean - spread), abs(mean + spread))
        if least < 1e-6 * most:
            kpp += 1e-2 * most - least
            kqq += 1e-2 * most - least
        det = kpp * kqq - kpq * kpq
        sp, sq = (kqq * gp - kpq * gq) / det, (kpp * gq - kpq * gp) / det
        length = np.sqrt(sp * sp + sq * sq)
        if length > 0.5:
            sp, sq = 0.5 * sp / length, 0.5 * sq / length
        climbed = False
        for _ in range(30):
            x, y, z = nx + sp * px + sq * qx, ny + sp * py + sq * qy, nz + sp * pz + sq * qz
            norm = np.sqrt(x * x + y * y + z * z)
            x, y, z = x / norm, y / norm, z / norm
            trial = gap_along(m, i, j, rx, ry, rz, x, y, z)
            if trial >= value - 4e-16 * size:
                climbed = True
                break
            sp, sq = 0.5 * sp, 0.5 * sq
        if not climbed:
            return value, nx, ny, nz, False
        nx, ny, nz = x, y, z
    return value, nx, ny, nz, False


@routine
def settle_normal(m, i, j, rx, ry, rz, nx, ny, nz):
    """The normal, from where a climb ended: Newton's iteration for a vanishing slope, while it brings it down.

    The climb ends where f, flat at its maximum, is known to rounding; the points of flat ellipsoids still move then by
    some 1e-7 of their size. No step changes f by more than rounding: those that would are left out.
    """
    last = np.inf
    px, py, pz = nx, ny, nz
    for _ in range(10):
        ax, ay, az = image(m, i, nx, ny, nz)
        bx, by, bz = image(m, j, nx, ny, nz)
        height_a, height_b = np.sqrt(nx * ax + ny * ay + nz * az), np.sqrt(nx * bx + ny * by + nz * bz)
        ax, ay, az = ax / height_a, ay / height_a, az / height_a
        bx, by, bz = bx / height_b, by / height_b, bz / height_b
        gx, gy, gz = rx - ax - bx, ry - ay - by, rz - az - bz
        value = gx * nx + gy * ny + gz * nz
        tx, ty, tz, ux, uy, uz = tangents(nx, ny, nz)
        gt, gu = gx * tx + gy * ty + gz * tz, gx * ux + gy * uy + gz * uz
        slope = abs(gt) + abs(gu)
        if not slope < 0.5 * last:
            return px, py, pz
        last, px, py, pz = slope, nx, ny, nz
        ktt, kuu, ktu = value, value, 0.0
        for body in range(2):
            k, height = (i, height_a) if body == 0 else (j, height_b)
            x, y, z = (ax, ay, az) if body == 0 else (bx, by, bz)
            mtx, mty, mtz = image(m, k, tx, ty, tz)
            mux, muy, muz = image(m, k, ux, uy, uz)
            t, u = x * tx + y * ty + z * tz, x * ux + y * uy + z * uz
            ktt += ((tx * mtx + ty * mty + tz * mtz) - t * t) / height
            kuu += ((ux * mux + uy * muy + uz * muz) - u * u) / height
            ktu += ((tx * mux + ty * muy + tz * muz) - t * u) / height
        det = ktt * kuu - ktu * ktu
        if not (det > 0.0 and ktt > 0.0):
            return px, py, pz
        st, su = (kuu * gt - ktu * gu) / det, (ktt * gu - ktu * gt) / det
        if st * st + su * su > 1e-6:  # not near the end: the climb stopped for another reason
            return px, py, pz
        nx, ny, nz = nx + st * tx + su * ux, ny + st * ty + su * uy, nz + st * tz + su * uz
        norm = np.sqrt(nx * nx + ny * ny + nz * nz)
        nx, ny, nz = nx / norm, ny / norm, nz / norm
    return px, py, pz
