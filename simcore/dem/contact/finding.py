"""Where bodies touch each other: overlap, normal and point of each contact.

First a contact is checked from its memory: one function for each kind of scene, so that its step holds only what it
needs; in a scene of mixed kinds the pair decides. What the memory cannot answer is left pending and searched. Both
leave overlap, direction and point in the arrays, from which the force law presses (simcore.dem.forces.pressing).
"""

from simcore.compilation import leaf, routine
from simcore.dem.contact.pairs import ellipsoid_potentials as potential
from simcore.dem.contact.pairs import ellipsoids as ellipsoid
from simcore.dem.contact.pairs import polyhedra as polyhedron
from simcore.dem.contact.pairs import polyhedron_ellipsoid as mixed
from simcore.dem.contact.pairs import spheres as sphere
from simcore.dem.contact.pairs.gap_memory import remember_apart, still_apart
from simcore.dem.contact.pairs.inflated import search_inflated
from simcore.dem.shapes.hulls import is_hull
from simcore.dem.state.touches import forget_springs, partner_offset

touch_spheres = sphere.touch
recheck_ellipsoids, search_ellipsoid_contact = ellipsoid.recheck, ellipsoid.search_contact
recheck_potentials, search_potential_contact = potential.recheck, potential.search_contact
recheck_polyhedra, search_polyhedron_contact = polyhedron.recheck, polyhedron.search_contact
recheck_mixed, search_mixed_contact = mixed.recheck, mixed.search_contact


@leaf
def check_spheres(bodies, contacts, p, width, periodic):
    """Update contact p between spheres."""
    rx, ry, rz = partner_offset(bodies, contacts, p, width, periodic)
    i, j = contacts.body_a[p], contacts.body_b[p]
    reach = bodies.radius[i] + bodies.radius[j]
    if rx * rx + ry * ry + rz * rz < reach * reach:
        overlap, nx, ny, nz, x, y, z = touch_spheres(bodies, i, j, rx, ry, rz)
        _note(contacts, p, overlap, nx, ny, nz, x, y, z)
    elif contacts.touching[p] != 0:
        _end(contacts, p)


@leaf
def check_ellipsoids(bodies, contacts, p, width, periodic):
    """Update contact p between ellipsoids from its memory, or leave it pending."""
    i, j = contacts.body_a[p], contacts.body_b[p]
    rx, ry, rz = partner_offset(bodies, contacts, p, width, periodic)
    if contacts.touching[p] != 0 or not still_apart(bodies, contacts, p, i, j, rx, ry, rz):
        known, overlap, nx, ny, nz, x, y, z = recheck_ellipsoids(bodies, contacts, p, i, j, rx, ry, rz)
        contacts.pending[p] = not known
        if known:
            _note(contacts, p, overlap, nx, ny, nz, x, y, z)


@leaf
def check_potentials(bodies, contacts, p, width, periodic):
    """Update contact p between ellipsoids by their potentials from its memory, or leave it pending."""
    i, j = contacts.body_a[p], contacts.body_b[p]
    rx, ry, rz = partner_offset(bodies, contacts, p, width, periodic)
    if contacts.touching[p] != 0 or not still_apart(bodies, contacts, p, i, j, rx, ry, rz):
        known, overlap, nx, ny, nz, x, y, z = recheck_potentials(bodies, contacts, p, i, j, rx, ry, rz)
        contacts.pending[p] = not known
        if known:
            _note(contacts, p, overlap, nx, ny, nz, x, y, z)


@leaf
def check_polyhedra(shapes, bodies, contacts, p, width, periodic):
    """Update contact p between convex polyhedra from its memory, or leave it pending."""
    i, j = contacts.body_a[p], contacts.body_b[p]
    rx, ry, rz = partner_offset(bodies, contacts, p, width, periodic)
    if contacts.touching[p] != 0 or not still_apart(bodies, contacts, p, i, j, rx, ry, rz):
        known, overlap, nx, ny, nz, x, y, z = recheck_polyhedra(shapes, bodies, contacts, p, i, j, rx, ry, rz)
        contacts.pending[p] = not known
        if known:
            _note(contacts, p, overlap, nx, ny, nz, x, y, z)


