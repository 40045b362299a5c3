"""Bodies that move by their contacts and by gravity: the core without a packing process."""

import math
import sys
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from simcore.compilation import thread_limit
from simcore.dem.contact.patch.workspace import make_workspace
from simcore.dem.energy import mechanical_energy, spring_energy
from simcore.dem.forces.spring_dashpot import contact_law
from simcore.dem.overlaps import half_thickness
from simcore.dem.shapes.polyhedra import ELLIPSOID, MIXED, POLYHEDRON, SPHERE, Base, Shape, collect_shapes
from simcore.dem.simulation_checks import (
    GAIN,
    GAIN_OF_POLYHEDRA,
    check_finite,
    check_gain,
    check_overlaps,
    check_place,
    check_start,
    check_width,
    read_only,
    steps_until_passed,
)
from simcore.dem.simulation_input import UPRIGHT, check_index, check_number, check_shapes, rotations_of, rows_of
from simcore.dem.stability import minimum_steps_per_contact_time
from simcore.dem.state.bodies import make_bodies
from simcore.dem.state.contacts import Box, CandidatePairs, State
from simcore.dem.state.features import Features
from simcore.dem.state.touching_contacts import TouchingContacts, touching_contacts
from simcore.dem.step.candidate_pairs import list_candidates
from simcore.dem.step.step import STAGES, Drive, make_advance
from simcore.grains.polyhedron import volume_moments

CHECKS = 8  # of overlaps and energies in a contact time, at most
MARGIN = 0.1  # of the radius of a body: distance that it may move before candidate pairs are listed again


class SystemEnergy(NamedTuple):
    """Energy of all bodies [J]."""

    motion: float  # kinetic energy of translation and rotation
    height: float  # of the centres of mass above z = 0
    springs: float  # of normal and tangential springs, and of twisted patches

    @property
    def total(self) -> float:
        """Sum of the three."""
        return self.motion + self.height + self.springs


