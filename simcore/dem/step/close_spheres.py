"""Search for spheres that meet, in linked cells.

The cells form as many levels as the sizes of the spheres require. A sphere belongs to the level of its size, crowded
levels have finer cells, and a pair is searched from its smaller sphere. In horizontally periodic boxes cells wrap
around, and each wrap counts the image: a pair that is close through several images, or a sphere that is close to an
image of itself, is found once for each image. Several threads share the spheres of a level. The pairs are the same,
because they are sorted afterwards.
"""

from typing import NamedTuple

import numpy as np
from numba import get_num_threads, prange

from simcore.compilation import kernel, parallel_kernel, routine
from simcore.dem.state.contacts import Box

FINEST = 4.0  # largest factor by which the cells of a crowded level are made smaller
SLACK = 1e-6  # share of their range by which the quick test keeps spheres that do not quite meet; far above round-off
CELLS_OF_A_FEW, CELLS_PER_SPHERE = 4096, 64  # limit of the number of cells; a dense bed has about one for each sphere
PAIRS_PER_SPHERE = 32  # memory for pairs at first; the search is repeated if they are more
BLOCK = 64  # number of spheres that a thread takes at a time; the threads take turns, as blocks are unequally costly


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
    # A cell is at least as wide as the largest distance at which two spheres of its level meet.
    cell_width = 2.0 * reach.min() * 2.0 ** (1 + np.arange(level.max() + 1))
    grids = [
        _sort_into_cells(spheres, np.flatnonzero(level == k), cell_width[k], box)
        for k in range(len(cell_width))
        if np.any(level == k)
    ]
    pairs_of_levels = []
    for fine, grid in enumerate(grids):
        for coarse in range(fine, len(grids)):
            pairs_of_levels += _search(spheres, grid, grids[coarse], fine == coarse)
    return sort_pairs(np.concatenate(pairs_of_levels), len(reach))


class _Grid(NamedTuple):
    members: np.ndarray  # (k,) spheres in the order of their cells
    places: np.ndarray  # (k, 4) [m]: wrapped position and radius of the members
    largest: float  # [m], radius
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


def _sort_into_cells(spheres, members, cell_width, box: Box) -> _Grid:
    wrapped = spheres.wrapped[members]
    low = wrapped.min(axis=0)
    extent = wrapped.max(axis=0) - low
    if box.width > 0.0:
        low[:2], extent[:2] = 0.0, box.width
    # Bounding spheres of long grains overlap much; finer cells then contain fewer bodies that are too far away.
    crowd = len(members) / np.prod(np.maximum(extent / cell_width, 1.0))
    cell_width /= np.clip(np.floor(np.cbrt(crowd)), 1.0, FINEST)
    counts = np.maximum(np.floor(extent / cell_width), 1).astype(np.int64)
    counts = _limit_cells(counts, len(members))
    widths = np.where(extent > 0.0, extent / counts, cell_width)
    cell = np.clip(((wrapped - low) / widths).astype(np.int64), 0, counts - 1)
    flat = (cell[:, 0] * counts[1] + cell[:, 1]) * counts[2] + cell[:, 2]
    order = np.argsort(flat, kind="stable")
    start = np.concatenate(([0], np.cumsum(np.bincount(flat, minlength=counts.prod()))))
    reach = spheres.reach[members]
    places = np.column_stack([wrapped, reach])[order]
    return _Grid(members[order], places, float(reach.max()), start, counts, low, widths)


def _limit_cells(counts, n) -> np.ndarray:
    """Return the numbers of cells along the axes (3,), reduced until memory for the cells of n spheres is bounded.

    Grains far above the bed, or far apart in open space, would otherwise need a grid of nearly empty cells.
    """
    counts = np.minimum(counts, 4 + 2 * n)
    while np.prod(counts, dtype=float) > CELLS_OF_A_FEW + CELLS_PER_SPHERE * n:
        longest = counts.argmax()
        counts[longest] = (counts[longest] + 1) // 2
    return counts


def _search(spheres, fine, coarse, same_level) -> list[np.ndarray]:
    """Return the pairs of members of two grids that meet, in arrays (k, 4); pairs of one level are found once."""
    threads = get_num_threads()
    search = _search_serial if threads == 1 else _search_parallel
    capacity = 2 * BLOCK * PAIRS_PER_SPHERE + PAIRS_PER_SPHERE * len(fine.members) // threads
    while True:
        pairs, counts = search(spheres, fine, coarse, same_level, threads, capacity)
        if counts.max() <= capacity:
            return [pairs[thread, :count] for thread, count in enumerate(counts)]
        capacity = int(counts.max())


def _search_blocks(spheres, fine, coarse, same_level, threads, capacity):
    """Return the pairs of each thread (threads, capacity, 4) and their numbers, which may exceed the capacity."""
    pairs = np.empty((threads, capacity, 4), np.int64)
    counts = np.zeros(threads, np.int64)
    n = len(fine.members)
    for thread in prange(threads):
        for begin in range(thread * BLOCK, n, threads * BLOCK):
            end = min(begin + BLOCK, n)
            counts[thread] = _search_from(spheres, fine, coarse, same_level, begin, end, pairs[thread], counts[thread])
    return pairs, counts


