"""A packing on one rank, and the reductions over all bodies, which do not depend on the number of ranks.

A packing runs on one rank (OneRank) or on several that share its bodies (simcore.dem.ranks.many_ranks.ManyRanks, which
has the same methods). Decisions rest on maxima and sums over all bodies. A sum of floats depends on the order of its
terms and therefore on the number of ranks; `totals` adds integers instead.
"""

import time
from contextlib import contextmanager

import numpy as np

from simcore.dem.state.bodies import join_bodies
from simcore.dem.state.parts import assemble, take_part
from simcore.dem.step.candidate_pairs import list_candidates

_BITS = 62  # sums of integers stay below 2^62, so that an int64 cannot overflow
STOP_CHECK_INTERVAL = 0.5  # [s], approximate interval at which a single rank checks for a stop request


class OneRank:
    """The only rank: it moves all bodies."""

    rank, size = 0, 1
    shared = 0  # candidate pairs that another rank computes too
    exchanging, bytes_sent, steps = 0.0, 0, 0  # of the exchange between ranks: time [s], bytes, number of steps

    def __init__(self):
        self.steps_per_check = 1  # number of steps that recently took about STOP_CHECK_INTERVAL

    def maximum(self, values) -> np.ndarray:
        """Return the maximum over all ranks of each value, (k,) floats."""
        return np.asarray(values, float)

    def add(self, counts) -> np.ndarray:
        """Return the sum over all ranks of each integer, (k,) int64."""
        return np.asarray(counts, np.int64)

    def first(self, candidate: tuple, n_keys: int) -> tuple:
        """Return the greatest of the tuples of all ranks, by their first n_keys members."""
        return candidate

    def all(self, values: list) -> list:
        """Return the lists of all ranks joined to one, in the order of the ranks."""
        return values

    def largest(self, values, ids, *more) -> tuple:
        """Return (value, id, ...) of the largest value of all ranks; among equal values the lowest id is taken.

        values (n,), ids (n,), more: further arrays (n, ...), of which the row of the same body is returned. If no rank
        has a value, the result is (-inf, -1, ...) with None for each array of `more`.
        """
        candidate = -np.inf, 1, *(None for _ in more)
        if len(values):
            k = int(np.argmax(values))
            candidate = float(values[k]), -int(ids[k]), *(array[k] for array in more)
        value, minus_id, *more = self.first(candidate, 2)
        return value, -minus_id, *more

    def totals(self, *groups) -> list[float]:
        """Return the sum of each group of numbers over all ranks, with the same rounding for any order of the terms.

        Each number is rounded to a multiple of a power of two. The power follows from the largest number and the count,
        so that the int64 sum cannot overflow. The error is below count (count + 1) 2^-61 of the largest number: 5e-7 of
        it for 10⁶ numbers, 2e-12 for 2000. The sum is nan if a number is not finite.
        """
        groups = [np.asarray(group, float).ravel() for group in groups]
        tops = self.maximum(
            [np.abs(group).max(initial=0.0) if np.isfinite(group).all() else np.inf for group in groups]
        )
        counts = self.add([len(group) for group in groups])
        powers = _BITS - np.frexp(np.where(np.isfinite(tops), tops, 0.0))[1] - np.ceil(np.log2(counts + 1)).astype(int)
        sums = self.add(
            [
                np.rint(np.ldexp(group, power)).astype(np.int64).sum() if np.isfinite(top) else 0
                for group, power, top in zip(groups, powers, tops, strict=True)
            ]
        )
        return [
            float(np.ldexp(float(sum_), -power)) if np.isfinite(top) else np.nan
            for sum_, power, top in zip(sums, powers, tops, strict=True)
        ]

    @contextmanager
    def together(self):
        """Return a context in which an unexpected exception of one rank ends all ranks."""
        yield

    def on_first(self, act, expected=(ValueError, OSError)):
        """Call `act` on rank 0 and return its result there, None elsewhere; raise an `expected` error on all ranks."""
        result, failure = None, None
        if self.rank == 0:
            try:
                result = act()
            except expected as error:
                failure = error
        failure = self.all([failure])[0]
        if failure is not None:
            raise failure
        return result

    # -- distribution of the bodies -------------------------------------------------------------------------

    def insert(self, bodies, inserted, box):
        """Return `bodies` (or None) joined with those of the inserted bodies that this rank moves."""
        return inserted if bodies is None else join_bodies(bodies, inserted)

    def list_candidates(self, bodies, shapes, box, margin, features, old):
        """Return the bodies of this rank and their candidate pairs; see candidate_pairs.list_candidates."""
        return bodies, list_candidates(bodies, shapes, box, margin, features, old)

    def advance(self, step, bodies, n_steps, stop_request):
        """Advance by at most n_steps; return (steps done, whether the list is stale, stop request or 0).

        step(n) -> (steps done, stale). stop_request() -> an integer, 0 if no stop is requested; None: never checked.
        """
        if stop_request is None:
            return *step(n_steps), 0
        started = time.monotonic()
        done, stale = step(min(n_steps, self.steps_per_check))
        elapsed = time.monotonic() - started
        if elapsed > STOP_CHECK_INTERVAL:
            self.steps_per_check = max(done // 2, 1)
        elif elapsed < 0.4 * STOP_CHECK_INTERVAL and done == self.steps_per_check:
            self.steps_per_check = 2 * done
        return done, stale, stop_request()

    def parts(self, bodies, candidates):
        """Yield the parts (simcore.dem.state.parts) of all ranks, one after the other, on rank 0."""
        yield take_part(bodies, candidates, bodies.own)

    def restore(self, sections, box, features):
        """Return Bodies and CandidatePairs from the parts of all former ranks; sections() iterates over the parts."""
        parts = list(sections())
        return assemble(parts, np.concatenate([part["body.id"] for part in parts]))


def started_by_mpi(environment) -> bool:
    """Return whether an MPI launcher (mpiexec of MPICH or Open MPI, srun) started this process."""
    return any(name in environment for name in ("PMI_RANK", "PMIX_RANK", "OMPI_COMM_WORLD_RANK"))


ONE_RANK = OneRank()
