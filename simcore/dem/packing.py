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

from simcore.dem.bodies import Bodies, join_bodies, make_bodies
from simcore.dem.contact.patch import make_room
from simcore.dem.expectation import expect, warnings
from simcore.dem.generation import give_birth, lattice_sites, occupy_sites
from simcore.dem.neighbors import Box, Near, list_near
from simcore.dem.observation import Observation, observe
from simcore.dem.scene import Scene
from simcore.dem.shapes import Base, collect_shapes
from simcore.dem.stepping import STAGES, Drive, make_advance
from simcore.dem.watch import PackingError, Stability, Watch

GENERATING, SHAKING, DAMPING = "generating", "shaking", "damping"
# Of the mean sieve size: the skin at rest, and how far it grows while lists hold for fewer steps than LIST_HOLDS[0],
# as when grains fall; above LIST_HOLDS[1] it shrinks again. From 0.2 to 0.4 a shaken bed costs the same within 10 %.
SKIN, WIDEST_SKIN = 0.3, 1.5
LIST_HOLDS = (100, 1000)
SKIN_STEP = 1.5
REFILL_HEIGHT = 0.6  # of the domain: where the study's batches begin
STUDY_FIRST_FILL = 0.1


class Draw(NamedTuple):
    """Grains by id, as the grain room draws them; all (n,) but scale (n, 3) and uniforms (n, 8)."""

    shape: np.ndarray
    scale: np.ndarray
    sieve_size: np.ndarray
    uniforms: np.ndarray


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

    @property
    def contacts(self):
        return self.near.contacts

    @property
    def walls(self):
        return self.near.walls


def pack(scene: Scene, bases: list[Base], draw: Callable, report: Callable = lambda line: None) -> Packed:
    """Run the packing of `scene`.

    bases: shapes of the grains. draw(ids (n,)) -> Draw, the same for an id whenever it is asked. report(text):
    called with a progress line every scene.numerics.progress_interval of wall-clock time and at each change of
    phase. Raises PackingError.
    """
    return Process(scene, bases, draw, report).run()


