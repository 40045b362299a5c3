"""The benchmark of extrapolation: intervals for a linear truth and for a curved one."""

import numpy as np
import pandas as pd
import pytest

from benchmarks.studies.extrapolation import by_distance, predictions


def table_of(truth, number=300):
    rng = np.random.default_rng(0)
    features = pd.DataFrame({"a": rng.uniform(1, 5, number), "b": rng.uniform(1, 2, number)})
    predicted = predictions(features, truth(features.a, features.b).to_numpy() + 0.003 * rng.normal(size=number))
    # Five shares of the 300 rows are predicted at either end of each of the two features.
    assert len(predicted) == 2 * 2 * (30 + 60 + 90 + 120 + 150)
    return by_distance(predicted).set_index("distance")


def test_a_linear_truth_is_contained_at_any_distance():
    table = table_of(lambda a, b: 0.3 + 0.02 * a + 0.01 * b)
    mean = np.average(table.by_least_squares, weights=table.predictions)
    # The 300 packings are each predicted several times, so 0.95 is uncertain by sqrt(0.95 0.05 / 300) = 0.013 at least.
    assert mean == pytest.approx(0.95, abs=0.03) and table.by_least_squares.min() > 0.9
    assert (table.widened >= table.by_least_squares).all()


def test_a_curved_truth_leaves_the_interval_with_distance():
    table = table_of(lambda a, b: 0.3 + 0.002 * a**2 + 0.01 * b)
    assert table.by_least_squares["from 0.5"] < 0.6 < 0.8 < table.by_least_squares["from 0"]
    assert table.widened["from 0.5"] > table.by_least_squares["from 0.5"] + 0.1
