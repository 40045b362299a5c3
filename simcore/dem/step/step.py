"""The time step of a scene, compiled from only the parts that the scene requires.

`make_advance(features)` returns a compiled function that steps until the neighbour list is no longer valid. The
features are captured as constants: numba removes every branch not taken, and each variant is cached on disk.

One step has three stages. First the contacts of all candidate pairs and walls are found, each pair once, in its
canonical order, from unshifted coordinates. Then the forces of all touching contacts are computed. Last, the forces on
every body that this rank moves are added, contacts in order of (partner, image) and then walls, and the body is
integrated (semi-implicit Euler: velocity first).

The results are the same, to the bit, for any number of threads. With several threads each iteration of a loop writes
only to its own index: all forces are stored, and each body then reads those of its contacts. A single thread takes the
contacts in blocks that stay in the processor's cache. It adds each force to the sums of both bodies as soon as the
force is known. The order is that of (partner, image) here as well, because the contacts are sorted by (a, b, image).
The exception is a pair that is listed through several images, whose order for b is the reverse; with such pairs a
single thread stores the forces as several do. After each block it moves the bodies whose contacts are done: those
below body a of the next row, because all later rows have higher bodies. It stores forces, net forces and, of spheres,
overlaps, directions and points only in the last of the requested steps. A call that ends early, because the neighbour
list is no longer valid, leaves those of a former call; Process does not pass them on.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from numba import get_num_threads

from simcore.compilation import cycles, kernel, leaf, parallel_kernel
from simcore.dem.shapes.polyhedra import ELLIPSOID, MIXED, POLYHEDRON, SPHERE
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
    press_spheres,
    press_walls,
    viscous_friction_at_contacts,
    viscous_friction_at_walls,
)
from simcore.dem.step.motion import StepWorkspace, begin_sums
from simcore.dem.step.motion_stage import move_bodies, move_spheres

BLOCK = 512  # number of contacts that a single thread takes through all loops before it takes the next ones
STAGES = ("contact", "force", "integration")


class Drive(NamedTuple):
    """Values that are constant over a number of steps, SI. A change of them does not compile the step again."""

    dt: float
    gravity: float  # [m/s²], less buoyancy, downward
    shaking: float  # [m/s²], amplitude of the horizontal acceleration; 0 without shaking
    shaking_rate: float  # [1/s], angular frequency
    damping: float  # factor on the velocities after each step; 1 without damping
    width: float  # [m], of the periodic box; 0 if the domain is not periodic
    wall_radius: float  # [m], of the cylinder


def make_advance(features: Features):
    """Return the compiled function advance(state, law, drive, clock, first_step, n_steps) -> (steps done, stale).

    It steps until n_steps are done or the list is stale: a point of a body has moved by the body's margin since the
    listing, or a position is not finite. The caller then lists the candidate pairs again. With dt = 0 forces are
    evaluated and nothing moves. If fewer than n_steps are done, outputs of Bodies and Contacts may be of a former step.
    state: State. law: ContactLaw, or HertzLaw if features.hertz is set.
    clock: (3,) int64, to which the processor cycles of each of STAGES are added if features.timed is set.
    """
    # Integers make True and 1 one variant. get_num_threads also starts numba's threads, whose functions the compiled
    # code calls.
    return _make_advance(Features(*(int(value) for value in features)), get_num_threads() > 1)


@cache
def _make_advance(has: Features, several_threads: bool):
    has = has._replace(patch=int(has.patch and has.kind in (POLYHEDRON, MIXED)))
    kind, walled, patch = has.kind, has.floor or has.cylinder, has.patch
    potential, inflated, hertz, sliding = has.potential, has.inflated, has.hertz, has.sliding
    shaken, timed = has.shaken, has.timed
    fused = kind == SPHERE and not (hertz or sliding or timed or several_threads)

    # This function has no prange loop itself; its decorator selects how the kernels with prange loops are compiled.
    @(parallel_kernel if several_threads else kernel)
    def advance(state, law, drive: Drive, clock, first_step, n_steps):
        shapes, bodies, contacts, walls, workspace = state
        n_contacts = len(contacts.body_a)
        moved = np.zeros(len(bodies.own), np.bool_)
        adding = not (several_threads or sliding or pairs_repeat(contacts))
        sums = np.empty((len(bodies.mass) if adding else 0, 6))
        for i in range(len(sums)):
            begin_sums(bodies, sums, i, drive.gravity)
        block = max(n_contacts, 1) if several_threads else BLOCK
        since = cycles()
        for step in range(n_steps):
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
            if walled and hertz:
                press_hertzian_walls(bodies, walls, law, drive, has)
            elif walled:
                press_walls(bodies, walls, law, drive, has)
            if walled and sliding:
                viscous_friction_at_walls(bodies, walls, law, has)
            if timed:
                since = count_cycles(clock, 1, since)

            storing = not adding or step == n_steps - 1
            push = 0.0
            if shaken:
                push = drive.shaking * np.sin(drive.shaking_rate * (first_step + step) * drive.dt)
            last = 0
            for begin in range(0, max(n_contacts, 1), block):
                end = min(begin + block, n_contacts)
                first, last = last, count_done(bodies, contacts, last, end)
                work = StepWorkspace(sums, moved, adding, storing, first, last)
                if fused:
                    press_spheres(bodies, contacts, law, drive, begin, end, work, has)
                elif kind == SPHERE:
                    find_spheres(bodies, contacts, drive, begin, end, has)
                elif kind == ELLIPSOID and potential:
                    find_potentials(shapes, bodies, contacts, drive, begin, end, has)
                elif kind == ELLIPSOID:
                    find_ellipsoids(shapes, bodies, contacts, drive, begin, end, has)
                elif kind == MIXED:
                    find_mixed(shapes, bodies, contacts, drive, begin, end, has)
                else:
                    find_polyhedra(shapes, bodies, contacts, drive, begin, end, has)
                if inflated:
                    find_inflated(shapes, bodies, contacts, drive, begin, end, has)
                if patch:
                    find_patches(shapes, bodies, contacts, workspace, drive, begin, end, has)
                if timed:
                    since = count_cycles(clock, 0, since)
                if hertz:
                    press_hertzian_contacts(bodies, contacts, law, drive, begin, end, work, has)
                elif not fused:
                    press_contacts(bodies, contacts, law, drive, begin, end, work, has)
                if sliding:
                    viscous_friction_at_contacts(bodies, contacts, law, drive, begin, end, has)
                if timed:
                    since = count_cycles(clock, 1, since)
                if kind == SPHERE:
                    move_spheres(bodies, contacts, walls, drive, push, work, has)
                else:
                    move_bodies(shapes, bodies, contacts, walls, drive, push, work, has)
                if timed:
                    since = count_cycles(clock, 2, since)
            for k in range(len(moved)):
                if moved[k]:
                    return step + 1, True
        return n_steps, False

    return advance


@leaf
def count_done(bodies, contacts, last, end):
    """Return how many of the bodies of this rank have no contact in row `end` or later; at least `last` of them."""
    done, n_own = last, len(bodies.own)
    if end == len(contacts.body_a):
        return n_own
    while done < n_own and bodies.own[done] < contacts.body_a[end]:
        done += 1
    return done


@leaf
def pairs_repeat(contacts):
    """Return whether a pair is listed through several images, or a body with its own image."""
    a, b = contacts.body_a, contacts.body_b
    repeated = len(a) > 0 and a[0] == b[0]
    for p in range(1, len(a)):
        repeated |= (a[p] == b[p]) | ((a[p] == a[p - 1]) & (b[p] == b[p - 1]))
    return repeated


@leaf
def count_cycles(clock, stage, since):
    """Add the cycles since `since` to those of the stage; return the present cycle count."""
    now = cycles()
    clock[stage] += now - since
    return now
