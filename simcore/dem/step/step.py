"""The step of a scene, composed of what the scene has and nothing else.

`make_advance(features)` returns a compiled function that steps until the neighbour list no longer holds. The features
are captured as constants: numba prunes every branch not taken, and each variant is cached on disk.

One step: contacts of all candidate pairs and walls are found, each pair once, in its canonical order, from unshifted
coordinates; forces press on what touches; then every body that moves here adds its contacts in order of (partner,
image), then its walls, and is integrated (semi-implicit Euler: velocity first). All loops write only what belongs to
their index, so the thread count cannot change a bit.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from numba import get_num_threads, prange

from simcore.compilation import cycles, kernel, leaf, parallel_kernel
from simcore.dem.forces.hertz import contact_law_at, wall_law_at
from simcore.dem.forces.pressing import press_contact, press_wall
from simcore.dem.forces.sliding import rub_contact, rub_wall
from simcore.dem.shapes.hulls import CONVEX, ELLIPSOID, MIXED, SPHERE, is_hull
from simcore.dem.state.features import Features
from simcore.dem.step.contact_stage import (
    find_ellipsoids,
    find_inflated,
    find_mixed,
    find_patches,
    find_polyhedra,
    find_potentials,
    find_spheres,
    find_wall_patches,
    find_walls_of_ellipsoids,
    find_walls_of_mixed,
    find_walls_of_polyhedra,
    find_walls_of_spheres,
)
from simcore.dem.step.motion import (
    add_forces,
    derive_form_matrix,
    has_left,
    move,
    note_hold,
    note_net_force,
    spin_sphere,
    turn,
)

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
    """advance(state, law, drive, clock, first_step, n_steps) -> (steps done, stale).

    Steps until n_steps are done or a body has left its listed place by its margin (also where a position ceased to be
    finite); then the caller lists anew. With dt = 0 forces are evaluated and nothing moves.
    state: State. law: ContactLaw, or HertzLaw where features.hertz.
    clock: (3,) int64, cycles of each of STAGES, added to where features.timed.
    """
    # Integers, so that True and 1 are one variant. Asking for the threads also starts numba's, whose functions the
    # compiled code calls.
    return _make_advance(Features(*(int(value) for value in features)), get_num_threads() > 1)


@cache
def _make_advance(has: Features, several_threads: bool):
    has = has._replace(patch=int(has.patch and has.kind in (CONVEX, MIXED)))
    kind, walled, patch = has.kind, has.floor or has.cylinder, has.patch
    potential, inflated, hertz, sliding = has.potential, has.inflated, has.hertz, has.sliding
    implicit, shaken, timed = has.implicit, has.shaken, has.timed

    @(parallel_kernel if several_threads else kernel)
    def advance(state, law, drive: Drive, clock, first_step, n_steps):
        shapes, bodies, contacts, walls = state.shapes, state.bodies, state.contacts, state.walls
        moved = np.zeros(len(bodies.own), np.bool_)
        since = cycles()
        for step in range(n_steps):
            if kind == SPHERE:
                find_spheres(state, drive, has)
            elif kind == ELLIPSOID and potential:
                find_potentials(state, drive, has)
            elif kind == ELLIPSOID:
                find_ellipsoids(state, drive, has)
            elif kind == MIXED:
                find_mixed(state, drive, has)
            else:
                find_polyhedra(state, drive, has)
            if inflated:
                find_inflated(state, drive, has)
            if patch:
                find_patches(state, drive, has)
            if walled and kind == SPHERE:
                find_walls_of_spheres(state, drive)
            elif walled and kind == ELLIPSOID:
                find_walls_of_ellipsoids(state, drive)
            elif walled and kind == MIXED:
                find_walls_of_mixed(state, drive)
            elif walled:
                find_walls_of_polyhedra(state, drive)
            if walled and patch:
                find_wall_patches(state, drive)
            if timed:
                since = count_cycles(clock, 0, since)

            for p in prange(len(contacts.body_a)):
                if contacts.touching[p] != 0:
                    at = contact_law_at(law, bodies, contacts, p) if hertz else law
                    press_contact(bodies, contacts, at, drive, p, has)
                    if sliding:
                        rub_contact(bodies, contacts, law, drive, p, has)
            if walled:
                for w in prange(len(walls.body)):
                    if walls.touching[w] != 0:
                        at = wall_law_at(law, bodies, walls, w) if hertz else law
                        press_wall(bodies, walls, at, drive, w, has)
                        if sliding:
                            rub_wall(bodies, walls, law, w, has)
            if timed:
                since = count_cycles(clock, 1, since)

            push = 0.0
            if shaken:
                push = drive.shaking * np.sin(drive.shaking_rate * (first_step + step) * drive.dt)
            for k in prange(len(bodies.own)):
                i = bodies.own[k]
                force, torque = add_forces(bodies, contacts, walls, drive.gravity, i, walled)
                note_net_force(bodies, i, force)
                if drive.dt > 0.0:
                    if implicit:
                        note_hold(bodies, contacts, walls, i, walled)
                    move(bodies, i, force, torque, push, drive.dt, drive.damping)
                    if kind == SPHERE:
                        spin_sphere(bodies, i)
                    else:
                        turn(bodies, i, drive.dt, drive.damping)
                    if kind == ELLIPSOID or (kind == MIXED and not is_hull(shapes, bodies, i)):
                        derive_form_matrix(bodies, i)
                    moved[k] = has_left(bodies, i, kind != SPHERE)
            if timed:
                since = count_cycles(clock, 2, since)
            for k in range(len(bodies.own)):
                if moved[k]:
                    return step + 1, True
        return n_steps, False

    return advance


@leaf
def count_cycles(clock, stage, since):
    """Add the cycles since then to those of the stage; returns the cycles now."""
    now = cycles()
    clock[stage] += now - since
    return now
