"""The stage of a step that computes forces and torques of touching contacts and walls: a kernel for each force law.

The kernels take the parts of State one by one, because a parallel loop of numba can use a tuple only if the tuple is an
argument of the function.
"""

from numba import prange

from simcore.compilation import leaf, loops
from simcore.dem.contact.find_contact import touch_spheres
from simcore.dem.forces.hertz import contact_law_at, wall_law_at
from simcore.dem.forces.pressing import press_contact, press_wall
from simcore.dem.forces.viscous_friction import viscous_friction_at_contact, viscous_friction_at_wall
from simcore.dem.state.touches import partner_offset
from simcore.dem.step.motion import add_push
from simcore.dem.vectors import Contact, read, write


@loops
def press_contacts(bodies, contacts, law, drive, begin, end, work, has):
    """Compute the forces of touching contacts by the linear law.

    begin, end: rows of the contacts. work: StepWorkspace, to whose sums the forces are added.
    """
    for p in prange(begin, end):
        if contacts.touching[p] != 0:
            offset = partner_offset(bodies, contacts, p, drive.width, has.periodic)
            push = press_contact(bodies, contacts, _stored(contacts, p), offset, law, drive, p, has)
            _pass_on(contacts, p, push, work)


@loops
def press_hertzian_contacts(bodies, contacts, law, drive, begin, end, work, has):
    """Compute the forces of touching contacts by Hertz's law; see press_contacts."""
    for p in prange(begin, end):
        if contacts.touching[p] != 0:
            offset = partner_offset(bodies, contacts, p, drive.width, has.periodic)
            contact = _stored(contacts, p)
            at = contact_law_at(law, bodies, contacts, p, contact.overlap)
            push = press_contact(bodies, contacts, contact, offset, at, drive, p, has)
            _pass_on(contacts, p, push, work)


@loops
def press_spheres(bodies, contacts, law, drive, begin, end, work, has):
    """Find the contacts of spheres and compute their forces by the linear law, as find_spheres and press_contacts."""
    for p in prange(begin, end):
        touch, contact, offset = touch_spheres(bodies, contacts, p, drive.width, has.periodic, work.storing)
        if touch:
            push = press_contact(bodies, contacts, contact, offset, law, drive, p, has)
            _pass_on(contacts, p, push, work)


@leaf
def _stored(contacts, p):
    """Return the Contact of touching contact p."""
    return Contact(contacts.overlap[p], read(contacts.direction, p), read(contacts.point, p))


@leaf
def _pass_on(contacts, p, push, work):
    """Add the Push of contact p to the sums of its bodies, or store it, or both, as `work` requires."""
    if work.adding:
        add_push(contacts, work.sums, p, push)
    if work.storing:
        write(contacts.force, p, push.force)
        write(contacts.torque_a, p, push.torque_a)
        write(contacts.torque_b, p, push.torque_b)


@loops
def viscous_friction_at_contacts(bodies, contacts, law, drive, begin, end, has):
    """Add friction without springs to the forces of touching contacts."""
    for p in prange(begin, end):
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
