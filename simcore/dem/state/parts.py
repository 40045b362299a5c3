"""Parts of a packing: rows of bodies, contacts and walls that refer to bodies by id instead of by row.

Bodies that change their rank are sent as parts, checkpoints consist of parts, and a packing of many ranks is assembled
from parts. A part is a dict from "body.position", "contact.spring", "wall.vertex" and so on to arrays; fields that
follow from the rows alone (own, incident, start) are not in it.
"""

import numpy as np

from simcore.dem.state.bodies import Bodies, Contacts, Walls
from simcore.dem.state.contacts import CandidatePairs, list_incident, list_walls_of

_DERIVED = {"body": {"own"}, "contact": {"incident_start", "incident"}, "wall": {"start"}}
_GROUPS = {"body": Bodies, "contact": Contacts, "wall": Walls}


def take_part(bodies: Bodies, candidates: CandidatePairs | None, rows, shared: bool = False) -> dict:
    """Return the part of the bodies in `rows`, with their walls and the contacts whose body a is among them.

    shared: True: also the contacts whose body b is among them, so that the part contains all contacts of these bodies.
    candidates: None: the part has no contacts and walls.
    """
    part = _take("body", bodies, rows, len(bodies.mass))
    if candidates is None:
        return part
    among = np.zeros(len(bodies.mass), np.bool_)
    among[rows] = True
    contacts, walls = candidates
    kept = among[contacts.body_a] | among[contacts.body_b] if shared else among[contacts.body_a]
    part |= _take("contact", contacts, np.flatnonzero(kept), len(contacts.body_a))
    part |= _take("wall", walls, np.flatnonzero(among[walls.body]), len(walls.body))
    for name in ("contact.body_a", "contact.body_b", "wall.body"):
        part[name] = bodies.id[part[name]]
    return part


def _take(group, arrays, rows, count):
    # Fields that the scene does not need have no rows.
    return {
        f"{group}.{name}": array[rows] if len(array) == count else array
        for name, array in arrays._asdict().items()
        if name not in _DERIVED[group]
    }


def assemble(parts: list[dict], own) -> tuple[Bodies, CandidatePairs | None]:
    """Assemble Bodies in order of their id, with the contacts and walls of the bodies in `own`.

    own (k,): ids of the bodies that this rank moves. Bodies and contacts that are in several parts are taken once.
    Contacts with a body that is in no part are left out. If no part has contacts, None is returned instead of
    CandidatePairs.
    """
    body = _join(parts, "body")
    body = _unique(body, [body["id"]])
    ids = body["id"]
    moves_here = np.isin(ids, own)
    bodies = Bodies(own=np.flatnonzero(moves_here), **body)

    if not any("contact.body_a" in part for part in parts):
        return bodies, None
    contact = _join(parts, "contact")
    a, has_a = _locate(ids, contact["body_a"])
    b, has_b = _locate(ids, contact["body_b"])
    kept = np.flatnonzero(has_a & has_b)
    kept = kept[moves_here[a[kept]] | moves_here[b[kept]]]
    contact = _rows(contact | {"body_a": a.astype(np.int32), "body_b": b.astype(np.int32)}, kept, len(a))
    images = [contact["image"][:, 1], contact["image"][:, 0]] if len(contact["image"]) else []
    contact = _unique(contact, [*images, contact["body_b"], contact["body_a"]])
    start, incident = list_incident(contact["body_a"], contact["body_b"], len(ids))

    wall = _join(parts, "wall")
    row, has_body = _locate(ids, wall["body"])
    kept = np.flatnonzero(has_body)
    kept = kept[moves_here[row[kept]]]
    wall = _rows(wall | {"body": row.astype(np.int32)}, kept, len(row))
    wall = _unique(wall, [wall["wall"], wall["body"]])
    return bodies, CandidatePairs(
        Contacts(incident_start=start, incident=incident, **contact),
        Walls(start=list_walls_of(wall["body"], len(ids)), **wall),
    )


def _join(parts, group):
    names = [name for name in _GROUPS[group]._fields if name not in _DERIVED[group]]
    return {
        name: np.concatenate([part[f"{group}.{name}"] for part in parts if f"{group}.{name}" in part]) for name in names
    }


def _locate(ids, wanted):
    """Return the rows (k,) of the `wanted` ids in the sorted `ids`, and whether each is there, (k,) bool."""
    rows = np.searchsorted(ids, wanted)
    rows = np.minimum(rows, max(len(ids) - 1, 0))
    return rows, (ids[rows] == wanted if len(ids) else np.zeros(len(wanted), np.bool_))


def _unique(arrays, keys):
    """Return the rows sorted by the keys, of which the last is the primary one; each combination occurs once."""
    order = np.lexsort(keys)
    if len(order):
        differs = np.any([key[order[1:]] != key[order[:-1]] for key in keys], axis=0)
        order = order[np.concatenate(([True], differs))]
    return _rows(arrays, order, len(keys[0]))


def _rows(arrays, rows, count):
    return {name: array[rows] if len(array) == count else array for name, array in arrays.items()}
