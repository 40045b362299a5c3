"""What stops a run that has gone wrong, and what is noted of one that may: looked at whenever convergence is.

- A position that is not finite, or a speed far above what fall and shaking give.
- A speed with which a grain would sink as deep as half its thickness into one as heavy that lies on the floor. Impacts
  are over within a contact time, mostly between two looks, so that what is coming has to be seen.
- An overlap as deep as half a grain is thick: the grain's centre has reached the partner's surface, and beyond that
  the least translation that parts them may lie on the far side. While grains fall, one that touches a PINCHING times
  heavier one is let pass, with a warning: a pair is as stiff as its lighter grain's mass makes it, so a stone comes
  down on a pebble sqrt(M / m) times as deep as on its like whatever the time step, and sinks no more than its weight
  asks when it lies. Then the pebble counts as any other.
- Energy that comes from nowhere. Between two looks contacts only take energy, so the mechanical energy (motion,
  height, springs) grows by no more than shaking puts in: its work is ∫ a(t) P dt of the momentum P <= M V along it,
  where V, the speed that all energy of motion and springs would make, grows by no more than shaking and fall give,
  so the work is at most M U (V + U + g T) with U = ∫ |a| dt over the time T. The step's own error comes on top, as a
  share of the energy of motion and springs: k dt² / m_eff, since a contact begins up to a step's way deep, and
  ENERGY_SLACK for patches, which are not conservative (elastic beds gain 0.2 in 2500 contact times), and for contact
  points that hop. What could lift all grains by LIFT of their half thickness changes no porosity and is let pass: a
  contact that slips sets its tangential spring anew, up to 2 ζ² m_eff u² from nothing. A time step beyond its limit
  multiplies the energy of its mode in every step.
- The grain whose contacts call for the shortest time step (simcore.dem.stability) is noted at every STIFFNESS_LOOKSth
  look; beyond its limit it is told, not stopped: contacts that slip or part hold such a mode in check, and where they
  do not, energy tells, or the bed does not come to rest.
"""

from typing import NamedTuple

import numpy as np

from simcore.dem.forces.hertz import local_law
from simcore.dem.from_scene import compose, stiffening_advice
from simcore.dem.ranks.one_rank import ONE_RANK
from simcore.dem.stability import Estimate, body_steps, contact_load, stiffest_body
from simcore.dem.state.bodies import Bodies
from simcore.dem.step.near_pairs import Near
from simcore.dem.step.step import Drive
from simcore.packing.expectation import backing, depth_of_impact, fall_speed
from simcore.scene.scene import Scene

# Speed that no grain reaches by falling through the domain and shaking, with this margin: then a contact blew up.
SPEED_MARGIN = 5.0
DEEPEST = 1.0  # overlap over the thinner grain's half thickness
PINCHING = 20.0  # of masses: a stone comes down 4.5 times as deep as on its like
ENERGY_SLACK = 0.1
LIFT = 0.01
ROUNDING = 1e-9  # of all energy above the floor
STIFFNESS_LOOKS = 5
BED_NEEDS = (1.2, 1.35)  # times the steps of its stiffest grain by itself; see simcore.dem.stability


class PackingError(RuntimeError):
    """A packing that failed: did not converge, blew up, or does not fit. The message names grain and cause."""


class Stability(NamedTuple):
    """What the time step was, and what it should have been."""

    steps: float  # per contact time
    expected: Estimate | None  # before the run
    needed: float  # by the stiffest grain seen; by itself, the whole bed needs more
    grain: int  # -1 where nothing ever touched
    contacts: int  # it had
    deepest: float  # largest overlap over the thinner grain's half thickness


