"""Convex hull against ellipsoid: by the common normal, from what the last step found or from nothing.

The smooth body makes the contact a point that moves continuously, also where it rolls from a face over an edge: there
is no patch. The ellipsoid's point along the normal is where they touch; the hull's is known less well on flat faces.

A pair remembers its normal and the corner, edge or face of the hull that is touched. Within a step they change little:
the normal of a face follows from its vertices, of an edge or a corner by one or two steps of Newton's iteration, and
where the point still lies inside and no other vertex reaches farther, that is the maximum of f(n) = n·r − h_hull(n) −
h_ellipsoid(n) again. Else the climb goes on from there (`mixed_climb`).

A gap is concave in n and has one maximum. A maximum that is an overlap below the ellipsoid's rolling radius is the
global one (`deep` says why), so a new contact needs no search as long as it is shallow; a deeper one is searched at
every step.

Either body of a pair may be the hull: seen from a hull that is body b, offset and normal change their sign.
"""

import numpy as np

from simcore.compilation import leaf, routine
from simcore.dem.contact.pairs.gap_memory import STILL_GAP, remember_apart
from simcore.dem.contact.search.deep_overlap import least_of_mixed, rolling_radius, unit
from simcore.dem.contact.search.ellipsoid_climb import image, tangents
from simcore.dem.contact.search.polyhedron_ellipsoid_climb import climb_feature, gap_along
from simcore.dem.shapes.hulls import base_direction, climb_from_hint, is_hull, vertex_offset

ENOUGH_GAP = 0.02  # of the pair's size: a step need not know a wider gap to the last digit
# Of the pair's size, as of ellipsoids: tangential distance of the two points that is left. f is flat there: it is known
# to the square of that over the radius of curvature.
BESIDE = 1e-11
CHECK_TOLERANCE = 1e-12  # of the pair's size: by how much another vertex may reach farther; rounding is some 1e-15
INSIDE_TOLERANCE = 1e-9  # barycentric
ITERATIONS = 5  # of Newton: from 1e-4, a step's turn, two reach rounding; more is a case for the climb


@routine
def search_normal(shapes, bodies, i, j, rx, ry, rz, size, enough):
    """Global maximum of f from nothing, hull i and ellipsoid j: (f, normal i to j (3), point of the hull (3),
    active vertices (3)).

    A gap f > enough ends the search early. The point is from the hull's centre; for the vertices see climb_feature.
    """
    nx, ny, nz = unit(rx, ry, rz)
    v = climb_from_hint(shapes, bodies.shape[i], *base_direction(bodies, i, nx, ny, nz))
    value, nx, ny, nz, converged, x, y, z, a0, a1, a2 = climb_feature(
        shapes, bodies, i, j, rx, ry, rz, size, v, nx, ny, nz, enough
    )
    certain = rolling_radius(bodies.form_matrix, bodies.rotation, j)
    if not (value > enough or (converged and value >= -certain)):
        value, nx, ny, nz, x, y, z, a0 = least_of_mixed(
            shapes, bodies, bodies.form_matrix, i, j, rx, ry, rz, size, certain, a0, value, nx, ny, nz
        )
        a1, a2 = -1, -1
    return value, nx, ny, nz, x, y, z, a0, a1, a2


