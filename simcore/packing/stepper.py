"""The compiled step of a scene and its arguments besides bodies and candidate pairs."""

import time

import numpy as np

from simcore.compilation import thread_limit
from simcore.dem.contact.patch.workspace import make_workspace
from simcore.dem.from_scene import compose
from simcore.dem.shapes.polyhedra import collect_shapes
from simcore.dem.state.contacts import Box, State
from simcore.dem.step.step import STAGES, Drive, make_advance
from simcore.packing.packed import DAMPING


class Stepper:
    """Steps the bodies of one scene and measures in `seconds` the wall-clock time of each part."""

    def __init__(self, scene, bases, **changes):
        """changes: to the features of the scene, such as `timed`, which also measures the parts of the steps."""
        self.scene = scene
        self.shapes = collect_shapes(bases)
        domain = scene.domain
        self.box = Box(domain.width) if domain.periodic else Box(0.0, 0.5 * domain.width)
        composition = compose(scene)
        self.law = composition.law
        self.features = composition.features._replace(**changes)
        self.advance_steps = make_advance(self.features)
        self.workspace = make_workspace(self.shapes, thread_limit())
        self.clock = np.zeros(len(STAGES), np.int64)
        self.seconds = dict.fromkeys(("neighbour search", *STAGES), 0.0)

    def drive(self, phase, dt) -> Drive:
        """Return the Drive (gravity, shaking, damping, ...) of steps of dt [s] in a phase."""
        scene = self.scene
        return Drive(
            dt=dt,
            gravity=scene.material.effective_gravity,
            shaking=0.0 if phase == DAMPING else scene.shaking.acceleration,
            shaking_rate=scene.shaking.rate,
            damping=scene.damping.factor**dt if phase == DAMPING else 1.0,
            width=self.box.width,
            wall_radius=0.5 * scene.domain.width,
        )

    def step(self, bodies, candidates, drive, first_step, n_steps):
        """Run n_steps steps, or fewer if a body exceeds its margin; return (steps done, whether the list is stale)."""
        state = State(self.shapes, bodies, *candidates, self.workspace)
        return self.advance_steps(state, self.law, drive, self.clock, first_step, n_steps)

    def touching_pairs(self, bodies, candidates, drive):
        """Return the pairs (m, 2) of bodies that touch, by the contact search of the step; no body moves."""
        clock = np.zeros_like(self.clock)
        state = State(self.shapes, bodies, *candidates, self.workspace)
        self.advance_steps(state, self.law, drive, clock, 0, 1)
        contacts = candidates.contacts
        return np.column_stack([contacts.body_a, contacts.body_b])[contacts.touching != 0]

    def count(self, started, before) -> None:
        """Divide the time since `started` among the stages by their cycles since `before`, if the step is timed."""
        if self.features.timed:
            elapsed, cycles = time.perf_counter() - started, self.clock - before
            for stage, share in zip(STAGES, cycles / cycles.sum(), strict=True):
                self.seconds[stage] += elapsed * share
