"""Parts: a packing taken apart by bodies and put together again is the same, to the bit."""

import numpy as np
import pytest

from simcore.dem.state.parts import assemble, take_part
from tests.helpers.few_spheres import pack_few_spheres
from tests.helpers.same_bits import arrays_of, assert_same_bits


@pytest.fixture(scope="module")
def packed():
    return pack_few_spheres()


@pytest.mark.parametrize("shared", [False, True])
def test_any_parts_make_the_whole(packed, shared):
    """Shared parts list the contacts between them twice, and each of these is counted once."""
    rng = np.random.default_rng(3)
    owner = rng.integers(0, 3, len(packed.bodies.mass))
    parts = [take_part(packed.bodies, packed.candidates, np.flatnonzero(owner == k), shared) for k in (2, 0, 1)]
    whole = assemble(parts, np.arange(len(owner)))
    assert_same_bits(arrays_of(packed.bodies, packed.candidates), arrays_of(*whole))


def test_what_is_not_here_is_left_out(packed):
    """With own bodies 0 to 9 and ghosts 10 to 19, contacts among ghosts and with other bodies are left out."""
    some = np.arange(20)
    bodies, near = assemble([take_part(packed.bodies, packed.candidates, some, shared=True)], np.arange(10))
    assert list(bodies.id) == list(some) and list(bodies.own) == list(range(10))
    assert list(bodies.ghosts) == list(range(10, 20))
    a, b = packed.contacts.body_a, packed.contacts.body_b
    kept = (a < 20) & (b < 20) & ((a < 10) | (b < 10))
    assert 0 < kept.sum() < len(a)
    np.testing.assert_array_equal(near.contacts.body_a, a[kept])
    np.testing.assert_array_equal(near.contacts.spring, packed.contacts.spring[kept])
    assert (near.walls.body < 10).all()
    np.testing.assert_array_equal(near.walls.body, packed.walls.body[packed.walls.body < 10])


def test_without_contacts_there_is_no_near(packed):
    bodies, near = assemble([take_part(packed.bodies, None, np.array([3, 4]))], [4])
    assert near is None and list(bodies.id) == [3, 4] and list(bodies.own) == [1]
