"""Functions for rows of contacts and walls that apply to all shapes."""

from simcore.compilation import leaf
from simcore.dem.vectors import ZERO, Vec, minus, read, write


@leaf
def partner_offset(bodies, contacts, p, width, periodic):
    """Return the vector [m] from the centre of body a of contact p to that of its partner, b or an image of b."""
    offset = minus(read(bodies.position, contacts.body_b[p]), read(bodies.position, contacts.body_a[p]))
    if periodic:
        return Vec(offset.x + contacts.image[p, 0] * width, offset.y + contacts.image[p, 1] * width, offset.z)
    return offset


@leaf
def forget_springs(touches, k):
    """Reset the springs of a contact or a wall that ended, if the scene has springs."""
    if k < len(touches.spring):
        write(touches.spring, k, ZERO)
    if k < len(touches.twist):
        touches.twist[k] = 0.0
    if k < len(touches.stuck):
        touches.stuck[k] = 0
