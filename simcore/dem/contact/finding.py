"""What bodies do to each other and to the walls: from signed distance to force and torque.

First a contact is checked from what the last step left (`check_*`), by one function for each kind of scene, so that its
step contains only what it needs; in a scene of mixed kinds the pair decides. What that does not answer is left pending
and searched from nothing (`search_*`). Both write overlap, direction and point to the arrays. Then the force law
presses, the same for all kinds.
"""

from simcore.compilation import leaf, routine
from simcore.dem.contact.pair import pair_of
from simcore.dem.contact.pairs import ellipsoid_potentials, ellipsoids, polyhedra, polyhedron_ellipsoid
from simcore.dem.contact.pairs.gap_memory import remember_apart, still_apart
from simcore.dem.contact.pairs.inflated import search_inflated
from simcore.dem.contact.pairs.spheres import touch
from simcore.dem.contact.walls import forget_springs
from simcore.dem.forces.spring_dashpot import (
    explicit_dashpot,
    implicit_dashpot,
    normal_force,
    patch_torque,
    preload,
    tangential_force,
)
from simcore.dem.shapes.hulls import CONVEX, ELLIPSOID, MIXED, is_hull
from simcore.dem.vectors import Vec, minus, read, squared, write

recheck_ellipsoids, search_ellipsoid_contact = ellipsoids.recheck, ellipsoids.search_contact
recheck_potentials, search_potential_contact = ellipsoid_potentials.recheck, ellipsoid_potentials.search_contact
recheck_polyhedra, search_polyhedron_contact = polyhedra.recheck, polyhedra.search_contact
recheck_mixed, search_mixed_contact = polyhedron_ellipsoid.recheck, polyhedron_ellipsoid.search_contact


@leaf
def offset_to_partner(bodies, contacts, p, width, periodic):
    """Vector from the centre of body a to that of its partner, b or an image of it."""
    r = minus(read(bodies.position, contacts.body_b[p]), read(bodies.position, contacts.body_a[p]))
    if periodic:
        return Vec(r.x + contacts.image[p, 0] * width, r.y + contacts.image[p, 1] * width, r.z)
    return r


@leaf
def partner_offset(bodies, contacts, p, width, periodic):
    """`offset_to_partner` as three numbers."""
    r = offset_to_partner(bodies, contacts, p, width, periodic)
    return r.x, r.y, r.z


@leaf
def _pair(bodies, contacts, p, width, periodic):
    """The bodies of candidate pair p."""
    r = offset_to_partner(bodies, contacts, p, width, periodic)
    return pair_of(bodies, contacts.body_a[p], contacts.body_b[p], r)


@leaf
def check_spheres(bodies, contacts, p, width, periodic):
    """Update contact p between spheres."""
    pair = _pair(bodies, contacts, p, width, periodic)
    if squared(pair.offset) < pair.size * pair.size:
        _store(contacts, p, touch(bodies, pair))
    elif contacts.touching[p] != 0:
        _end(contacts, p)


def _make_check(kind, potential=False):
    """Function that updates contact p of a scene of this kind from what is remembered, or leaves it pending."""

    @leaf
    def check(shapes, bodies, contacts, p, width, periodic):
        pair = _pair(bodies, contacts, p, width, periodic)
        if contacts.touching[p] == 0 and still_apart(bodies, contacts, p, pair):
            return
        if kind == MIXED:
            a, b = is_hull(shapes, bodies, pair.a), is_hull(shapes, bodies, pair.b)
            if a and b:
                certain, contact = recheck_polyhedra(shapes, bodies, contacts, p, pair)
            elif a or b:
                certain, contact = recheck_mixed(shapes, bodies, contacts, p, pair)
            else:
                certain, contact = recheck_ellipsoids(shapes, bodies, contacts, p, pair)
        elif kind == CONVEX:
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
    """Function that updates pending contact p of a scene of this kind from nothing."""

    @routine
    def search(shapes, bodies, contacts, p, width, periodic):
        pair = _pair(bodies, contacts, p, width, periodic)
        if kind == MIXED:
            a, b = is_hull(shapes, bodies, pair.a), is_hull(shapes, bodies, pair.b)
            if a and b:
                contact = search_polyhedron_contact(shapes, bodies, contacts, p, pair)
            elif a or b:
                contact = search_mixed_contact(shapes, bodies, contacts, p, pair)
            else:
                contact = search_ellipsoid_contact(shapes, bodies, contacts, p, pair)
        elif kind == CONVEX:
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
check_polyhedra, search_polyhedra = _make_check(CONVEX), _make_search(CONVEX)
check_mixed, search_mixed = _make_check(MIXED), _make_search(MIXED)