class Simulation:
    """n bodies that fall, collide and come to rest. Nothing is inserted or shaken, and no bed is evaluated.

        import simcore

        ball = simcore.sphere(5e-3)
        two = simcore.Simulation([ball], [0, 0], [(0, 0, 0), (0.012, 0, 0)], gravity=0, floor=False,
                                 velocity=[(1, 0, 0), (0, 0, 0)], restitution=1.0)
        two.advance(0.01)
        two.velocity, two.contacts.force, two.energy.total

    Contacts are linear springs with dashpots and Coulomb friction, as those of a packing with the explicit dashpot
    (docs/explanation/time_step.md). At its end a contact may pull. Contacts of polyhedra are not conservative: give
    "point" if restitution is above 0.3 (docs/explanation/differences_r22.md). What is read is a copy and cannot be
    changed; np.array(...) of it can. The step is compiled once for each combination of kinds of shapes, friction,
    floor, cylinder and period, which takes up to a minute.
    """

    def __init__(
        self,
        shapes,
        shape,
        position,
        *,
        orientation=UPRIGHT,
        velocity=(0.0, 0.0, 0.0),
        angular_velocity=(0.0, 0.0, 0.0),
        density=2650.0,
        restitution=0.1,
        friction=0.5,
        poisson_ratio=0.22,
        contact_time=1e-3,
        steps_per_contact_time=40.0,
        polyhedron_contact="patch",
        gravity=9.81,
        floor=True,
        width=None,
        cylinder_radius=None,
    ):
        """Place the bodies; SI units.

        shapes: list of Shape, from simcore.sphere, ellipsoid and convex. shape (n,): index of the shape of each body.
        position (n, 3) [m] and orientation (n, 4), a quaternion (w, x, y, z): of the frame in which the shape was
        given, as in `simcore.query`. velocity (n, 3) [m/s] of the centre of mass, angular_velocity (n, 3) [1/s].
        orientation and velocities may also be one value for all bodies. density [kg/m³]. restitution e in (0, 1] and
        contact_time T [s] of a collision of two bodies; with their effective mass m, that of the body alone at a wall,
        the stiffness is m (π² + ln² e)/T² and the damping −2 m ln(e)/T. friction: Coulomb's coefficient. poisson_ratio
        ν: the tangential stiffness is 2 (1 − ν)/(2 − ν) times the normal one. steps_per_contact_time: T over the time
        step. polyhedron_contact: "patch" or "point", where polyhedra press. gravity [m/s²], downward. floor: whether
        there is one at z = 0. width [m]: period along x and y; cylinder_radius [m]: of an upright cylinder about the z
        axis; without either, the space is open.
        ValueError names the argument and the body that is wrong, and bodies that are below the floor or overlap.
        """
        self.shapes = check_shapes(shapes)
        index = check_index(shape, len(self.shapes))
        n = len(index)
        position = rows_of("position", position, n, 3, per_body=True)
        orientation = rotations_of(rows_of("orientation", orientation, n, 4))
        numbers = {
            "density": density,
            "restitution": restitution,
            "friction": friction,
            "poisson_ratio": poisson_ratio,
            "contact_time": contact_time,
            "steps_per_contact_time": steps_per_contact_time,
            "gravity": gravity,
            "width": width,
            "cylinder_radius": cylinder_radius,
        }
        for name, value in numbers.items():
            if value is not None or name not in ("width", "cylinder_radius"):
                check_number(name, value)
        if width is not None and cylinder_radius is not None:
            raise ValueError("Simulation: width and cylinder_radius are both given; a cylinder is not periodic.")
        check_place(position, width)
        if not isinstance(floor, bool | np.bool_):
            raise ValueError(f"Simulation: floor is {floor!r}; give True or False.")
        if polyhedron_contact not in ("patch", "point"):
            raise ValueError(f"Simulation: polyhedron_contact is {polyhedron_contact!r}; give 'patch' or 'point'.")

        frames = [_body_frame(each) for each in self.shapes]
        bases = [frame.base for frame in frames]
        self._offset = np.array([frame.offset for frame in frames])[index]
        self._turn = Rotation.from_matrix(np.array([frame.axes for frame in frames])[index])
        kind = _kind({self.shapes[i].kind for i in index})
        self._features = Features(
            kind=kind,
            friction=friction > 0.0,
            floor=bool(floor),
            cylinder=cylinder_radius is not None,
            periodic=width is not None,
            shaken=False,
            patch=polyhedron_contact == "patch" and kind in (POLYHEDRON, MIXED),
        )
        self._law = contact_law(float(restitution), float(contact_time), float(poisson_ratio), float(friction))
        needed = minimum_steps_per_contact_time(self._law)
        if steps_per_contact_time < needed:
            raise ValueError(
                f"Simulation: steps_per_contact_time = {steps_per_contact_time:g} is unstable for a body pinched "
                f"between two others; at restitution {restitution:g}, give at least {needed:.2f}, and usually 40."
            )
        self.time_step = float(contact_time) / float(steps_per_contact_time)  # [s]
        self._check_interval = math.ceil(steps_per_contact_time / CHECKS)
        self._box = Box(float(width or 0.0), float(cylinder_radius or np.inf))
        self._drive = Drive(self.time_step, float(gravity), 0.0, 0.0, 1.0, self._box.width, self._box.wall_radius)
        self._bodies = make_bodies(
            bases,
            index,
            [frames[i].scale for i in index],
            position + orientation.apply(self._offset),
            (orientation * self._turn).as_quat(scalar_first=True),
            rows_of("velocity", velocity, n, 3),
            rows_of("angular_velocity", angular_velocity, n, 3),
            float(density),
            features=self._features,
        )
        self._thickness = half_thickness(self._bodies)
        check_width(self._thickness, width)
        self._table = collect_shapes(bases)
        self._workspace = make_workspace(self._table, thread_limit())
        self._clock = np.zeros(len(STAGES), np.int64)
        self._advance = make_advance(self._features)
        self._candidates = None
        self.steps = 0  # since the start
        self._list()
        check_start(self._bodies, self.contacts, self._features.floor, self._box)
        self._checked, self._checked_at = None, 0  # energies and step of the last check
        self._check()

    def advance(self, duration=None, *, steps=None):
        """Move the bodies for at least `duration` [s], or for a number of time steps.

        ValueError unless exactly one of them is given. FloatingPointError if a position is no longer finite, a body
        overlaps another one by more than a quarter of its thickness, the bodies gain energy, because their time step is
        too long, or a body is so fast that it may pass through another one within a step. This is checked when
        candidate pairs are listed again and at the end of a call, but at most CHECKS times in a contact time, and more
        often if a body moves by half its thickness in that time.
        """
        if (duration is None) == (steps is None):
            raise ValueError("Simulation.advance: give either a duration [s] or a number of steps.")
        if steps is None:
            # A difference of two times may be negative by rounding.
            if isinstance(duration, float) and -1e-6 * self.time_step < duration < 0.0:
                duration = 0.0
            check_number("duration", duration)
            steps = math.ceil(duration / self.time_step - 1e-9)
        elif not (isinstance(steps, int | np.integer) and steps >= 0):
            raise ValueError(f"Simulation.advance: steps is {steps!r}; give a whole number of at least 0.")
        left = int(steps)
        while left > 0:
            passed = self._steps_until_passed()
            state = State(self._table, self._bodies, *self._candidates, self._workspace)
            done, stale = self._advance(state, self._law, self._drive, self._clock, self.steps, min(left, passed))
            left -= done
            self.steps += done
            if stale:
                check_finite(self._bodies, self.steps)
            if self.steps - self._checked_at >= min(self._check_interval, passed):
                self._check()
            if stale:
                self._list()

    @property
    def time(self) -> float:
        """Time since the start [s]."""
        return self.steps * self.time_step

    @property
    def position(self) -> np.ndarray:
        """Positions (n, 3) [m] of the frames in which the shapes were given; not wrapped into the period."""
        return read_only(self._bodies.position - self._rotation().apply(self._offset))

    @property
    def orientation(self) -> np.ndarray:
        """Orientations (n, 4) of these frames, quaternions (w, x, y, z).

        If all bodies are spheres, their orientations are not followed, and all are (1, 0, 0, 0).
        """
        return read_only(self._rotation().as_quat(scalar_first=True))

    @property
    def centre_of_mass(self) -> np.ndarray:
        """Centres of mass (n, 3) [m]."""
        return read_only(self._bodies.position.copy())

    @property
    def velocity(self) -> np.ndarray:
        """Velocities (n, 3) [m/s] of the centres of mass."""
        return read_only(self._bodies.velocity.copy())

    @property
    def angular_velocity(self) -> np.ndarray:
        """Angular velocities (n, 3) [1/s]."""
        return read_only(self._bodies.angular_velocity.copy())

    @property
    def mass(self) -> np.ndarray:
        """Masses (n,) [kg]."""
        return read_only(self._bodies.mass.copy())

    @property
    def contacts(self) -> TouchingContacts:
        """The contacts of bodies that touch now, with their forces."""
        return TouchingContacts(*map(read_only, touching_contacts(*self._evaluated())))

    @property
    def energy(self) -> SystemEnergy:
        """The SystemEnergy now. Velocities are advanced by half a step, at which the step conserves energy."""
        bodies, candidates = self._evaluated()
        energy = mechanical_energy(bodies, candidates, self._law, self._drive.gravity, self.time_step)
        springs = spring_energy(bodies, candidates, self._law)
        return SystemEnergy(float(energy.motion.sum()), float(energy.height.sum()), float(springs.sum()))

    def _rotation(self):
        if self._features.kind == SPHERE:
            return Rotation.from_quat(np.tile(UPRIGHT, (len(self._bodies.mass), 1)), scalar_first=True)
        return Rotation.from_quat(self._bodies.orientation, scalar_first=True) * self._turn.inv()

    def _list(self):
        margin = MARGIN * self._bodies.radius
        self._candidates = list_candidates(
            self._bodies, self._table, self._box, margin, self._features, self._candidates
        )

    def _steps_until_passed(self):
        """Return `steps_until_passed`; a body without a floor, a cylinder or another one meets only its own images."""
        if len(self._thickness) == 1 and not self._features.periodic:
            return sys.maxsize
        return steps_until_passed(self._bodies, self._thickness, self.time_step)

    def _check(self):
        """Raise FloatingPointError if bodies overlap too deeply or have gained energy since the last check."""
        bodies, candidates = self._evaluated()
        now = mechanical_energy(bodies, candidates, self._law, self._drive.gravity, self.time_step)
        moving = now.motion + spring_energy(bodies, candidates, self._law)
        share = GAIN_OF_POLYHEDRA if self._features.kind in (POLYHEDRON, MIXED) else GAIN
        self._checked = check_gain(bodies, self._checked, (moving, now.height), self._drive, self._law, share)
        check_overlaps(bodies, candidates, self.time)
        self._checked_at = self.steps

    def _evaluated(self):
        """Return copies of bodies and candidate pairs with the forces of the present positions.

        They are copies, so that reading forces changes no bit of what follows.
        """
        bodies = self._bodies._replace(**{name: field.copy() for name, field in self._bodies._asdict().items()})
        contacts, walls = (
            rows._replace(**{name: field.copy() for name, field in rows._asdict().items()}) for rows in self._candidates
        )
        state = State(self._table, bodies, contacts, walls, self._workspace)
        self._advance(state, self._law, self._drive._replace(dt=0.0), self._clock, self.steps, 1)
        return bodies, CandidatePairs(contacts, walls)


class _Frame(NamedTuple):
    """The base of a Shape, and the centre of mass and the principal axes in the frame in which it was given."""

    base: Base
    scale: tuple
    offset: np.ndarray  # (3,) [m]
    axes: np.ndarray  # (3, 3), columns


def _body_frame(shape: Shape) -> _Frame:
    """Return the frame in which bodies of this shape move: about the centre of mass, along the principal axes."""
    if shape.kind != POLYHEDRON:
        return _Frame(shape.base, shape.scale, np.zeros(3), np.eye(3))
    volume, centre, products = volume_moments(shape.base.vertices, shape.base.faces)
    moments, axes = np.linalg.eigh(products)
    axes[:, 0] *= np.sign(np.linalg.det(axes))  # right-handed
    base = Base(shape.base.name, (shape.base.vertices - centre) @ axes, shape.base.faces, float(volume), moments)
    return _Frame(base, (1.0, 1.0, 1.0), centre + shape.center, axes)


def _kind(kinds):
    """Return the kind of a scene with bodies of these kinds."""
    if POLYHEDRON in kinds:
        return POLYHEDRON if kinds == {POLYHEDRON} else MIXED
    return SPHERE if kinds == {SPHERE} else ELLIPSOID
