"""The contacts of a step: overlap, normal and point of each candidate pair.

First each pair is checked from its remembered contact (`check_*`). There is one function for each kind of scene, so
that its step contains only what it needs; in a scene of mixed kinds the shapes of the pair select the method. If the
check is not sufficient, the pair is pending and is searched anew (`search_*`). Both write overlap, direction and point
to the arrays that the force law reads (simcore.dem.forces.pressing).
"""

from simcore.compilation import leaf, routine
from simcore.dem.contact.pair import pair_of
from simcore.dem.contact.pairs import ellipsoid_potentials, ellipsoids, polyhedra, polyhedron_ellipsoid
from simcore.dem.contact.pairs.inflated import search_inflated
from simcore.dem.contact.pairs.remembered_gaps import remember_apart, still_apart
from simcore.dem.contact.pairs.spheres import touch
from simcore.dem.shapes.polyhedra import ELLIPSOID, MIXED, POLYHEDRON, is_polyhedron
from simcore.dem.state.touches import forget_springs, partner_offset
from simcore.dem.vectors import ZERO, Contact, squared, write

recheck_ellipsoids, search_ellipsoid_contact = ellipsoids.recheck, ellipsoids.search_contact
recheck_potentials, search_potential_contact = ellipsoid_potentials.recheck, ellipsoid_potentials.search_contact
recheck_polyhedra, search_polyhedron_contact = polyhedra.recheck, polyhedra.search_contact
recheck_mixed, search_mixed_contact = polyhedron_ellipsoid.recheck, polyhedron_ellipsoid.search_contact


@leaf
def _pair(bodies, contacts, p, width, periodic):
    """Return the Pair of candidate pair p."""
    offset = partner_offset(bodies, contacts, p, width, periodic)
    return pair_of(bodies, contacts.body_a[p], contacts.body_b[p], offset)


@leaf
def check_spheres(bodies, contacts, p, width, periodic):
    """Update contact p of two spheres."""
    touch_spheres(bodies, contacts, p, width, periodic, True)


@leaf
def touch_spheres(bodies, contacts, p, width, periodic, storing):
    """Update contact p of two spheres; return (whether they touch, their Contact, the offset of their centres [m]).

    storing: whether overlap, normal and point are written to the arrays. The Contact has no meaning if they are apart.
    """
    pair = _pair(bodies, contacts, p, width, periodic)
    if squared(pair.offset) < pair.size * pair.size:
        contact = touch(bodies, pair)
        if contact.overlap > 0.0:
            contacts.touching[p] = 1
            if storing:
                _store(contacts, p, contact)
            return True, contact, pair.offset
    if contacts.touching[p] != 0:
        _end(contacts, p)
        contacts.overlap[p] = 0.0
        write(contacts.direction, p, ZERO)
    return False, Contact(0.0, ZERO, ZERO), pair.offset


def _make_check(kind, potential=False):
    """Return the function that updates contact p of a scene of this kind from its remembered contact.

    The function leaves the pair pending if the remembered contact is not sufficient.
    """

    @leaf
    def check(shapes, bodies, contacts, p, width, periodic):
        pair = _pair(bodies, contacts, p, width, periodic)
        if contacts.touching[p] == 0 and still_apart(bodies, contacts, p, pair):
            return
        if kind == MIXED:
            a, b = is_polyhedron(shapes, bodies, pair.a), is_polyhedron(shapes, bodies, pair.b)
            if a and b:
                certain, contact = recheck_polyhedra(shapes, bodies, contacts, p, pair)
            elif a or b:
                certain, contact = recheck_mixed(shapes, bodies, contacts, p, pair)
            else:
                certain, contact = recheck_ellipsoids(shapes, bodies, contacts, p, pair)
        elif kind == POLYHEDRON:
            certain, contact = recheck_polyhedra(shapes, bodies, contacts, p, pair)
        elif potential:
            certain, contact = recheck_potentials(shapes, bodies, contacts, p, pair)
        else:
            certain, contact = recheck_ellipsoids(shapes, bodies, contacts, p, pair)
        contacts.pending[p] = not certain
        if certain:
            _store(contacts, p, contact)

    return check


def _make_search(kind, potential=False):
    """Return the function that searches pending contact p of a scene of this kind."""

    @routine
    def search(shapes, bodies, contacts, p, width, periodic):
        pair = _pair(bodies, contacts, p, width, periodic)
        if kind == MIXED:
            a, b = is_polyhedron(shapes, bodies, pair.a), is_polyhedron(shapes, bodies, pair.b)
            if a and b:
                contact = search_polyhedron_contact(shapes, bodies, contacts, p, pair)
            elif a or b:
                contact = search_mixed_contact(shapes, bodies, contacts, p, pair)
            else:
                contact = search_ellipsoid_contact(shapes, bodies, contacts, p, pair)
        elif kind == POLYHEDRON:
            contact = search_polyhedron_contact(shapes, bodies, contacts, p, pair)
        elif potential:
            contact = search_potential_contact(shapes, bodies, contacts, p, pair)
        else:
            contact = search_ellipsoid_contact(shapes, bodies, contacts, p, pair)
        contacts.pending[p] = 0
        _store(contacts, p, contact)

    return search


check_ellipsoids, search_ellipsoids = _make_check(ELLIPSOID), _make_search(ELLIPSOID)
check_potentials, search_potentials = _make_check(ELLIPSOID, potential=True), _make_search(ELLIPSOID, potential=True)
check_polyhedra, search_polyhedra = _make_check(POLYHEDRON), _make_search(POLYHEDRON)
check_mixed, search_mixed = _make_check(MIXED), _make_search(MIXED)


@routine
def find_inflated(shapes, bodies, contacts, p, width, periodic):
    """Update touching contact p of two convex polyhedra as the program of Rettinger et al. (2022) finds it.

    If that program finds no contact, the contact ends: its springs are reset, and the next step searches the pair anew.
    """
    pair = _pair(bodies, contacts, p, width, periodic)
    exists, contact = search_inflated(shapes, bodies, pair)
    if exists:
        _store(contacts, p, contact)
    else:
        _end(contacts, p)
        remember_apart(bodies, contacts, p, pair, 0.0)


@leaf
def _store(contacts, p, contact):
    """Write a contact to the arrays; reset its springs if it has ended."""
    write(contacts.direction, p, contact.normal)
    contacts.overlap[p] = contact.overlap
    if contact.overlap > 0.0:
        contacts.touching[p] = 1
        write(contacts.point, p, contact.point)
    elif contacts.touching[p] != 0:
        _end(contacts, p)


@leaf
def _end(contacts, p):
    """Mark contact p as apart; reset its springs, its point and its forces."""
    contacts.touching[p] = 0
    forget_springs(contacts, p)
    for field in (contacts.point, contacts.force, contacts.torque_a, contacts.torque_b):
        write(field, p, ZERO)
