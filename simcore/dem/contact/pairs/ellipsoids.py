"""Ellipsoid against ellipsoid by the common normal.

f(n) = n·r − h_A(n) − h_B(n) with h(n) = √(nᵀ M n), M = R diag(s²) Rᵀ, has its stationary points where the surfaces
have parallel tangent planes and the line between the two points is normal to both. Newton's iteration on the unit
sphere converges from the last step's normal in one or two steps. A gap is concave in n and has one maximum; an
overlap may have several, so a pair that comes without memory is searched for the deepest view (`deep`).
"""

import numpy as np

from simcore.compilation import leaf, routine
from simcore.dem.contact.pairs.gap_memory import STILL_GAP, remember_apart
from simcore.dem.contact.search.deep_overlap import climb_from, least_of_ellipsoids, rolling_radius, start_normal
from simcore.dem.contact.search.ellipsoid_climb import TOLERANCE, climb_normal, gap_along, image, support_height

__all__ = ["TOLERANCE", "climb_normal", "gap_along", "recheck", "search_contact", "search_normal", "support_height"]

ENOUGH_GAP = 0.02  # of the pair's size: a step need not know a wider gap to the last digit


@routine
def search_normal(m, i, j, rotation, rx, ry, rz, size, enough):
    """Global maximum of f, from nothing: (f, normal (3)). A gap f > enough ends the search early.

    A gap is concave in n: its maximum is the only one. A shallow overlap is certain to be the least (`deep` says why);
    from any other the search goes on through all directions.
    """
    nx, ny, nz = start_normal(m, i, j, rotation, rx, ry, rz)
    value, nx, ny, nz, converged = climb_from(m, i, j, rx, ry, rz, size, nx, ny, nz, enough)
    certain = rolling_radius(m, rotation, i) + rolling_radius(m, rotation, j)
    if value > enough or (converged and value >= -certain):
        return value, nx, ny, nz
    value, nx, ny, nz, _, _, _, _ = least_of_ellipsoids(m, m, m, i, j, rx, ry, rz, size, certain, 0, value, nx, ny, nz)
    return value, nx, ny, nz


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


@routine
def search_contact(bodies, contacts, p, i, j, rx, ry, rz):
    """Near pair p from nothing: (overlap [m], normal a to b (3), contact point relative to a (3))."""
    size = bodies.radius[i] + bodies.radius[j]
    value, nx, ny, nz = search_normal(bodies.form_matrix, i, j, bodies.rotation, rx, ry, rz, size, ENOUGH_GAP * size)
    return _conclude(bodies, contacts, p, i, j, rx, ry, rz, value, nx, ny, nz)


@leaf
def _conclude(bodies, contacts, p, i, j, rx, ry, rz, value, nx, ny, nz):
    """Overlap, normal and point from f at its maximum; a gap is remembered."""
    if value >= 0.0:
        remember_apart(bodies, contacts, p, i, j, rx, ry, rz, value)
        return -value, nx, ny, nz, 0.0, 0.0, 0.0
    x, y, z = image(bodies.form_matrix, i, nx, ny, nz)
    height = np.sqrt(nx * x + ny * y + nz * z)
    half = 0.5 * value
    return -value, nx, ny, nz, x / height + half * nx, y / height + half * ny, z / height + half * nz
