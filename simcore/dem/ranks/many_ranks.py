"""A packing on several MPI ranks: the domain is divided into horizontal blocks, and each rank moves the bodies of one.

Between two listings of candidate pairs a body stays on its rank. Every rank steps its own bodies beside ghosts: copies
of the bodies of other ranks that they may touch, updated after each step. A contact across a border is computed on both
sides, from the same numbers in the same order, so that no forces are sent. Both sides store the remembered contact, and
it moves with a body that changes its rank. At each listing a body moves to the rank of the block that contains it,
and the blocks are cut again if the load has become uneven. The neighbour search treats periodic images on any number of
ranks: each near image of a ghost, or of an own body, gives a pair.

The results are the same, to the bit, for any number of ranks; simcore.dem.ranks.one_rank contains the reductions.
"""

import time
import traceback
from contextlib import contextmanager

import numpy as np
from mpi4py import MPI

from simcore.dem.ranks.one_rank import OneRank
from simcore.dem.shapes.polyhedra import ELLIPSOID, MIXED, SPHERE
from simcore.dem.state.bodies import Bodies, join_bodies
from simcore.dem.state.contacts import CandidatePairs
from simcore.dem.state.features import Features
from simcore.dem.state.parts import assemble, take_part
from simcore.dem.step.candidate_pairs import list_contacts, list_pairs

BINS = 512  # of the histograms from which blocks are cut
UNEVEN = 1.02  # ratio of the largest load to the mean above which the blocks are cut again
MARGIN = 1e-9  # share of the reach; boxes are less than 1e6 grains wide, and rounding is 1e-16 of their width
# Loads of a body, a candidate pair and a contact: approximate measured shares of a step of polyhedra.
BODY, PAIR, CONTACT = 4, 1, 8


