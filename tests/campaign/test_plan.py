"""Hours of studies and their pieces."""

import numpy as np
import pandas as pd
import pytest

from simcore.campaign.plan import describe_studies, estimate_studies, number_pieces
from simcore.packing.cost import PackingCost


def test_pieces_are_within_their_hours_and_the_first_seed_comes_first():
    seeds = np.tile([1, 2], 10)
    hours = np.full(20, 0.5)
    pieces = number_pieces(hours, seeds, 2.0)
    assert [hours[pieces == piece].sum() for piece in range(1, 6)] == [2.0] * 5
    assert pieces[seeds == 1].max() == pieces[seeds == 2].min() == 3


def test_a_packing_longer_than_a_piece_is_one_by_itself():
    assert number_pieces([0.1, 5.0, 0.1, 0.2], [1, 1, 1, 1], 2.0).tolist() == [1, 2, 3, 3]


def test_the_hours_of_all_are_those_of_the_studies_in_it():
    steps = {"generating": 4, "shaking": 3, "damping": 3, "longest_damping": 9}
    cost = PackingCost(grains=100, batches=1, **steps, cpu_seconds=1800.0, array_bytes=0.0)
    assert cost.steps == 10
    packings = pd.DataFrame({"study": ["a", "a", "other", "b"], "cost": [cost] * 4, "piece": [1, 2, 1, 1]})
    table = estimate_studies(packings, ["a", "b"]).set_index("study")
    assert list(table.index) == ["a", "b", "all", "other"]
    assert table.loc["all", ["packings", "grains", "cpu_h", "longest_h", "pieces"]].tolist() == [3, 300, 1.5, 0.5, 3]
    assert table.cpu_h["other"] == pytest.approx(0.5)
    text = describe_studies(table.reset_index(), 2)
    assert "all" in text and "1.50" in text and "a_piece_1" in text
