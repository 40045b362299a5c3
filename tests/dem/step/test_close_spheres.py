"""The search for spheres that meet, compared with all pairs in all images."""

import tracemalloc

import numpy as np
import pytest

from simcore.dem.state.contacts import Box
from simcore.dem.step import close_spheres
from simcore.dem.step.close_spheres import find_pairs, sort_pairs


def all_pairs(position, radius, width):
    """Return the set of (a, b, image x, image y) by brute force, with a < b, or a = b and a positive image."""
    near = set()
    n = len(radius)
    if width > 0.0:
        span = np.ptp(position[:, :2]) + 2.0 * radius.max()
        reach = int(np.ceil(span / width)) + 1
        images = [(i, j) for i in range(-reach, reach + 1) for j in range(-reach, reach + 1)]
    else:
        images = [(0, 0)]
    for image in images:
        offset = position[None] - position[:, None] + np.array([*image, 0]) * width
        close = (offset**2).sum(axis=-1) < (radius[:, None] + radius[None]) ** 2
        for a, b in zip(*np.nonzero(close), strict=True):
            if a < b or (a == b and image > (0, 0)):
                near.add((int(a), int(b), *image))
    assert n
    return near


def found_pairs(position, radius, width):
    pairs = find_pairs(position, radius, Box(width))
    keys = [tuple(int(value) for value in row) for row in pairs]
    assert len(set(keys)) == len(keys), "a pair is listed twice"
    assert keys == sorted(keys), "not in the order of the key"
    return set(keys)


@pytest.mark.parametrize(
    "width, largest, n",
    [
        (0.0, 0.02, 300),  # open
        (0.0, 0.12, 300),  # open, sizes 1 : 12
        (0.3, 0.02, 300),
        (0.3, 0.12, 300),  # a pair may touch through several images
        (0.05, 0.06, 40),  # far narrower than the largest
        (1.0, 0.12, 300),
    ],
)
def test_the_list_holds_every_near_pair_once(width, largest, n, monkeypatch):
    rng = np.random.default_rng(1)
    radius = np.exp(rng.uniform(np.log(0.01), np.log(largest), n))
    radius[0], radius[1] = 0.01, largest
    extent = width if width > 0.0 else 0.4
    # Positions are not wrapped: they are up to two widths away from the box.
    position = rng.uniform([-2 * extent, -2 * extent, 0.0], [3 * extent, 3 * extent, 0.5], (n, 3))
    if width == 0.0:
        position = rng.uniform(0.0, 0.4, (n, 3))
    found = found_pairs(position, radius, width)
    assert found == all_pairs(position, radius, width)
    assert len(found) > n / 8
    monkeypatch.setattr(close_spheres, "get_num_threads", lambda: 3)
    assert found_pairs(position, radius, width) == found


def test_a_grain_meets_its_own_images_once_each():
    found = found_pairs(np.array([[0.05, 0.02, 0.1]]), np.array([0.06]), 0.1)
    assert found == {(0, 0, 0, 1), (0, 0, 1, 0)}
    wider = found_pairs(np.array([[0.05, 0.02, 0.1]]), np.array([0.08]), 0.1)
    assert wider == {(0, 0, 0, 1), (0, 0, 1, -1), (0, 0, 1, 0), (0, 0, 1, 1)}


def test_places_on_the_border_of_box_and_cell():
    position = np.array([[0.0, 0.0, 0.0], [0.2, 0.2, 0.0], [0.4, 0.0, 0.0], [-1e-18, 0.1, 0.0], [0.1, 0.3999999, 0.1]])
    radius = np.full(5, 0.15)
    assert found_pairs(position, radius, 0.4) == all_pairs(position, radius, 0.4)


@pytest.mark.parametrize("width", [0.0, 0.4])
def test_crowded_spheres_are_searched_in_finer_cells(width):
    position = np.random.default_rng(5).uniform(0.0, 0.4, (300, 3))
    radius = np.full(300, 0.05)
    found = found_pairs(position, radius, width)
    assert found == all_pairs(position, radius, width) and len(found) > 5 * 300


def test_spheres_far_apart_in_open_space_need_little_memory():
    n = 500  # a cell for each width of a sphere would take 16 GB
    position = np.random.default_rng(3).uniform(0.0, 100.0, (n, 3))
    position[7] = position[3] + [0.0015, 0.0, 0.0]
    tracemalloc.start()
    found = found_pairs(position, np.full(n, 1e-3), 0.0)
    assert found == {(3, 7, 0, 0)}
    assert tracemalloc.get_traced_memory()[1] < 20e6
    tracemalloc.stop()


@pytest.mark.parametrize("threads", [1, 3])
def test_more_pairs_than_there_is_memory_for_at_first(threads, monkeypatch):
    n = 400
    monkeypatch.setattr(close_spheres, "get_num_threads", lambda: threads)
    pairs = find_pairs(np.random.default_rng(2).uniform(0.0, 0.1, (n, 3)), np.full(n, 0.1), Box(0.0))
    assert len(pairs) == n * (n - 1) // 2
    np.testing.assert_array_equal(pairs[:, :2], np.transpose(np.triu_indices(n, 1)))


def test_pairs_that_do_not_move_here_are_left_out():
    rng = np.random.default_rng(3)
    position, radius, here = rng.uniform(0.0, 0.2, (200, 3)), np.full(200, 0.02), rng.uniform(size=200) < 0.3
    every = find_pairs(position, radius, Box(0.2))
    kept = every[here[every[:, 0]] | here[every[:, 1]]]
    np.testing.assert_array_equal(find_pairs(position, radius, Box(0.2), here), kept)
    assert 0 < len(kept) < len(every)


def test_pairs_are_sorted_as_by_comparison():
    rng = np.random.default_rng(4)
    pairs = np.unique(np.column_stack([rng.integers(0, 12, (4000, 2)), rng.integers(-2, 3, (4000, 2))]), axis=0)
    shuffled = rng.permutation(pairs)
    np.testing.assert_array_equal(sort_pairs(shuffled, 12), shuffled[np.lexsort(shuffled.T[::-1])])
    assert len(pairs) > 2000 and len(sort_pairs(pairs[:0], 12)) == 0
