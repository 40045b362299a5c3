"""The contacts of bodies that touch: between two bodies, and between a body and a wall."""

from typing import NamedTuple

import numpy as np

from simcore.dem.state.bodies import CYLINDER, FLOOR, Bodies
from simcore.dem.state.contacts import CandidatePairs

FLOOR_PARTNER, CYLINDER_PARTNER = -1, -2  # numbers of the second body if a contact is with a wall


class TouchingContacts(NamedTuple):
    """c contacts: those of two bodies by their keys, then those with the floor and with the cylinder by the body."""

    body: np.ndarray  # (c, 2): a second body of -1 is the floor, -2 the cylinder
    image: np.ndarray  # (c, 2): periods along x and y by which the second body is shifted
    normal: np.ndarray  # (c, 3), from the first to the second body
    point: np.ndarray  # (c, 3) [m], where the force acts
    overlap: np.ndarray  # (c,) [m]
    force: np.ndarray  # (c, 3) [N], on the second body


def touching_contacts(bodies: Bodies, candidates: CandidatePairs) -> TouchingContacts:
    """Return the contacts of a state whose forces have been evaluated.

    Points and images refer to the stored centres, which are not wrapped into the periodic box.
    """
    contacts, walls = candidates
    p = np.flatnonzero(contacts.touching)
    a, b = contacts.body_a[p], contacts.body_b[p]
    image = contacts.image[p].astype(np.int64) if len(contacts.image) else np.zeros((len(p), 2), np.int64)
    parts = [
        TouchingContacts(
            np.column_stack([a, b]),
            image,
            contacts.direction[p],
            bodies.position[a] + contacts.point[p],
            contacts.overlap[p],
            contacts.force[p],
        )
    ]
    for wall, partner in ((FLOOR, FLOOR_PARTNER), (CYLINDER, CYLINDER_PARTNER)):
        w = np.flatnonzero((walls.touching > 0) & (walls.wall == wall))
        i = walls.body[w]
        parts.append(
            TouchingContacts(
                np.column_stack([i, np.full(len(i), partner)]),
                np.zeros((len(i), 2), np.int64),
                -walls.normal[w],
                bodies.position[i] + walls.point[w],
                walls.overlap[w],
                -walls.force[w],
            )
        )
    return TouchingContacts(*(np.concatenate(field) for field in zip(*parts, strict=True)))
