"""What bodies do to each other and to the walls: from signed distance to force and torque.

First a contact is checked from its memory: one function for each kind of shape, so that a scene's step holds only
its own. What the memory cannot answer is left pending and searched. Both leave overlap, direction and point in the
arrays. Then the force law presses, the same for all kinds.
"""

import numpy as np

from simcore.compilation import leaf, search
from simcore.dem.contact import ellipsoid, polyhedron, sphere
from simcore.dem.contact.wall import CYLINDER
from simcore.dem.force_laws import tangential_force

touch_spheres = sphere.touch
recheck_ellipsoids, search_ellipsoid_contact = ellipsoid.recheck, ellipsoid.search_contact
recheck_polyhedra, search_polyhedron_contact = polyhedron.recheck, polyhedron.search_contact


@leaf
def partner_offset(bodies, contacts, p, width):
    """Vector from the centre of body a to that of its partner, b or an image of it."""
    i, j = contacts.body_a[p], contacts.body_b[p]
    return (
        bodies.position[j, 0] - bodies.position[i, 0] + contacts.image[p, 0] * width,
        bodies.position[j, 1] - bodies.position[i, 1] + contacts.image[p, 1] * width,
        bodies.position[j, 2] - bodies.position[i, 2],
    )


@leaf
def _certainly_apart(bodies, contacts, p):
    """Whether the bodies cannot have closed the gap that was last seen."""
    i, j = contacts.body_a[p], contacts.body_b[p]
    return contacts.touching[p] == 0 and bodies.travel[i] + bodies.travel[j] < contacts.safe_until[p]


@leaf
def check_spheres(bodies, contacts, p, width):
    """Update contact p between spheres."""
    rx, ry, rz = partner_offset(bodies, contacts, p, width)
    overlap, nx, ny, nz, x, y, z = touch_spheres(bodies, contacts.body_a[p], contacts.body_b[p], rx, ry, rz)
    _note(contacts, p, overlap, nx, ny, nz, x, y, z)


@leaf
def check_ellipsoids(bodies, contacts, p, width):
    """Update contact p between ellipsoids from its memory, or leave it pending."""
    if not _certainly_apart(bodies, contacts, p):
        rx, ry, rz = partner_offset(bodies, contacts, p, width)
        known, overlap, nx, ny, nz, x, y, z = recheck_ellipsoids(
            bodies, contacts, p, contacts.body_a[p], contacts.body_b[p], rx, ry, rz
        )
        contacts.pending[p] = not known
        _note(contacts, p, overlap, nx, ny, nz, x, y, z)


@leaf
def check_polyhedra(shapes, bodies, contacts, p, width):
    """Update contact p between convex polyhedra from its memory, or leave it pending."""
    if not _certainly_apart(bodies, contacts, p):
        rx, ry, rz = partner_offset(bodies, contacts, p, width)
        known, overlap, nx, ny, nz, x, y, z = recheck_polyhedra(
            shapes, bodies, contacts, p, contacts.body_a[p], contacts.body_b[p], rx, ry, rz
        )
        contacts.pending[p] = not known
        if known:
            _note(contacts, p, overlap, nx, ny, nz, x, y, z)


@search
def search_ellipsoids(bodies, contacts, p, width):
    """Update pending contact p between ellipsoids."""
    rx, ry, rz = partner_offset(bodies, contacts, p, width)
    overlap, nx, ny, nz, x, y, z = search_ellipsoid_contact(
        bodies, contacts, p, contacts.body_a[p], contacts.body_b[p], rx, ry, rz
    )
    contacts.pending[p] = 0
    _note(contacts, p, overlap, nx, ny, nz, x, y, z)


@search
def search_polyhedra(shapes, bodies, contacts, p, width):
    """Update pending contact p between convex polyhedra."""
    rx, ry, rz = partner_offset(bodies, contacts, p, width)
    overlap, nx, ny, nz, x, y, z = search_polyhedron_contact(
        shapes, bodies, contacts, p, contacts.body_a[p], contacts.body_b[p], rx, ry, rz
    )
    contacts.pending[p] = 0
    _note(contacts, p, overlap, nx, ny, nz, x, y, z)


@leaf
def _note(contacts, p, overlap, nx, ny, nz, px, py, pz):
    """Write what was found; a contact that ended loses its spring."""
    contacts.direction[p, 0], contacts.direction[p, 1], contacts.direction[p, 2] = nx, ny, nz
    if overlap <= 0.0:
        contacts.touching[p] = 0
        contacts.spring[p, 0], contacts.spring[p, 1], contacts.spring[p, 2] = 0.0, 0.0, 0.0
        return
    contacts.touching[p] = 1
    contacts.overlap[p] = overlap
    contacts.point[p, 0], contacts.point[p, 1], contacts.point[p, 2] = px, py, pz


