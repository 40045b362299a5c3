"""Score and choice of candidates on made-up errors."""

import numpy as np
import pytest

from simcore.models.size_and_form.choice import Score, choose, score

GROUPS = np.array(["a", "a", "b", "b", "c", "c"])


def test_the_score_is_the_weighted_mean_size_of_the_error():
    errors = {"good": [0.001, -0.001, 0.002, 0.002, 0.0, 0.0], "bad": [0.004] * 6}
    result = score(errors, [1, 1, 2, 2, 1, 1], GROUPS)
    assert result["good"].error == pytest.approx((2 * 0.001 + 4 * 0.002) / 8)
    assert result["good"].excess == 0 and result["good"].excess_std_error == 0
    assert result["bad"].excess == pytest.approx(0.004 - 0.00125)
    # Differences of the groups are 3, 2 and 4 thousandths, with shares 1/4, 1/2, 1/4 and the mean 2.75.
    deviations = np.array([0.25 * 0.25, 0.5 * -0.75, 0.25 * 1.25]) * 1e-3
    assert result["bad"].excess_std_error == pytest.approx(np.sqrt(1.5 * np.sum(deviations**2)))


def test_the_standard_error_is_the_scatter_of_the_excess_over_samples_of_groups():
    """Beds of a group share a deviation, so the scatter is that of groups, not of beds."""
    rng, excess, stated = np.random.default_rng(1), [], []
    groups = np.repeat(np.arange(8), 5)
    for _ in range(600):
        shared = np.repeat(rng.normal(0, 1e-3, 8), 5)
        errors = {"good": np.full(40, 0.002), "bad": 0.01 + shared}
        result = score(errors, np.ones(40), groups)["bad"]
        excess.append(result.excess)
        stated.append(result.excess_std_error**2)
    assert np.sqrt(np.mean(stated)) == pytest.approx(np.std(excess), rel=0.1)


def test_what_cannot_be_scored_is_refused():
    with pytest.raises(ValueError, match="two groups"):
        score({"a": [0.1, 0.2]}, [1, 1], ["x", "x"])
    with pytest.raises(ValueError, match="candidate a has 1 errors for 2 beds"):
        score({"a": [0.1]}, [1, 1], ["x", "y"])
    with pytest.raises(ValueError, match="candidate a has no prediction for every bed"):
        score({"a": [0.1, np.nan]}, [1, 1], ["x", "y"])


def test_the_simplest_that_is_not_worse_is_chosen():
    parameters = {"literature": 0, "L": 2, "F": 2, "H": 3}
    family = {
        "literature": Score(0.009, 0.005, 0.002),
        "L": Score(0.0045, 0.0005, 0.001),
        "F": Score(0.0043, 0.0003, 0.001),
        "H": Score(0.004, 0.0, 0.0),
    }
    assert choose(family, family, parameters) == "L"  # the first of two with as many parameters
    assert choose(family, {**family, "L": Score(0.006, 0.002, 0.001)}, parameters) == "F"
    assert choose({**family, "literature": Score(0.005, 0.001, 0.002)}, family, parameters) == "L"
    close = {**family, "literature": Score(0.005, 0.001, 0.002)}
    assert choose(close, close, parameters) == "literature"
    # If each candidate fails one of the two comparisons, the error over families decides.
    failing = {name: Score(0.01, 0.005, 0.001) for name in parameters}
    assert choose(family, failing, parameters) == "H"


def test_the_model_in_use_is_kept_within_two_standard_errors():
    parameters = {"literature": 0, "L": 2, "H": 3}
    scores = {
        "literature": Score(0.009, 0.005, 0.002),
        "L": Score(0.0058, 0.0018, 0.001),
        "H": Score(0.004, 0.0, 0.0),
    }
    assert choose(scores, scores, parameters) == choose(scores, scores, parameters, "literature") == "H"
    assert choose(scores, scores, parameters, "L") == "L"
    worse = {**scores, "L": Score(0.0061, 0.0021, 0.001)}
    assert choose(scores, worse, parameters, "L") == choose(worse, scores, parameters, "L") == "H"
    assert choose(scores, scores, parameters, "a name that is not compared") == "H"
