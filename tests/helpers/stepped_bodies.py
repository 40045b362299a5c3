"""A few bodies, moved by the compiled step alone, without a packing process."""

import numba
import numpy as np

from simcore.dem.contact.patch.workspace import make_workspace
from simcore.dem.forces.viscous_friction import NONE
from simcore.dem.shapes.polyhedra import MIXED, POLYHEDRON, collect_shapes, unit_sphere
from simcore.dem.state.bodies import make_bodies
from simcore.dem.state.contacts import Box, State
from simcore.dem.state.features import Features
from simcore.dem.step.candidate_pairs import list_candidates
from simcore.dem.step.motion import derive_form_matrix, derive_rotation
from simcore.dem.step.step import STAGES, Drive, make_advance


class SteppedBodies:
    """Bodies, the scene they are in, and the compiled step.

    law: ContactLaw, or HertzLaw with hertz; with an implicit dashpot the law of the time step (implicit_law). All
    variants have a floor and, except those with viscous friction, friction. A friction coefficient of 0 and a floor far
    below are data, so they need no compilation of their own.
    """

    def __init__(
        self,
        kind,
        law,
        scale,
        position,
        velocity,
        spin=None,
        bases=None,
        shape=None,
        attractive=True,
        patch=False,
        implicit=False,
        friction=True,
        hertz=False,
        sliding=NONE,
        preloaded=False,
        **drive,
    ):
        position = np.atleast_2d(np.asarray(position, float))
        n = len(position)
        self.bases = [unit_sphere()] if bases is None else bases
        self.shapes = collect_shapes(self.bases)
        still = np.zeros((n, 3))
        orientation = drive.pop("orientation", np.tile([1.0, 0.0, 0.0, 0.0], (n, 1)))
        self.bodies = make_bodies(
            self.bases,
            np.zeros(n, int) if shape is None else shape,
            np.broadcast_to(scale, (n, 3)),
            position,
            np.broadcast_to(orientation, (n, 4)),
            np.broadcast_to(velocity, (n, 3)),
            still if spin is None else np.broadcast_to(spin, (n, 3)),
            density=drive.pop("density", 1.0),
        )
        self.law = law
        self.width = drive.pop("width", 0.0)
        self.skin = drive.pop("skin", 0.2) * self.bodies.radius.max()
        patch = patch and kind in (POLYHEDRON, MIXED)
        self.features = Features(
            kind,
            friction,
            attractive,
            patch=patch,
            implicit=implicit,
            hertz=hertz,
            sliding=sliding,
            preloaded=preloaded,
        )
        self.candidates = None
        self._list()
        self.drive = {
            "gravity": 0.0, "shaking": 0.0, "shaking_rate": 0.0, "damping": 1.0, "wall_radius": np.inf,
        } | drive  # fmt: skip
        self._advance = make_advance(self.features)
        self.workspace = make_workspace(self.shapes, numba.get_num_threads())
        self.clock = np.zeros(len(STAGES), np.int64)
        self.step = 0

    def advance(self, dt, n_steps):
        """Make n_steps of dt [s]; with dt = 0 only the forces of the current positions are computed."""
        drive = Drive(dt=dt, width=self.width, **self.drive)
        left = n_steps
        while left > 0:
            state = State(self.shapes, self.bodies, *self.candidates, self.workspace)
            done, stale = self._advance(state, self.law, drive, self.clock, self.step, left)
            left -= done
            self.step += done
            if stale:
                self._list()

    def _list(self):
        self.candidates = list_candidates(
            self.bodies, self.shapes, Box(self.width), 0.5 * self.skin, self.features, self.candidates
        )

    @property
    def contacts(self):
        return self.candidates.contacts

    @property
    def walls(self):
        return self.candidates.walls

    def derive(self):
        """Update derived fields after positions, orientations or momenta were set by hand."""
        for i in range(len(self.bodies.mass)):
            derive_rotation(self.bodies, i)
            derive_form_matrix(self.bodies, i)

    def on_floor(self):
        """Return whether each body touches the floor, (n,)."""
        on = np.zeros(len(self.bodies.mass), bool)
        on[self.walls.body[self.walls.touching > 0]] = True
        return on

    def floor_force(self):
        """Return the upward force of the floor on each body, (n,) [N]."""
        force = np.zeros(len(self.bodies.mass))
        force[self.walls.body] = self.walls.force[:, 2]
        return force

    def energy(self):
        """Return the kinetic energy [J]."""
        b = self.bodies
        spin = 0.5 * (b.angular_momentum * b.angular_velocity).sum()
        return 0.5 * (b.mass[:, None] * b.velocity**2).sum() + spin
