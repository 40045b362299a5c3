"""The stage of a step that moves the bodies: each adds what presses on it, and is integrated.

A parallel loop of numba can use a tuple only where its function gets it as an argument, hence no State here.
"""

from numba import prange

from simcore.compilation import leaf, loops
from simcore.dem.shapes.hulls import ELLIPSOID, MIXED, is_hull
from simcore.dem.step.motion import (
    add_forces,
    count_effective_contacts,
    derive_form_matrix,
    has_left,
    move,
    note_net_force,
    spin_sphere,
    turn,
)


@loops
def move_spheres(bodies, contacts, walls, drive, push, moved, has):
    """Spheres that move here. push [m/s²]: of shaking; moved (k,): becomes whether each has left its listed place."""
    for k in prange(len(bodies.own)):
        i = bodies.own[k]
        force, torque = _balance(bodies, contacts, walls, drive, i, has)
        if drive.dt > 0.0:
            move(bodies, i, force, torque, push, drive.dt, drive.damping)
            spin_sphere(bodies, i)
            moved[k] = has_left(bodies, i, False)


@loops
def move_bodies(shapes, bodies, contacts, walls, drive, push, moved, has):
    """Bodies of other kinds, as move_spheres."""
    for k in prange(len(bodies.own)):
        i = bodies.own[k]
        force, torque = _balance(bodies, contacts, walls, drive, i, has)
        if drive.dt > 0.0:
            move(bodies, i, force, torque, push, drive.dt, drive.damping)
            turn(bodies, i, drive.dt, drive.damping)
            if has.kind == ELLIPSOID or (has.kind == MIXED and not is_hull(shapes, bodies, i)):
                derive_form_matrix(bodies, i)
            moved[k] = has_left(bodies, i, True)


@leaf
def _balance(bodies, contacts, walls, drive, i, has):
    """Force and torque on body i, and what is noted of them."""
    walled = has.floor != 0 or has.cylinder != 0
    force, torque = add_forces(bodies, contacts, walls, drive.gravity, i, walled)
    note_net_force(bodies, i, force)
    if has.implicit and drive.dt > 0.0:
        count_effective_contacts(bodies, contacts, walls, i, walled)
    return force, torque
