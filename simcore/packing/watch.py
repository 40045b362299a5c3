"""Runs the checks at the end of each stretch, and stops a packing that has failed, with a message."""

from functools import partial

from simcore.dem.from_scene import compose
from simcore.dem.ranks.one_rank import ONE_RANK
from simcore.dem.spread_contacts import Estimate
from simcore.dem.stability import body_steps, contact_load, stiffest_body
from simcore.dem.state.bodies import Bodies
from simcore.dem.state.contacts import CandidatePairs
from simcore.dem.step.step import Drive
from simcore.packing.expectation import backing
from simcore.packing.messages import (
    advice_on_rest,
    describe,
    describe_tolerated,
    few_steps_warning,
    hint,
    pinching_warning,
)
from simcore.packing.packed import PackingError, Stability
from simcore.packing.run_checks import (
    Interval,
    check_energy,
    check_finite,
    check_impact,
    check_speed,
    deepest_on_all_ranks,
    half_thickness,
    pinched,
    too_deep,
)
from simcore.packing.state import PackingState, WatchState
from simcore.scene.scene import Scene

CHECKS_PER_SEARCH = 5  # number of checks from one search for the stiffest grain to the next


class Watch:
    """Checks the bodies of a scene; its state between checks is PackingState.watch."""

    def __init__(self, scene: Scene, width: float, report, ranks=ONE_RANK):
        self.scene, self.width, self.report, self.ranks = scene, width, report, ranks
        self.composition = compose(scene)
        self.backing = backing(scene)

    def begin_anew(self, state: PackingState, bodies: Bodies) -> None:
        """Discard the stored energy, because bodies were added or changed. PackingError as in `check`.

        The energy is compared from the second check on, so that batches at every check leave nothing to compare.
        """
        state.watch.energy = None
        self._check_speeds(state, bodies, half_thickness(bodies))

    def check(
        self, state: PackingState, bodies: Bodies, candidates: CandidatePairs, drive: Drive, falling: bool
    ) -> None:
        """Raise PackingError if a check fails at the end of a stretch of steps with this drive.

        falling: whether grains may still be falling from their insertion height, until PackingState.space_deadline.
        """
        watch_state, step = state.watch, state.step
        self.check_finite(bodies, step)
        thickness = half_thickness(bodies)
        self._check_speeds(state, bodies, thickness)
        self._check_overlap(state, bodies, candidates, thickness, falling and step < state.space_deadline)
        time = (step - state.stretch_start) * drive.dt
        interval = Interval(drive, time, self.composition)
        watch_state.energy, problem = check_energy(bodies, candidates, watch_state.energy, interval, self.ranks)
        self._stop_for(problem, step, watch_state)
        if watch_state.checks % CHECKS_PER_SEARCH == 0:
            self._note_stiffest(watch_state, bodies, candidates, drive.dt, step)
        watch_state.checks += 1

    def check_finite(self, bodies: Bodies, step: int) -> None:
        """Raise PackingError if a position or an angular momentum is not finite."""
        self._stop_for(check_finite(bodies, self.ranks), step, None)

    def stability(self, watch_state: WatchState, expected: Estimate | None) -> Stability:
        """Return the Stability of the packing: its steps per contact time and the number that it needed."""
        steps = self.scene.numerics.steps_per_contact_time
        return Stability(
            steps, expected, watch_state.needed, watch_state.stiffest, watch_state.contacts, watch_state.deepest
        )

    def hint(self, watch_state: WatchState) -> str:
        """Return an addition to a message if the time step may be too long for the stiffest grain, otherwise ""."""
        return hint(self.scene, watch_state)

    def advice_on_rest(self, watch_state: WatchState) -> str:
        """Return the advice for a bed that does not come to rest."""
        return advice_on_rest(self.scene, watch_state)

    def warnings(self, watch_state: WatchState) -> list[str]:
        """Return a sentence for each exceeded limit that was tolerated."""
        return describe_tolerated(self.scene, watch_state)

    def _stop_for(self, problem, step, watch_state):
        if problem is not None:
            raise PackingError(describe(problem, self.scene, step, watch_state))

    def _check_speeds(self, state, bodies, thickness):
        self._stop_for(check_speed(bodies, self.scene, self.ranks), state.step, state.watch)
        impact = check_impact(bodies, thickness, self.scene, self.backing, self.ranks)
        self._stop_for(impact, state.step, state.watch)

    def _check_overlap(self, state, bodies, candidates, thickness, falling):
        """Check overlaps. Pebbles under far heavier stones may overlap deeply while grains fall; reported once."""
        watch_state = state.watch
        deepest = deepest_on_all_ranks(bodies, candidates, thickness, self.ranks)
        watch_state.deepest = max(watch_state.deepest, deepest.ratio)
        if too_deep(deepest) and falling:
            others = deepest_on_all_ranks(bodies, candidates, thickness, self.ranks, ~pinched(bodies, self.ranks))
            if not too_deep(others) and not watch_state.warned_of_pinching:
                watch_state.warned_of_pinching = True
                self.report(pinching_warning(self.scene, deepest, state.step))
            deepest = others
        if too_deep(deepest):
            self._stop_for(deepest, state.step, watch_state)

    def _note_stiffest(self, watch_state, bodies, candidates, dt, step):
        """Store the grain whose contacts need the shortest time step; warn once if the time step is longer."""
        scene, law, stiffness_factor = self.scene, self.composition.continuous_law, self.composition.stiffness_factor
        friction, implicit = self.composition.features.friction, self.composition.features.implicit
        load = partial(contact_load, law, dt, friction) if implicit else contact_load(law, dt, friction)
        stiffest = stiffest_body(
            bodies, candidates, self.width, load, ranks=self.ranks, stiffness_factor=stiffness_factor
        )
        if stiffest.load <= watch_state.load:
            return
        watch_state.load, watch_state.stiffest, watch_state.contacts = stiffest.load, stiffest.body, stiffest.contacts
        # The linear law derived from law hertz may be overdamped and then has no contact time.
        time = None if stiffness_factor is None else scene.numerics.contact_time
        watch_state.needed = body_steps(
            bodies, candidates, self.width, law, friction, stiffest.body,
            implicit=implicit, ranks=self.ranks, stiffness_factor=stiffness_factor, time=time,
        )  # fmt: skip
        if watch_state.needed > scene.numerics.steps_per_contact_time and not watch_state.warned_of_steps:
            watch_state.warned_of_steps = True
            self.report(few_steps_warning(scene, watch_state, step))
