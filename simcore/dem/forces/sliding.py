"""Friction without memory: what slides is held back in proportion to its speed, and nothing is held at rest.

The deposits paper's words are "-(coefficient) v_t", dynamic friction only and no static spring. Taken as they stand
(VISCOUS) the force is F_t = -c m v_t with the effective mass m and a rate c, so that light and heavy grains slow down
alike and one limit of the time step holds for all. A grain that skims another would so be held harder than any
friction could: ours (CAPPED) cuts the force at Coulomb's limit µ F_n, as Haff and Werner (1986) do. Either way a grain
on a slope creeps, at g sin θ / c where the limit is not reached: a bed settles toward one without friction, the
slower the larger c is.

It acts where a contact has pressed, after the normal force of whichever law, and needs no array of its own.
"""

import numpy as np

from simcore.compilation import leaf
from simcore.dem.contact.finding import contact_velocity, partner_offset, wall_velocity

NONE, CAPPED, VISCOUS = 0, 1, 2


@leaf
def sliding_force(law, mass, limit, nx, ny, nz, ux, uy, uz):
    """Tangential force (3) [N] on what moves at u against its partner. mass: effective; limit [N]: at most."""
    un = ux * nx + uy * ny + uz * nz
    ux, uy, uz = ux - un * nx, uy - un * ny, uz - un * nz
    rate = law.sliding * mass
    force = rate * np.sqrt(ux * ux + uy * uy + uz * uz)
    if force > limit:
        rate *= limit / force
    return -rate * ux, -rate * uy, -rate * uz


@leaf
def rub_contact(bodies, contacts, law, width, p, periodic, capped):
    """Add the sliding friction of touching contact p to its force and torques."""
    i, j = contacts.body_a[p], contacts.body_b[p]
    rx, ry, rz = partner_offset(bodies, contacts, p, width, periodic)
    nx, ny, nz = contacts.direction[p, 0], contacts.direction[p, 1], contacts.direction[p, 2]
    px, py, pz = contacts.point[p, 0], contacts.point[p, 1], contacts.point[p, 2]
    qx, qy, qz = px - rx, py - ry, pz - rz
    ux, uy, uz = contact_velocity(bodies, i, j, px, py, pz, qx, qy, qz)
    limit = np.inf
    if capped:
        push = contacts.force[p, 0] * nx + contacts.force[p, 1] * ny + contacts.force[p, 2] * nz
        limit = law.friction * max(push, 0.0)
    mass = bodies.mass[i] * bodies.mass[j] / (bodies.mass[i] + bodies.mass[j])
    fx, fy, fz = sliding_force(law, mass, limit, nx, ny, nz, ux, uy, uz)
    contacts.force[p, 0] += fx
    contacts.force[p, 1] += fy
    contacts.force[p, 2] += fz
    contacts.torque_a[p, 0] -= py * fz - pz * fy
    contacts.torque_a[p, 1] -= pz * fx - px * fz
    contacts.torque_a[p, 2] -= px * fy - py * fx
    contacts.torque_b[p, 0] += qy * fz - qz * fy
    contacts.torque_b[p, 1] += qz * fx - qx * fz
    contacts.torque_b[p, 2] += qx * fy - qy * fx


@leaf
def rub_wall(bodies, walls, law, w, capped):
    """Add the sliding friction of touching wall w to its force and torque."""
    i = walls.body[w]
    nx, ny, nz = walls.normal[w, 0], walls.normal[w, 1], walls.normal[w, 2]
    px, py, pz = walls.point[w, 0], walls.point[w, 1], walls.point[w, 2]
    ux, uy, uz = wall_velocity(bodies, i, px, py, pz)
    limit = np.inf
    if capped:
        push = walls.force[w, 0] * nx + walls.force[w, 1] * ny + walls.force[w, 2] * nz
        limit = law.friction * max(push, 0.0)
    fx, fy, fz = sliding_force(law, bodies.mass[i], limit, nx, ny, nz, ux, uy, uz)
    walls.force[w, 0] += fx
    walls.force[w, 1] += fy
    walls.force[w, 2] += fz
    walls.torque[w, 0] += py * fz - pz * fy
    walls.torque[w, 1] += pz * fx - px * fz
    walls.torque[w, 2] += px * fy - py * fx
