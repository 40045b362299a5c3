"""Rows of contacts and walls: candidate pairs and bodies near a wall, with their remembered contacts.

The columns that only some scenes require are listed in simcore.dem.state.features.COLUMNS.
"""

from typing import NamedTuple

import numpy as np

from simcore.compilation import kernel, leaf
from simcore.dem.shapes.polyhedra import MIXED, POLYHEDRON, SPHERE, Shapes
from simcore.dem.state.bodies import CYLINDER, FLOOR, Bodies, Contacts, Walls
from simcore.dem.state.features import Features, columns


class Box(NamedTuple):
    """Horizontal extent [m]: periodic with a width, or open (width 0), optionally within a cylinder."""

    width: float
    wall_radius: float = np.inf


class CandidatePairs(NamedTuple):
    """The pairs of bodies, and the bodies and walls, that may touch before the next listing."""

    contacts: Contacts
    walls: Walls


class State(NamedTuple):
    """All that a step reads and writes, as one argument. workspace: of patches, with one row for each thread."""

    shapes: Shapes
    bodies: Bodies
    contacts: Contacts
    walls: Walls
    workspace: tuple


def bytes_per_pair(features: Features) -> int:
    """Return the memory [bytes] of a candidate pair in a scene with these features."""
    # Without `list_incident`, so that `explain` compiles nothing: a pair has two sides, and no start of its own.
    contacts = _contacts(*_keys(np.zeros((1, 4), np.int64)), np.zeros(0, np.int64), np.zeros(2, np.int32), features)
    return sum(array.nbytes for array in contacts)


def empty_contacts(pairs: np.ndarray, n_bodies: int, features: Features) -> Contacts:
    """Return contacts with the given sorted keys (m, 4) and no remembered contacts."""
    body_a, body_b, image = _keys(pairs)
    return _contacts(body_a, body_b, image, *list_incident(body_a, body_b, n_bodies), features)


def _keys(pairs):
    return pairs[:, 0].astype(np.int32), pairs[:, 1].astype(np.int32), pairs[:, 2:].astype(np.int32)


def _contacts(body_a, body_b, image, start, incident, features):
    m = len(body_a)
    apart = 0 if features.kind == SPHERE else m
    return Contacts(
        body_a=body_a,
        body_b=body_b,
        image=image if features.periodic else image[:0].copy(),
        touching=np.zeros(m, np.uint8),
        pending=np.zeros(apart, np.uint8),
        direction=np.zeros((m, 3)),
        facet=np.full((m if features.kind in (POLYHEDRON, MIXED) else 0, 6), -1, np.int32),
        apart_at=np.zeros((apart, 3)),
        safe_until=np.full(apart, -np.inf),
        overlap=np.zeros(m),
        point=np.zeros((m, 3)),
        force=np.zeros((m, 3)),
        torque_a=np.zeros((m, 3)),
        torque_b=np.zeros((m, 3)),
        incident_start=start,
        incident=incident,
        **columns(features, m),
    )


@kernel
def list_incident(body_a, body_b, n_bodies):
    """Return `incident_start` and `incident` of Contacts with these keys, which are sorted by (a, b, image)."""
    m = len(body_a)
    start = np.zeros(n_bodies + 1, np.int64)
    for p in range(m):
        start[body_a[p] + 1] += 1
        start[body_b[p] + 1] += 1
    for i in range(n_bodies):
        start[i + 1] += start[i]
    # Contacts of a body are in order of (partner, image). The partners of b are lower than b, those of a are higher;
    # images of a body of itself are in between. Seen from b, the images of a pair have the opposite sign and order.
    next_side = start[:-1].copy()
    incident = np.empty(2 * m, np.int32)
    begin = 0
    while begin < m:
        end = begin + 1
        while end < m and body_a[end] == body_a[begin] and body_b[end] == body_b[begin]:
            end += 1
        for p in range(end - 1, begin - 1, -1):
            incident[next_side[body_b[p]]] = 2 * p + 1
            next_side[body_b[p]] += 1
        begin = end
    for p in range(m):
        incident[next_side[body_a[p]]] = 2 * p
        next_side[body_a[p]] += 1
    return start, incident


def empty_walls(bodies: Bodies, shapes: Shapes, box: Box, features: Features) -> Walls:
    """Return rows for the bodies whose distance from a wall is below their margin, without remembered contacts."""
    n, reach = len(bodies.mass), bodies.radius + bodies.margin
    near = np.zeros((n, 2), np.bool_)
    if features.floor:
        near[:, FLOOR] = bodies.position[:, 2] < reach
    if features.cylinder:
        near[:, CYLINDER] = np.hypot(bodies.position[:, 0], bodies.position[:, 1]) + reach > box.wall_radius
    near &= bodies.moves_here[:, None]
    body, wall = np.nonzero(near)
    w = len(body)
    return Walls(
        body=body.astype(np.int32),
        wall=wall.astype(np.int32),
        touching=np.zeros(w, np.uint8),
        vertex=shapes.vertex_start[bodies.shape[body]].astype(np.int32),
        overlap=np.zeros(w),
        normal=np.zeros((w, 3)),
        point=np.zeros((w, 3)),
        force=np.zeros((w, 3)),
        torque=np.zeros((w, 3)),
        start=list_walls_of(body, n),
        **columns(features, w),
    )


def list_walls_of(body, n_bodies):
    """Return `start` of Walls whose rows have these bodies, in order."""
    return np.concatenate(([0], np.cumsum(np.bincount(body, minlength=n_bodies)))).astype(np.int64)


def carry_remembered_contacts(old: Contacts, new: Contacts) -> None:
    """Copy the remembered and output fields of the pairs that are in both lists."""
    rows, old_rows = _common_rows((old.body_a, old.body_b, old.image), (new.body_a, new.body_b, new.image))
    _carry(old, new, rows, old_rows, ("body_a", "body_b", "image", "pending", "incident_start", "incident"))


def carry_remembered_walls(old: Walls, new: Walls) -> None:
    """Copy the remembered and output fields of the rows that are in both lists; (body, wall) is unique in each."""
    _, rows, old_rows = np.intersect1d(2 * new.body + new.wall, 2 * old.body + old.wall, return_indices=True)
    _carry(old, new, rows, old_rows, ("body", "wall", "start"))


def _carry(old, new, rows, old_rows, without):
    """Copy the fields from `old_rows` of the old list to `rows` of the new list, except those in `without`."""
    for name in type(new)._fields:
        field = getattr(new, name)
        if name not in without and len(field):
            field[rows] = getattr(old, name)[old_rows]


@kernel
def _common_rows(old, new):
    """Return the rows (k,) of the keys of `new` that are in `old`, and their rows (k,) in `old`; both are sorted."""
    rows, old_rows = np.empty(len(new[0]), np.int64), np.empty(len(new[0]), np.int64)
    count, k = 0, 0
    for p in range(len(new[0])):
        while k < len(old[0]) and _before(old, k, new, p):
            k += 1
        if k < len(old[0]) and not _before(new, p, old, k):
            rows[count], old_rows[count] = p, k
            count += 1
    return rows[:count], old_rows[:count]


@leaf
def _before(keys, k, other_keys, p):
    """Return whether key k of the one list comes before key p of the other list."""
    a, b, image = keys
    other_a, other_b, other_image = other_keys
    if a[k] != other_a[p]:
        return a[k] < other_a[p]
    if b[k] != other_b[p]:
        return b[k] < other_b[p]
    if len(image) == 0:
        return False
    if image[k, 0] != other_image[p, 0]:
        return image[k, 0] < other_image[p, 0]
    return image[k, 1] < other_image[p, 1]
