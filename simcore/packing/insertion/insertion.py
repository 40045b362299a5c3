"""Decides when a batch of grains is inserted, and inserts batches until the amount of the packing is reached."""

import numpy as np

from simcore.dem.state.bodies import FLOOR, make_bodies
from simcore.dem.step.candidate_pairs import list_candidates
from simcore.packing.insertion.batches import Pouring
from simcore.packing.insertion.initial_states import initial_states
from simcore.packing.insertion.random_placement import fall_time
from simcore.packing.insertion.waiting import steps_of_wait
from simcore.packing.messages import no_space
from simcore.packing.packed import GENERATING, PackingError

LONG_FLIGHT = 50.0  # longest wait for a grain in flight, in times to fall through the domain


class Insertion:
    """Inserts the batches of a scene. Every rank draws the whole batch and takes its own grains."""

    def __init__(self, scene, bases, draw, stepper, ranks):
        self.scene, self.bases, self.stepper, self.ranks = scene, bases, stepper, ranks
        self.dt = scene.numerics.time_step
        self.pouring = Pouring(scene, bases, draw)

    def is_due(self, state, bodies, candidates) -> bool:
        """Return whether a batch is inserted now; PackingError if there will never be space for one."""
        if bodies is None:
            return True
        if state.in_stretch or state.step < state.next_insertion:
            return False
        top = self._top(bodies)
        if self._has_space(state, bodies, top):
            return True
        if state.step < state.space_deadline:
            return False
        # A heavy grain can throw a light one above the insertion height. Insertion waits for it, but not for ever.
        may_wait = (state.step - state.space_deadline) * self.dt < LONG_FLIGHT * self.fall_time()
        bed = _touches(bodies, candidates)
        bed_top = self._top(bodies, bed)
        if may_wait and self._has_space(state, bodies, bed_top, among=bed):
            return False
        # The bed itself has reached the height where batches begin: the next fills the rest of the domain.
        if self._has_space(state, bodies, top, last=True):
            return True
        if may_wait and self._has_space(state, bodies, bed_top, last=True, among=bed):
            return False
        _, radius = self._highest(bodies)
        largest = 2.0 * float(radius)
        needed = self.pouring.needed_height(state.inserted, largest)
        bed_top = bed_top if np.isfinite(bed_top) else top
        raise PackingError(no_space(self.scene, state.inserted, top, bed_top, needed, largest))

    def batch(self, state, bodies):
        """Return the next batch: (new bodies, their mean sieve size [m]); store in `state` when another may follow."""
        scene, inserted = self.scene, state.inserted
        drawn, places, interval = self.pouring.batch(inserted, self._top(bodies), self._touching)
        state.next_insertion = state.step + steps_of_wait(interval, self.scene.convergence.interval, self.dt)
        count = len(places)
        if scene.amount_grains is not None:
            state.complete = inserted + count >= scene.amount_grains
        else:
            inserted_mass = 0.0 if bodies is None else self.ranks.totals(bodies.mass[bodies.own])[0]
            mass = inserted_mass + np.cumsum(scene.material.density * self.pouring.volumes(drawn)[:count])
            state.complete = bool(mass[-1] >= scene.amount_mass)
            if state.complete and scene.generation.fill == "bed":
                # ASSUME: the grain that reaches the mass is the last. Rettinger et al. (2022) end with a whole batch
                # and exceed the mass, but here a batch just above the bed can be larger than the packing.
                count = int(np.searchsorted(mass, scene.amount_mass)) + 1
        fallen = state.step + round(interval / self.dt)
        state.space_deadline = max(state.step, fallen) + round(2.0 * self.fall_time() / self.dt)
        new = self._new_bodies(drawn, places, count)
        new.id[:] += inserted
        return new, float(np.mean(drawn.sieve_size[:count]))

    def fall_time(self) -> float:
        """Return the time [s] to fall through the domain from its top with the insertion velocity."""
        scene = self.scene
        return fall_time(scene.domain.height, -scene.generation.velocity_z, scene.material.effective_gravity)

    def _new_bodies(self, drawn, places, count):
        """Return bodies of the first `count` drawn grains at these places, with ids from 0 on."""
        scene = self.scene
        states = initial_states(scene.generation, places[:count], drawn.sieve_size[:count], drawn.uniforms[:count])
        return make_bodies(
            self.bases,
            drawn.shape[:count],
            drawn.scale[:count],
            *states,
            scene.material.density,
            features=self.stepper.features,
        )

    def _touching(self, drawn, places):
        """Return the pairs (m, 2) of drawn grains that touch each other at these places."""
        bodies = self._new_bodies(drawn, places, len(places))
        candidates = list_candidates(bodies, self.stepper.shapes, self.stepper.box, 0.0, self.stepper.features)
        return self.stepper.touching_pairs(bodies, candidates, self.stepper.drive(GENERATING, 0.0))

    def _has_space(self, state, bodies, top, last=False, among=None):
        return self.pouring.has_space(state.inserted, top, lambda: self._highest(bodies, among), last)

    def _top(self, bodies, among=None):
        """Return the height [m] below which all grains are, or all bodies of the mask `among` (n,)."""
        if bodies is None:
            return 0.0
        counted = _counted(bodies, among)
        tops = bodies.position[counted, 2] + bodies.radius[counted]
        return float(self.ranks.maximum([tops.max(initial=-np.inf)])[0])

    def _highest(self, bodies, among=None):
        """Return the height of the highest centre and the largest bounding radius [m]; among: as in _top."""
        counted = _counted(bodies, among)
        return self.ranks.maximum(
            [bodies.position[counted, 2].max(initial=-np.inf), bodies.radius[bodies.own].max(initial=0.0)]
        )


def _counted(bodies, among):
    """Return a mask (n,) of the bodies that this rank moves, or of those among them that the mask `among` marks."""
    return bodies.moves_here if among is None else bodies.moves_here & among


def _touches(bodies, candidates):
    """Return a mask (n,) of the bodies of this rank that touched something in the last step."""
    contacts, walls = candidates
    touching = np.zeros(len(bodies.id), bool)
    for rows, touch in (
        (contacts.body_a, contacts.touching),
        (contacts.body_b, contacts.touching),
        (walls.body, walls.touching & (walls.wall == FLOOR)),  # a grain in flight may touch the cylinder
    ):
        touching[rows[touch != 0]] = True
    return touching
