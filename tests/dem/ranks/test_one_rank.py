"""Results over all bodies: sums that do not depend on the order, and maxima that prefer the lowest id."""

import math

import numpy as np
import pytest

from simcore.dem.ranks.one_rank import ONE_RANK, started_by_mpi


@pytest.mark.parametrize("n", [1, 7, 2000, 300_000])
def test_totals_do_not_depend_on_the_order(n):
    rng = np.random.default_rng(n)
    values = rng.lognormal(0.0, 3.0, n) * rng.choice([-1.0, 1.0], n)
    (total,) = ONE_RANK.totals(values)
    for _ in range(5):
        assert ONE_RANK.totals(rng.permutation(values)) == [total]
    # Each number is rounded to a multiple of at most 2 count 2^-62 of the largest.
    assert abs(total - math.fsum(values)) <= n * n * 2.0**-62 * np.abs(values).max() + np.spacing(abs(total))


def test_totals_of_several_groups_are_those_of_each():
    groups = [np.array([0.1, 0.2]), np.zeros((0, 3)), np.full((4, 3), 1e-300), np.array([-1e300])]
    assert ONE_RANK.totals(*groups) == [ONE_RANK.totals(group)[0] for group in groups]
    assert ONE_RANK.totals(*groups)[1:] == [0.0, pytest.approx(12e-300), -1e300]


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_total_of_what_is_not_finite_is_nan(bad):
    total, other = ONE_RANK.totals([1.0, bad], [2.0])
    assert math.isnan(total) and other == 2.0


def test_the_largest_of_equals_is_that_of_the_lowest_id():
    value, id_, more = ONE_RANK.largest(np.array([1.0, 3.0, 3.0]), np.array([7, 8, 9]), np.array([0.5, 0.6, 0.7]))
    assert (value, id_, more) == (3.0, 8, 0.6)
    assert ONE_RANK.largest(np.zeros(0), np.zeros(0, int), np.zeros(0)) == (-np.inf, -1, None)


def test_the_starter_of_a_process_is_read_from_its_environment():
    assert started_by_mpi({"PMI_RANK": "0"}) and started_by_mpi({"PMIX_RANK": "1"})
    assert not started_by_mpi({"SLURM_NTASKS": "4", "PATH": ""})
