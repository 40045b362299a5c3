"""What is decided about all bodies together, and how: by maxima, and by sums that do not depend on their order.

A packing runs on one rank (OneRank) or on several that share its bodies (simcore.dem.ranks.many_ranks.ManyRanks, which
has the same methods). Sums of floats depend on their order, and so would every decision on the number of ranks;
`totals` adds whole numbers instead.
"""

import time
from contextlib import contextmanager

import numpy as np

from simcore.dem.state.bodies import join_bodies
from simcore.dem.state.parts import assemble, take_part
from simcore.dem.step.candidate_pairs import list_candidates

# Of the sign and the largest magnitude of an int64.
_BITS = 62
HEARS = 0.5  # [s], about how often a rank by itself looks whether it is wished to stop


class OneRank:
    """All bodies are here."""

    rank, size = 0, 1
    shared = 0  # candidate pairs that another rank computes too
    exchanging, bytes_sent, steps = 0.0, 0, 0  # [s], bytes and steps of what ranks tell each other

    def __init__(self):
        self.at_once = 1  # steps, of late, in about HEARS

    def maximum(self, values) -> np.ndarray:
        """Maxima over ranks of each of some numbers, (k,) floats."""
        return np.asarray(values, float)

    def add(self, counts) -> np.ndarray:
        """Sums over ranks of each of some whole numbers, (k,) int64."""
        return np.asarray(counts, np.int64)

    def first(self, found: tuple, n_keys: int) -> tuple:
        """That of the ranks' tuples whose first n_keys members are the greatest."""
        return found

    def all(self, found: list) -> list:
        """The ranks' lists, one after the other."""
        return found

    def largest(self, values, ids, *more) -> tuple:
        """(value, id, ...) of the largest value of all ranks, of the lowest id among equals; `more` goes with the ids.

        values (n,), ids (n,), more: further arrays (n, ...). (-inf, -1, ...) with None for each of `more` where there
        is none.
        """
        found = -np.inf, 1, *(None for _ in more)
        if len(values):
            k = int(np.argmax(values))
            found = float(values[k]), -int(ids[k]), *(each[k] for each in more)
        value, minus_id, *more = self.first(found, 2)
        return value, -minus_id, *more

    def totals(self, *groups) -> list[float]:
        """Sum of each group of numbers over all ranks, rounded the same whatever their order.

        Each number is taken as a whole multiple of a power of two, chosen from the largest and from how many there are
        so that the sum of an int64 cannot overflow: the error is below count² 2^-62 of the largest, 3e-7 of it for 10⁶
        numbers, 1e-12 for 2000. nan where a number is not finite.
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
        """Within it, an exception that no rank expects ends all ranks."""
        yield

    def on_first(self, act, expected=OSError):
        """What `act` returns on rank 0, None elsewhere; an `expected` exception is raised on all ranks."""
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

    # -- who has what ---------------------------------------------------------------------------------------

    def welcome(self, bodies, born, box):
        """`bodies` (or None) and of the newborn those that move here."""
        return born if bodies is None else join_bodies(bodies, born)

    def list_candidates(self, bodies, shapes, box, margin, features, old):
        """The bodies that are here now, and their candidate pairs; see candidate_pairs.list_candidates."""
        return bodies, list_candidates(bodies, shapes, box, margin, features, old)

    def advance(self, step, bodies, n_steps, wish):
        """Steps done, at most n_steps; whether the list is stale; the wish, if any, at which it stopped before.

        step(n) -> (steps done, stale). wish() -> a whole number, 0 for none; None where nobody wishes.
        """
        if wish is None:
            return *step(n_steps), 0
        started = time.monotonic()
        done, stale = step(min(n_steps, self.at_once))
        elapsed = time.monotonic() - started
        if elapsed > HEARS:
            self.at_once = max(done // 2, 1)
        elif elapsed < 0.4 * HEARS and done == self.at_once:
            self.at_once = 2 * done
        return done, stale, wish()

    def parts(self, bodies, candidates):
        """The parts (simcore.dem.state.parts) of all ranks, one after the other, on rank 0."""
        yield take_part(bodies, candidates, bodies.own)

    def restore(self, sections, box, features):
        """Bodies and CandidatePairs from the parts of all ranks that were; sections(): iterates over them."""
        parts = list(sections())
        return assemble(parts, np.concatenate([part["body.id"] for part in parts]))


def started_by_mpi(environment) -> bool:
    """Whether a launcher of MPI (mpiexec of MPICH or Open MPI, srun) started this process."""
    return any(name in environment for name in ("PMI_RANK", "PMIX_RANK", "OMPI_COMM_WORLD_RANK"))


ONE_RANK = OneRank()
