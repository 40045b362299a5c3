"""Ellipsoid against ellipsoid by the common normal.

f(n) = n·r − h_A(n) − h_B(n) with h(n) = √(nᵀ M n), M = R diag(s²) Rᵀ, has its stationary points where the surfaces
have parallel tangent planes and the line between the two points is normal to both. Newton's iteration on the unit
sphere converges from the last step's normal in one or two steps. A gap is concave in n and has one maximum; an
overlap may have several, so a pair that comes without memory is searched from many directions.
"""

import numpy as np

from simcore.compilation import leaf, search
from simcore.dem.contact.gap import STILL_GAP, remember_apart

TOLERANCE = 1e-11  # of the pair's size: tangential distance of the two surface points that is left
ITERATIONS = 60
ENOUGH_GAP = 0.02  # of the pair's size: a step need not know a wider gap to the last digit
SPIRAL_STARTS = 32
REFINED_STARTS = 6


@leaf
def _image(m, i, nx, ny, nz):
    """M n"""
    return (
        m[i, 0] * nx + m[i, 3] * ny + m[i, 4] * nz,
        m[i, 3] * nx + m[i, 1] * ny + m[i, 5] * nz,
        m[i, 4] * nx + m[i, 5] * ny + m[i, 2] * nz,
    )


@leaf
def support_height(m, i, nx, ny, nz):
    """h(n) of body i: how far it reaches along n from its centre."""
    x, y, z = _image(m, i, nx, ny, nz)
    return np.sqrt(nx * x + ny * y + nz * z)


@leaf
def gap_along(m, i, j, rx, ry, rz, nx, ny, nz):
    """f(n): the gap that the direction n shows, negative where it shows an overlap."""
    return nx * rx + ny * ry + nz * rz - support_height(m, i, nx, ny, nz) - support_height(m, j, nx, ny, nz)


@leaf
def _tangents(nx, ny, nz):
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
        ax, ay, az = _image(m, i, nx, ny, nz)
        bx, by, bz = _image(m, j, nx, ny, nz)
        height_a = np.sqrt(nx * ax + ny * ay + nz * az)
        height_b = np.sqrt(nx * bx + ny * by + nz * bz)
        ax, ay, az = ax / height_a, ay / height_a, az / height_a  # support points
        bx, by, bz = bx / height_b, by / height_b, bz / height_b
        gx, gy, gz = rx - ax - bx, ry - ay - by, rz - az - bz
        value = gx * nx + gy * ny + gz * nz
        px, py, pz, qx, qy, qz = _tangents(nx, ny, nz)
        gp = gx * px + gy * py + gz * pz
        gq = gx * qx + gy * qy + gz * qz
        converged = abs(gp) + abs(gq) <= TOLERANCE * size
        if converged or value > enough:
            return value, nx, ny, nz, converged
        # Curvature of both surfaces: tangential part of M/h − (M n)(M n)ᵀ/h³
        apx, apy, apz = _image(m, i, px, py, pz)
        bpx, bpy, bpz = _image(m, j, px, py, pz)
        aqx, aqy, aqz = _image(m, i, qx, qy, qz)
        bqx, bqy, bqz = _image(m, j, qx, qy, qz)
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


