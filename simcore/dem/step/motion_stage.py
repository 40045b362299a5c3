"""The stage of a step that moves the bodies: it adds the forces on each body and integrates its motion.

The kernels take the parts of State one by one, because a parallel loop of numba can use a tuple only if the tuple is an
argument of the function.
"""

from numba import prange

from simcore.compilation import leaf, loops
from simcore.dem.shapes.polyhedra import ELLIPSOID, MIXED, is_polyhedron
from simcore.dem.step.motion import (
    add_forces,
    begin_sums,
    count_effective_contacts,
    derive_form_matrix,
    has_left,
    move,
    note_moved,
    note_net_force,
    spin_sphere,
    take_sums,
    turn,
)


@loops
def move_spheres(bodies, contacts, walls, drive, push, work, has):
    """Move the spheres that this rank moves, from the first to the last of `work`.

    push [m/s²]: acceleration by shaking. work: StepWorkspace; its sums begin anew for the next step.
    """
    for k in prange(work.first, work.last):
        i = bodies.own[k]
        force, torque = _balance(bodies, contacts, walls, drive, i, work, has)
        if drive.dt > 0.0:
            move(bodies, i, force, torque, push, drive.dt, drive.damping)
            spin_sphere(bodies, i)
            note_moved(work, k, has_left(bodies, i, False))


@loops
def move_bodies(shapes, bodies, contacts, walls, drive, push, work, has):
    """Move bodies of other kinds; see move_spheres."""
    for k in prange(work.first, work.last):
        i = bodies.own[k]
        force, torque = _balance(bodies, contacts, walls, drive, i, work, has)
        if drive.dt > 0.0:
            move(bodies, i, force, torque, push, drive.dt, drive.damping)
            turn(bodies, i, drive.dt, drive.damping)
            if has.kind == ELLIPSOID or (has.kind == MIXED and not is_polyhedron(shapes, bodies, i)):
                derive_form_matrix(bodies, i)
            note_moved(work, k, has_left(bodies, i, True))


@leaf
def _balance(bodies, contacts, walls, drive, i, work, has):
    """Return force and torque on body i; store the net force and, for implicit dashpots, the effective contacts.

    work: StepWorkspace. Without `adding` the stored forces of the contacts are added here.
    """
    walled = has.floor != 0 or has.cylinder != 0
    if work.adding:
        force, torque = take_sums(walls, work.sums, i, walled)
        begin_sums(bodies, work.sums, i, drive.gravity)
    else:
        force, torque = add_forces(bodies, contacts, walls, drive.gravity, i, walled)
    if work.storing:
        note_net_force(bodies, i, force)
    if has.implicit and drive.dt > 0.0:
        count_effective_contacts(bodies, contacts, walls, i, walled)
    return force, torque
