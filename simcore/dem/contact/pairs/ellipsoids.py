"""Contacts of two ellipsoids by their common normal.

f(n) = n·r − h_A(n) − h_B(n) with h(n) = √(nᵀ M n), M = R diag(s²) Rᵀ, is stationary where the surfaces have parallel
tangent planes and the line between the two surface points is normal to both. Newton's iteration on the unit sphere
converges from the normal of the last step in one or two steps. A gap is concave in n and has one maximum. An overlap
may have several local minima, so that a pair without a remembered contact, or with a deep one, is searched for the
least one (`deep_overlap`).
"""

import numpy as np

from simcore.compilation import leaf, routine
from simcore.dem.contact.pairs.remembered_gaps import STILL_GAP, remember_apart
from simcore.dem.contact.search.deep_overlap import climb_from, least_of_ellipsoids, rolling_radius, start_normal
from simcore.dem.contact.search.ellipsoid_climb import TOLERANCE, climb_normal, surface_point
from simcore.dem.vectors import ZERO, Contact, plus_scaled, read

__all__ = ["TOLERANCE", "recheck", "search_contact", "search_normal"]

ENOUGH_GAP = 0.02  # of the pair's size: a step needs no accurate value of a wider gap


@routine
def search_normal(shapes, bodies, pair, enough):
    """Search the global maximum of f: Summit. A gap f > enough ends the search early.

    A gap is concave in n, so that its maximum is the only one. A shallow overlap is certainly the least one
    (`deep_overlap` explains why). After any other result the search continues through all directions.
    """
    m, rotation = bodies.form_matrix, bodies.rotation
    top = climb_from(m, pair, start_normal(m, pair), enough)
    certain = rolling_radius(m, rotation, pair.a) + rolling_radius(m, rotation, pair.b)
    if top.value > enough or (top.converged and top.value >= -certain):
        return top
    return least_of_ellipsoids(shapes, bodies, pair, certain, top)


@leaf
def recheck(shapes, bodies, contacts, p, pair):
    """Check candidate pair p from its remembered normal: (whether the result is certain, Contact).

    The pair is apart if the overlap is not positive. The result is not certain if there is no remembered normal, the
    overlap may not be the least one, or the iteration did not converge; the pair must then be searched.
    """
    normal = read(contacts.direction, p)
    if normal.x == 0.0 and normal.y == 0.0 and normal.z == 0.0:
        return False, Contact(0.0, ZERO, ZERO)
    # A direction that shows much of the gap of the last search suffices for a pair apart; a contact needs the best one.
    enough = np.inf if contacts.touching[p] != 0 else -STILL_GAP * contacts.overlap[p]
    top = climb_normal(bodies.form_matrix, pair, normal, enough)
    contact = _conclude(bodies, contacts, p, pair, top)
    overlap = contact.overlap
    if contacts.touching[p] == 0 and overlap <= 0.0:
        overlap = min(overlap, contacts.overlap[p])
    certain = top.converged or top.value > enough
    if certain and top.value < 0.0:
        m, rotation = bodies.form_matrix, bodies.rotation
        certain = top.value >= -(rolling_radius(m, rotation, pair.a) + rolling_radius(m, rotation, pair.b))
    return certain, Contact(overlap, contact.normal, contact.point)


@routine
def search_contact(shapes, bodies, contacts, p, pair):
    """Search the contact of candidate pair p, without a remembered contact."""
    return _conclude(bodies, contacts, p, pair, search_normal(shapes, bodies, pair, ENOUGH_GAP * pair.size))


@leaf
def _conclude(bodies, contacts, p, pair, top):
    """Return the contact at the maximum of f; remember a gap."""
    if top.value >= 0.0:
        remember_apart(bodies, contacts, p, pair, top.value)
        return Contact(-top.value, top.normal, ZERO)
    point, _ = surface_point(bodies.form_matrix, pair.a, top.normal)
    return Contact(-top.value, top.normal, plus_scaled(point, 0.5 * top.value, top.normal))