@routine
def find_inflated(shapes, bodies, contacts, p, width, periodic):
    """Touching contact p between convex polyhedra as the program of Rettinger et al. (2022) finds it.

    Where it finds none the contact has ended: its springs are gone, and the next step searches it from nothing.
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
    """Write a contact to the arrays; one that ended loses its springs."""
    write(contacts.direction, p, contact.normal)
    contacts.overlap[p] = contact.overlap
    if contact.overlap > 0.0:
        contacts.touching[p] = 1
        write(contacts.point, p, contact.point)
    elif contacts.touching[p] != 0:
        _end(contacts, p)


@leaf
def _end(contacts, p):
    contacts.touching[p] = 0
    forget_springs(contacts, p)


@leaf
def contact_velocity(bodies, i, j, px, py, pz, qx, qy, qz):
    """Velocity (3) of b against a where they touch; p, q: the point, from the centres of a and of b."""
    ux = bodies.velocity[j, 0] - bodies.velocity[i, 0]
    uy = bodies.velocity[j, 1] - bodies.velocity[i, 1]
    uz = bodies.velocity[j, 2] - bodies.velocity[i, 2]
    spin = bodies.angular_velocity
    ax, ay, az = spin[i, 0], spin[i, 1], spin[i, 2]
    bx, by, bz = spin[j, 0], spin[j, 1], spin[j, 2]
    ux += (by * qz - bz * qy) - (ay * pz - az * py)
    uy += (bz * qx - bx * qz) - (az * px - ax * pz)
    uz += (bx * qy - by * qx) - (ax * py - ay * px)
    return ux, uy, uz


@leaf
def wall_velocity(bodies, i, px, py, pz):
    """Velocity (3) of body i where it touches a wall; p: the point, from its centre."""
    wx, wy, wz = bodies.angular_velocity[i, 0], bodies.angular_velocity[i, 1], bodies.angular_velocity[i, 2]
    ux = bodies.velocity[i, 0] + wy * pz - wz * py
    uy = bodies.velocity[i, 1] + wz * px - wx * pz
    uz = bodies.velocity[i, 2] + wx * py - wy * px
    return ux, uy, uz


@leaf
def press_contact(bodies, contacts, law, dt, width, p, friction, attractive, periodic, patch, implicit, preloaded):
    """Force of touching contact p on b, torques on both, and its springs."""
    i, j = contacts.body_a[p], contacts.body_b[p]
    rx, ry, rz = partner_offset(bodies, contacts, p, width, periodic)
    nx, ny, nz = contacts.direction[p, 0], contacts.direction[p, 1], contacts.direction[p, 2]
    px, py, pz = contacts.point[p, 0], contacts.point[p, 1], contacts.point[p, 2]
    qx, qy, qz = px - rx, py - ry, pz - rz
    ux, uy, uz = contact_velocity(bodies, i, j, px, py, pz, qx, qy, qz)
    mass = bodies.mass[i] * bodies.mass[j] / (bodies.mass[i] + bodies.mass[j])
    if implicit:
        damping, tangential_damping = implicit_dashpot(law, max(1.0, bodies.hold[i], bodies.hold[j]))
    else:
        damping, tangential_damping = explicit_dashpot(law)
    push = normal_force(law, damping, mass, contacts.overlap[p], ux * nx + uy * ny + uz * nz, attractive)
    fx, fy, fz = push * nx, push * ny, push * nz
    if friction:
        limit = law.friction * abs(push)
        tx, ty, tz, sx, sy, sz = tangential_force(
            law, tangential_damping, mass, limit, dt, nx, ny, nz, ux, uy, uz,
            contacts.spring[p, 0], contacts.spring[p, 1], contacts.spring[p, 2],
        )  # fmt: skip
        if preloaded:
            sx, sy, sz = preload(
                law, tangential_damping, mass, limit, nx, ny, nz, ux, uy, uz, tx, ty, tz, sx, sy, sz, contacts.stuck, p
            )
        contacts.spring[p, 0], contacts.spring[p, 1], contacts.spring[p, 2] = sx, sy, sz
        fx, fy, fz = fx + tx, fy + ty, fz + tz
    contacts.force[p, 0], contacts.force[p, 1], contacts.force[p, 2] = fx, fy, fz
    mx, my, mz = 0.0, 0.0, 0.0
    if patch:
        spin = bodies.angular_velocity
        ax, ay, az = spin[i, 0], spin[i, 1], spin[i, 2]
        bx, by, bz = spin[j, 0], spin[j, 1], spin[j, 2]
        mx, my, mz = patch_torque(
            law, damping, tangential_damping, mass, push, dt, nx, ny, nz, bx - ax, by - ay, bz - az,
            contacts.spread, contacts.twist, p, friction,
        )  # fmt: skip
    contacts.torque_a[p, 0] = -(py * fz - pz * fy) - mx
    contacts.torque_a[p, 1] = -(pz * fx - px * fz) - my
    contacts.torque_a[p, 2] = -(px * fy - py * fx) - mz
    contacts.torque_b[p, 0] = qy * fz - qz * fy + mx
    contacts.torque_b[p, 1] = qz * fx - qx * fz + my
    contacts.torque_b[p, 2] = qx * fy - qy * fx + mz


@leaf
def press_wall(bodies, walls, law, dt, w, friction, attractive, patch, implicit, preloaded):
    """Force and torque of touching wall w on its body, and its springs."""
    i = walls.body[w]
    nx, ny, nz = walls.normal[w, 0], walls.normal[w, 1], walls.normal[w, 2]
    px, py, pz = walls.point[w, 0], walls.point[w, 1], walls.point[w, 2]
    ux, uy, uz = wall_velocity(bodies, i, px, py, pz)
    mass = bodies.mass[i]
    if implicit:
        damping, tangential_damping = implicit_dashpot(law, max(1.0, bodies.hold[i]))
    else:
        damping, tangential_damping = explicit_dashpot(law)
    push = normal_force(law, damping, mass, walls.overlap[w], ux * nx + uy * ny + uz * nz, attractive)
    fx, fy, fz = push * nx, push * ny, push * nz
    if friction:
        limit = law.friction * abs(push)
        tx, ty, tz, sx, sy, sz = tangential_force(
            law, tangential_damping, mass, limit, dt, nx, ny, nz, ux, uy, uz,
            walls.spring[w, 0], walls.spring[w, 1], walls.spring[w, 2],
        )  # fmt: skip
        if preloaded:
            sx, sy, sz = preload(
                law, tangential_damping, mass, limit, nx, ny, nz, ux, uy, uz, tx, ty, tz, sx, sy, sz, walls.stuck, w
            )
        walls.spring[w, 0], walls.spring[w, 1], walls.spring[w, 2] = sx, sy, sz
        fx, fy, fz = fx + tx, fy + ty, fz + tz
    walls.force[w, 0], walls.force[w, 1], walls.force[w, 2] = fx, fy, fz
    mx, my, mz = 0.0, 0.0, 0.0
    if patch:
        wx, wy, wz = bodies.angular_velocity[i, 0], bodies.angular_velocity[i, 1], bodies.angular_velocity[i, 2]
        mx, my, mz = patch_torque(
            law, damping, tangential_damping, mass, push, dt, nx, ny, nz, wx, wy, wz,
            walls.spread, walls.twist, w, friction,
        )  # fmt: skip
    walls.torque[w, 0] = py * fz - pz * fy + mx
    walls.torque[w, 1] = pz * fx - px * fz + my
    walls.torque[w, 2] = px * fy - py * fx + mz