class Watch:
    """Looks at a scene's bodies; remembers the energy last seen and the stiffest grain."""

    def __init__(self, scene: Scene, width: float, report, ranks=ONE_RANK):
        self.scene, self.width, self.report, self.ranks = scene, width, report, ranks
        self.composition = compose(scene)
        self.load, self.needed, self.stiffest, self.contacts = 0.0, 0.0, -1, 0
        self.deepest, self.looks, self.told, self.pinched = 0.0, 0, False, False
        self.energy, self.backing = None, backing(scene)

    def look_again(self, bodies: Bodies, step: int) -> None:
        """The bodies are others now, or were set by hand: what they had is no measure. PackingError as of `look`."""
        self.energy = None
        self._check_speeds(bodies, step, half_thickness(bodies))

    def look(self, bodies: Bodies, near: Near, drive: Drive, step: int, n_steps: int, falling: bool = False) -> None:
        """PackingError where something is wrong. drive: of the n_steps since the last look; step: their end.

        falling: whether grains may still be falling from birth.
        """
        self.check_finite(bodies, step)
        thickness = half_thickness(bodies)
        self._check_speeds(bodies, step, thickness)
        self._check_overlap(bodies, near, step, thickness, falling)
        self._check_energy(bodies, near, drive, step, n_steps * drive.dt, thickness)
        if self.looks % STIFFNESS_LOOKS == 0:
            self._note_stiffest(bodies, near, drive.dt, step)
        self.looks += 1

    def stability(self, expected: Estimate | None) -> Stability:
        steps = self.scene.numerics.steps_per_contact_time
        return Stability(steps, expected, self.needed, self.stiffest, self.contacts, self.deepest)

    def warnings(self) -> list[str]:
        """Return a sentence for each thing that was let pass."""
        lines = []
        if self.told:
            lines.append(f"At its stiffest {self._about_stiffest()}, and the packing had {self._steps():g}.")
        if self.pinched:
            lines.append(
                f"While grains fell, a stone of at least {PINCHING:g} times the mass of a grain pressed it deeper than "
                f"half of its thickness."
            )
        return lines

    def _steps(self):
        return self.scene.numerics.steps_per_contact_time

    def state(self) -> dict:
        """What it remembers, as JSON can hold it."""
        return {name: getattr(self, name) for name in _REMEMBERED}

    def resume(self, state: dict) -> None:
        """Remember what another one's `state` was."""
        for name in _REMEMBERED:
            setattr(self, name, state[name])
        self.energy = None if self.energy is None else _Energy(*self.energy)

    def check_finite(self, bodies, step):
        own = bodies.own
        bad = ~np.isfinite(bodies.position[own]).all(axis=1) | ~np.isfinite(bodies.angular_momentum[own]).all(axis=1)
        worst, grain = self.ranks.largest(bad, bodies.id[own])
        if worst > 0.0:
            raise PackingError(
                f"{self.scene.name}: the position of grain {grain} is not finite at step {step}; most "
                f"likely the time step is too long: {self._longer()}"
            )

    def _check_speeds(self, bodies, step, thickness):
        own = bodies.own
        speed = np.sqrt((bodies.velocity[own] ** 2).sum(axis=1))
        limit = fall_speed(self.scene) + self.scene.shaking.acceleration / self.scene.shaking.rate
        top, fastest = self.ranks.largest(speed, bodies.id[own])
        if top > SPEED_MARGIN * limit:
            raise PackingError(
                f"{self.scene.name}: grain {fastest} moves at {top:.3g} m/s at step {step}, more than fall "
                f"and shaking can give ({limit:.3g} m/s); the time step is too long for its contacts ({self._longer()})"
                f" or grains overlapped at birth (raise generation.spacing)"
            )
        depth = self.backing * depth_of_impact(self.scene, speed, bodies.mass[own])
        relative, grain, speed, depth = self.ranks.largest(depth / thickness[own], bodies.id[own], speed, depth)
        if relative > DEEPEST:
            raise PackingError(
                f"{self.scene.name}: grain {grain} moves at {speed:.3g} m/s at step "
                f"{step} and would sink {depth * 1e3:.3g} mm into what it meets, more than half of it is thick. "
                f"{stiffening_advice(self.scene)} Impacts become shallower then, and also if grains fall less far"
            )

    def _check_overlap(self, bodies, near, step, thickness, falling):
        deepest = self._deepest(bodies, near, thickness)
        self.deepest = max(self.deepest, deepest[0])
        if deepest[0] <= DEEPEST:
            return
        if falling:
            pressed, deepest = deepest, self._deepest(bodies, near, thickness, ~self._pinched(bodies, near))
            if deepest[0] <= DEEPEST and not self.pinched:
                self.pinched = True
                self.report(
                    f"{self.scene.name}: warning: {_overlapping(*pressed[1:])} at step {step}, more than half of the "
                    f"grain is thick; let pass while grains fall where a stone of {PINCHING:g} times the mass lands "
                    f"on a grain, and only then"
                )
        if deepest[0] > DEEPEST:
            raise PackingError(
                f"{self.scene.name}: {_overlapping(*deepest[1:])} at step {step}, more "
                f"than half of the grain is thick: contacts are too soft for what presses on them. "
                f"{stiffening_advice(self.scene)} Overlaps also become smaller if grains fall less far. If the grains "
                f"overlapped from the start, raise generation.spacing"
            )

    def _deepest(self, bodies, near, thickness, counted=None):
        """Of all ranks: overlap over the thinner grain's half thickness, overlap [m], ids of the thinner and other."""
        overlap, (thin, other), relative = deepest_overlap(near, thickness, bodies.id, counted)
        thin, other = (int(bodies.id[row]) if row >= 0 else -1 for row in (thin, other))
        # Of several as deep, that of the lowest grains.
        order = relative, other >= 0, -min(thin, other), -max(thin, other)
        relative, *_, overlap, thin, other = self.ranks.first((*order, overlap, thin, other), len(order))
        return relative, overlap, thin, other

    def _pinched(self, bodies, near):
        """Bodies (n,) that touch a PINCHING times heavier one, and those of other ranks, which these judge."""
        contacts = near.contacts
        p = np.flatnonzero(contacts.touching)
        a, b, mass = contacts.body_a[p], contacts.body_b[p], bodies.mass
        pinched = ~bodies.moves_here
        pinched[a[mass[b] > PINCHING * mass[a]]] = True
        pinched[b[mass[a] > PINCHING * mass[b]]] = True
        return pinched

    def _check_energy(self, bodies, near, drive, step, time, thickness):
        own = bodies.own
        moving, height = self._energies(bodies, near, drive)
        moving, height = moving[own], height[own]
        now = _Energy(*self.ranks.totals(moving, height, np.abs(height)))
        before, self.energy = self.energy, now
        if before is None:
            return
        mass, lift = self.ranks.totals(bodies.mass[own], bodies.mass[own] * thickness[own])
        speed = np.sqrt(2.0 * before.moving / mass)
        push = drive.shaking * min(time, 2.0 / drive.shaking_rate * np.ceil(time * drive.shaking_rate / np.pi))
        allowed = mass * push * (speed + push + drive.gravity * time)
        slack = ENERGY_SLACK + self.composition.stiffest_law.stiffness * drive.dt**2
        allowed += LIFT * drive.gravity * lift
        allowed += slack * before.moving + ROUNDING * (before.moving + before.distance)
        gained = now.moving + now.height - before.moving - before.height
        if gained > allowed:
            _, grain = self.ranks.largest(moving, bodies.id[own])
            raise PackingError(
                f"{self.scene.name}: {gained:.3g} J came from nowhere within {time:.3g} s before step {step}, of which "
                f"fall, shaking and springs explain {allowed:.3g} J; grain {grain} has most of all. The time step is "
                f"too long for its contacts: {self._longer()}{self.hint()}"
            )

    def _energies(self, bodies, near, drive):
        """Of motion and springs, and of height, each (n,) [J], of the last evaluation of forces.

        With centres' velocities between those before and after it.
        """
        back = drive.dt / drive.damping
        velocity = bodies.velocity / drive.damping - 0.5 * drive.dt * bodies.net_force / bodies.mass[:, None]
        moving = 0.5 * bodies.mass * (velocity**2).sum(axis=1)
        moving += 0.5 * (bodies.angular_momentum * bodies.angular_velocity).sum(axis=1)
        height = bodies.mass * drive.gravity * (bodies.position[:, 2] - back * bodies.velocity[:, 2])
        return moving + spring_energy(bodies, near, self.composition.law), height

    def _note_stiffest(self, bodies, near, dt, step):
        firmness = self.composition.firmness
        found = stiffest_body(bodies, near, self.width, self._load(dt), ranks=self.ranks, firmness=firmness)
        if found.load <= self.load:
            return
        self.load, self.stiffest, self.contacts = found.load, found.body, found.contacts
        law, hold = self.composition.continuous_law, found.contacts if self.scene.implicit else None
        # Of law hertz the linear one says no contact time: it may be overdamped.
        time = None if firmness is None else self.scene.numerics.contact_time
        self.needed = body_steps(
            bodies, near, self.width, law, self.composition.features.friction, found.body,
            hold=hold, ranks=self.ranks, firmness=firmness, time=time,
        )  # fmt: skip
        if self.needed > self.scene.numerics.steps_per_contact_time and not self.told:
            self.told = True
            self.report(
                f"{self.scene.name}: warning: at step {step} {self._about_stiffest()}, and this run has "
                f"{self._steps():g}; such a grain jitters in its contacts and takes up "
                f"energy until they slip or part, which is watched"
            )

    def _load(self, dt):
        """By which bodies are ranked: with an implicit dashpot as if each had one contact."""
        law, features = self.composition.continuous_law, self.composition.features
        return contact_load(law, dt, features.friction, 1.0 if features.implicit else None)

    def hint(self):
        """Half a sentence where the time step may be too long for the stiffest grain seen, or empty."""
        return f"; {self._about_stiffest()}" if self._may_jitter() else ""

    def _may_jitter(self):
        """Whether the time step may be too long for the stiffest grain, as it was held in the bed."""
        return BED_NEEDS[1] * self.needed > self._steps()

    def advice_on_rest(self):
        """Return the sentence that says what helps a bed that does not come to rest."""
        if self._may_jitter():
            enough = int(np.ceil(BED_NEEDS[1] * self.needed))
            return f"Raise numerics.steps_per_contact_time from {self._steps():g} to at least {enough}."
        return "Shake or damp longer, or loosen `convergence`."

    def _about_stiffest(self):
        return (
            f"grain {self.stiffest} with {self.contacts} contacts alone needs {self.needed:.1f} steps a contact time, "
            f"a bed {BED_NEEDS[0]:g} to {BED_NEEDS[1]:g} times that"
        )

    def _longer(self):
        return f"raise numerics.steps_per_contact_time (now {self.scene.numerics.steps_per_contact_time:g})"


