"""Candidate pairs: the pairs of bodies that may touch before the next listing, by a margin for each body.

Each body has its own margin, so that a few fast bodies make neither the listings frequent nor all lists long.
Pairs of bodies that are not spheres are listed only if they can meet before the next listing.
"""

import numpy as np
from numba import get_num_threads, prange

from simcore.compilation import kernel, leaf, parallel_kernel, routine
from simcore.dem.contact.search.ellipsoid_climb import support_height
from simcore.dem.shapes.polyhedra import SPHERE, Shapes, base_direction, climb_from_hint, is_polyhedron
from simcore.dem.state.bodies import Bodies
from simcore.dem.state.contacts import (
    Box,
    CandidatePairs,
    carry_remembered_contacts,
    carry_remembered_walls,
    empty_contacts,
    empty_walls,
)
from simcore.dem.state.features import Features
from simcore.dem.step.close_spheres import find_pairs
from simcore.dem.vectors import Vec

BLOCK = 512  # number of pairs that a thread tests at a time; the threads take turns, as blocks are unequally costly


def list_candidates(
    bodies: Bodies, shapes: Shapes, box: Box, margin, features: Features, old: CandidatePairs | None = None
) -> CandidatePairs:
    """List the pairs whose gap may be less than the sum of their margins, and the bodies within their margin of a wall.

    margin [m], a scalar or (n,): is stored in `bodies.margin`. Pairs and walls that `old` contains keep their
    remembered contacts. The positions of the bodies are stored as well: the list is valid while no point of a body has
    moved by more than the body's margin. Pairs with close bounding spheres are left out if their remembered contact, or
    the line between their centres, shows a gap of more than the sum of their margins.
    """
    bodies.margin[:] = margin
    pairs = list_pairs(bodies, shapes, box, features, old)
    return list_contacts(pairs, bodies, shapes, box, features, old)


def list_pairs(bodies, shapes, box, features, old) -> np.ndarray:
    """Return the keys (m, 4) of the candidate pairs with a body that this rank moves; see `list_candidates`.

    The margins are those stored in `bodies`.
    """
    pairs = find_pairs(bodies.position, bodies.radius + bodies.margin, box, bodies.moves_here)
    if features.kind == SPHERE:
        return pairs
    before = empty_contacts(pairs[:0], 0, features) if old is None else old.contacts
    threads = get_num_threads()
    can_meet = _can_meet_serial if threads == 1 else _can_meet_parallel
    return pairs[can_meet(pairs, bodies, shapes, before, box.width, threads, BLOCK)]


def list_contacts(pairs, bodies, shapes, box, features, old) -> CandidatePairs:
    """Build the rows of candidate pairs and of bodies near a wall, with remembered contacts; see `list_candidates`."""
    contacts = empty_contacts(pairs, len(bodies.mass), features)
    walls = empty_walls(bodies, shapes, box, features)
    if old is not None:
        carry_remembered_contacts(old.contacts, contacts)
        carry_remembered_walls(old.walls, walls)
    bodies.listed_position[:] = bodies.position
    if features.kind != SPHERE:
        bodies.listed_turned[:] = bodies.turned
    return CandidatePairs(contacts, walls)


def _can_meet(pairs, bodies, shapes, old, width, threads, block):
    """Return for each pair (m, 4) whether it may touch before the next listing, by a quick test: (m,) bool."""
    can = np.ones(len(pairs), np.bool_)
    for thread in prange(threads):
        for begin in range(thread * block, len(pairs), threads * block):
            _test_pairs(pairs, bodies, shapes, old, width, begin, min(begin + block, len(pairs)), can)
    return can


_can_meet_serial, _can_meet_parallel = kernel(_can_meet), parallel_kernel(_can_meet)


@routine
def _test_pairs(pairs, bodies, shapes, old, width, begin, end, can):
    """Test the pairs from `begin` to `end`; `can` is set to False for those that cannot meet."""
    n_old = len(old.body_a)
    k = _first_row(old, pairs, begin)
    for p in range(begin, end):
        i, j = pairs[p, 0], pairs[p, 1]
        while k < n_old and _key_before(old, k, pairs, p):
            k += 1
        rx = bodies.position[j, 0] - bodies.position[i, 0] + pairs[p, 2] * width
        ry = bodies.position[j, 1] - bodies.position[i, 1] + pairs[p, 3] * width
        rz = bodies.position[j, 2] - bodies.position[i, 2]
        margin = bodies.margin[i] + bodies.margin[j]
        if k < n_old and _same_key(old, k, pairs, p):
            if old.touching[k] != 0:
                continue
            dx, dy, dz = rx - old.apart_at[k, 0], ry - old.apart_at[k, 1], rz - old.apart_at[k, 2]
            gap = old.safe_until[k] - bodies.turned[i] - bodies.turned[j]
            can[p] = gap - np.sqrt(dx * dx + dy * dy + dz * dz) <= margin
            continue
        distance = np.sqrt(rx * rx + ry * ry + rz * rz)
        if distance == 0.0:
            continue
        nx, ny, nz = rx / distance, ry / distance, rz / distance
        reach = _reach(shapes, bodies, i, nx, ny, nz) + _reach(shapes, bodies, j, -nx, -ny, -nz)
        can[p] = distance - reach <= margin


@routine
def _first_row(old, pairs, p):
    """Return the first row of the old list whose key does not come before that of pair p."""
    low, high = 0, len(old.body_a)
    while low < high:
        middle = (low + high) // 2
        if _key_before(old, middle, pairs, p):
            low = middle + 1
        else:
            high = middle
    return low


@leaf
def _reach(shapes, bodies, i, nx, ny, nz):
    """Return how far body i, a polyhedron or an ellipsoid, extends from its centre along n."""
    if not is_polyhedron(shapes, bodies, i):
        return support_height(bodies.form_matrix, i, Vec(nx, ny, nz))
    dx, dy, dz = base_direction(bodies, i, nx, ny, nz)
    v = climb_from_hint(shapes, bodies.shape[i], dx, dy, dz)
    return dx * shapes.vertices[v, 0] + dy * shapes.vertices[v, 1] + dz * shapes.vertices[v, 2]


@leaf
def _key_before(old, k, pairs, p):
    """Return whether key k of the old list comes before pair p."""
    if old.body_a[k] != pairs[p, 0]:
        return old.body_a[k] < pairs[p, 0]
    if old.body_b[k] != pairs[p, 1]:
        return old.body_b[k] < pairs[p, 1]
    if len(old.image) == 0:
        return False
    if old.image[k, 0] != pairs[p, 2]:
        return old.image[k, 0] < pairs[p, 2]
    return old.image[k, 1] < pairs[p, 3]


@leaf
def _same_key(old, k, pairs, p):
    """Return whether key k of the old list is pair p."""
    if old.body_a[k] != pairs[p, 0] or old.body_b[k] != pairs[p, 1]:
        return False
    return len(old.image) == 0 or (old.image[k, 0] == pairs[p, 2] and old.image[k, 1] == pairs[p, 3])
