"""The packing process: generate, shake, damp, until the grains rest.

Grains are born in batches until the amount is reached; shaking acts from the first step until its duration after
the last birth; then all velocities are damped until the packing has converged. Phase, batch and stop are decided
from the whole packing at fixed steps, never from wall-clock time.
"""

import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numba import get_num_threads

from simcore.dem.contact.patch.patch import make_room
from simcore.dem.from_scene import compose
from simcore.dem.ranks.one_rank import ONE_RANK
from simcore.dem.shapes.hulls import collect_shapes
from simcore.dem.state.bodies import Bodies, make_bodies
from simcore.dem.state.parts import assemble
from simcore.dem.step.near_pairs import Box, Near, list_near
from simcore.dem.step.step import STAGES, Drive, make_advance
from simcore.packing.expectation import expect, warnings
from simcore.packing.insertion.batches import Pouring
from simcore.packing.insertion.initial_states import give_birth
from simcore.packing.insertion.random_placement import fall_time
from simcore.packing.observation import Observation, observe
from simcore.packing.rest import judge_settled, judge_still
from simcore.packing.watch import PackingError, Stability, Watch
from simcore.scene.scene import Scene
from simcore.scene.shapes import Base

GENERATING, SHAKING, DAMPING = "generating", "shaking", "damping"
# Of the mean sieve size: the skin, twice the margin of a body at rest (from 0.2 to 0.4 a shaken bed costs the same
# within 10 %), and what the way that a body goes in the time of a list adds to its margin at most.
SKIN, WIDEST_MARGIN = 0.3, 1.0
LIST_HOLDS = (100, 1000)  # steps: lists that hold for fewer look farther ahead, for more less far
AHEAD_STEP = 1.5
LONG_FLIGHT = 50.0  # times to fall through the domain


class Packed(NamedTuple):
    """A converged packing."""

    bodies: Bodies
    near: Near
    observation: Observation
    steps: int
    time: float  # [s], simulated
    last_birth: float  # [s], simulated
    checks: list  # (time [s], phase, Observation) at every convergence interval
    stability: Stability | None = None
    warnings: tuple = ()  # sentences on what may be wrong with it

    @property
    def contacts(self):
        return self.near.contacts

    @property
    def walls(self):
        return self.near.walls


class Interrupted(Exception):
    """A packing that stopped because it was wished to; its checkpoint is written."""


class Keeper:
    """Keeps nothing, and never wishes to stop; what `pack` asks of one that does (checkpoints/keeper.py)."""

    # wish(step) -> 0 to go on, KEEP, or KEEP_AND_STOP; asked between steps, the greatest of all ranks counts.
    wish = None

    def latest(self):
        """(state, sections) to go on from, or None. sections(): iterates over the parts of all bodies."""
        return None

    def keep(self, state: dict, parts) -> None:
        """Keep the state, a dict that JSON can hold, and the parts, which come one after the other on rank 0."""


KEEP, KEEP_AND_STOP = 1, 2


def pack(
    scene: Scene,
    bases: list[Base],
    draw: Callable,
    report: Callable = lambda line: None,
    ranks=ONE_RANK,
    keeper: Keeper | None = None,
) -> Packed | None:
    """Run the packing of `scene`, or go on where the keeper's latest state was.

    bases: shapes of the grains. draw(ids (n,)) -> Draw, the same for an id whenever it is asked. report(text):
    called with a progress line every scene.numerics.progress_interval of wall-clock time and at each change of
    phase. ranks: that share the bodies; the whole packing is returned on rank 0, None on the others. Raises
    PackingError, and Interrupted where the keeper wishes.
    """
    return Process(scene, bases, draw, report, ranks=ranks, keeper=keeper).run()


