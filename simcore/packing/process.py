"""The packing process: generate, shake and damp until the grains are at rest.

Grains are inserted in batches until the amount is reached. Shaking starts with the first step and ends its duration
after the last insertion. Then all velocities are damped until the packing has converged. Phases, batches and the end
depend on the state of the whole packing at fixed steps, never on wall-clock time.
"""

import math
import time
from collections.abc import Callable

import numpy as np

from simcore.dem.ranks.one_rank import ONE_RANK
from simcore.dem.state.parts import assemble
from simcore.packing.announcement import announcement
from simcore.packing.expectation import expect, warnings
from simcore.packing.insertion.insertion import Insertion
from simcore.packing.insertion.waiting import check_steps
from simcore.packing.keeping import KEEP_AND_STOP, Keeper
from simcore.packing.neighbour_lists import adapt_look_ahead, margins, skin_of
from simcore.packing.observation import observe
from simcore.packing.packed import DAMPING, GENERATING, SHAKING, Interrupted, Packed, PackingError
from simcore.packing.progress import Progress
from simcore.packing.rest import judge_settled, judge_still
from simcore.packing.softness import mean_overlap, measured_warnings
from simcore.packing.state import PackingState
from simcore.packing.stepper import Stepper
from simcore.packing.watch import Watch
from simcore.provenance.cpu_time import before_compiling
from simcore.scene.scene import Scene
from simcore.scene.shapes import Base


def pack(
    scene: Scene,
    bases: list[Base],
    draw: Callable,
    report: Callable = lambda line: None,
    ranks=ONE_RANK,
    keeper: Keeper | None = None,
) -> Packed | None:
    """Run the packing of `scene`, or resume it from the keeper's latest checkpoint.

    bases: shapes of the grains. draw(ids (n,)) -> Draw, which is the same for an id in each call. report(text): called
    with a progress line every scene.numerics.progress_interval of wall-clock time and at each change of phase. ranks:
    the ranks that share the bodies; rank 0 returns the whole packing, the others None. Raises PackingError if the
    packing fails, and Interrupted if the keeper returns KEEP_AND_STOP.
    """
    return Process(scene, bases, draw, report, ranks=ranks, keeper=keeper).run()


