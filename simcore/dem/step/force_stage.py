"""The stage of a step that computes forces and torques of touching contacts and walls: a kernel for each force law.

The kernels take the parts of State one by one, because a parallel loop of numba can use a tuple only if the tuple is an
argument of the function.
"""

from numba import prange

from simcore.compilation import loops
from simcore.dem.forces.hertz import contact_law_at, wall_law_at
from simcore.dem.forces.pressing import press_contact, press_wall
from simcore.dem.forces.viscous_friction import viscous_friction_at_contact, viscous_friction_at_wall


@loops
def press_contacts(bodies, contacts, law, drive, has):
    """Compute the forces of touching contacts by the linear law."""
    for p in prange(len(contacts.body_a)):
        if contacts.touching[p] != 0:
            press_contact(bodies, contacts, law, drive, p, has)


@loops
def press_hertzian_contacts(bodies, contacts, law, drive, has):
    """Compute the forces of touching contacts by Hertz's law."""
    for p in prange(len(contacts.body_a)):
        if contacts.touching[p] != 0:
            press_contact(bodies, contacts, contact_law_at(law, bodies, contacts, p), drive, p, has)


@loops
def viscous_friction_at_contacts(bodies, contacts, law, drive, has):
    """Add friction without springs to the forces of touching contacts."""
    for p in prange(len(contacts.body_a)):
        if contacts.touching[p] != 0:
            viscous_friction_at_contact(bodies, contacts, law, drive, p, has)


@loops
def press_walls(bodies, walls, law, drive, has):
    """Compute the forces of touching walls by the linear law."""
    for w in prange(len(walls.body)):
        if walls.touching[w] != 0:
            press_wall(bodies, walls, law, drive, w, has)


@loops
def press_hertzian_walls(bodies, walls, law, drive, has):
    """Compute the forces of touching walls by Hertz's law."""
    for w in prange(len(walls.body)):
        if walls.touching[w] != 0:
            press_wall(bodies, walls, wall_law_at(law, bodies, walls, w), drive, w, has)


@loops
def viscous_friction_at_walls(bodies, walls, law, has):
    """Add friction without springs to the forces of touching walls."""
    for w in prange(len(walls.body)):
        if walls.touching[w] != 0:
            viscous_friction_at_wall(bodies, walls, law, w, has)
