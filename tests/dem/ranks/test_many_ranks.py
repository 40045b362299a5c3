"""Blocks of ranks: every place has one rank, and loads are even where grains are not.

What the ranks compute is tested in test_equality.py.
"""

import numpy as np
import pytest

from simcore.dem.ranks.many_ranks import ManyRanks, _bin, _layout, _quantiles
from simcore.dem.state.contacts import Box


@pytest.fixture(scope="module")
def ranks():
    from mpi4py import MPI

    return ManyRanks(MPI.COMM_SELF)


def cut(ranks, place, layout, box):
    ranks.layout = layout
    return ranks._cut([place], [np.ones(len(place))], box, together=False)


@pytest.mark.parametrize("layout", [(1, 1), (2, 1), (1, 2), (3, 2), (4, 4)])
@pytest.mark.parametrize("crowd", [0.0, 0.8])
def test_blocks_have_even_loads_where_grains_are_uneven(ranks, layout, crowd):
    """A bin is 1/512 of the width, so a column of bins has about 2 % of grains crowded into a tenth of it."""
    rng = np.random.default_rng(4)
    place = rng.uniform(0.0, 1.0, (20_000, 2))
    crowded = rng.uniform(size=len(place)) < crowd
    place[crowded] = 0.3 + 0.1 * place[crowded]
    blocks = cut(ranks, place, layout, Box(1.0))
    counts = np.bincount(blocks.rank_of(place), minlength=np.prod(layout))
    assert len(counts) == np.prod(layout)
    assert counts.max() <= (1.0 + 0.05 * sum(layout)) * counts.mean()


def test_blocks_of_a_cylinder_span_it(ranks):
    place = np.random.default_rng(5).uniform(-0.05, 0.05, (1000, 2))
    blocks = cut(ranks, place, (2, 2), Box(0.0, 0.05))
    assert set(blocks.rank_of(place)) == {0, 1, 2, 3}
    assert set(blocks.rank_of(np.array([[-9.0, -9.0], [9.0, 9.0]]))) == {0, 3}  # grains outside have a rank too


def test_places_on_a_border_and_at_the_ends_have_a_rank():
    assert list(_bin(np.array([0.0, 1.0, -1e-18, np.nextafter(1.0, 0.0)]), (0.0, 1.0))) == [0, 511, 0, 511]
    assert list(_quantiles(np.array([1, 1, 1, 1]), 2)) == [2]
    assert list(_quantiles(np.array([5, 0, 0, 0]), 2)) == [1]


@pytest.mark.parametrize(
    "size, layout", [(1, (1, 1)), (2, (2, 1)), (3, (3, 1)), (4, (2, 2)), (6, (3, 2)), (400, (20, 20))]
)
def test_layouts_are_as_square_as_they_can_be(size, layout):
    assert _layout(size) == layout


def test_a_layout_of_another_number_of_blocks_is_refused():
    from mpi4py import MPI

    with pytest.raises(ValueError, match="The layout 2 x 2 must have one block for each rank, but there are 1 ranks"):
        ManyRanks(MPI.COMM_SELF, layout=(2, 2))