class Process:
    """A running packing. `pack` runs it to the end; benchmarks and tests step it themselves.

    It advances in stretches of steps. At the end of a stretch the packing is checked and the next stretch is chosen.
    Later steps depend only on the bodies, their candidate pairs and `state`, so that a checkpoint can be written after
    any step.
    """

    def __init__(self, scene, bases, draw, report, timed=False, ranks=ONE_RANK, keeper=None, **changes):
        """timed: measure in `stepper.seconds` the time of each part. changes: to the features of the scene's step."""
        self.scene, self.bases, self.draw, self.ranks = scene, bases, draw, ranks
        self.keeper = Keeper() if keeper is None else keeper
        self.progress = Progress(scene, report)
        self.stepper = Stepper(scene, bases, timed=timed, **changes)
        announce = lambda: self.progress.phase(announcement(self.stepper.features))  # noqa: E731
        before_compiling(self.stepper.advance_steps, announce)
        self.insertion = Insertion(scene, bases, draw, self.stepper, ranks)
        self.watch = Watch(scene, self.stepper.box.width, report, ranks)
        self.dt = scene.numerics.time_step
        self.interval_steps = check_steps(scene.convergence.interval, self.dt)
        self.shaking_steps = round(scene.shaking.duration / self.dt)
        self.state = PackingState()
        self.bodies = None
        self.candidates = None
        self.outputs_are_current = True  # the last call of the step did all its steps; only then it stores all outputs

    @property
    def contacts(self):
        """Contacts between grains, of the candidate pairs."""
        return self.candidates.contacts

    @property
    def walls(self):
        """Contacts with walls, of the candidate pairs."""
        return self.candidates.walls

    @property
    def step(self) -> int:
        """Number of time steps so far."""
        return self.state.step

    @property
    def checks(self) -> list:
        """Time, phase and Observation of each check so far."""
        return self.state.checks

    def run(self):
        """Run the packing to its end; return Packed on rank 0 and None on the others."""
        expected = self.expect()
        self.insertion.pouring.check_widths()
        self.resume()
        state = self.state
        if state.phase == GENERATING:
            self.generate()
            state.phase, state.last_insertion, state.shaking_end = SHAKING, state.step, state.step + self.shaking_steps
        if state.phase == SHAKING:
            self.shake(state.shaking_end)
        observation = self.settle()
        self.evaluate()
        stability = self.watch.stability(state.watch, expected.stability)
        parts = list(self.ranks.parts(self.bodies, self.candidates))
        if self.ranks.rank > 0:
            return None
        bodies, candidates = assemble(parts, np.arange(state.inserted))
        last_insertion, end = state.last_insertion * self.dt, state.step * self.dt
        overlap = mean_overlap(bodies, candidates.contacts, self.scene.material.density)
        sentences = (*warnings(self.scene, expected), *self.watch.warnings(state.watch))
        sentences += (*measured_warnings(self.scene, overlap),)
        return Packed(
            bodies,
            candidates,
            observation,
            state.step,
            end,
            last_insertion,
            state.checks,
            stability,
            overlap,
            sentences,
        )

    def expect(self):
        """Return the Expectation of the scene, and report its warnings."""
        expected = expect(self.scene, self.bases, self.draw)
        for text in warnings(self.scene, expected):
            self.progress.phase(f"warning: {text}")
        return expected

    def place(self, bodies, mean_size):
        """Continue with these bodies. mean_size [m]: mean of their sieve sizes, which scales the skin."""
        self.bodies, self.state.mean_size = bodies, mean_size
        self.state.inserted = int(self.ranks.add([len(bodies.own)])[0])
        self.watch.begin_anew(self.state, bodies)
        self.state.skin = skin_of(self.scene, mean_size)
        self.list_candidates()

    # -- phases ---------------------------------------------------------------------------------------------

    def generate(self):
        """Insert batches until the amount is reached; return the step of the last insertion."""
        while not self.state.complete:
            if self.insertion.is_due(self.state, self.bodies, self.candidates):
                self.insert_batch()
            else:
                self.advance(self.interval_steps, GENERATING)
        (mass,) = self.ranks.totals(self.bodies.mass[self.bodies.own])
        self.progress.phase(f"{self.state.inserted} grains inserted, {mass:.4g} kg")
        return self.state.step

    def insert_batch(self):
        """Insert the next batch of grains; each rank takes its own grains."""
        new, mean_size = self.insertion.batch(self.state, self.bodies)
        self.place(self.ranks.insert(self.bodies, new, self.stepper.box), mean_size)

    def shake(self, end):
        """Shake until step `end`."""
        while self.state.in_stretch or self.state.step < end:
            self.advance(min(self.interval_steps, end - self.state.step), SHAKING, end)

    def settle(self):
        """Damp until the packing is at rest and return its Observation; PackingError after damping.max_time."""
        scene, state = self.scene, self.state
        if state.phase != DAMPING:
            state.phase, state.damping_start = DAMPING, state.step
            state.mean_height = observe(self.bodies, self.candidates, self.ranks).mean_height
        stretches = math.ceil(max(round(scene.damping.max_time / self.dt), 1) / self.interval_steps)
        end = state.damping_start + stretches * self.interval_steps
        while state.in_stretch or state.step < end:
            observed = self.advance(self.interval_steps, DAMPING, end)
            verdict = self._judge(observed)
            state.mean_height = observed.mean_height
            if verdict.at_rest:
                self.progress.phase(
                    f"converged after {state.step} steps: largest speed {observed.max_speed:.2g} m/s, unbalanced "
                    f"force {observed.unbalanced_force:.2g}"
                )
                return observed
        own = self.bodies.own
        _, fastest = self.ranks.largest((self.bodies.velocity[own] ** 2).sum(axis=1), self.bodies.id[own])
        goal = scene.convergence
        allowed = f" (allowed {goal.max_speed:g})" if goal.rule == "still" else ""
        raise PackingError(
            f"{scene.name}: not at rest after {(state.step - state.damping_start) * self.dt:.4g} s of damping, step "
            f"{state.step}: "
            f"{verdict.reason}, grain {fastest} moves at {observed.max_speed:.2g} m/s{allowed}"
            f"{self.watch.hint(state.watch)}. {self.watch.advice_on_rest(state.watch)}"
        )

    def _judge(self, observed):
        """Return the Verdict on the observed state by the scene's rule."""
        goal = self.scene.convergence
        if goal.rule == "still":
            return judge_still(goal, observed, self.state.mean_height)
        (mass,) = self.ranks.totals(self.bodies.mass[self.bodies.own])
        since = self.state.damping_start * self.dt
        return judge_settled(goal, self.scene.material, observed, self.state.checks, since, mass, self.state.inserted)

    # -- checkpoints ----------------------------------------------------------------------------------------

    def keep(self):
        """Pass the state to the keeper, and return whether it is stored; the state does not change."""
        return self.keeper.keep(self.state.to_header(), self.ranks.parts(self.bodies, self.candidates))

    def resume(self):
        """Restore the state of the keeper's latest checkpoint, if there is one."""
        latest = self.keeper.latest()
        if latest is None:
            return
        header, sections = latest
        self.state = state = PackingState.from_header(header)
        self.bodies, self.candidates = self.ranks.restore(sections, self.stepper.box, self.stepper.features)
        self.progress.resume(state.step)
        self.progress.phase(f"resumes from step {state.step}, t = {state.step * self.dt:.3f} s, {state.phase}")

    # -- steps ----------------------------------------------------------------------------------------------

    def advance(self, n_steps, phase, end=None):
        """Run a stretch of n_steps, or the rest of the current one; list candidates if needed, check, report."""
        state, drive = self.state, self.stepper.drive(phase, self.dt)
        if not state.in_stretch:
            state.stretch_start, state.stretch_end, state.in_stretch = state.step, state.step + n_steps, True
        deferred = 0  # a wish of the keeper: a frame shows forces, so it waits until they are those of the last step
        while state.step < state.stretch_end:
            stale, wish = self._advance(drive, 1 if deferred else state.stretch_end - state.step)
            if stale:
                self.watch.check_finite(self.bodies, state.step)
                self.list_candidates()
            wish = max(wish, deferred)
            deferred = 0 if self.outputs_are_current else wish
            if wish and self.outputs_are_current:
                stored = self.keep()
                if wish == KEEP_AND_STOP:
                    start = "resume from there" if stored else "start from its last checkpoint, or anew without one"
                    raise Interrupted(
                        f"{self.scene.name}: interrupted at step {state.step}, t = {state.step * self.dt:.3f} s, by "
                        f"request. Run the same command again to {start}"
                    )
        state.in_stretch = False
        observed = observe(self.bodies, self.candidates, self.ranks)
        self.watch.check(state, self.bodies, self.candidates, drive, falling=phase != DAMPING)
        state.checks.append((state.step * self.dt, phase, observed))
        self.progress.line(phase, state.step, self.dt, state.inserted, observed, end)
        return observed

    def evaluate(self):
        """Compute forces, overlaps and contact points of the final positions without moving a body."""
        self.stepper.step(self.bodies, self.candidates, self.stepper.drive(DAMPING, 0.0), self.state.step, 1)

    def _advance(self, drive, n_steps):
        """Run at most n_steps steps; return (whether the neighbour list is stale, wish of the keeper)."""
        before, started = self.stepper.clock.copy(), time.perf_counter()
        wish = self.keeper.wish and (lambda: self.keeper.wish(self.state.step))
        _, stale, wish = self.ranks.advance(lambda n: self._step(drive, n), self.bodies, n_steps, wish)
        self.stepper.count(started, before)
        return stale, wish

    def _step(self, drive, n_steps):
        done, stale = self.stepper.step(self.bodies, self.candidates, drive, self.state.step, n_steps)
        self.state.step += done
        self.outputs_are_current = done == n_steps
        return done, stale

    def list_candidates(self):
        """List the candidate pairs with the look-ahead time adapted to the last lists."""
        started = time.perf_counter()
        adapt_look_ahead(self.state, self.dt)
        stepper = self.stepper
        self.bodies, self.candidates = self.ranks.list_candidates(
            self.bodies,
            stepper.shapes,
            stepper.box,
            margins(self.bodies, self.state),
            stepper.features,
            self.candidates,
        )
        stepper.seconds["neighbour search"] += time.perf_counter() - started
