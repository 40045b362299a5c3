"""Ellipsoid against ellipsoid by the least potential of the one on the surface of the other.

The construction of Baram and Lind (arXiv:1110.2792), after Perram et al. (1996). The potential of an ellipsoid is its
quadratic form, 0 at its centre and 1 on its surface. Where it is least on the other's surface, the other is deepest in
it. Two such points, one on each surface, span the contact vector: its length is the overlap, its middle the contact
point. With M = R diag(s²) Rᵀ and r from a to b, b's point is r − M_b g and a's is M_a g, where for each

    (M_near + λ M_far) g = r,   φ(λ) = gᵀ M_near g = 1,

g the gradient of the surface's own ellipsoid there (half of it, for b reversed) and λ >= 0, as long as neither centre
lies in the other body. φ falls and 1/√φ is concave in λ (as in trust regions, Moré and Sorensen 1983), so Newton's
iteration climbs to the one root from any start below it, and a start above it falls below in one step. λ follows from
the normal: λ = h_near (n·r − h_near) / h_far², which the last step's normal answers to second order. No other memory.

Direction. The contact vector is no normal: as the depth δ goes to zero it tends to δ (n + t), n the common normal, t
tangential, of the order of the tangents of the angles between n and the lines to the centres, and none for spheres. A
force along it feeds or eats energy in every oblique impact. The gradients at both points tend to ±n.
# ASSUME: the paper replaces the direction by the averaged gradients where it deviates from them, by an angle that its
# text has lost. Here always: the vector deviates by 20 degrees on average in pairs of 1.6 : 1 : 0.6, however shallow.
The length stays: |n + t| times the depth along the normal, a spring that is stiffer by as much. Since that factor
changes as the contact slides, elastic impacts lose some energy, in proportion to their depth. What all this does is
measured in benchmarks/studies/ellipsoid_contact.py.

Separation. For λ > 0, det(λA + B) of the 4 × 4 forms has the sign of λ rᵀ (M_a + λ M_b)⁻¹ r − 1 − λ. It has two
distinct positive roots where that is positive for some λ, and then the pair is apart (Wang et al. 2001). Divided by
1 + λ it is Perram and Wertheim's function of λ / (1 + λ) less one, which is concave, so its maximum decides. Where it
is positive, q = (M_a + λ M_b)⁻¹ r is normal to a separating plane, and the gap along q is certain. That plane is
remembered and asked first; and nothing at all is asked until the bodies can have closed the gap (`gap`).

A plane has no centre; the walls press at the deepest point, whatever the construction for pairs.
"""

import numpy as np

from simcore.compilation import leaf, routine
from simcore.dem.contact.pairs.ellipsoids import search_contact as search_common_normal
from simcore.dem.contact.pairs.gap_memory import STILL_GAP, remember_apart
from simcore.dem.contact.search.deep_overlap import start_normal, unit
from simcore.dem.contact.search.ellipsoid_climb import gap_along, image, support_height

CLOSE = 1e-8  # |√φ − 1| from which one more step, with g taken as linear in it, is right to rounding
FEW, MANY = 8, 60  # iterations from the last normal, which takes one to three, and from nothing
FLAT = 1e-8  # |Δ log λ| at the maximum that decides on separation: its value is right to the square of this
ENOUGH = 0.1  # the same where the value shows a gap already


@leaf
def _factor(m, i, j, factor):
    """M_i + factor M_j as L D Lᵀ: D (3), L (3)."""
    xx, yy, zz = m[i, 0] + factor * m[j, 0], m[i, 1] + factor * m[j, 1], m[i, 2] + factor * m[j, 2]
    xy, xz, yz = m[i, 3] + factor * m[j, 3], m[i, 4] + factor * m[j, 4], m[i, 5] + factor * m[j, 5]
    lyx, lzx = xy / xx, xz / xx
    dy = yy - lyx * xy
    lzy = (yz - lyx * xz) / dy
    return xx, dy, zz - lzx * xz - lzy * lzy * dy, lyx, lzx, lzy


@leaf
def _solve(dx, dy, dz, lyx, lzx, lzy, x, y, z):
    y = y - lyx * x
    z = z - lzx * x - lzy * y
    z = z / dz
    y = y / dy - lzy * z
    return x / dx - lyx * y - lzx * z, y, z