class ManyRanks(OneRank):
    """The ranks of a communicator; the results are those of OneRank, to the bit."""

    def __init__(self, comm=None, layout=None):
        """Divide the domain into blocks, one a rank.

        layout: (columns, rows) of blocks along x and y; by default as close to a square as their number allows.
        ValueError if the layout has not one block for each rank.
        """
        self.comm = MPI.COMM_WORLD if comm is None else comm
        self.rank, self.size = self.comm.Get_rank(), self.comm.Get_size()
        self.layout = _layout(self.size) if layout is None else tuple(layout)
        if self.layout[0] * self.layout[1] != self.size:
            raise ValueError(
                f"The layout {self.layout[0]} x {self.layout[1]} must have one block for each rank, but there are "
                f"{self.size} ranks. Choose a layout with columns × rows = {self.size}."
            )
        self.blocks = None
        self.halo = None
        self.bytes_sent = self.steps = 0  # their ratio is the number of bytes per step
        self.exchanging = 0.0  # [s], including the time spent waiting for other ranks

    @contextmanager
    def together(self):
        """End all ranks if one rank raises an exception; the others would otherwise wait for it forever."""
        try:
            yield
        except BaseException:
            traceback.print_exc()
            self.comm.Abort(1)

    # -- decisions ------------------------------------------------------------------------------------------

    def maximum(self, values):
        """Return the largest of each value (n,) over all ranks."""
        values = np.asarray(values, float)
        result = np.empty_like(values)
        self.comm.Allreduce(values, result, op=MPI.MAX)
        return result

    def add(self, counts):
        """Return the sum of each count (n,) over all ranks."""
        counts = np.asarray(counts, np.int64)
        result = np.empty_like(counts)
        self.comm.Allreduce(counts, result, op=MPI.SUM)
        return result

    def first(self, candidate, n_keys):
        """Return the candidate of all ranks whose first n_keys entries are largest."""
        return max(self.comm.allgather(candidate), key=lambda of_rank: of_rank[:n_keys])

    def all(self, values):
        """Return the values of all ranks in one list, in the order of the ranks."""
        return [value for of_rank in self.comm.allgather(values) for value in of_rank]

    # -- distribution of the bodies -------------------------------------------------------------------------

    def insert(self, bodies: Bodies | None, inserted: Bodies, box) -> Bodies:
        """Return `bodies` joined with those of the inserted bodies that this rank moves.

        inserted: all inserted bodies, the same on every rank.
        """
        if self.blocks is None:
            load = np.ones(len(inserted.mass))
            self.blocks = self._cut([_wrapped(inserted.position, box)], [load], box, together=False)
        mine = np.flatnonzero(self.blocks.rank_of(_wrapped(inserted.position, box)) == self.rank)
        new, _ = assemble([take_part(inserted, None, mine)], inserted.id[mine])
        if bodies is None:
            return new
        own = np.concatenate([bodies.own, len(bodies.mass) + np.arange(len(mine))])
        return join_bodies(bodies, new)._replace(own=own)

    def list_candidates(
        self, bodies, shapes, box, margin, features: Features, old: CandidatePairs | None
    ) -> tuple[Bodies, CandidatePairs]:
        """Return own bodies and ghosts with their candidate pairs: candidate_pairs.list_candidates over all ranks."""
        bodies.margin[:] = margin
        part = self._migrate(bodies, old, box)
        own = part["body.id"]
        ghosts = self._ghosts_from_others(part, box)
        bodies, old = assemble([part, *ghosts.values()], own)
        pairs = list_pairs(bodies, shapes, box, features, old)
        kept = bodies.moves_here
        kept[pairs[:, :2].ravel()] = True
        rows = np.flatnonzero(kept)
        if len(rows) < len(kept):
            bodies, old = assemble([take_part(bodies, old, rows, shared=True)], own)
            pairs[:, :2] = (np.cumsum(kept) - 1)[pairs[:, :2]]
        candidates = list_contacts(pairs, bodies, shapes, box, features, old)
        sources = {rank: ghost_part["body.id"] for rank, ghost_part in ghosts.items()}
        self.halo = _Halo(self.comm, bodies, features, sources)
        self.shared = int((~bodies.moves_here[pairs[:, :2]]).any(axis=1).sum())
        return bodies, candidates

    def _migrate(self, bodies, candidates, box):
        """Exchange bodies between ranks; return the part of the bodies that this rank moves from now on."""
        place = _wrapped(bodies.position[bodies.own], box)
        load = _loads(bodies, candidates)[bodies.own]
        loads = np.array(self.comm.allgather(load.sum()))
        if loads.max() > UNEVEN * loads.mean():
            self.blocks = self._cut([place], [load], box)
        target = self.blocks.rank_of(place)
        stays, goes = bodies.own[target == self.rank], np.unique(target[target != self.rank])
        part = take_part(bodies, candidates, stays, shared=True)
        if self.add([len(goes)])[0] == 0:
            return part
        leaving = [None] * self.size
        for rank in goes:
            leaving[rank] = take_part(bodies, candidates, bodies.own[target == rank], shared=True)
        parts = [part, *(arriving for arriving in self.comm.alltoall(leaving) if arriving is not None)]
        return {name: np.concatenate([piece[name] for piece in parts]) for name in part}

    def _ghosts_from_others(self, part, box):
        """Return the parts of the bodies of other ranks that may form candidate pairs with own bodies, by rank."""
        place = _wrapped(part["body.position"], box)
        # The reach is slightly enlarged because wrapped positions round differently from distances in the list.
        reach = (1.0 + MARGIN) * (part["body.radius"] + part["body.margin"])
        low, high = place - reach[:, None], place + reach[:, None]
        extent = np.array([low.min(axis=0, initial=np.inf), high.max(axis=0, initial=-np.inf)])
        extents = self.comm.allgather(extent)
        sent = [None] * self.size
        for rank, (floor, ceiling) in enumerate(extents):
            if rank == self.rank:
                continue
            near = np.ones(len(place), np.bool_)
            for axis in range(2):
                shifts = (-box.width, 0.0, box.width) if box.width > 0.0 else (0.0,)
                near &= np.any(
                    [
                        (low[:, axis] + shift <= ceiling[axis]) & (high[:, axis] + shift >= floor[axis])
                        for shift in shifts
                    ],
                    axis=0,
                )
            rows = np.flatnonzero(near)
            sent[rank] = {name: _if_rows(part, name, rows) for name in part if name.startswith("body.")}
        return {rank: received for rank, received in enumerate(self.comm.alltoall(sent)) if received is not None}

    # -- steps ----------------------------------------------------------------------------------------------

    def advance(self, step, bodies, n_steps, stop_request):
        """Advance; return (steps done, whether the list is stale, largest stop request of all ranks); see OneRank."""
        flags, largest_flags = np.zeros(2, np.int64), np.zeros(2, np.int64)
        for done in range(1, n_steps + 1):
            _, flags[0] = step(1)
            flags[1] = 0 if stop_request is None else stop_request()
            began = time.perf_counter()
            self.halo.send(bodies)
            self.comm.Allreduce(flags, largest_flags, op=MPI.MAX)
            self.halo.receive(bodies)
            self.exchanging += time.perf_counter() - began
            self.steps += 1
            self.bytes_sent += self.halo.bytes_sent
            if largest_flags.any():
                return done, bool(largest_flags[0]), int(largest_flags[1])
        return n_steps, False, 0

    # -- whole packings -------------------------------------------------------------------------------------

    def parts(self, bodies, candidates):
        """Yield the parts of all ranks one after the other on rank 0; other ranks send theirs and yield nothing."""
        part = take_part(bodies, candidates, bodies.own)
        if self.rank > 0:
            self.comm.recv(source=0, tag=1)  # waits for its turn, so that only one part is in transit at a time
            self.comm.send(part, dest=0, tag=2)
            return
        yield part
        for rank in range(1, self.size):
            self.comm.send(None, dest=rank, tag=1)
            yield self.comm.recv(source=rank, tag=2)

    def restore(self, sections, box, features: Features) -> tuple[Bodies, CandidatePairs]:
        """Return own bodies with ghosts, and candidate pairs, from the parts of all former ranks.

        sections() iterates over the parts.
        """
        places = [_wrapped(part["body.position"], box) for part in sections()]
        self.blocks = self._cut(places, [np.ones(len(place)) for place in places], box, together=False)
        ranks = [self.blocks.rank_of(place) for place in places]
        own = np.concatenate([part["body.id"][rank == self.rank] for part, rank in zip(sections(), ranks, strict=True)])
        # Contacts and walls of own bodies come first; they determine which bodies are needed as partners.
        kept = [_rows_about(part, own) for part in sections()]
        wanted = np.concatenate([own, *(part[f"contact.body_{side}"] for part in kept for side in "ab")])
        sources = {rank: [] for rank in range(self.size)}
        for part, rank in zip(sections(), ranks, strict=True):
            rows = np.flatnonzero(np.isin(part["body.id"], wanted))
            kept.append({name: _if_rows(part, name, rows) for name in part if name.startswith("body.")})
            for source, ids in sources.items():
                ids.append(part["body.id"][rows][rank[rows] == source])
        bodies, candidates = assemble(kept, own)
        self.halo = _Halo(self.comm, bodies, features, {rank: np.concatenate(ids) for rank, ids in sources.items()})
        return bodies, candidates

    def _cut(self, places, loads, box, together=True):
        """Return blocks of equal load. together: True: `places` are of this rank's bodies; False: of all bodies."""
        columns, rows = self.layout
        span = (0.0, box.width) if box.width > 0.0 else (-box.wall_radius, box.wall_radius)

        def counted(bins, size):
            total = sum(np.bincount(index, load, minlength=size) for index, load in zip(bins, loads, strict=True))
            total = total.astype(np.int64)
            return self.add(total) if together else total

        along_x, along_y = ([_bin(place[:, axis], span) for place in places] for axis in range(2))
        cuts_x = _quantiles(counted(along_x, BINS), columns)
        column = [np.searchsorted(cuts_x, bins, side="right") for bins in along_x]
        flat = counted([c * BINS + y for c, y in zip(column, along_y, strict=True)], columns * BINS)
        cuts_y = [_quantiles(counts, rows) for counts in flat.reshape(columns, BINS)]
        return _Blocks(span, cuts_x, cuts_y, rows)