_REMEMBERED = ("load", "needed", "stiffest", "contacts", "deepest", "looks", "told", "pinched", "energy")


class _Energy(NamedTuple):
    """Of all bodies together [J]."""

    moving: float  # of motion and springs
    height: float
    distance: float  # as of height, each body's taken positive: the measure of its rounding


def half_thickness(bodies: Bodies) -> np.ndarray:
    """Shortest semi-axis (n,) [m] of the ellipsoid of the same mass and moments of inertia."""
    moments = 0.5 * bodies.inertia.sum(axis=1) - bodies.inertia.max(axis=1)
    return np.sqrt(5.0 * moments / bodies.mass)


def _overlapping(overlap, thin, other):
    partner = "the wall" if other < 0 else f"grain {other}"
    return f"grain {thin} and {partner} overlap by {overlap * 1e3:.3g} mm"


def deepest_overlap(near: Near, thickness, ids, counted=None):
    """The overlap [m] that is largest against the thinner grain's half thickness: (overlap, (thinner, other), ratio).

    thickness: of each grain, (n,) [m]; ids (n,): of two as thick the lower counts as thinner. counted (n,) bool: of
    contacts those whose thinner grain is; None: all. A wall stands as grain -1; (0, (-1, -1), 0) where nothing touches.
    """
    contacts, walls = near
    counted = np.ones(len(thickness), bool) if counted is None else counted
    found = 0.0, (-1, -1), 0.0
    p = np.flatnonzero(contacts.touching)
    a, b = contacts.body_a[p], contacts.body_b[p]
    a_thinner = (thickness[a] < thickness[b]) | ((thickness[a] == thickness[b]) & (ids[a] < ids[b]))
    thin, other = np.where(a_thinner, a, b), np.where(a_thinner, b, a)
    p, thin, other = p[counted[thin]], thin[counted[thin]], other[counted[thin]]
    if len(p):
        ratio = contacts.overlap[p] / thickness[thin]
        k = int(np.argmax(ratio))
        found = float(contacts.overlap[p[k]]), (int(thin[k]), int(other[k])), float(ratio[k])
    w = np.flatnonzero(walls.touching)
    w = w[counted[walls.body[w]]]
    if len(w):
        ratio = walls.overlap[w] / thickness[walls.body[w]]
        k = int(np.argmax(ratio))
        if ratio[k] > found[2]:
            found = float(walls.overlap[w[k]]), (int(walls.body[w[k]]), -1), float(ratio[k])
    return found


