"""The step of a scene, composed of what the scene has and nothing else.

`make_advance(features)` returns a compiled function that steps until the neighbour list no longer holds. Features
are captured as plain constants: numba prunes every branch not taken, and each variant is cached on disk.

One step: every near pair is looked at once, in its canonical order, from unshifted coordinates; then every body
adds its contacts in order of (partner, image), meets the walls and is integrated (semi-implicit Euler: velocity
first). Both loops write only what belongs to their index, so the thread count cannot change a bit.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from numba import prange

from simcore.compilation import leaf, parallel_kernel
from simcore.dem.contact.wall import (
    CYLINDER,
    FLOOR,
    cylinder_convex,
    cylinder_ellipsoid,
    cylinder_sphere,
    floor_convex,
    floor_ellipsoid,
    floor_sphere,
)
from simcore.dem.force_laws import ContactLaw
from simcore.dem.integrators import derive_form_matrix, move, spin_sphere, turn
from simcore.dem.interaction import (
    check_ellipsoids,
    check_polyhedra,
    check_spheres,
    press_contact,
    press_wall,
    search_ellipsoids,
    search_polyhedra,
)
from simcore.dem.shapes import ELLIPSOID, SPHERE


class Features(NamedTuple):
    """What a scene has. Every combination is compiled by itself."""

    kind: int  # SPHERE, ELLIPSOID or CONVEX
    friction: bool
    attractive: bool  # normal force may pull at the end of a contact
    floor: bool
    cylinder: bool


class Drive(NamedTuple):
    """Numbers of a stretch of steps, SI. Changing them compiles nothing."""

    dt: float
    gravity: float  # [m/s²], less buoyancy, downward
    shaking: float  # [m/s²], amplitude of the horizontal acceleration; 0 when still
    shaking_rate: float  # [1/s], angular
    damping: float  # factor on the velocities after each step; 1 without
    width: float  # [m], of the periodic box; 0 in a cylinder
    wall_radius: float  # [m], of the cylinder
    list_margin: float  # [m], way from its listed position after which a body needs a new list


def make_advance(features: Features):
    """advance(bodies, shapes, contacts, law, drive, first_step, n_steps) -> (steps done, list is stale).

    Steps until n_steps are done or a body has left its listed place by drive.list_margin (also where a position
    ceased to be finite); then the caller lists anew. With dt = 0 forces are evaluated and nothing moves.
    """
    return _make_advance(*(int(value) for value in features))


@cache
def _make_advance(kind: int, friction: int, attractive: int, floor: int, cylinder: int):
    @parallel_kernel
    def advance(bodies, shapes, contacts, law: ContactLaw, drive: Drive, first_step, n_steps):
        n_bodies = len(bodies.mass)
        dt = drive.dt
        moved = np.zeros(n_bodies, np.bool_)
        for step in range(n_steps):
            for p in prange(len(contacts.body_a)):
                if kind == SPHERE:
                    check_spheres(bodies, contacts, p, drive.width)
                elif kind == ELLIPSOID:
                    check_ellipsoids(bodies, contacts, p, drive.width)
                else:
                    check_polyhedra(shapes, bodies, contacts, p, drive.width)
            # A loop of its own, so that the counting of references for these calls burdens no check.
            if kind != SPHERE:
                for p in prange(len(contacts.body_a)):
                    if contacts.pending[p] != 0:
                        if kind == ELLIPSOID:
                            search_ellipsoids(bodies, contacts, p, drive.width)
                        else:
                            search_polyhedra(shapes, bodies, contacts, p, drive.width)
            for p in prange(len(contacts.body_a)):
                if contacts.touching[p] != 0:
                    press_contact(bodies, contacts, law, dt, drive.width, p, friction, attractive)
            push_x = drive.shaking * np.sin(drive.shaking_rate * (first_step + step) * dt)
            for i in prange(n_bodies):
                fx, fy, fz, mx, my, mz = gather(bodies, contacts, drive.gravity, i)
                if floor:
                    if kind == SPHERE:
                        floor_sphere(bodies, i)
                    elif kind == ELLIPSOID:
                        floor_ellipsoid(bodies, i)
                    else:
                        floor_convex(shapes, bodies, i)
                    gx, gy, gz, tx, ty, tz = press_wall(bodies, law, dt, i, FLOOR, friction, attractive)
                    fx, fy, fz, mx, my, mz = fx + gx, fy + gy, fz + gz, mx + tx, my + ty, mz + tz
                if cylinder:
                    if kind == SPHERE:
                        cylinder_sphere(bodies, i, drive.wall_radius)
                    elif kind == ELLIPSOID:
                        cylinder_ellipsoid(bodies, i, drive.wall_radius)
                    else:
                        cylinder_convex(shapes, bodies, i, drive.wall_radius)
                    gx, gy, gz, tx, ty, tz = press_wall(bodies, law, dt, i, CYLINDER, friction, attractive)
                    fx, fy, fz, mx, my, mz = fx + gx, fy + gy, fz + gz, mx + tx, my + ty, mz + tz
                note_net_force(bodies, i, fx, fy, fz)
                if dt > 0.0:
                    move(bodies, i, fx, fy, fz, mx, my, mz, push_x, dt, drive.damping)
                    if kind == SPHERE:
                        spin_sphere(bodies, i)
                    else:
                        turn(bodies, i, dt, drive.damping)
                        if kind == ELLIPSOID:
                            derive_form_matrix(bodies, i)
                    moved[i] = has_left(bodies, i, drive.list_margin)
            for i in range(n_bodies):
                if moved[i]:
                    return step + 1, True
        return n_steps, False

    return advance


@leaf
def gather(bodies, contacts, gravity, i):
    """Weight, contact forces and torques of body i (3 + 3), added in order of (partner, image)."""
    force, torque_a, torque_b = contacts.force, contacts.torque_a, contacts.torque_b
    fx, fy, fz = 0.0, 0.0, -bodies.mass[i] * gravity
    mx, my, mz = 0.0, 0.0, 0.0
    for k in range(contacts.incident_start[i], contacts.incident_start[i + 1]):
        p = contacts.incident[k] >> 1
        if contacts.touching[p] == 0:
            continue
        if contacts.incident[k] & 1:
            fx, fy, fz = fx + force[p, 0], fy + force[p, 1], fz + force[p, 2]
            mx, my, mz = mx + torque_b[p, 0], my + torque_b[p, 1], mz + torque_b[p, 2]
        else:
            fx, fy, fz = fx - force[p, 0], fy - force[p, 1], fz - force[p, 2]
            mx, my, mz = mx + torque_a[p, 0], my + torque_a[p, 1], mz + torque_a[p, 2]
    return fx, fy, fz, mx, my, mz


@leaf
def note_net_force(bodies, i, fx, fy, fz):
    """A leaf, since numba drops a parallel loop's own writes to a tuple's array that the kernel never reads."""
    bodies.net_force[i, 0], bodies.net_force[i, 1], bodies.net_force[i, 2] = fx, fy, fz


@leaf
def has_left(bodies, i, margin):
    """Whether body i is farther than `margin` [m] from where it was listed, or nowhere (not a number)."""
    dx = bodies.position[i, 0] - bodies.listed_position[i, 0]
    dy = bodies.position[i, 1] - bodies.listed_position[i, 1]
    dz = bodies.position[i, 2] - bodies.listed_position[i, 2]
    return not (dx * dx + dy * dy + dz * dz <= margin * margin)