class _Blocks:
    """The blocks of the ranks: columns along x, each cut into rows along y."""

    def __init__(self, span, cuts_x, cuts_y, rows):
        self.span, self.cuts_x, self.cuts_y, self.rows = span, cuts_x, cuts_y, rows

    def rank_of(self, place):
        """Return the ranks (n,) whose blocks contain wrapped positions (n, 2) [m]."""
        column = np.searchsorted(self.cuts_x, _bin(place[:, 0], self.span), side="right")
        y = _bin(place[:, 1], self.span)
        rank = np.zeros(len(place), np.int64)
        for k, cuts in enumerate(self.cuts_y):
            here = column == k
            rank[here] = k * self.rows + np.searchsorted(cuts, y[here], side="right")
        return rank


class _Halo:
    """The exchange of ghosts: after a step it sends the state of own bodies and receives that of the ghosts here."""

    def __init__(self, comm, bodies, features, sources):
        """Request from the other ranks the bodies that are ghosts here. sources: ids of their bodies, by rank."""
        self.comm = comm
        ghosts = bodies.id[bodies.ghosts]
        none = np.zeros(0, np.int64)
        requested_here = [np.intersect1d(sources.get(rank, none), ghosts) for rank in range(comm.Get_size())]
        requested_there = comm.alltoall(requested_here)
        sent, received = (
            [np.searchsorted(bodies.id, ids) for ids in by_rank] for by_rank in (requested_there, requested_here)
        )
        self.fields = ["position", "velocity", "angular_velocity"]
        self.fields += ["rotation", "turned"] if features.kind != SPHERE else []
        self.fields += ["form_matrix"] if features.kind in (ELLIPSOID, MIXED) else []
        self.fields += ["effective_contacts"] if features.implicit else []
        width = sum(int(np.prod(getattr(bodies, name).shape[1:])) for name in self.fields)
        self.sent_rows, self.sent_slices = np.concatenate(sent), _slices(sent)
        self.ghost_rows, self.ghost_slices = np.concatenate(received), _slices(received)
        self.sending = np.empty((len(self.sent_rows), width))
        self.receiving = np.empty((len(self.ghost_rows), width))
        self.bytes_sent = self.sending.nbytes
        self.requests = []

    def send(self, bodies):
        """Start to send the own bodies that are ghosts on other ranks, and to receive the ghosts."""
        column = 0
        for name in self.fields:
            sent = getattr(bodies, name)[self.sent_rows]
            width = int(np.prod(sent.shape[1:]))
            self.sending[:, column : column + width] = sent.reshape(len(sent), width)
            column += width
        self.requests = [
            self.comm.Irecv(self.receiving[rows], source=rank, tag=0) for rank, rows in self.ghost_slices.items()
        ]
        self.requests += [
            self.comm.Isend(self.sending[rows], dest=rank, tag=0) for rank, rows in self.sent_slices.items()
        ]

    def receive(self, bodies):
        """Wait for the exchange to end and update the ghosts."""
        MPI.Request.Waitall(self.requests)
        column = 0
        for name in self.fields:
            field = getattr(bodies, name)
            width = int(np.prod(field.shape[1:]))
            received = self.receiving[:, column : column + width]
            field[self.ghost_rows] = received.reshape(len(received), *field.shape[1:])
            column += width