@leaf
def deepest_gradient(m, near, far, rx, ry, rz, start, iterations):
    """Where the surface of `near` is deepest in `far`: (found, λ, g (3)), gᵀ M_near g = 1 but for rounding.

    r from a to b, whichever is near. start: of λ. Not found where the centre of `far` lies in `near`.
    """
    factor = max(start, 0.0)
    gx, gy, gz = 0.0, 0.0, 0.0
    for _ in range(iterations):
        dx, dy, dz, lyx, lzx, lzy = _factor(m, near, far, factor)
        gx, gy, gz = _solve(dx, dy, dz, lyx, lzx, lzy, rx, ry, rz)
        nx, ny, nz = image(m, near, gx, gy, gz)
        fx, fy, fz = image(m, far, gx, gy, gz)
        zx, zy, zz = _solve(dx, dy, dz, lyx, lzx, lzy, fx, fy, fz)  # −dg/dλ
        square = gx * nx + gy * ny + gz * nz
        root = np.sqrt(square)
        step = square * (root - 1.0) / (nx * zx + ny * zy + nz * zz)
        if abs(root - 1.0) <= CLOSE:
            return factor + step >= 0.0, factor + step, gx - step * zx, gy - step * zy, gz - step * zz
        if not (step > 0.0 or factor > 0.0):
            break
        factor = max(factor + step, 0.0)
    return False, factor, gx, gy, gz


@routine
def contact_of(m, i, j, rx, ry, rz, nx, ny, nz, iterations):
    """Contact from a normal close to it: (found, overlapping, contact vector (3), normal (3), middle (3)).

    From the centre of a. Apart, the contact vector points backwards, from b to a; its length is no bound of the gap.
    """
    across = nx * rx + ny * ry + nz * rz
    height_a, height_b = support_height(m, i, nx, ny, nz), support_height(m, j, nx, ny, nz)
    start_a = height_a * (across - height_a) / (height_b * height_b)
    start_b = height_b * (across - height_b) / (height_a * height_a)
    found_a, factor_a, ax, ay, az = deepest_gradient(m, i, j, rx, ry, rz, start_a, iterations)
    found_b, factor_b, bx, by, bz = deepest_gradient(m, j, i, rx, ry, rz, start_b, iterations)
    px, py, pz = image(m, i, ax, ay, az)
    qx, qy, qz = image(m, j, bx, by, bz)
    reach_a, reach_b = np.sqrt(ax * px + ay * py + az * pz), np.sqrt(bx * qx + by * qy + bz * qz)
    px, py, pz, qx, qy, qz = px / reach_a, py / reach_a, pz / reach_a, qx / reach_b, qy / reach_b, qz / reach_b
    # Each one's potential at the other's point, 1 where they only touch
    of_b = factor_a * support_height(m, j, ax, ay, az)
    of_a = factor_b * support_height(m, i, bx, by, bz)
    # Sums that do not depend on which of the two comes first: exchanged, they are the same to the bit
    cx, cy, cz = (px + qx) - rx, (py + qy) - ry, (pz + qz) - rz
    length_a, length_b = np.sqrt(ax * ax + ay * ay + az * az), np.sqrt(bx * bx + by * by + bz * bz)
    nx, ny, nz = unit(ax / length_a + bx / length_b, ay / length_a + by / length_b, az / length_a + bz / length_b)
    found = found_a and found_b
    return found, of_a + of_b < 2.0, cx, cy, cz, nx, ny, nz, px - 0.5 * cx, py - 0.5 * cy, pz - 0.5 * cz


@leaf
def characteristic(m, i, j, rx, ry, rz, factor):
    """det(λA + B) at λ = factor > 0, over a positive number: (value, q (3), Newton's step of log λ to its maximum).

    Over 1 + λ the value is largest where √(qᵀ M_a q) = λ √(qᵀ M_b q).
    """
    dx, dy, dz, lyx, lzx, lzy = _factor(m, i, j, factor)
    qx, qy, qz = _solve(dx, dy, dz, lyx, lzx, lzy, rx, ry, rz)
    ax, ay, az = image(m, i, qx, qy, qz)
    bx, by, bz = image(m, j, qx, qy, qz)
    a, b = qx * ax + qy * ay + qz * az, qx * bx + qy * by + qz * bz
    zx, zy, zz = _solve(dx, dy, dz, lyx, lzx, lzy, bx, by, bz)
    c = bx * zx + by * zy + bz * zz
    left = 0.5 * np.log(a / b) - np.log(factor)
    slope = 1.0 + factor * (b / a - factor * c / a - c / b)
    if not slope > 0.1:
        slope = 1.0
    return factor * (qx * rx + qy * ry + qz * rz) - 1.0 - factor, qx, qy, qz, left / slope


