"""Bodies shared out to the ranks of MPI, each to the rank of the horizontal block it is in.

Between two lists of neighbours a body stays where it is, and every rank steps its own bodies beside ghosts: copies of
those of other ranks that they may touch, sent after each step. A contact across a border is computed on both sides,
from the same numbers in the same order, so that forces need not travel; its memory is on both sides too, and goes with
a body that changes its rank. When neighbours are listed, bodies go to the rank whose block they are in, and blocks
follow the grains where the load has become uneven. Periodic images are found by the neighbour list, on any number of
ranks: a ghost, or an own body, is met through each image that is near.

What a rank does, or which rank does it, decides no bit: see simcore.dem.ranks.one_rank for what is decided together.
"""

import time
import traceback
from contextlib import contextmanager

import numpy as np
from mpi4py import MPI

from simcore.dem.ranks.one_rank import OneRank
from simcore.dem.shapes.hulls import ELLIPSOID, MIXED, SPHERE
from simcore.dem.state.bodies import Bodies, join_bodies
from simcore.dem.state.contacts import CandidatePairs
from simcore.dem.state.features import Features
from simcore.dem.state.parts import assemble, take_part
from simcore.dem.step.candidate_pairs import list_contacts, list_pairs

BINS = 512  # of the histograms from which blocks are cut
UNEVEN = 1.02  # largest load over the mean from which blocks are cut anew
MARGIN = 1e-9  # of the reach; boxes are less than 1e6 grains wide, and rounding 1e-16 of their width
# What a body's candidate pairs and contacts cost, as loads; measured shares of a step of polyhedra, roughly.
BODY, PAIR, CONTACT = 4, 1, 8