@routine
def check_feature(shapes, bodies, i, j, rx, ry, rz, size, a0, a1, a2, nx, ny, nz):
    """Whether hull i still touches ellipsoid j with this corner, edge or face: (holds, f, normal (3)), from n."""
    m = bodies.form_matrix
    vx, vy, vz = vertex_offset(shapes, bodies, i, a0)
    dx, dy, dz = rx - vx, ry - vy, rz - vz
    ex, ey, ez, fx, fy, fz, length, area = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0
    if a1 >= 0:
        ex, ey, ez = vertex_offset(shapes, bodies, i, a1)
        ex, ey, ez = ex - vx, ey - vy, ez - vz
        length = np.sqrt(ex * ex + ey * ey + ez * ez)
    if a2 >= 0:
        fx, fy, fz = vertex_offset(shapes, bodies, i, a2)
        fx, fy, fz = fx - vx, fy - vy, fz - vz
        x, y, z = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
        area = np.sqrt(x * x + y * y + z * z)
        if not area > 1e-13 * size * size:
            return False, 0.0, nx, ny, nz
        if x * nx + y * ny + z * nz < 0.0:
            area = -area
        nx, ny, nz = x / area, y / area, z / area
    gx, gy, gz = 0.0, 0.0, 0.0  # from the hull's vertex a0 to the ellipsoid's point
    for k in range(ITERATIONS + 1):
        if a1 >= 0 and a2 < 0:  # at right angles to the edge
            along = (nx * ex + ny * ey + nz * ez) / (length * length)
            nx, ny, nz = unit(nx - along * ex, ny - along * ey, nz - along * ez)
        ax, ay, az = image(m, j, nx, ny, nz)
        height = np.sqrt(nx * ax + ny * ay + nz * az)
        ax, ay, az = ax / height, ay / height, az / height
        gx, gy, gz = dx - ax, dy - ay, dz - az
        value = gx * nx + gy * ny + gz * nz
        if a2 >= 0:
            break
        if a1 >= 0:  # about the edge
            px, py, pz = (ey * nz - ez * ny) / length, (ez * nx - ex * nz) / length, (ex * ny - ey * nx) / length
            gp = gx * px + gy * py + gz * pz
            if abs(gp) <= BESIDE * size:
                break
            x, y, z = image(m, j, px, py, pz)
            ap = ax * px + ay * py + az * pz
            step = gp / (((px * x + py * y + pz * z) - ap * ap) / height + value)
            sx, sy, sz = step * px, step * py, step * pz
        else:
            px, py, pz, qx, qy, qz = tangents(nx, ny, nz)
            gp, gq = gx * px + gy * py + gz * pz, gx * qx + gy * qy + gz * qz
            if abs(gp) + abs(gq) <= BESIDE * size:
                break
            ap, aq = ax * px + ay * py + az * pz, ax * qx + ay * qy + az * qz
            x, y, z = image(m, j, px, py, pz)
            kpp = ((px * x + py * y + pz * z) - ap * ap) / height + value
            kpq = ((qx * x + qy * y + qz * z) - ap * aq) / height
            x, y, z = image(m, j, qx, qy, qz)
            kqq = ((qx * x + qy * y + qz * z) - aq * aq) / height + value
            det = kpp * kqq - kpq * kpq
            sp, sq = (kqq * gp - kpq * gq) / det, (kpp * gq - kpq * gp) / det
            sx, sy, sz = sp * px + sq * qx, sp * py + sq * qy, sp * pz + sq * qz
        if k == ITERATIONS or not sx * sx + sy * sy + sz * sz < 1e-2:
            return False, 0.0, nx, ny, nz
        nx, ny, nz = unit(nx + sx, ny + sy, nz + sz)
    # Where the ellipsoid's point lies on the edge or the face
    inside = 1.0
    if a2 >= 0:
        w1 = ((gy * fz - gz * fy) * nx + (gz * fx - gx * fz) * ny + (gx * fy - gy * fx) * nz) / area
        w2 = ((ey * gz - ez * gy) * nx + (ez * gx - ex * gz) * ny + (ex * gy - ey * gx) * nz) / area
        inside = min(w1, min(w2, 1.0 - w1 - w2))
    elif a1 >= 0:
        w1 = (gx * ex + gy * ey + gz * ez) / (length * length)
        inside = min(w1, 1.0 - w1)
    if not inside >= -INSIDE_TOLERANCE:
        return False, 0.0, nx, ny, nz
    shown, _ = gap_along(shapes, bodies, i, j, rx, ry, rz, a0, nx, ny, nz)
    return value - shown <= CHECK_TOLERANCE * size, shown, nx, ny, nz