@leaf
def check_mixed(shapes, bodies, contacts, p, width, periodic):
    """Update contact p between ellipsoids, polyhedra or one of each from its memory, or leave it pending."""
    i, j = contacts.body_a[p], contacts.body_b[p]
    rx, ry, rz = partner_offset(bodies, contacts, p, width, periodic)
    if contacts.touching[p] != 0 or not still_apart(bodies, contacts, p, i, j, rx, ry, rz):
        hull_a, hull_b = is_hull(shapes, bodies, i), is_hull(shapes, bodies, j)
        if hull_a and hull_b:
            known, overlap, nx, ny, nz, x, y, z = recheck_polyhedra(shapes, bodies, contacts, p, i, j, rx, ry, rz)
        elif hull_a or hull_b:
            known, overlap, nx, ny, nz, x, y, z = recheck_mixed(shapes, bodies, contacts, p, i, j, rx, ry, rz)
        else:
            known, overlap, nx, ny, nz, x, y, z = recheck_ellipsoids(bodies, contacts, p, i, j, rx, ry, rz)
        contacts.pending[p] = not known
        if known:
            _note(contacts, p, overlap, nx, ny, nz, x, y, z)


@routine
def search_ellipsoids(bodies, contacts, p, width, periodic):
    """Update pending contact p between ellipsoids."""
    rx, ry, rz = partner_offset(bodies, contacts, p, width, periodic)
    overlap, nx, ny, nz, x, y, z = search_ellipsoid_contact(
        bodies, contacts, p, contacts.body_a[p], contacts.body_b[p], rx, ry, rz
    )
    contacts.pending[p] = 0
    _note(contacts, p, overlap, nx, ny, nz, x, y, z)


@routine
def search_potentials(bodies, contacts, p, width, periodic):
    """Update pending contact p between ellipsoids by their potentials."""
    rx, ry, rz = partner_offset(bodies, contacts, p, width, periodic)
    overlap, nx, ny, nz, x, y, z = search_potential_contact(
        bodies, contacts, p, contacts.body_a[p], contacts.body_b[p], rx, ry, rz
    )
    contacts.pending[p] = 0
    _note(contacts, p, overlap, nx, ny, nz, x, y, z)


@routine
def search_polyhedra(shapes, bodies, contacts, p, width, periodic):
    """Update pending contact p between convex polyhedra."""
    rx, ry, rz = partner_offset(bodies, contacts, p, width, periodic)
    overlap, nx, ny, nz, x, y, z = search_polyhedron_contact(
        shapes, bodies, contacts, p, contacts.body_a[p], contacts.body_b[p], rx, ry, rz
    )
    contacts.pending[p] = 0
    _note(contacts, p, overlap, nx, ny, nz, x, y, z)


@routine
def search_mixed(shapes, bodies, contacts, p, width, periodic):
    """Update pending contact p between ellipsoids, polyhedra or one of each."""
    i, j = contacts.body_a[p], contacts.body_b[p]
    hull_a, hull_b = is_hull(shapes, bodies, i), is_hull(shapes, bodies, j)
    if hull_a and hull_b:
        search_polyhedra(shapes, bodies, contacts, p, width, periodic)
    elif hull_a or hull_b:
        rx, ry, rz = partner_offset(bodies, contacts, p, width, periodic)
        overlap, nx, ny, nz, x, y, z = search_mixed_contact(shapes, bodies, contacts, p, i, j, rx, ry, rz)
        contacts.pending[p] = 0
        _note(contacts, p, overlap, nx, ny, nz, x, y, z)
    else:
        search_ellipsoids(bodies, contacts, p, width, periodic)


@routine
def find_inflated(shapes, bodies, contacts, p, width, periodic):
    """Touching contact p between convex polyhedra as the source study's program finds it.

    Where it loses it the contact has ended: its springs are gone, and the next step searches it from nothing.
    """
    i, j = contacts.body_a[p], contacts.body_b[p]
    rx, ry, rz = partner_offset(bodies, contacts, p, width, periodic)
    found, overlap, nx, ny, nz, x, y, z = search_inflated(shapes, bodies, i, j, rx, ry, rz)
    if found:
        _note(contacts, p, overlap, nx, ny, nz, x, y, z)
    else:
        _end(contacts, p)
        remember_apart(bodies, contacts, p, i, j, rx, ry, rz, 0.0)


@leaf
def _note(contacts, p, overlap, nx, ny, nz, px, py, pz):
    """Write what was found; a contact that ended loses its springs."""
    contacts.direction[p, 0], contacts.direction[p, 1], contacts.direction[p, 2] = nx, ny, nz
    contacts.overlap[p] = overlap
    if overlap > 0.0:
        contacts.touching[p] = 1
        contacts.point[p, 0], contacts.point[p, 1], contacts.point[p, 2] = px, py, pz
    elif contacts.touching[p] != 0:
        _end(contacts, p)


@leaf
def _end(contacts, p):
    contacts.touching[p] = 0
    forget_springs(contacts, p)