class ManyRanks(OneRank):
    """The ranks of a communicator; with one rank the result is that of OneRank, to the bit."""

    def __init__(self, comm=None, layout=None):
        """layout: (columns, rows) of blocks along x and y, by default as square as their number allows."""
        self.comm = MPI.COMM_WORLD if comm is None else comm
        self.rank, self.size = self.comm.Get_rank(), self.comm.Get_size()
        self.layout = _layout(self.size) if layout is None else tuple(layout)
        if self.layout[0] * self.layout[1] != self.size:
            raise ValueError(f"layout {self.layout[0]} x {self.layout[1]} has not as many blocks as ranks, {self.size}")
        self.blocks = None
        self.halo = None
        self.bytes_sent = self.steps = 0  # to tell what a step sends
        self.exchanging = 0.0  # [s], waiting for others included

    @contextmanager
    def together(self):
        """An exception that one rank alone would meet ends all, who would else wait for it."""
        try:
            yield
        except BaseException:
            traceback.print_exc()
            self.comm.Abort(1)

    # -- decisions ------------------------------------------------------------------------------------------

    def maximum(self, values):
        values = np.asarray(values, float)
        found = np.empty_like(values)
        self.comm.Allreduce(values, found, op=MPI.MAX)
        return found

    def add(self, counts):
        counts = np.asarray(counts, np.int64)
        found = np.empty_like(counts)
        self.comm.Allreduce(counts, found, op=MPI.SUM)
        return found

    def first(self, found, n_keys):
        return max(self.comm.allgather(found), key=lambda each: each[:n_keys])

    def all(self, found):
        return [each for some in self.comm.allgather(found) for each in some]

    # -- who has what ---------------------------------------------------------------------------------------

    def welcome(self, bodies: Bodies | None, born: Bodies, box) -> Bodies:
        """`bodies` and those of the newborn that this rank moves; born: all of them, the same on every rank."""
        if self.blocks is None:
            self.blocks = self._cut([_wrapped(born.position, box)], [np.ones(len(born.mass))], box, together=False)
        mine = np.flatnonzero(self.blocks.rank_of(_wrapped(born.position, box)) == self.rank)
        new, _ = assemble([take_part(born, None, mine)], born.id[mine])
        if bodies is None:
            return new
        own = np.concatenate([bodies.own, len(bodies.mass) + np.arange(len(mine))])
        return join_bodies(bodies, new)._replace(own=own)

    def list_candidates(
        self, bodies, shapes, box, margin, features: Features, old: CandidatePairs | None
    ) -> tuple[Bodies, CandidatePairs]:
        """Own bodies and ghosts with their candidate pairs: as candidate_pairs.list_candidates, over all ranks."""
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
        sources = {rank: each["body.id"] for rank, each in ghosts.items()}
        self.halo = _Halo(self.comm, bodies, features, sources)
        self.shared = int((~bodies.moves_here[pairs[:, :2]]).any(axis=1).sum())
        return bodies, candidates

    def _migrate(self, bodies, candidates, box):
        """All that is known of the bodies that this rank moves from now on, as a part."""
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
        parts = [part, *(each for each in self.comm.alltoall(leaving) if each is not None)]
        return {name: np.concatenate([each[name] for each in parts]) for name in part}

    def _ghosts_from_others(self, part, box):
        """Parts of other ranks' bodies that may come candidates, by rank."""
        place = _wrapped(part["body.position"], box)
        # Somewhat too far, since places are rounded otherwise than distances in the list.
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
        return {rank: each for rank, each in enumerate(self.comm.alltoall(sent)) if each is not None}

    # -- steps ----------------------------------------------------------------------------------------------

    def advance(self, step, bodies, n_steps, wish):
        """Steps done, whether the list is stale, and the greatest wish of any rank; see OneRank.advance."""
        flags, found = np.zeros(2, np.int64), np.zeros(2, np.int64)
        for done in range(1, n_steps + 1):
            _, flags[0] = step(1)
            flags[1] = 0 if wish is None else wish()
            began = time.perf_counter()
            self.halo.send(bodies)
            self.comm.Allreduce(flags, found, op=MPI.MAX)
            self.halo.receive(bodies)
            self.exchanging += time.perf_counter() - began
            self.steps += 1
            self.bytes_sent += self.halo.bytes_sent
            if found.any():
                return done, bool(found[0]), int(found[1])
        return n_steps, False, 0

    # -- all together ---------------------------------------------------------------------------------------

    def parts(self, bodies, candidates):
        """The parts of all ranks one after the other, on rank 0; nothing on the others, which send theirs."""
        part = take_part(bodies, candidates, bodies.own)
        if self.rank > 0:
            self.comm.recv(source=0, tag=1)  # so that only one is under way
            self.comm.send(part, dest=0, tag=2)
            return
        yield part
        for rank in range(1, self.size):
            self.comm.send(None, dest=rank, tag=1)
            yield self.comm.recv(source=rank, tag=2)

    def restore(self, sections, box, features: Features) -> tuple[Bodies, CandidatePairs]:
        """Own bodies, ghosts and candidate pairs from the parts of all former ranks; sections() iterates over them."""
        places = [_wrapped(part["body.position"], box) for part in sections()]
        self.blocks = self._cut(places, [np.ones(len(place)) for place in places], box, together=False)
        ranks = [self.blocks.rank_of(place) for place in places]
        own = np.concatenate([part["body.id"][rank == self.rank] for part, rank in zip(sections(), ranks, strict=True)])
        # Contacts and walls of own bodies; then, now that it is known which they are, these bodies and their partners.
        kept = [_rows_about(part, own) for part in sections()]
        wanted = np.concatenate([own, *(part[f"contact.body_{side}"] for part in kept for side in "ab")])
        sources = {rank: [] for rank in range(self.size)}
        for part, rank in zip(sections(), ranks, strict=True):
            rows = np.flatnonzero(np.isin(part["body.id"], wanted))
            kept.append({name: _if_rows(part, name, rows) for name in part if name.startswith("body.")})
            for each, ids in sources.items():
                ids.append(part["body.id"][rows][rank[rows] == each])
        bodies, candidates = assemble(kept, own)
        self.halo = _Halo(self.comm, bodies, features, {rank: np.concatenate(ids) for rank, ids in sources.items()})
        return bodies, candidates

    def _cut(self, places, loads, box, together=True):
        """Blocks with the same load each; together: places are this rank's own, else those of all."""
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
        cuts_y = [_quantiles(each, rows) for each in flat.reshape(columns, BINS)]
        return _Blocks(span, cuts_x, cuts_y, rows)


