"""The step of a scene, composed of what the scene has and nothing else.

`make_advance(features)` returns a compiled function that steps until the neighbour list no longer holds. Features
are captured as plain constants: numba prunes every branch not taken, and each variant is cached on disk.

One step: every near pair is looked at once, in its canonical order, from unshifted coordinates, and every body near
a wall; then every body that moves here adds its contacts in order of (partner, image), then its walls, and is
integrated (semi-implicit Euler: velocity first). All loops write only what belongs to their index, so the thread
count cannot change a bit.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from numba import get_thread_id, prange

from simcore.compilation import cycles, leaf, parallel_kernel
from simcore.dem.contact.finding import (
    check_ellipsoids,
    check_mixed,
    check_polyhedra,
    check_potentials,
    check_spheres,
    find_inflated,
    search_ellipsoids,
    search_mixed,
    search_polyhedra,
    search_potentials,
)
from simcore.dem.contact.patch.patch import find_patch
from simcore.dem.contact.walls import (
    FLOOR,
    cylinder_convex,
    cylinder_ellipsoid,
    cylinder_patch,
    cylinder_sphere,
    floor_convex,
    floor_ellipsoid,
    floor_patch,
    floor_sphere,
)
from simcore.dem.forces.hertz import contact_law_at, wall_law_at
from simcore.dem.forces.pressing import press_contact, press_wall
from simcore.dem.forces.sliding import rub_contact, rub_wall
from simcore.dem.shapes.hulls import CONVEX, ELLIPSOID, MIXED, SPHERE, is_hull
from simcore.dem.state.features import Features
from simcore.dem.state.touches import partner_offset
from simcore.dem.step.motion import derive_form_matrix, move, spin_sphere, turn

STAGES = ("contact", "force", "integration")


class Drive(NamedTuple):
    """Numbers of a stretch of steps, SI. Changing them compiles nothing."""

    dt: float
    gravity: float  # [m/s²], less buoyancy, downward
    shaking: float  # [m/s²], amplitude of the horizontal acceleration; 0 when still
    shaking_rate: float  # [1/s], angular
    damping: float  # factor on the velocities after each step; 1 without
    width: float  # [m], of the periodic box; 0 in a cylinder
    wall_radius: float  # [m], of the cylinder


def make_advance(features: Features):
    """advance(bodies, shapes, contacts, walls, room, law, drive, clock, first_step, n_steps) -> (steps done, stale).

    Steps until n_steps are done or a body has left its listed place by its margin (also where a position ceased to be
    finite); then the caller lists anew. With dt = 0 forces are evaluated and nothing moves.
    law: ContactLaw, or HertzLaw where features.hertz.
    clock: (3,) int64, cycles of each of STAGES, added to where features.timed.
    """
    return _make_advance(*(int(value) for value in features))


@cache
def _make_advance(
    kind, friction, attractive, floor, cylinder, periodic, shaken, patch, implicit, timed, potential, hertz, sliding,
    preloaded, inflated,
):  # fmt: skip
    walled = floor or cylinder
    patch = patch and (kind == CONVEX or kind == MIXED)
    has = Features(
        kind, friction, attractive, floor, cylinder, periodic, shaken, patch, implicit, timed, potential, hertz,
        sliding, preloaded, inflated,
    )  # fmt: skip

    @parallel_kernel
    def advance(bodies, shapes, contacts, walls, room, law, drive: Drive, clock, first_step, n_steps):
        n_own = len(bodies.own)
        n_pairs, n_walls = len(contacts.body_a), len(walls.body)
        dt, width = drive.dt, drive.width
        moved = np.zeros(n_own, np.bool_)
        for step in range(n_steps):
            if timed:
                start = cycles()
            for p in prange(n_pairs):
                if kind == SPHERE:
                    # Nothing is ever left pending: pressed at once, what was found is still at hand.
                    check_spheres(bodies, contacts, p, width, periodic)
                    if contacts.touching[p] != 0:
                        at = law
                        if hertz:
                            at = contact_law_at(law, bodies, contacts, p)
                        press_contact(bodies, contacts, at, drive, p, has)
                        if sliding:
                            rub_contact(bodies, contacts, law, drive, p, has)
                elif kind == ELLIPSOID and potential:
                    check_potentials(shapes, bodies, contacts, p, width, periodic)
                elif kind == ELLIPSOID:
                    check_ellipsoids(shapes, bodies, contacts, p, width, periodic)
                elif kind == MIXED:
                    check_mixed(shapes, bodies, contacts, p, width, periodic)
                else:
                    check_polyhedra(shapes, bodies, contacts, p, width, periodic)
            # A loop of its own: what is rare and long stays out of the loop that is neither.
            if kind != SPHERE:
                for p in prange(n_pairs):
                    if contacts.pending[p] != 0:
                        if kind == ELLIPSOID and potential:
                            search_potentials(shapes, bodies, contacts, p, width, periodic)
                        elif kind == ELLIPSOID:
                            search_ellipsoids(shapes, bodies, contacts, p, width, periodic)
                        elif kind == MIXED:
                            search_mixed(shapes, bodies, contacts, p, width, periodic)
                        else:
                            search_polyhedra(shapes, bodies, contacts, p, width, periodic)
            if inflated:
                for p in prange(n_pairs):
                    if contacts.touching[p] != 0:
                        find_inflated(shapes, bodies, contacts, p, width, periodic)
            if patch:
                for p in prange(n_pairs):
                    if contacts.touching[p] != 0:
                        i, j = contacts.body_a[p], contacts.body_b[p]
                        if kind != MIXED or (is_hull(shapes, bodies, i) and is_hull(shapes, bodies, j)):
                            offset = partner_offset(bodies, contacts, p, width, periodic)
                            find_patch(shapes, bodies, contacts, p, offset, room, get_thread_id())
            if timed:
                middle = cycles()
            if kind != SPHERE:
                for p in prange(n_pairs):
                    if contacts.touching[p] != 0:
                        at = law
                        if hertz:
                            at = contact_law_at(law, bodies, contacts, p)
                        press_contact(bodies, contacts, at, drive, p, has)
                        if sliding:
                            rub_contact(bodies, contacts, law, drive, p, has)
            if walled:
                for w in prange(n_walls):
                    if floor and (not cylinder or walls.wall[w] == FLOOR):
                        if kind == SPHERE:
                            floor_sphere(bodies, walls, w)
                        elif kind == ELLIPSOID or (kind == MIXED and not is_hull(shapes, bodies, walls.body[w])):
                            floor_ellipsoid(bodies, walls, w)
                        elif floor_convex(shapes, bodies, walls, w) and patch:
                            floor_patch(shapes, bodies, walls, w, room, get_thread_id())
                    elif cylinder:
                        if kind == SPHERE:
                            cylinder_sphere(bodies, walls, w, drive.wall_radius)
                        elif kind == ELLIPSOID or (kind == MIXED and not is_hull(shapes, bodies, walls.body[w])):
                            cylinder_ellipsoid(bodies, walls, w, drive.wall_radius)
                        else:
                            cylinder_convex(shapes, bodies, walls, w, drive.wall_radius)
                            if patch and walls.touching[w] != 0:
                                cylinder_patch(shapes, bodies, walls, w, drive.wall_radius)
                    if walls.touching[w] != 0:
                        at = law
                        if hertz:
                            at = wall_law_at(law, bodies, walls, w)
                        press_wall(bodies, walls, at, drive, w, has)
                        if sliding:
                            rub_wall(bodies, walls, law, w, has)
            if timed:
                last = cycles()
            push_x = 0.0
            if shaken:
                push_x = drive.shaking * np.sin(drive.shaking_rate * (first_step + step) * dt)
            for k in prange(n_own):
                i = bodies.own[k]
                fx, fy, fz, mx, my, mz = gather(bodies, contacts, drive.gravity, i)
                if walled:
                    gx, gy, gz, tx, ty, tz = gather_walls(walls, i)
                    fx, fy, fz, mx, my, mz = fx + gx, fy + gy, fz + gz, mx + tx, my + ty, mz + tz
                note_net_force(bodies, i, fx, fy, fz)
                if implicit and dt > 0.0:
                    note_hold(bodies, contacts, walls, i, walled)
                if dt > 0.0:
                    move(bodies, i, fx, fy, fz, mx, my, mz, push_x, dt, drive.damping)
                    if kind == SPHERE:
                        spin_sphere(bodies, i)
                    else:
                        turn(bodies, i, dt, drive.damping)
                        if kind == ELLIPSOID or (kind == MIXED and not is_hull(shapes, bodies, i)):
                            derive_form_matrix(bodies, i)
                    moved[k] = has_left(bodies, i, kind != SPHERE)
            if timed:
                count_cycles(clock, middle - start, last - middle, cycles() - last)
            for k in range(n_own):
                if moved[k]:
                    return step + 1, True
        return n_steps, False

    return advance


@leaf
def count_cycles(clock, contact, force, integration):
    clock[0] += contact
    clock[1] += force
    clock[2] += integration


@leaf
def gather_walls(walls, i):
    """Force and torque (3 + 3) of the walls on body i."""
    force, torque = walls.force, walls.torque
    fx, fy, fz, mx, my, mz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for w in range(walls.start[i], walls.start[i + 1]):
        if walls.touching[w] != 0:
            fx, fy, fz = fx + force[w, 0], fy + force[w, 1], fz + force[w, 2]
            mx, my, mz = mx + torque[w, 0], my + torque[w, 1], mz + torque[w, 2]
    return fx, fy, fz, mx, my, mz


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
def note_hold(bodies, contacts, walls, i, walled):
    """How firmly its contacts hold body i: the contacts it has, each weighed by how far it moves this body.

    A pair's relative motion u_a − u_b holds back at most the motion m_a w_a u_a² + m_b w_b u_b² of its bodies with the
    weights w_a = m_b / (m_a + m_b) / p, w_b = m_a / (m_a + m_b) / (1 − p) and any p within (0, 1); so the weights of a
    body's contacts add up to a bound of the modes it takes part in. With p = R_b / (R_a + R_b) a contact of like grains
    weighs 1 on both, one of a small and a large grain 1 on the small and little on the large. A wall weighs 1.
    """
    hold = 0.0
    mass, radius = bodies.mass[i], bodies.radius[i]
    for k in range(contacts.incident_start[i], contacts.incident_start[i + 1]):
        p = contacts.incident[k] >> 1
        if contacts.touching[p] != 0:
            j = contacts.body_a[p] if contacts.incident[k] & 1 else contacts.body_b[p]
            hold += bodies.mass[j] * (radius + bodies.radius[j]) / ((mass + bodies.mass[j]) * bodies.radius[j])
    if walled:
        for w in range(walls.start[i], walls.start[i + 1]):
            if walls.touching[w] != 0:
                hold += 1.0
    bodies.hold[i] = hold


@leaf
def has_left(bodies, i, turning):
    """Whether a point of body i can be farther than its margin from where it was listed, or is nowhere (nan)."""
    margin = bodies.margin[i]
    dx = bodies.position[i, 0] - bodies.listed_position[i, 0]
    dy = bodies.position[i, 1] - bodies.listed_position[i, 1]
    dz = bodies.position[i, 2] - bodies.listed_position[i, 2]
    if turning:
        margin -= bodies.turned[i] - bodies.listed_turned[i]
    return not (margin > 0.0 and dx * dx + dy * dy + dz * dz <= margin * margin)