@leaf
def separation(m, i, j, rx, ry, rz, nx, ny, nz):
    """Whether the pair is apart, by the roots of det(λA + B): (apart, normal of a separating plane (3))."""
    guess = np.log(support_height(m, i, nx, ny, nz) / support_height(m, j, nx, ny, nz))
    low, high = -np.inf, np.inf
    apart, qx, qy, qz = False, nx, ny, nz
    for _ in range(MANY):
        value, qx, qy, qz, step = characteristic(m, i, j, rx, ry, rz, np.exp(guess))
        apart = value > 0.0
        if abs(step) <= (ENOUGH if apart else FLAT):
            break
        if step > 0.0:
            low = guess
        else:
            high = guess
        trial = guess + min(max(step, -2.0), 2.0)
        if not (trial > low and trial < high):
            trial = 0.5 * (low + high)
        if trial == guess:
            break
        guess = trial
    qx, qy, qz = unit(qx, qy, qz)
    return apart, qx, qy, qz


@leaf
def recheck(bodies, contacts, p, i, j, rx, ry, rz):
    """Near pair p from its last normal: (known, overlap [m], normal a to b (3), contact point relative to a (3)).

    The pair is apart where the overlap is not positive. Known is False for a pair without a normal, where the
    remembered plane no longer separates, where the iteration takes long, and where a centre lies in the other body.
    """
    nx, ny, nz = contacts.direction[p, 0], contacts.direction[p, 1], contacts.direction[p, 2]
    if nx == 0.0 and ny == 0.0 and nz == 0.0:
        return False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    m = bodies.form_matrix
    if contacts.touching[p] == 0:
        gap = gap_along(m, i, j, rx, ry, rz, nx, ny, nz)
        if not gap > -STILL_GAP * contacts.overlap[p]:
            return False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        remember_apart(bodies, contacts, p, i, j, rx, ry, rz, gap)
        return True, min(-gap, contacts.overlap[p]), nx, ny, nz, 0.0, 0.0, 0.0
    found, overlapping, cx, cy, cz, nx, ny, nz, x, y, z = contact_of(m, i, j, rx, ry, rz, nx, ny, nz, FEW)
    if not found:
        return False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    overlap = _conclude(bodies, contacts, p, i, j, rx, ry, rz, overlapping, cx, cy, cz, nx, ny, nz)
    return True, overlap, nx, ny, nz, x, y, z


@routine
def search_contact(bodies, contacts, p, i, j, rx, ry, rz):
    """Near pair p from nothing: (overlap [m], normal a to b (3), contact point relative to a (3)).

    Where a centre lies in the other body the potential there falls outwards, and what is least on the surface is the
    far side: such a pair, thousands of times deeper than any in a bed, meets along its common normal.
    """
    m = bodies.form_matrix
    nx, ny, nz = start_normal(m, i, j, bodies.rotation, rx, ry, rz)
    apart, px, py, pz = separation(m, i, j, rx, ry, rz, nx, ny, nz)
    if apart:
        gap = max(gap_along(m, i, j, rx, ry, rz, px, py, pz), 0.0)
        remember_apart(bodies, contacts, p, i, j, rx, ry, rz, gap)
        return -gap, px, py, pz, 0.0, 0.0, 0.0
    found, overlapping, cx, cy, cz, nx, ny, nz, x, y, z = contact_of(m, i, j, rx, ry, rz, nx, ny, nz, MANY)
    if not found:
        return search_common_normal(bodies, contacts, p, i, j, rx, ry, rz)
    overlap = _conclude(bodies, contacts, p, i, j, rx, ry, rz, overlapping, cx, cy, cz, nx, ny, nz)
    return overlap, nx, ny, nz, x, y, z


@leaf
def _conclude(bodies, contacts, p, i, j, rx, ry, rz, overlapping, cx, cy, cz, nx, ny, nz):
    """Overlap, the length of the contact vector; a gap is remembered and negative."""
    if overlapping:
        return np.sqrt(cx * cx + cy * cy + cz * cz)
    gap = max(gap_along(bodies.form_matrix, i, j, rx, ry, rz, nx, ny, nz), 0.0)
    remember_apart(bodies, contacts, p, i, j, rx, ry, rz, gap)
    return -gap