@leaf
def recheck(shapes, bodies, contacts, p, i, j, rx, ry, rz):
    """Near pair p from its memory: (known, overlap [m], normal a to b (3), contact point relative to a (3)).

    The pair is apart where the overlap is not positive. Known is False for a pair without memory, for an overlap that
    need not be the least, and where the climb did not converge: then the pair has to be searched.
    """
    a0, a1, a2 = contacts.facet[p, 0], contacts.facet[p, 1], contacts.facet[p, 2]
    if a0 < 0:
        return False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    size = bodies.radius[i] + bodies.radius[j]
    nx, ny, nz = contacts.direction[p, 0], contacts.direction[p, 1], contacts.direction[p, 2]
    k, e = i, j
    swapped = not is_hull(shapes, bodies, i)
    if swapped:
        k, e = j, i
        rx, ry, rz, nx, ny, nz = -rx, -ry, -rz, -nx, -ny, -nz
    known, value, enough, searched = False, 0.0, np.inf, contacts.overlap[p]
    if contacts.touching[p] != 0:
        known, value, nx, ny, nz = check_feature(shapes, bodies, k, e, rx, ry, rz, size, a0, a1, a2, nx, ny, nz)
    else:  # a direction that still shows much of the gap searched last needs no better one
        enough = -STILL_GAP * searched
    if not known:
        value, nx, ny, nz, known, _, _, _, a0, a1, a2 = climb_feature(
            shapes, bodies, k, e, rx, ry, rz, size, a0, nx, ny, nz, enough
        )
    known = value > 0.0 or (known and value >= -rolling_radius(bodies.form_matrix, bodies.rotation, e))
    overlap, nx, ny, nz, x, y, z = _conclude(
        bodies, contacts, p, i, j, e, swapped, rx, ry, rz, value, nx, ny, nz, a0, a1, a2
    )
    if value > enough:
        overlap = min(overlap, searched)
    return known, overlap, nx, ny, nz, x, y, z


@routine
def search_contact(shapes, bodies, contacts, p, i, j, rx, ry, rz):
    """Near pair p from nothing: (overlap [m], normal a to b (3), contact point relative to a (3))."""
    size = bodies.radius[i] + bodies.radius[j]
    k, e = i, j
    swapped = not is_hull(shapes, bodies, i)
    if swapped:
        k, e = j, i
        rx, ry, rz = -rx, -ry, -rz
    value, nx, ny, nz, _, _, _, a0, a1, a2 = search_normal(shapes, bodies, k, e, rx, ry, rz, size, ENOUGH_GAP * size)
    if not value >= -rolling_radius(bodies.form_matrix, bodies.rotation, e):
        a0 = -1  # the next step would not trust it
    return _conclude(bodies, contacts, p, i, j, e, swapped, rx, ry, rz, value, nx, ny, nz, a0, a1, a2)


@leaf
def _conclude(bodies, contacts, p, i, j, e, swapped, rx, ry, rz, value, nx, ny, nz, a0, a1, a2):
    """Overlap, normal and point from f at its maximum; r and n are seen from the hull. A gap is remembered."""
    contacts.facet[p, 0], contacts.facet[p, 1], contacts.facet[p, 2] = a0, a1, a2
    x, y, z = image(bodies.form_matrix, e, nx, ny, nz)
    height = np.sqrt(nx * x + ny * y + nz * z)
    # From the hull's centre to the middle between the ellipsoid's point and the hull's, below it by the overlap
    half = 0.5 * value
    x, y, z = rx - x / height - half * nx, ry - y / height - half * ny, rz - z / height - half * nz
    if swapped:
        x, y, z = x - rx, y - ry, z - rz
        rx, ry, rz, nx, ny, nz = -rx, -ry, -rz, -nx, -ny, -nz
    if value >= 0.0:
        remember_apart(bodies, contacts, p, i, j, rx, ry, rz, value)
    return -value, nx, ny, nz, x, y, z
