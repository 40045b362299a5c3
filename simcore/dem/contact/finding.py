"""What bodies do to each other and to the walls: from signed distance to force and torque.

First a contact is checked from its memory: one function for each kind of scene, so that its step holds only what it
needs; in a scene of mixed kinds the pair decides. What the memory cannot answer is left pending and searched. Both
leave overlap, direction and point in the arrays. Then the force law presses, the same for all kinds.
"""

from simcore.compilation import leaf, routine
from simcore.dem.contact.pairs import ellipsoid_potentials as potential
from simcore.dem.contact.pairs import ellipsoids as ellipsoid
from simcore.dem.contact.pairs import polyhedra as polyhedron
from simcore.dem.contact.pairs import polyhedron_ellipsoid as mixed
from simcore.dem.contact.pairs import spheres as sphere
from simcore.dem.contact.pairs.gap_memory import remember_apart, still_apart
from simcore.dem.contact.pairs.inflated import search_inflated
from simcore.dem.contact.walls import forget_springs
from simcore.dem.forces.spring_dashpot import (
    explicit_dashpot,
    implicit_dashpot,
    normal_force,
    patch_torque,
    preload,
    tangential_force,
)
from simcore.dem.shapes.hulls import is_hull

touch_spheres = sphere.touch
recheck_ellipsoids, search_ellipsoid_contact = ellipsoid.recheck, ellipsoid.search_contact
recheck_potentials, search_potential_contact = potential.recheck, potential.search_contact
recheck_polyhedra, search_polyhedron_contact = polyhedron.recheck, polyhedron.search_contact
recheck_mixed, search_mixed_contact = mixed.recheck, mixed.search_contact


@leaf
def partner_offset(bodies, contacts, p, width, periodic):
    """Vector from the centre of body a to that of its partner, b or an image of it."""
    i, j = contacts.body_a[p], contacts.body_b[p]
    rx = bodies.position[j, 0] - bodies.position[i, 0]
    ry = bodies.position[j, 1] - bodies.position[i, 1]
    rz = bodies.position[j, 2] - bodies.position[i, 2]
    if periodic:
        return rx + contacts.image[p, 0] * width, ry + contacts.image[p, 1] * width, rz
    return rx, ry, rz


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