def _layout(size):
    """Return (columns, rows) of `size` blocks, as close to a square as possible."""
    rows = max(k for k in range(1, int(np.sqrt(size)) + 1) if size % k == 0)
    return size // rows, rows


def _wrapped(position, box):
    """Return the horizontal positions (n, 2), wrapped into a periodic box."""
    place = position[:, :2].copy()
    if box.width > 0.0:
        place -= np.floor(place / box.width) * box.width
    return place


def _bin(places, span):
    """Return the bins of coordinates, of BINS equal bins over the span."""
    low, high = span
    return np.clip((places - low) / (high - low) * BINS, 0, BINS - 1).astype(np.int64)


def _quantiles(counts, number):
    """Return the bins (number - 1,) at which a histogram is cut into equal parts."""
    total = np.cumsum(counts)
    return np.searchsorted(total, total[-1] * np.arange(1, number) / number) + 1


def _slices(rows):
    """Return by rank the slice of its rows in the concatenation of `rows`; ranks without rows are left out."""
    ends = np.cumsum([len(of_rank) for of_rank in rows])
    return {
        rank: slice(end - len(of_rank), end)
        for rank, (of_rank, end) in enumerate(zip(rows, ends, strict=True))
        if len(of_rank)
    }


def _loads(bodies, candidates):
    """Return the cost of a step of each body, (n,), in the unit of BODY, PAIR and CONTACT."""
    load = np.full(len(bodies.mass), float(BODY))
    if candidates is not None:
        contacts = candidates.contacts
        for side in (contacts.body_a, contacts.body_b):
            load += np.bincount(side, PAIR + CONTACT * contacts.touching, minlength=len(load))
    return load


def _rows_about(part, ids):
    """Return the contacts and walls of a part in which any of the bodies takes part."""
    contacts = np.flatnonzero(np.isin(part["contact.body_a"], ids) | np.isin(part["contact.body_b"], ids))
    walls = np.flatnonzero(np.isin(part["wall.body"], ids))
    return {name: _if_rows(part, name, contacts) for name in part if name.startswith("contact.")} | {
        name: _if_rows(part, name, walls) for name in part if name.startswith("wall.")
    }


def _if_rows(part, name, rows):
    """Return these rows of a field; a field that the scene does not need has no rows and is returned unchanged."""
    group = name.partition(".")[0]
    count = len(part[{"body": "body.id", "contact": "contact.body_a", "wall": "wall.body"}[group]])
    return part[name][rows] if len(part[name]) == count else part[name]