class Process:
    """A packing under way; `pack` runs it through, benchmarks and tests step it themselves."""

    def __init__(self, scene, bases, draw, report, timed=False):
        """timed: count in `seconds` what each part of the steps takes."""
        self.scene, self.bases, self.draw = scene, bases, draw
        self.progress = _Progress(scene, report)
        self.shapes = collect_shapes(bases)
        domain = scene.domain
        self.box = Box(domain.width) if domain.periodic else Box(0.0, 0.5 * domain.width)
        self.features = scene.features._replace(timed=timed)
        self.advance_steps = make_advance(self.features)
        self.room = make_room(self.shapes, get_num_threads())
        self.clock = np.zeros(len(STAGES), np.int64)
        self.seconds = dict.fromkeys(("neighbour search", *STAGES), 0.0)
        self.dt = scene.numerics.time_step
        self.interval_steps = max(round(scene.convergence.interval / self.dt), 1)
        self.shaking_steps = round(scene.shaking.duration / self.dt)
        self.step = 0
        self.listed_step = 0
        self.watch = Watch(scene, self.box.width, report)
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
        last_birth = self.generate()
        self.shake(last_birth + self.shaking_steps)
        observation = self.settle()
        self.evaluate()
        return Packed(
            self.bodies,
            self.near,
            observation,
            self.step,
            self.step * self.dt,
            last_birth * self.dt,
            self.checks,
            self.watch.stability(expected.stability),
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
        self.watch.look_again(bodies, self.step)
        self.skin = (SKIN if self.scene.numerics.skin is None else self.scene.numerics.skin) * mean_size
        self.list_near()

    # -- phases ---------------------------------------------------------------------------------------------

    def generate(self):
        """Batches until the amount is reached; returns the step of the last birth."""
        while not self._add_batch():
            patience = self.step + round(2.0 * self._fall_time() / self.dt)
            while not self._has_room():
                if self.step >= patience:
                    top = self._top() * 1e3
                    raise PackingError(
                        f"{self.scene.name}: after {len(self.bodies.mass)} grains the bed reaches {top:.0f} mm and "
                        f"leaves no room for another batch below domain.height = "
                        f"{self.scene.domain.height * 1e3:.0f} mm; make the domain higher or wider, or pour less"
                    )
                self.advance(self.interval_steps, GENERATING)
        self.progress.phase(f"{len(self.bodies.mass)} grains born, {self.bodies.mass.sum():.4g} kg")
        return self.step

    def shake(self, end):
        while self.step < end:
            self.advance(min(self.interval_steps, end - self.step), SHAKING, end)

    def settle(self):
        """Damping until converged; PackingError after damping.max_time."""
        scene = self.scene
        goal = scene.convergence
        end = self.step + round(scene.damping.max_time / self.dt)
        before = observe(self.bodies, self.near).mean_height
        while self.step < end:
            seen = self.advance(self.interval_steps, DAMPING, end)
            change = abs(seen.mean_height - before)
            before = seen.mean_height
            if (
                change < goal.height_change
                and seen.max_speed < goal.max_speed
                and seen.unbalanced_force < goal.max_unbalanced_force
            ):
                self.progress.phase(
                    f"converged after {self.step} steps: largest speed {seen.max_speed:.2g} m/s, unbalanced force "
                    f"{seen.unbalanced_force:.2g}"
                )
                return seen
        fastest = self._fastest()
        raise PackingError(
            f"{scene.name}: not at rest after {scene.damping.max_time:g} s of damping, step {self.step}: mean height "
            f"changed by {change:.2g} m in {goal.interval:g} s (allowed {goal.height_change:g}), grain {fastest} moves "
            f"at {seen.max_speed:.2g} m/s (allowed {goal.max_speed:g}), unbalanced force {seen.unbalanced_force:.2g} "
            f"(allowed {goal.max_unbalanced_force:g}){self.watch.hint()}. Shake or damp longer, or loosen `convergence`"
        )

    # -- births ---------------------------------------------------------------------------------------------

    def _top(self):
        """Height below which all grains lie [m]."""
        return 0.0 if self.bodies is None else float((self.bodies.position[:, 2] + self.bodies.radius).max())

    def _fall_time(self):
        """Time to fall through the domain from birth [s]."""
        g, v = self.scene.material.effective_gravity, -self.scene.generation.velocity_z
        return (np.sqrt(v**2 + 2.0 * g * self.scene.domain.height) - v) / g

    def _has_room(self):
        generation, height = self.scene.generation, self.scene.domain.height
        if generation.fill == "study":
            margin = max(generation.spacing, 2.0 * float(self.bodies.radius.max()))
            return float(self.bodies.position[:, 2].max()) < REFILL_HEIGHT * height - margin
        return self._top() + generation.drop_height < REFILL_HEIGHT * height

    def _add_batch(self):
        """One batch of grains; True when the amount is reached."""
        scene, generation = self.scene, self.scene.generation
        born = 0 if self.bodies is None else len(self.bodies.mass)
        if generation.fill == "study":
            low = (STUDY_FIRST_FILL if born == 0 else REFILL_HEIGHT) * scene.domain.height
        else:
            low = self._top() + generation.drop_height
        sites = lattice_sites(scene.domain, generation.spacing, low, scene.domain.height)
        wanted = len(sites) if scene.amount_grains is None else min(len(sites), scene.amount_grains - born)
        ids = np.arange(born, born + max(wanted, 1))  # one also where there is no site, so that the error has its size
        drawn = self.draw(ids)
        reach, half_height = extents(self.bases, drawn, generation.orientation == "random")
        sites[:, 2] += half_height[: len(sites)].max(initial=0.0)
        sites = sites[sites[:, 2] + half_height.max(initial=0.0) <= scene.domain.height]
        taken = occupy_sites(sites, reach, half_height, scene.domain)
        if len(taken) == 0:
            raise PackingError(
                f"{scene.name}: no grain finds room at birth between {low:.3g} m and domain.height "
                f"{scene.domain.height:g} m in a {scene.domain.type} domain of width {scene.domain.width:g} m; grains "
                f"reach {2 * reach.max(initial=0.0):.3g} m across; make the domain larger"
            )
        count = len(taken)
        reached = False
        if scene.amount_grains is not None:
            reached = born + count >= scene.amount_grains
        else:
            before = 0.0 if self.bodies is None else self.bodies.mass.sum()
            mass = before + np.cumsum(self._masses(drawn)[:count])
            reached = bool(mass[-1] >= scene.amount_mass)
            if reached and generation.fill == "bed":
                # ASSUME: the study ends with a whole batch and overshoots; a batch just above the bed can be larger
                # than the packing, so the grain that reaches the mass is the last.
                count = int(np.searchsorted(mass, scene.amount_mass)) + 1
        birth = give_birth(generation, sites[taken[:count]], drawn.sieve_size[:count], drawn.uniforms[:count])
        new = make_bodies(
            self.bases, drawn.shape[:count], drawn.scale[:count], *birth, scene.material.density, self.features
        )
        everyone = new if self.bodies is None else join_bodies(self.bodies, new)
        self.place(everyone, float(np.mean(drawn.sieve_size[:count])))
        return reached

    def _masses(self, drawn):
        volume = np.array([base.volume for base in self.bases])
        return self.scene.material.density * volume[drawn.shape] * drawn.scale.prod(axis=1)

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
            list_margin=np.inf,  # known when the list is
        )

    def advance(self, n_steps, phase, end=None):
        """Step, list anew where needed, check that all is sane, and report."""
        drive = self._drive(phase, self.dt)
        left = n_steps
        while left > 0:
            done, stale = self._advance(drive, left)
            self.step += done
            left -= done
            if stale:
                self.watch.check_finite(self.bodies, self.step)
                self.list_near()
        seen = observe(self.bodies, self.near)
        self.watch.look(self.bodies, self.near, drive, self.step, n_steps)
        self.checks.append((self.step * self.dt, phase, seen))
        self.progress.line(phase, self.step, self.dt, len(self.bodies.mass), seen, end)
        return seen

    def evaluate(self):
        """Forces, overlaps and contact points of the final positions, without moving anything."""
        drive = self._drive(DAMPING, 0.0)
        self._advance(drive, 1)

    def _advance(self, drive, n_steps):
        """(steps done, whether the list is stale)"""
        drive = drive._replace(list_margin=0.5 * self.skin)
        before, started = self.clock.copy(), time.perf_counter()
        result = self.advance_steps(
            self.bodies, self.shapes, *self.near, self.room, self.scene.law, drive, self.clock, self.step, n_steps
        )
        if self.features.timed:
            elapsed, cycles = time.perf_counter() - started, self.clock - before
            for stage, share in zip(STAGES, cycles / cycles.sum(), strict=True):
                self.seconds[stage] += elapsed * share
        return result

    def list_near(self):
        """List what can touch, with the skin that the last lists call for."""
        started = time.perf_counter()
        held = self.step - self.listed_step
        if self.scene.numerics.skin is None and held > 0:
            if held < LIST_HOLDS[0]:
                self.skin = min(SKIN_STEP * self.skin, WIDEST_SKIN * self.mean_size)
            elif held > LIST_HOLDS[1]:
                self.skin = max(self.skin / SKIN_STEP, SKIN * self.mean_size)
        self.listed_step = self.step
        self.near = list_near(self.bodies, self.shapes, self.box, self.skin, self.features, self.near)
        self.seconds["neighbour search"] += time.perf_counter() - started

    def _fastest(self):
        """Id of the grain whose centre moves fastest."""
        return int(np.argmax((self.bodies.velocity**2).sum(axis=1)))


def extents(bases: list[Base], drawn: Draw, any_orientation: bool):
    """How far grains reach horizontally and vertically from their centre at birth, (n,) and (n,) [m]."""
    if any_orientation:
        radius = np.zeros(len(drawn.shape))
    reach = np.zeros(len(drawn.shape))
    half_height = np.zeros(len(drawn.shape))
    for k, (shape, scale) in enumerate(zip(drawn.shape, drawn.scale, strict=True)):
        if len(bases[shape].vertices):
            corners = np.abs(bases[shape].vertices * scale)
            reach[k], half_height[k] = np.hypot(corners[:, 0], corners[:, 1]).max(), corners[:, 2].max()
            if any_orientation:
                radius[k] = np.sqrt((corners**2).sum(axis=1).max())
        else:
            reach[k], half_height[k] = max(scale[0], scale[1]), scale[2]
            if any_orientation:
                radius[k] = scale.max()
    return (radius, radius) if any_orientation else (reach, half_height)


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