class _Blocks:
    """Columns along x, each cut into rows along y."""

    def __init__(self, span, cuts_x, cuts_y, rows):
        self.span, self.cuts_x, self.cuts_y, self.rows = span, cuts_x, cuts_y, rows

    def rank_of(self, place):
        """Ranks (n,) of wrapped places (n, 2) [m]."""
        column = np.searchsorted(self.cuts_x, _bin(place[:, 0], self.span), side="right")
        y = _bin(place[:, 1], self.span)
        rank = np.zeros(len(place), np.int64)
        for k, cuts in enumerate(self.cuts_y):
            here = column == k
            rank[here] = k * self.rows + np.searchsorted(cuts, y[here], side="right")
        return rank


class _Halo:
    """Sends what a step changes of own bodies that are ghosts elsewhere, and receives the same of the ghosts here."""

    def __init__(self, comm, bodies, features, sources):
        """sources: ids of bodies of other ranks, by rank; those that are ghosts here are asked for."""
        self.comm = comm
        ghosts = bodies.id[bodies.ghosts]
        none = np.zeros(0, np.int64)
        asked = [np.intersect1d(sources.get(rank, none), ghosts) for rank in range(comm.Get_size())]
        wanted = comm.alltoall(asked)
        sent, received = ([np.searchsorted(bodies.id, ids) for ids in each] for each in (wanted, asked))
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
        column = 0
        for name in self.fields:
            sent = getattr(bodies, name)[self.sent_rows]
            width = int(np.prod(sent.shape[1:]))
            self.sending[:, column : column + width] = sent.reshape(len(sent), width)
            column += width
        self.requests = [
            self.comm.Irecv(self.receiving[some], source=rank, tag=0) for rank, some in self.ghost_slices.items()
        ]
        self.requests += [
            self.comm.Isend(self.sending[some], dest=rank, tag=0) for rank, some in self.sent_slices.items()
        ]

    def receive(self, bodies):
        MPI.Request.Waitall(self.requests)
        column = 0
        for name in self.fields:
            field = getattr(bodies, name)
            width = int(np.prod(field.shape[1:]))
            received = self.receiving[:, column : column + width]
            field[self.ghost_rows] = received.reshape(len(received), *field.shape[1:])
            column += width


def _layout(size):
    rows = max(k for k in range(1, int(np.sqrt(size)) + 1) if size % k == 0)
    return size // rows, rows


def _wrapped(position, box):
    place = position[:, :2].copy()
    if box.width > 0.0:
        place -= np.floor(place / box.width) * box.width
    return place


def _bin(places, span):
    low, high = span
    return np.clip((places - low) / (high - low) * BINS, 0, BINS - 1).astype(np.int64)


def _quantiles(counts, number):
    """Bins (number - 1,) at which a histogram is cut into equal parts."""
    total = np.cumsum(counts)
    return np.searchsorted(total, total[-1] * np.arange(1, number) / number) + 1


def _slices(rows):
    ends = np.cumsum([len(each) for each in rows])
    return {
        rank: slice(end - len(each), end) for rank, (each, end) in enumerate(zip(rows, ends, strict=True)) if len(each)
    }


def _loads(bodies, candidates):
    """What a step of each body costs, (n,) in some unit."""
    load = np.full(len(bodies.mass), float(BODY))
    if candidates is not None:
        contacts = candidates.contacts
        for side in (contacts.body_a, contacts.body_b):
            load += np.bincount(side, PAIR + CONTACT * contacts.touching, minlength=len(load))
    return load


def _rows_about(part, ids):
    """Contacts and walls of a part that any of the bodies has."""
    contacts = np.flatnonzero(np.isin(part["contact.body_a"], ids) | np.isin(part["contact.body_b"], ids))
    walls = np.flatnonzero(np.isin(part["wall.body"], ids))
    return {name: _if_rows(part, name, contacts) for name in part if name.startswith("contact.")} | {
        name: _if_rows(part, name, walls) for name in part if name.startswith("wall.")
    }


def _if_rows(part, name, rows):
    """Those rows of a field; a field that the scene does not need has none."""
    group = name.partition(".")[0]
    count = len(part[{"body": "body.id", "contact": "contact.body_a", "wall": "wall.body"}[group]])
    return part[name][rows] if len(part[name]) == count else part[name]
