"""Candidate pairs: the neighbour search in linked cells, with a margin for each body.

Each body has its own margin, so that a few fast bodies make neither the listings frequent nor all lists long.
Pairs of bodies that are not spheres are listed only if they can meet before the next listing.
The cells form as many levels as the sizes of the bodies require. A body belongs to the level whose cells are just wider
than its bounding sphere with margin, and a pair is searched from its smaller body. In horizontally periodic boxes cells
wrap around, and each wrap counts the image: a pair that is close through several images, or a grain that is close to
an image of itself, is listed once for each image.
"""

from typing import NamedTuple

import numpy as np

from simcore.compilation import kernel, leaf
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
from simcore.dem.vectors import Vec

FINEST = 4.0  # largest factor by which the cells of a crowded level are made smaller


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
    return pairs[_can_meet(pairs, bodies, shapes, before, box.width)]


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


def find_pairs(position, reach, box: Box, moves_here=None) -> np.ndarray:
    """Find the pairs of spheres that meet: sorted rows (m, 4) of a, b and image, a < b, or a = b with positive image.

    The partner is b shifted by image × width. position (n, 3) [m], not wrapped; reach (n,) [m], radius of each sphere.
    moves_here (n,) bool: pairs in which neither body moves here are left out; None: all bodies move here.
    """
    if len(reach) == 0:
        return np.zeros((0, 4), np.int64)
    if moves_here is None:
        moves_here = np.ones(len(reach), np.bool_)
    spheres = _spheres(position, reach, box, moves_here)
    level = np.floor(np.log2(reach / reach.min()) + 1e-12).astype(np.int64)
    cell_width = 2.0 * reach.min() * 2.0 ** (1 + np.arange(level.max() + 1))
    grids = [
        _sort_into_cells(spheres.wrapped, np.flatnonzero(level == k), cell_width[k], box)
        if np.any(level == k)
        else None
        for k in range(len(cell_width))
    ]
    pairs_of_levels = []
    for fine, grid in enumerate(grids):
        if grid is None:
            continue
        for coarse in range(fine, len(grids)):
            if grids[coarse] is not None:
                # The range of a pair is at most the mean of the two cell widths.
                span = 0.5 * (cell_width[fine] + cell_width[coarse])
                pairs_of_levels.append(_search(spheres, grid.members, grids[coarse], span, fine == coarse))
    pairs = np.concatenate(pairs_of_levels)
    return pairs[np.lexsort((pairs[:, 3], pairs[:, 2], pairs[:, 1], pairs[:, 0]))]


class _Grid(NamedTuple):
    members: np.ndarray  # (k,) bodies in the order of their cells
    cell_start: np.ndarray  # (nx * ny * nz + 1,)
    counts: np.ndarray  # (3,) number of cells along each axis
    origin: np.ndarray  # (3,)
    widths: np.ndarray  # (3,)


class _Spheres(NamedTuple):
    position: np.ndarray  # (n, 3) [m]
    reach: np.ndarray  # (n,) [m]
    moves_here: np.ndarray  # (n,) bool
    wrapped: np.ndarray  # (n, 3) [m], in [0, width) horizontally
    shift: np.ndarray  # (n, 2) int64: position = wrapped + shift × width
    width: float  # [m], 0 where not periodic


def _spheres(position, reach, box: Box, moves_here) -> _Spheres:
    wrapped = position.copy()
    shift = np.zeros((len(position), 2), np.int64)
    if box.width > 0.0:
        shift[:] = np.floor(position[:, :2] / box.width)
        wrapped[:, :2] = position[:, :2] - shift * box.width
    return _Spheres(position, reach, moves_here, wrapped, shift, box.width)