@search
def search_normal(m, i, j, rotation, rx, ry, rz, size, enough):
    """Global maximum of f, from nothing: (f, normal (3)). A gap f > enough ends the search early.

    Starts: along r, the axes of both bodies, and a spiral of directions, plain and taken as surface points of
    either body (which is where thin bodies hide their rims). The best few are climbed.
    """
    n_starts = 13 + 3 * SPIRAL_STARTS
    starts = np.empty((n_starts, 3))
    length = np.sqrt(rx * rx + ry * ry + rz * rz)
    if length > 0.0:
        starts[0, 0], starts[0, 1], starts[0, 2] = rx / length, ry / length, rz / length
    else:
        starts[0, 0], starts[0, 1], starts[0, 2] = 1.0, 0.0, 0.0
    for axis in range(3):
        for sign in range(2):
            for k in range(3):
                starts[1 + 2 * axis + sign, k] = (1.0 - 2.0 * sign) * rotation[i, k, axis]
                starts[7 + 2 * axis + sign, k] = (1.0 - 2.0 * sign) * rotation[j, k, axis]
    for k in range(SPIRAL_STARTS):
        z = 1.0 - (2.0 * k + 1.0) / SPIRAL_STARTS
        ring = np.sqrt(1.0 - z * z)
        angle = 2.399963229728653 * k
        x, y = ring * np.cos(angle), ring * np.sin(angle)
        row = 13 + 3 * k
        starts[row, 0], starts[row, 1], starts[row, 2] = x, y, z
        for body, offset in ((i, 1), (j, 2)):
            # n with surface point s ∘ u of the body: n ∝ R (u / s), the scales from the diagonal of RᵀMR
            for world in range(3):
                starts[row + offset, world] = 0.0
            for axis in range(3):
                ex, ey, ez = rotation[body, 0, axis], rotation[body, 1, axis], rotation[body, 2, axis]
                scale = support_height(m, body, ex, ey, ez)
                u = x if axis == 0 else (y if axis == 1 else z)
                starts[row + offset, 0] += ex * u / scale
                starts[row + offset, 1] += ey * u / scale
                starts[row + offset, 2] += ez * u / scale
            norm = np.sqrt(starts[row + offset, 0] ** 2 + starts[row + offset, 1] ** 2 + starts[row + offset, 2] ** 2)
            for world in range(3):
                starts[row + offset, world] /= norm
    values = np.empty(n_starts)
    for k in range(n_starts):
        values[k] = gap_along(m, i, j, rx, ry, rz, starts[k, 0], starts[k, 1], starts[k, 2])
    best, best_x, best_y, best_z = -np.inf, 1.0, 0.0, 0.0
    for _ in range(REFINED_STARTS):
        k = np.argmax(values)
        values[k] = -np.inf
        value, x, y, z, _ = climb_normal(m, i, j, rx, ry, rz, size, starts[k, 0], starts[k, 1], starts[k, 2], enough)
        if value > best:
            best, best_x, best_y, best_z = value, x, y, z
        if best > enough:
            break
    return best, best_x, best_y, best_z


@leaf
def recheck(bodies, contacts, p, i, j, rx, ry, rz):
    """Near pair p from its last normal: (known, overlap [m], normal a to b (3), contact point relative to a (3)).

    The pair is apart where the overlap is not positive. Known is False for a pair without a normal, and where the
    iteration did not converge: then the pair has to be searched.
    """
    nx, ny, nz = contacts.direction[p, 0], contacts.direction[p, 1], contacts.direction[p, 2]
    if nx == 0.0 and ny == 0.0 and nz == 0.0:
        return False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    size = bodies.radius[i] + bodies.radius[j]
    # A direction that still shows much of the gap searched last needs no better one; a contact needs the best.
    enough = np.inf if contacts.touching[p] != 0 else -STILL_GAP * contacts.overlap[p]
    value, nx, ny, nz, converged = climb_normal(bodies.form_matrix, i, j, rx, ry, rz, size, nx, ny, nz, enough)
    overlap, nx, ny, nz, x, y, z = _conclude(bodies, contacts, p, i, j, rx, ry, rz, value, nx, ny, nz)
    if contacts.touching[p] == 0 and overlap <= 0.0:
        overlap = min(overlap, contacts.overlap[p])
    return converged or value > enough, overlap, nx, ny, nz, x, y, z


@search
def search_contact(bodies, contacts, p, i, j, rx, ry, rz):
    """Near pair p from many directions: (overlap [m], normal a to b (3), contact point relative to a (3))."""
    size = bodies.radius[i] + bodies.radius[j]
    value, nx, ny, nz = search_normal(bodies.form_matrix, i, j, bodies.rotation, rx, ry, rz, size, ENOUGH_GAP * size)
    return _conclude(bodies, contacts, p, i, j, rx, ry, rz, value, nx, ny, nz)


@leaf
def _conclude(bodies, contacts, p, i, j, rx, ry, rz, value, nx, ny, nz):
    """Overlap, normal and point from f at its maximum; a gap is remembered."""
    if value > 0.0:
        remember_apart(bodies, contacts, p, i, j, rx, ry, rz, value)
        return -value, nx, ny, nz, 0.0, 0.0, 0.0
    x, y, z = _image(bodies.form_matrix, i, nx, ny, nz)
    height = np.sqrt(nx * x + ny * y + nz * z)
    half = 0.5 * value
    return -value, nx, ny, nz, x / height + half * nx, y / height + half * ny, z / height + half * nz
