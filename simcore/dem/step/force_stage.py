"""The stage of a step that presses what touches: a kernel for each force law. Each writes forces and torques.

A parallel loop of numba can use a tuple only where its function gets it as an argument, hence no State here.
"""

from numba import prange

from simcore.compilation import leaf, loops
from simcore.dem.contact.finding import press_contact, press_wall
from simcore.dem.forces.hertz import contact_law_at, wall_law_at
from simcore.dem.forces.sliding import CAPPED, rub_contact, rub_wall


@loops
def press_contacts(bodies, contacts, law, drive, has):
    """Touching contacts, by the linear law."""
    for p in prange(len(contacts.body_a)):
        if contacts.touching[p] != 0:
            _press(bodies, contacts, law, drive, p, has)


@loops
def press_hertzian_contacts(bodies, contacts, law, drive, has):
    """Touching contacts, by Hertz's law."""
    for p in prange(len(contacts.body_a)):
        if contacts.touching[p] != 0:
            _press(bodies, contacts, contact_law_at(law, bodies, contacts, p), drive, p, has)


@loops
def rub_contacts(bodies, contacts, law, drive, has):
    """Touching contacts: adds friction without memory."""
    for p in prange(len(contacts.body_a)):
        if contacts.touching[p] != 0:
            rub_contact(bodies, contacts, law, drive.width, p, has.periodic, has.sliding == CAPPED)


@loops
def press_walls(bodies, walls, law, drive, has):
    """Touching walls, by the linear law."""
    for w in prange(len(walls.body)):
        if walls.touching[w] != 0:
            _press_wall(bodies, walls, law, drive, w, has)


@loops
def press_hertzian_walls(bodies, walls, law, drive, has):
    """Touching walls, by Hertz's law."""
    for w in prange(len(walls.body)):
        if walls.touching[w] != 0:
            _press_wall(bodies, walls, wall_law_at(law, bodies, walls, w), drive, w, has)


@loops
def rub_walls(bodies, walls, law, has):
    """Touching walls: adds friction without memory."""
    for w in prange(len(walls.body)):
        if walls.touching[w] != 0:
            rub_wall(bodies, walls, law, w, has.sliding == CAPPED)


@leaf
def _press(bodies, contacts, law, drive, p, has):
    press_contact(
        bodies, contacts, law, drive.dt, drive.width, p, has.friction, has.attractive, has.periodic, has.patch,
        has.implicit, has.preloaded,
    )  # fmt: skip


@leaf
def _press_wall(bodies, walls, law, drive, w, has):
    press_wall(bodies, walls, law, drive.dt, w, has.friction, has.attractive, has.patch, has.implicit, has.preloaded)