class Process:
    """A packing under way; `pack` runs it through, benchmarks and tests step it themselves.

    It advances in stretches, at whose end it is looked at and decided what follows. All that later steps depend on is
    in the bodies, their Near and `state`, so that it can be kept after any step.
    """

    def __init__(self, scene, bases, draw, report, timed=False, ranks=ONE_RANK, keeper=None, **changes):
        """timed: count in `seconds` what each part of the steps takes. changes: of the features of the scene's step."""
        self.scene, self.bases, self.draw, self.ranks = scene, bases, draw, ranks
        self.keeper = Keeper() if keeper is None else keeper
        self.pouring = Pouring(scene, bases, draw)
        self.progress = _Progress(scene, report)
        self.shapes = collect_shapes(bases)
        domain = scene.domain
        self.box = Box(domain.width) if domain.periodic else Box(0.0, 0.5 * domain.width)
        composition = compose(scene)
        self.law = composition.law
        self.features = composition.features._replace(timed=timed, **changes)
        self.advance_steps = make_advance(self.features)
        self.room = make_room(self.shapes, get_num_threads())
        self.clock = np.zeros(len(STAGES), np.int64)
        self.seconds = dict.fromkeys(("neighbour search", *STAGES), 0.0)
        self.dt = scene.numerics.time_step
        self.interval_steps = max(round(scene.convergence.interval / self.dt), 1)
        self.shaking_steps = round(scene.shaking.duration / self.dt)
        self.phase = GENERATING
        self.step = self.listed_step = 0
        self.looked_at = self.look_at = 0  # steps at which the last stretch began, and ends
        self.under_way = False  # a stretch, which ends with its look
        self.born, self.full = 0, False
        self.patience = 0  # step until which there must be room for a batch
        self.next_birth = 0  # step before which no batch is born
        self.last_birth = self.end = 0  # steps; of the phase
        self.mean_size = self.skin = self.height = 0.0  # [m]; height: mean, at the last look while damping
        self.ahead = 0.0  # [s], time for whose way, at its speed, a body gets a margin
        self.watch = Watch(scene, self.box.width, report, ranks)
        self.bodies = None
        self.near = None
        self.checks = []

    @property
    def contacts(self):
        return self.near.contacts

    @property
    def walls(self):
        return self.near.walls

    def run(self):
        expected = self.expect()
        self.resume()
        if self.phase == GENERATING:
            self.generate()
            self.phase, self.last_birth, self.end = SHAKING, self.step, self.step + self.shaking_steps
        if self.phase == SHAKING:
            self.shake(self.end)
        observation = self.settle()
        self.evaluate()
        stability = self.watch.stability(expected.stability)
        parts = list(self.ranks.parts(self.bodies, self.near))
        if self.ranks.rank > 0:
            return None
        bodies, near = assemble(parts, np.arange(self.born))
        return Packed(
            bodies,
            near,
            observation,
            self.step,
            self.step * self.dt,
            self.last_birth * self.dt,
            self.checks,
            stability,
            (*warnings(self.scene, expected), *self.watch.warnings()),
        )

    def expect(self):
        """What can be said of the scene before it runs, with its warnings."""
        expected = expect(self.scene, self.bases, self.draw)
        for text in warnings(self.scene, expected):
            self.progress.phase(f"warning: {text}")
        return expected

    def place(self, bodies, mean_size):
        """These are the bodies now; mean_size [m]: of their sieve sizes, the measure of the skin."""
        self.bodies, self.mean_size = bodies, mean_size
        self.born = int(self.ranks.add([len(bodies.own)])[0])
        self.watch.look_again(bodies, self.step)
        self.skin = (SKIN if self.scene.numerics.skin is None else self.scene.numerics.skin) * mean_size
        self.list_near()

    # -- phases ---------------------------------------------------------------------------------------------

    def generate(self):
        """Batches until the amount is reached; returns the step of the last birth."""
        while not self.full:
            if self._is_time_for_batch():
                self._add_batch()
                self.patience = max(self.step, self.next_birth) + round(2.0 * self._fall_time() / self.dt)
                continue
            self.advance(self.interval_steps, GENERATING)
        (mass,) = self.ranks.totals(self.bodies.mass[self.bodies.own])
        self.progress.phase(f"{self.born} grains born, {mass:.4g} kg")
        return self.step

    def shake(self, end):
        while self.under_way or self.step < end:
            self.advance(min(self.interval_steps, end - self.step), SHAKING, end)

    def settle(self):
        """Damping until converged; PackingError after damping.max_time."""
        scene = self.scene
        if self.phase != DAMPING:
            self.phase, self.end = DAMPING, self.step + round(scene.damping.max_time / self.dt)
            self.height = observe(self.bodies, self.near, self.ranks).mean_height
        while self.under_way or self.step < self.end:
            seen = self.advance(self.interval_steps, DAMPING, self.end)
            verdict = self._judge(seen)
            self.height = seen.mean_height
            if verdict.at_rest:
                self.progress.phase(
                    f"converged after {self.step} steps: largest speed {seen.max_speed:.2g} m/s, unbalanced force "
                    f"{seen.unbalanced_force:.2g}"
                )
                return seen
        own = self.bodies.own
        _, fastest = self.ranks.largest((self.bodies.velocity[own] ** 2).sum(axis=1), self.bodies.id[own])
        raise PackingError(
            f"{scene.name}: not at rest after {scene.damping.max_time:g} s of damping, step {self.step}: "
            f"{verdict.told}, grain {fastest} moves at {seen.max_speed:.2g} m/s{self._allowed_speed()}"
            f"{self.watch.hint()}. {self.watch.advice_on_rest()}"
        )

    def _judge(self, seen):
        """Verdict on the state just seen, by the scene's rule."""
        goal = self.scene.convergence
        if goal.rule == "still":
            return judge_still(goal, seen, self.height)
        (mass,) = self.ranks.totals(self.bodies.mass[self.bodies.own])
        since = self.end * self.dt - self.scene.damping.max_time
        return judge_settled(goal, self.scene.material, seen, self.checks, since, mass, self.born)

    def _allowed_speed(self):
        goal = self.scene.convergence
        return f" (allowed {goal.max_speed:g})" if goal.rule == "still" else ""

    # -- kept and resumed -----------------------------------------------------------------------------------

    def keep(self):
        """What the packing is, for the keeper; it changes nothing."""
        state = {name: getattr(self, name) for name in _STATE}
        state["watch"] = self.watch.state()
        state["checks"] = [(time_, phase, *seen) for time_, phase, seen in self.checks]
        self.keeper.keep(state, self.ranks.parts(self.bodies, self.near))

    def resume(self):
        """Be where the keeper's latest packing was, if there is one."""
        latest = self.keeper.latest()
        if latest is None:
            return
        state, sections = latest
        for name in _STATE:
            setattr(self, name, state[name])
        self.watch.resume(state["watch"])
        self.checks = [(time_, phase, Observation(*seen)) for time_, phase, *seen in state["checks"]]
        self.bodies, self.near = self.ranks.restore(sections, self.box, self.features)
        self.progress.phase(f"goes on from step {self.step}, t = {self.step * self.dt:.3f} s, {self.phase}")

    # -- births ---------------------------------------------------------------------------------------------

    def _top(self, lying=False):
        """Height below which all grains are, or all that touch something [m]."""
        if self.bodies is None:
            return 0.0
        counted = np.zeros(len(self.bodies.id), bool)
        counted[self.bodies.own] = True
        if lying:
            counted &= self._touches()
        tops = self.bodies.position[counted, 2] + self.bodies.radius[counted]
        return float(self.ranks.most([tops.max(initial=-np.inf)])[0])

    def _touches(self):
        """Whether a body of this rank touches something, as of the last step (n,)."""
        contacts, walls = self.near
        touching = np.zeros(len(self.bodies.id), bool)
        for bodies, touch in (
            (contacts.body_a, contacts.touching),
            (contacts.body_b, contacts.touching),
            (walls.body, walls.touching),
        ):
            touching[bodies[touch != 0]] = True
        return touching

    def _is_time_for_batch(self):
        """Whether a batch is born now; PackingError where none ever finds room."""
        if self.bodies is None:
            return True
        if self.under_way or self.step < self.next_birth:
            return False
        top = self._top()
        if self._has_room(top):
            return True
        if self.step < self.patience:
            return False
        # A heavy grain that falls on a light one can throw it higher than where it was born: it is waited for, not
        # too long.
        waits = (self.step - self.patience) * self.dt < LONG_FLIGHT * self._fall_time()
        lying = self._top(lying=True)
        if waits and self._has_room(lying):
            return False
        # The bed itself has come to where batches begin: what is left of the domain takes the next.
        if self._has_room(top, last=True):
            return True
        if waits and self._has_room(lying, last=True):
            return False
        raise PackingError(
            f"{self.scene.name}: after {self.born} grains the bed reaches {top * 1e3:.0f} mm and leaves no room for "
            f"another batch below domain.height = {self.scene.domain.height * 1e3:.0f} mm; make the domain higher or "
            f"wider, or pour less"
        )

    def _fall_time(self):
        """Time to fall through the domain from birth [s]."""
        scene = self.scene
        return fall_time(scene.domain.height, -scene.generation.velocity_z, scene.material.effective_gravity)

    def _has_room(self, top, last=False):
        return self.pouring.has_room(self.born, top, self._highest, last)

    def _highest(self):
        """Height of the highest centre and largest bounding radius [m]."""
        own = self.bodies.own
        return self.ranks.most(
            [self.bodies.position[own, 2].max(initial=-np.inf), self.bodies.radius[own].max(initial=0.0)]
        )

    def _add_batch(self):
        """One batch of grains, of which every rank draws all and takes its own."""
        scene, born = self.scene, self.born
        drawn, places, interval = self.pouring.batch(born, self._top(), self._touching)
        self.next_birth = self.step + round(interval / self.dt)
        count = len(places)
        if scene.amount_grains is not None:
            self.full = born + count >= scene.amount_grains
        else:
            before = 0.0 if self.bodies is None else self.ranks.totals(self.bodies.mass[self.bodies.own])[0]
            mass = before + np.cumsum(scene.material.density * self.pouring.volumes(drawn)[:count])
            self.full = bool(mass[-1] >= scene.amount_mass)
            if self.full and scene.generation.fill == "bed":
                # ASSUME: the study ends with a whole batch and overshoots; a batch just above the bed can be larger
                # than the packing, so the grain that reaches the mass is the last.
                count = int(np.searchsorted(mass, scene.amount_mass)) + 1
        new = self._newborn(drawn, places, count)
        new.id[:] += born
        self.place(self.ranks.welcome(self.bodies, new, self.box), float(np.mean(drawn.sieve_size[:count])))

    def _newborn(self, drawn, places, count):
        """Bodies of the first `count` grains drawn, at these places, with ids from 0 on."""
        scene = self.scene
        birth = give_birth(scene.generation, places[:count], drawn.sieve_size[:count], drawn.uniforms[:count])
        return make_bodies(
            self.bases, drawn.shape[:count], drawn.scale[:count], *birth, scene.material.density, self.features
        )

    def _touching(self, drawn, places):
        """Pairs (m, 2) of the grains drawn that touch at these places; the step's own contacts tell."""
        bodies = self._newborn(drawn, places, len(places))
        near = list_near(bodies, self.shapes, self.box, 0.0, self.features)
        drive = self._drive(GENERATING, 0.0)
        clock = np.zeros_like(self.clock)
        self.advance_steps(bodies, self.shapes, *near, self.room, self.law, drive, clock, 0, 1)
        found = near.contacts
        return np.column_stack([found.body_a, found.body_b])[found.touching != 0]

    # -- steps ----------------------------------------------------------------------------------------------

    def _drive(self, phase, dt):
        scene = self.scene
        damping = scene.damping.factor**dt if phase == DAMPING else 1.0
        return Drive(
            dt=dt,
            gravity=scene.material.effective_gravity,
            shaking=0.0 if phase == DAMPING else scene.shaking.acceleration,
            shaking_rate=scene.shaking.rate,
            damping=damping,
            width=self.box.width,
            wall_radius=0.5 * scene.domain.width,
        )

    def advance(self, n_steps, phase, end=None):
        """A stretch of n_steps, or what is left of the one under way; list anew where needed, look, report."""
        drive = self._drive(phase, self.dt)
        if not self.under_way:
            self.looked_at, self.look_at, self.under_way = self.step, self.step + n_steps, True
        while self.step < self.look_at:
            stale, wish = self._advance(drive, self.look_at - self.step)
            if stale:
                self.watch.check_finite(self.bodies, self.step)
                self.list_near()
            if wish:
                self.keep()
                if wish == KEEP_AND_STOP:
                    raise Interrupted(
                        f"{self.scene.name}: interrupted at step {self.step}, t = {self.step * self.dt:.3f} s, as it "
                        f"was asked to; the same command goes on from there"
                    )
        self.under_way = False
        seen = observe(self.bodies, self.near, self.ranks)
        falling = phase != DAMPING and self.step < self.patience
        self.watch.look(self.bodies, self.near, drive, self.step, self.step - self.looked_at, falling)
        self.checks.append((self.step * self.dt, phase, seen))
        self.progress.line(phase, self.step, self.dt, self.born, seen, end)
        return seen

    def evaluate(self):
        """Forces, overlaps and contact points of the final positions, without moving anything."""
        drive, step = self._drive(DAMPING, 0.0), self.step
        self._step(drive, 1)
        self.step = step

    def _advance(self, drive, n_steps):
        """Some steps, at most n_steps: (whether the list is stale, wish of the keeper)."""
        before, started = self.clock.copy(), time.perf_counter()
        wish = self.keeper.wish and (lambda: self.keeper.wish(self.step))
        _, stale, wish = self.ranks.advance(lambda n: self._step(drive, n), self.bodies, n_steps, wish)
        if self.features.timed:
            elapsed, cycles = time.perf_counter() - started, self.clock - before
            for stage, share in zip(STAGES, cycles / cycles.sum(), strict=True):
                self.seconds[stage] += elapsed * share
        return stale, wish

    def _step(self, drive, n_steps):
        done, stale = self.advance_steps(
            self.bodies, self.shapes, *self.near, self.room, self.law, drive, self.clock, self.step, n_steps
        )
        self.step += done
        return done, stale

    def list_near(self):
        """List what can touch, looking as far ahead as the last lists call for."""
        started = time.perf_counter()
        held = self.step - self.listed_step
        if 0 < held < LIST_HOLDS[0]:
            self.ahead = min(max(AHEAD_STEP * self.ahead, held * self.dt), LIST_HOLDS[0] * self.dt)
        elif held > LIST_HOLDS[1]:
            self.ahead /= AHEAD_STEP
        self.listed_step = self.step
        self.bodies, self.near = self.ranks.list_near(
            self.bodies, self.shapes, self.box, self._margins(), self.features, self.near
        )
        self.seconds["neighbour search"] += time.perf_counter() - started

    def _margins(self):
        """Way (n,) [m] that the points of each body may go before neighbours are listed anew."""
        bodies = self.bodies
        spin = np.sqrt((bodies.angular_velocity**2).sum(axis=1))
        speed = np.sqrt((bodies.velocity**2).sum(axis=1)) + bodies.radius * spin
        # fmin: a speed that is not a number widens nothing; the watch will tell of it.
        return 0.5 * self.skin + np.fmin(self.ahead * speed, WIDEST_MARGIN * self.mean_size)


