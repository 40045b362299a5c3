"""Ellipsoid against ellipsoid by the common normal.

f(n) = n·r − h_A(n) − h_B(n) with h(n) = √(nᵀ M n), M = R diag(s²) Rᵀ, has its stationary points where the surfaces
have parallel tangent planes and the line between the two points is normal to both. Newton's iteration on the unit
sphere converges from the last step's normal in one or two steps. A gap is concave in n and has one maximum; an
overlap may have several, so a pair without a remembered contact is searched for the least one (`deep_overlap`).
"""

import numpy as np

from simcore.compilation import leaf, routine
from simcore.dem.contact.pairs.gap_memory import STILL_GAP, remember_apart
from simcore.dem.contact.search.deep_overlap import climb_from, least_of_ellipsoids, rolling_radius, start_normal
from simcore.dem.contact.search.ellipsoid_climb import TOLERANCE, climb_normal, surface_point
from simcore.dem.vectors import ZERO, Contact, plus_scaled, read

__all__ = ["TOLERANCE", "recheck", "search_contact", "search_normal"]

ENOUGH_GAP = 0.02  # of the pair's size: a step needs no digits of a wider gap


@routine
def search_normal(shapes, bodies, pair, enough):
    """Summit of f: the global maximum, from nothing. A gap f > enough ends the search early.

    A gap is concave in n: its maximum is the only one. A shallow overlap is certain to be the least (`deep_overlap`
    says why); from any other the search goes on through all directions.
    """
    m, rotation = bodies.form_matrix, bodies.rotation
    top = climb_from(m, pair, start_normal(m, pair), enough)
    certain = rolling_radius(m, rotation, pair.a) + rolling_radius(m, rotation, pair.b)
    if top.value > enough or (top.converged and top.value >= -certain):
        return top
    return least_of_ellipsoids(shapes, bodies, pair, certain, top)


@leaf
def recheck(shapes, bodies, contacts, p, pair):
    """Candidate pair p from its remembered normal: (whether that is certain, Contact).

    The pair is apart where the overlap is not positive. Not certain: there is no remembered normal, or the iteration
    did not converge; then the pair has to be searched.
    """
    normal = read(contacts.direction, p)
    if normal.x == 0.0 and normal.y == 0.0 and normal.z == 0.0:
        return False, Contact(0.0, ZERO, ZERO)
    # A direction that still shows much of the gap searched last needs no better one; a contact needs the best.
    enough = np.inf if contacts.touching[p] != 0 else -STILL_GAP * contacts.overlap[p]
    top = climb_normal(bodies.form_matrix, pair, normal, enough)
    contact = _conclude(bodies, contacts, p, pair, top)
    overlap = contact.overlap
    if contacts.touching[p] == 0 and overlap <= 0.0:
        overlap = min(overlap, contacts.overlap[p])
    return top.converged or top.value > enough, Contact(overlap, contact.normal, contact.point)


@routine
def search_contact(shapes, bodies, contacts, p, pair):
    """Contact of candidate pair p, from nothing."""
    return _conclude(bodies, contacts, p, pair, search_normal(shapes, bodies, pair, ENOUGH_GAP * pair.size))


@leaf
def _conclude(bodies, contacts, p, pair, top):
    """Contact from the maximum of f; a gap is remembered."""
    if top.value >= 0.0:
        remember_apart(bodies, contacts, p, pair, top.value)
        return Contact(-top.value, top.normal, ZERO)
    point, _ = surface_point(bodies.form_matrix, pair.a, top.normal)
    return Contact(-top.value, top.normal, plus_scaled(point, 0.5 * top.value, top.normal))