def _sort_into_cells(wrapped, members, cell_width, box: Box) -> _Grid:
    low = wrapped[members].min(axis=0)
    extent = wrapped[members].max(axis=0) - low
    if box.width > 0.0:
        low[:2], extent[:2] = 0.0, box.width
    # Bounding spheres of long grains overlap much; finer cells then contain fewer bodies that are too far away.
    crowd = len(members) / np.prod(np.maximum(extent / cell_width, 1.0))
    cell_width /= np.clip(np.floor(np.cbrt(crowd)), 1.0, FINEST)
    counts = np.maximum(np.floor(extent / cell_width), 1).astype(np.int64)
    # A few grains far above the bed must not make the grid larger than the bed requires.
    counts = np.minimum(counts, 4 + 2 * len(members))
    widths = np.where(extent > 0.0, extent / counts, cell_width)
    cell = np.clip(((wrapped[members] - low) / widths).astype(np.int64), 0, counts - 1)
    flat = (cell[:, 0] * counts[1] + cell[:, 1]) * counts[2] + cell[:, 2]
    order = np.argsort(flat, kind="stable")
    start = np.concatenate(([0], np.cumsum(np.bincount(flat, minlength=counts.prod()))))
    return _Grid(members[order], start, counts, low, widths)


@kernel
def _search(spheres, members, grid, span, same_level):
    """Find the pairs of `members` and bodies of `grid` whose spheres meet; pairs of one level are returned once."""
    position, wrapped, shift, width = spheres.position, spheres.wrapped, spheres.shift, spheres.width
    moves_here, reach = spheres.moves_here, spheres.reach
    pairs = np.empty((16 * len(members) + 16, 4), np.int64)
    n_pairs = 0
    low = np.empty(3, np.int64)
    high = np.empty(3, np.int64)
    for i in members:
        for axis in range(3):
            periodic = width > 0.0 and axis < 2
            place = wrapped[i, axis] - grid.origin[axis]
            low[axis] = int(np.floor((place - span) / grid.widths[axis]))
            high[axis] = int(np.floor((place + span) / grid.widths[axis]))
            if not periodic:
                low[axis] = min(max(low[axis], 0), grid.counts[axis] - 1)
                high[axis] = min(max(high[axis], 0), grid.counts[axis] - 1)
        for cx in range(low[0], high[0] + 1):
            ix = cx // grid.counts[0]
            for cy in range(low[1], high[1] + 1):
                iy = cy // grid.counts[1]
                column = ((cx - ix * grid.counts[0]) * grid.counts[1] + cy - iy * grid.counts[1]) * grid.counts[2]
                for k in range(grid.cell_start[column + low[2]], grid.cell_start[column + high[2] + 1]):
                    j = grid.members[k]
                    if same_level and (j < i or (j == i and (ix < 0 or (ix == 0 and iy <= 0)))):
                        continue
                    if not (moves_here[i] or moves_here[j]):
                        continue
                    a, b = i, j
                    image_x, image_y = ix - shift[j, 0] + shift[i, 0], iy - shift[j, 1] + shift[i, 1]
                    if i > j:
                        a, b, image_x, image_y = j, i, -image_x, -image_y
                    # In this order the sums round alike on every rank and from either body.
                    dx = position[b, 0] - position[a, 0] + image_x * width
                    dy = position[b, 1] - position[a, 1] + image_y * width
                    dz = position[b, 2] - position[a, 2]
                    range_ = reach[a] + reach[b]
                    if dx * dx + dy * dy + dz * dz >= range_ * range_:
                        continue
                    if n_pairs == len(pairs):
                        pairs = _twice_as_long(pairs)
                    pairs[n_pairs, 0], pairs[n_pairs, 1] = a, b
                    pairs[n_pairs, 2], pairs[n_pairs, 3] = image_x, image_y
                    n_pairs += 1
    return pairs[:n_pairs].copy()


@kernel
def _twice_as_long(pairs):
    # The loops are written out because an assignment to a slice takes seconds to compile.
    longer = np.empty((2 * len(pairs), 4), np.int64)
    for p in range(len(pairs)):
        for k in range(4):
            longer[p, k] = pairs[p, k]
    return longer


@kernel
def _can_meet(pairs, bodies, shapes, old, width):
    """Return for each pair (m, 4) whether it may touch before the next listing, by a quick test: (m,) bool."""
    can = np.ones(len(pairs), np.bool_)
    k, n_old = 0, len(old.body_a)
    for p in range(len(pairs)):
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
    return can


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