@leaf
def press_contact(bodies, contacts, law, dt, width, p, friction, attractive):
    """Force of touching contact p on b, torques on both, and its tangential spring."""
    i, j = contacts.body_a[p], contacts.body_b[p]
    rx, ry, rz = partner_offset(bodies, contacts, p, width)
    overlap = contacts.overlap[p]
    nx, ny, nz = contacts.direction[p, 0], contacts.direction[p, 1], contacts.direction[p, 2]
    px, py, pz = contacts.point[p, 0], contacts.point[p, 1], contacts.point[p, 2]
    qx, qy, qz = px - rx, py - ry, pz - rz
    ux = bodies.velocity[j, 0] - bodies.velocity[i, 0]
    uy = bodies.velocity[j, 1] - bodies.velocity[i, 1]
    uz = bodies.velocity[j, 2] - bodies.velocity[i, 2]
    spin = bodies.angular_velocity
    ax, ay, az = spin[i, 0], spin[i, 1], spin[i, 2]
    bx, by, bz = spin[j, 0], spin[j, 1], spin[j, 2]
    ux += (by * qz - bz * qy) - (ay * pz - az * py)
    uy += (bz * qx - bx * qz) - (az * px - ax * pz)
    uz += (bx * qy - by * qx) - (ax * py - ay * px)
    mass = bodies.mass[i] * bodies.mass[j] / (bodies.mass[i] + bodies.mass[j])
    un = ux * nx + uy * ny + uz * nz
    push = mass * (law.stiffness * overlap - law.damping * un)
    if not attractive:
        push = max(push, 0.0)
    fx, fy, fz = push * nx, push * ny, push * nz
    if friction:
        tx, ty, tz, sx, sy, sz = tangential_force(
            law, mass, law.friction * abs(push), dt, nx, ny, nz, ux, uy, uz,
            contacts.spring[p, 0], contacts.spring[p, 1], contacts.spring[p, 2],
        )  # fmt: skip
        contacts.spring[p, 0], contacts.spring[p, 1], contacts.spring[p, 2] = sx, sy, sz
        fx, fy, fz = fx + tx, fy + ty, fz + tz
    contacts.force[p, 0], contacts.force[p, 1], contacts.force[p, 2] = fx, fy, fz
    contacts.torque_a[p, 0] = -(py * fz - pz * fy)
    contacts.torque_a[p, 1] = -(pz * fx - px * fz)
    contacts.torque_a[p, 2] = -(px * fy - py * fx)
    contacts.torque_b[p, 0] = qy * fz - qz * fy
    contacts.torque_b[p, 1] = qz * fx - qx * fz
    contacts.torque_b[p, 2] = qx * fy - qy * fx


@leaf
def press_wall(bodies, law, dt, i, wall, friction, attractive):
    """Force and torque (3 + 3) of a wall on body i, from the deepest point found."""
    spring, force = bodies.wall_spring, bodies.wall_force
    overlap = bodies.wall_overlap[i, wall]
    if overlap <= 0.0:
        for axis in range(3):
            spring[i, wall, axis] = 0.0
            force[i, wall, axis] = 0.0
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    px, py, pz = bodies.wall_point[i, wall, 0], bodies.wall_point[i, wall, 1], bodies.wall_point[i, wall, 2]
    nx, ny, nz = 0.0, 0.0, 1.0  # from the wall into the body
    if wall == CYLINDER:
        x, y = bodies.position[i, 0] + px, bodies.position[i, 1] + py
        distance = np.sqrt(x * x + y * y)
        nx, ny, nz = -x / distance, -y / distance, 0.0
    # Midway between the surfaces
    px, py, pz = px + 0.5 * overlap * nx, py + 0.5 * overlap * ny, pz + 0.5 * overlap * nz
    wx, wy, wz = bodies.angular_velocity[i, 0], bodies.angular_velocity[i, 1], bodies.angular_velocity[i, 2]
    ux = bodies.velocity[i, 0] + wy * pz - wz * py
    uy = bodies.velocity[i, 1] + wz * px - wx * pz
    uz = bodies.velocity[i, 2] + wx * py - wy * px
    mass = bodies.mass[i]
    push = mass * (law.stiffness * overlap - law.damping * (ux * nx + uy * ny + uz * nz))
    if not attractive:
        push = max(push, 0.0)
    fx, fy, fz = push * nx, push * ny, push * nz
    if friction:
        tx, ty, tz, sx, sy, sz = tangential_force(
            law, mass, law.friction * abs(push), dt, nx, ny, nz, ux, uy, uz,
            spring[i, wall, 0], spring[i, wall, 1], spring[i, wall, 2],
        )  # fmt: skip
        spring[i, wall, 0], spring[i, wall, 1], spring[i, wall, 2] = sx, sy, sz
        fx, fy, fz = fx + tx, fy + ty, fz + tz
    force[i, wall, 0], force[i, wall, 1], force[i, wall, 2] = fx, fy, fz
    return fx, fy, fz, py * fz - pz * fy, pz * fx - px * fz, px * fy - py * fx