def spring_energy(bodies: Bodies, near: Near, law) -> np.ndarray:
    """Energy (n,) [J] of the springs of contacts, tangential ones and twisted patches too; half is each body's."""
    energy = np.zeros(len(bodies.mass))
    contacts, walls = near
    p, w = np.flatnonzero(contacts.touching), np.flatnonzero(walls.touching)
    a, b, i = contacts.body_a[p], contacts.body_b[p], walls.body[w]
    mass = bodies.mass[a] * bodies.mass[b] / (bodies.mass[a] + bodies.mass[b])
    at, share = local_law(law, bodies.mass[a], bodies.mass[b], contacts.overlap[p])
    stored = 0.5 * at.stiffness * mass * _stretch(contacts, contacts.direction, mass, p, at, share)
    for owner, energies in ((a, 0.5 * stored), (b, 0.5 * stored)):
        energy += np.bincount(owner, energies, minlength=len(energy))
    at, share = local_law(law, bodies.mass[i], np.full(len(w), np.inf), walls.overlap[w])
    stored = 0.5 * at.stiffness * bodies.mass[i] * _stretch(walls, walls.normal, bodies.mass[i], w, at, share)
    return energy + np.bincount(i, stored, minlength=len(energy))


def _stretch(rows, normal, mass, p, law, share):
    """Sum (k,) [m²] of the squares of the springs of rows p, each as stiff as the normal one. mass (k,): effective.

    share: of the square of the overlap, that counts.

    Tangential ones count as far as friction can hold them: where a contact slips at u the cut-back leaves d u / k in
    the spring, 1.4 times the energy of that motion at e = 0.1, of which nothing comes back.
    """
    square = share * rows.overlap[p] ** 2
    if len(rows.spring):
        push = np.abs((rows.force[p] * normal[p]).sum(axis=1))
        held = (law.friction * push / (law.tangential * law.stiffness * mass)) ** 2
        square += law.tangential * np.minimum((rows.spring[p] ** 2).sum(axis=1), held)
    if len(rows.twist):
        twist = np.maximum(rows.spread[p, :3].sum(axis=1), 0.0) * rows.twist[p] ** 2
        square += law.tangential * np.minimum(twist, held)
    return square