_search_serial, _search_parallel = kernel(_search_blocks), parallel_kernel(_search_blocks)


@routine
def _search_from(spheres, fine, coarse, same_level, begin, end, pairs, count):
    """Store the pairs of some members of `fine` from row `count` on; return the number, which may exceed the rows."""
    nx, ny, nz = coarse.counts[0], coarse.counts[1], coarse.counts[2]
    width = spheres.width
    for m in range(begin, end):
        i = fine.members[m]
        x, y, z, reach = fine.places[m, 0], fine.places[m, 1], fine.places[m, 2], fine.places[m, 3]
        span = (1.0 + SLACK) * (reach + coarse.largest)
        low_x, high_x = _cells(coarse, 0, x, span, width > 0.0)
        low_y, high_y = _cells(coarse, 1, y, span, width > 0.0)
        low_z, high_z = _cells(coarse, 2, z, span, False)
        for cx in range(low_x, high_x + 1):
            ix = cx // nx
            from_x = x - ix * width
            for cy in range(low_y, high_y + 1):
                iy = cy // ny
                from_y = y - iy * width
                column = ((cx - ix * nx) * ny + cy - iy * ny) * nz
                for k in range(coarse.cell_start[column + low_z], coarse.cell_start[column + high_z + 1]):
                    dx, dy, dz = coarse.places[k, 0] - from_x, coarse.places[k, 1] - from_y, coarse.places[k, 2] - z
                    range_ = (1.0 + SLACK) * (reach + coarse.places[k, 3])
                    if dx * dx + dy * dy + dz * dz >= range_ * range_:
                        continue
                    j = coarse.members[k]
                    if same_level and (j < i or (j == i and (ix < 0 or (ix == 0 and iy <= 0)))):
                        continue
                    if not (spheres.moves_here[i] or spheres.moves_here[j]):
                        continue
                    image_x = ix - spheres.shift[j, 0] + spheres.shift[i, 0]
                    image_y = iy - spheres.shift[j, 1] + spheres.shift[i, 1]
                    a, b = i, j
                    if i > j:
                        a, b, image_x, image_y = j, i, -image_x, -image_y
                    if not _meet(spheres, a, b, image_x, image_y):
                        continue
                    if count < len(pairs):
                        pairs[count, 0], pairs[count, 1] = a, b
                        pairs[count, 2], pairs[count, 3] = image_x, image_y
                    count += 1
    return count


@routine
def _cells(grid, axis, place, span, periodic):
    """Return the first and the last cell along an axis that are within `span` of a place."""
    low = int(np.floor((place - span - grid.origin[axis]) / grid.widths[axis]))
    high = int(np.floor((place + span - grid.origin[axis]) / grid.widths[axis]))
    if not periodic:
        low = min(max(low, 0), grid.counts[axis] - 1)
        high = min(max(high, 0), grid.counts[axis] - 1)
    return low, high


@routine
def _meet(spheres, a, b, image_x, image_y):
    """Return whether two spheres meet; with a < b the sums round alike on every rank and from either sphere."""
    dx = spheres.position[b, 0] - spheres.position[a, 0] + image_x * spheres.width
    dy = spheres.position[b, 1] - spheres.position[a, 1] + image_y * spheres.width
    dz = spheres.position[b, 2] - spheres.position[a, 2]
    range_ = spheres.reach[a] + spheres.reach[b]
    return dx * dx + dy * dy + dz * dz < range_ * range_


@kernel
def sort_pairs(pairs, n_bodies):
    """Return the rows (m, 4) sorted by all columns. It sorts by counting, which takes linear time."""
    m = len(pairs)
    order = _order_by(pairs, 0, _order_by(pairs, 1, np.arange(m), n_bodies), n_bodies)
    sorted_ = np.empty((m, 4), np.int64)
    for q in range(m):
        p, r = order[q], q
        while r > 0 and _later(sorted_, r - 1, pairs, p):
            for column in range(4):
                sorted_[r, column] = sorted_[r - 1, column]
            r -= 1
        for column in range(4):
            sorted_[r, column] = pairs[p, column]
    return sorted_


@kernel
def _order_by(pairs, column, order, n_bodies):
    """Return the rows (m,) in the order of a column of bodies; those of one body keep their given order (m,)."""
    start = np.zeros(n_bodies + 1, np.int64)
    for p in order:
        start[pairs[p, column] + 1] += 1
    for i in range(n_bodies):
        start[i + 1] += start[i]
    ordered = np.empty(len(order), np.int64)
    for p in order:
        ordered[start[pairs[p, column]]] = p
        start[pairs[p, column]] += 1
    return ordered


@routine
def _later(rows, r, others, p):
    """Return whether row r is of the same two bodies as row p of the others, through a later image."""
    if rows[r, 0] != others[p, 0] or rows[r, 1] != others[p, 1]:
        return False
    if rows[r, 2] != others[p, 2]:
        return rows[r, 2] > others[p, 2]
    return rows[r, 3] > others[p, 3]
