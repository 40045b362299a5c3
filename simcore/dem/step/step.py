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
from numba import get_num_threads

from simcore.compilation import cycles, kernel, leaf, parallel_kernel
from simcore.dem.shapes.hulls import ELLIPSOID, MIXED, POLYHEDRON, SPHERE
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
from simcore.dem.step.force_stage import (
    press_contacts,
    press_hertzian_contacts,
    press_hertzian_walls,
    press_walls,
    rub_contacts,
    rub_walls,
)
from simcore.dem.step.motion_stage import move_bodies, move_spheres

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
    has = has._replace(patch=int(has.patch and has.kind in (POLYHEDRON, MIXED)))
    kind, walled, patch = has.kind, has.floor or has.cylinder, has.patch
    potential, inflated, hertz, sliding = has.potential, has.inflated, has.hertz, has.sliding
    shaken, timed = has.shaken, has.timed

    # Without a loop over prange: this tells the kernels that have some what to be compiled for.
    @(parallel_kernel if several_threads else kernel)
    def advance(state, law, drive: Drive, clock, first_step, n_steps):
        shapes, bodies, contacts, walls, workspace = state
        moved = np.zeros(len(bodies.own), np.bool_)
        since = cycles()
        for step in range(n_steps):
            if kind == SPHERE:
                find_spheres(bodies, contacts, drive, has)
            elif kind == ELLIPSOID and potential:
                find_potentials(shapes, bodies, contacts, drive, has)
            elif kind == ELLIPSOID:
                find_ellipsoids(shapes, bodies, contacts, drive, has)
            elif kind == MIXED:
                find_mixed(shapes, bodies, contacts, drive, has)
            else:
                find_polyhedra(shapes, bodies, contacts, drive, has)
            if inflated:
                find_inflated(shapes, bodies, contacts, drive, has)
            if patch:
                find_patches(shapes, bodies, contacts, workspace, drive, has)
            if walled and kind == SPHERE:
                find_walls_of_spheres(bodies, walls, drive)
            elif walled and kind == ELLIPSOID:
                find_walls_of_ellipsoids(bodies, walls, drive)
            elif walled and kind == MIXED:
                find_walls_of_mixed(shapes, bodies, walls, drive)
            elif walled:
                find_walls_of_polyhedra(shapes, bodies, walls, drive)
            if walled and patch:
                find_wall_patches(shapes, bodies, walls, workspace, drive)
            if timed:
                since = count_cycles(clock, 0, since)

            if hertz:
                press_hertzian_contacts(bodies, contacts, law, drive, has)
            else:
                press_contacts(bodies, contacts, law, drive, has)
            if sliding:
                rub_contacts(bodies, contacts, law, drive, has)
            if walled and hertz:
                press_hertzian_walls(bodies, walls, law, drive, has)
            elif walled:
                press_walls(bodies, walls, law, drive, has)
            if walled and sliding:
                rub_walls(bodies, walls, law, has)
            if timed:
                since = count_cycles(clock, 1, since)

            push = 0.0
            if shaken:
                push = drive.shaking * np.sin(drive.shaking_rate * (first_step + step) * drive.dt)
            if kind == SPHERE:
                move_spheres(bodies, contacts, walls, drive, push, moved, has)
            else:
                move_bodies(shapes, bodies, contacts, walls, drive, push, moved, has)
            if timed:
                since = count_cycles(clock, 2, since)
            for k in range(len(moved)):
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