# What a process is besides its bodies and their Near.
_STATE = (
    "phase",
    "step",
    "listed_step",
    "looked_at",
    "look_at",
    "under_way",
    "born",
    "full",
    "patience",
    "next_birth",
    "last_birth",
    "end",
    "mean_size",
    "skin",
    "ahead",
    "height",
)


class _Progress:
    """Progress lines, by wall-clock time; they influence nothing."""

    def __init__(self, scene, report):
        self.scene, self.report = scene, report
        self.last_time = time.monotonic()
        self.last_step = 0

    def phase(self, text):
        self.report(f"{self.scene.name}: {text}")

    def line(self, phase, step, dt, n_bodies, seen, end):
        now = time.monotonic()
        elapsed = now - self.last_time
        if elapsed < self.scene.numerics.progress_interval:
            return
        rate = (step - self.last_step) / elapsed
        self.last_time, self.last_step = now, step
        shaking_left = 0 if phase == DAMPING else self.scene.shaking.duration / dt
        left = (end - step if end is not None else shaking_left) / rate
        # While damping, the end is a limit that is seldom reached.
        estimate = {GENERATING: f"> {left:.0f} s", SHAKING: f"about {left:.0f} s"}.get(phase, f"< {left:.0f} s")
        self.report(
            f"{self.scene.name}: {phase}, t = {step * dt:.3f} s, {n_bodies} grains, kinetic energy "
            f"{seen.kinetic_energy:.2e} J, mean overlap {seen.mean_overlap:.1e} m, {rate:.0f} steps/s, "
            f"{estimate} left in this phase"
        )
