"""How well elastic, frictionless beds conserve energy, against the time step; and the energy gain of single contacts.

    python benchmarks/studies/energy.py [--time 2.5] [--steps 20,40,80,160] > results/reference/energy.csv
    python benchmarks/studies/energy.py --impacts > results/reference/impacts.csv

Beds: 64 grains in a periodic box jump on a floor under gravity without loss for the given time [s] (10^5 steps at 40
steps per contact time of 1 ms). There is one CSV row per kind of grain and number of steps: relative error of the
energy, root mean square and largest; its drift (mean of the last tenth minus that of the first); mean number of
contacts; CPU time [µs] per grain and step. Impacts: pairs, and grains on the floor, meet once in random poses; there is
one row per form, number of steps and restitution.
"""

import argparse
import os
import time
from typing import NamedTuple

import numpy as np

CONTACT_TIME = 1e-3
GRAVITY = 9.81
SIZE = 0.01  # [m], scale of the radii


class Bed:
    """Bodies in a periodic box, or in the open (width 0), above a floor; the compiled step of simcore moves them."""

    def __init__(self, features, law, bases, shape, scale, position, orientation, velocity, spin, gravity, width=0.0):
        from numba import get_num_threads

        from simcore.dem.contact.patch.workspace import make_workspace
        from simcore.dem.shapes.polyhedra import collect_shapes
        from simcore.dem.state.bodies import make_bodies
        from simcore.dem.state.contacts import Box
        from simcore.dem.step.step import STAGES, make_advance

        self.features, self.law, self.gravity = features, law, gravity
        self.shapes = collect_shapes(bases)
        self.bodies = make_bodies(
            bases, shape, scale, position, orientation, velocity, spin, density=2650.0, features=features
        )
        self.box, self.skin, self.candidates = Box(width), 0.6 * SIZE, None
        self.list_candidates()
        self.advance_steps = make_advance(features)
        self.workspace = make_workspace(self.shapes, get_num_threads())
        self.clock, self.step = np.zeros(len(STAGES), np.int64), 0

    def list_candidates(self):
        from simcore.dem.step.candidate_pairs import list_candidates

        self.candidates = list_candidates(
            self.bodies, self.shapes, self.box, 0.5 * self.skin, self.features, self.candidates
        )

    def advance(self, dt, n_steps):
        """Run n_steps steps of dt [s]; with dt = 0, compute the forces of the current positions."""
        from simcore.dem.state.contacts import State
        from simcore.dem.step.step import Drive

        drive = Drive(dt, self.gravity, 0.0, 0.0, 1.0, self.box.width, np.inf)
        while n_steps > 0:
            state = State(self.shapes, self.bodies, *self.candidates, self.workspace)
            done, stale = self.advance_steps(state, self.law, drive, self.clock, self.step, n_steps)
            n_steps -= done
            self.step += done
            if stale:
                self.list_candidates()

    def energy(self, dt):
        """Return the Energy of the current positions; dt as in mechanical_energy."""
        from simcore.dem.energy import mechanical_energy

        self.advance(0.0, 1)
        return mechanical_energy(self.bodies, self.candidates, self.law, self.gravity, dt)


def pebble(seed, n_points=40):
    """Return the hull of random points on an ellipsoid 1.25 : 1 : 0.8, with the volume of the unit sphere."""
    from simcore.dem.shapes.polyhedra import Base
    from simcore.grains.mesh import make_grain

    points = np.random.default_rng(seed).standard_normal((n_points, 3))
    points *= np.array([1.25, 1.0, 0.8]) / np.linalg.norm(points, axis=1, keepdims=True)
    grain = make_grain(f"P{seed}", points)
    size = (4.0 / 3.0 * np.pi / grain.volume) ** (1.0 / 3.0)
    return Base(grain.name, size * grain.vertices, grain.faces, size**3 * grain.volume, size**2 * grain.second_moments)


def block(a, b, c):
    """Return a cuboid with these edges."""
    from simcore.dem.shapes.polyhedra import Base, convex

    corners = np.array([[x, y, z] for x in (-a, a) for y in (-b, b) for z in (-c, c)]) / 2.0
    hull = convex(corners).base
    return Base(f"{a}:{b}:{c}", hull.vertices, hull.faces, a * b * c, np.array([a * a, b * b, c * c]) / 12.0)


def random_turns(n, rng):
    turns = rng.standard_normal((n, 4))
    return turns / np.linalg.norm(turns, axis=1, keepdims=True)


def jumping_bed(kind, features, restitution=1.0, n_layers=4, seed=1):
    """Return a Bed of 16 n_layers grains with random orientations, velocities and spins that start a little apart.

    kind: sphere, ellipsoid or polyhedron. features: of the step; the friction coefficient of the law is always 0.
    """
    from simcore.dem.forces.spring_dashpot import contact_law
    from simcore.dem.shapes.polyhedra import unit_sphere

    rng = np.random.default_rng(seed)
    bases = [pebble(k) for k in range(4)] if kind == "polyhedron" else [unit_sphere()]
    form = {"sphere": (1.0, 1.0, 1.0), "ellipsoid": (1.25, 1.0, 0.8), "polyhedron": (1.0, 1.0, 1.0)}[kind]
    n, spacing = 16 * n_layers, 2.0 * SIZE * (1.02 if kind == "sphere" else 1.3)
    place = np.stack(np.unravel_index(np.arange(n), (n_layers, 4, 4))[::-1], axis=-1)
    position = spacing * (place + [0.5, 0.5, 0.55])
    size = SIZE * rng.uniform(0.8, 1.0, (n, 1))
    law = contact_law(restitution, CONTACT_TIME, 0.22, 0.0)
    return Bed(
        features, law, bases, rng.integers(len(bases), size=n), size * form, position, random_turns(n, rng),
        0.1 * rng.standard_normal((n, 3)), 5.0 * rng.standard_normal((n, 3)), GRAVITY, 4.0 * spacing,
    )  # fmt: skip


class Record(NamedTuple):
    """Energies of a run at equal intervals, in units of its mean kinetic energy, and its mean number of contacts."""

    error: np.ndarray  # change of the energy since the start, with velocities advanced to the positions
    raw: np.ndarray  # the same with unchanged velocities, half a step behind
    springs: np.ndarray  # energy in the springs
    contacts: float  # mean number that touch, including the floor

    @property
    def rms(self):
        return float(np.sqrt((self.error**2).mean()))

    @property
    def drift(self):
        tenth = len(self.error) // 10
        return float(self.error[-tenth:].mean() - self.error[:tenth].mean())


def follow(bed, duration, steps, samples):
    """Return the Record of `duration` [s] with `steps` steps per contact time and this number of samples."""
    dt = CONTACT_TIME / steps
    every = round(duration / dt / samples)
    start = bed.energy(dt).total
    error, raw, springs, motion, contacts = [], [], [], [], 0
    for _ in range(samples):
        bed.advance(dt, every)
        energy = bed.energy(dt)
        error.append(energy.total - start)
        raw.append(bed.energy(0.0).total - start)
        springs.append(energy.springs.sum())
        motion.append(energy.motion.sum())
        contacts += (bed.candidates.contacts.touching > 0).sum() + (bed.candidates.walls.touching > 0).sum()
    unit = np.mean(motion)
    return Record(np.array(error) / unit, np.array(raw) / unit, np.array(springs) / unit, contacts / samples)


class Impacts(NamedTuple):
    """Contacts from their first touch to their end, one value per contact (n,)."""

    gain: np.ndarray  # energy gained in the contact, in units of the energy of its normal motion
    lever: np.ndarray  # s: stiffness and damping against the normal motion, over those of a central contact
    switched: np.ndarray  # largest part of `gain` that changes of the deepest vertex or face can have caused

    @property
    def restitution(self):
        return np.sqrt(np.maximum(1.0 + self.gain, 0.0))

    def band(self, steps):
        """Return the largest `gain` of elastic contacts that the time step allows.

        Leapfrog conserves v²/2 + ω² x² (1 − (ω dt)²/4) / 2 within the contact. A contact that starts at a fraction φ of
        a step loses (ω dt)² φ (1 − φ) of v²/2 relative to that, and regains it with another φ at its end. The
        difference is at most (ω dt)²/4, with ω² = s (π/T_c)². (Central contacts end as they started if T_c/dt is a
        whole number, so that their error is of third order.)
        """
        return 0.25 * self.lever * (np.pi / steps) ** 2


FORMS = {
    "sphere": ("sphere", (1.0, 1.0, 1.0)),
    "ellipsoid": ("ellipsoid", (1.25, 1.0, 0.8)),
    "needle": ("ellipsoid", (3.0, 0.6, 0.6)),
    "pebble": ("polyhedron", lambda: [pebble(k) for k in range(4)]),
    "block": ("polyhedron", lambda: [block(1.8, 1.6, 1.4)]),
    "rod": ("polyhedron", lambda: [block(6.0, 1.0, 0.8)]),
}


def scatter(form, features, restitution, steps, n, floor, eccentric, speed, rng):
    """Return a Bed without gravity: n pairs about to meet, far from other pairs, or n grains above the floor."""
    from simcore.dem.forces.spring_dashpot import contact_law
    from simcore.dem.shapes.polyhedra import unit_sphere
    from simcore.dem.state.bodies import make_bodies

    _, given = FORMS[form]
    bases, axes = (given(), 1.0) if callable(given) else ([unit_sphere()], given)
    bodies = n if floor else 2 * n
    shape = rng.integers(len(bases), size=bodies)
    scale = SIZE * rng.uniform(0.5, 1.0, (bodies, 1)) * np.broadcast_to(axes, 3)
    still = np.zeros((bodies, 3))
    radius = make_bodies(bases, shape, scale, still, np.ones((bodies, 4)), still, still, 1.0).radius
    reach = (radius if floor else radius[0::2] + radius[1::2])[:, None]
    toward = np.array([[0.0, 0.0, 1.0]]) if floor else rng.standard_normal((n, 3))
    toward = np.broadcast_to(toward / np.linalg.norm(toward, axis=1, keepdims=True), (n, 3))
    aside = np.cross(toward, rng.standard_normal((n, 3)))
    aside *= eccentric * 0.99 * np.sqrt(rng.uniform(0.0, 1.0, (n, 1))) / np.linalg.norm(aside, axis=1, keepdims=True)
    ahead = 1.0 if floor else np.sqrt(1.0 - (aside**2).sum(axis=1, keepdims=True))
    # The gap is 0.001 of the reach, plus a random part of a step, so that the first touch has any phase.
    start = (1.001 * ahead * reach + rng.uniform(0.0, speed * CONTACT_TIME / steps, (n, 1))) * toward
    places = 30.0 * SIZE * np.stack([np.arange(n), np.zeros(n), np.full(n, 0.0 if floor else 4.0)], axis=-1)
    if floor:
        position, velocity = places + start, speed * (aside - toward)
    else:
        position = np.stack([places, places + start + reach * aside], axis=1).reshape(-1, 3)
        velocity = np.stack([np.zeros((n, 3)), -speed * toward], axis=1).reshape(-1, 3)
    spin = eccentric * 0.5 * speed / radius[:, None] * rng.standard_normal((bodies, 3))
    law = contact_law(restitution, CONTACT_TIME, 0.22, 0.0)
    return Bed(features, law, bases, shape, scale, position, random_turns(bodies, rng), velocity, spin, 0.0)


def impacts(form, features, restitution, steps, n, floor=False, eccentric=True, speed=0.5, seed=1):
    """Return the Impacts of n pairs, or of n grains on the floor, from random poses until they have ended.

    form: one of FORMS. eccentric: with random offsets or angles, and with spin; otherwise with neither. speed [m/s].
    """
    bed = scatter(form, features, restitution, steps, n, floor, eccentric, speed, np.random.default_rng([seed, steps]))
    b, dt = bed.bodies, CONTACT_TIME / steps
    unit = np.arange(n) if floor else np.arange(2 * n) // 2
    results = []
    # For each unit: whether it touches; for its contact, the energy of approach, the lever, the energy before, the
    # largest energy of the spring, the gain by switches, and, in the last step, force, speed of approach and braking.
    touched = np.zeros(n, bool)
    brought, lever, before, stored, switched, push, speeds, braking = np.zeros((8, n))
    energy = motion(b, unit, n)
    for _ in range(round(2.5 * (1.0 if floor else 2.0) * b.radius.max() / speed / dt)):
        x, v, w, rotation = b.position.copy(), b.velocity.copy(), b.angular_velocity.copy(), b.rotation.copy()
        bed.advance(dt, 1)
        touches = bed.candidates.walls if floor else bed.candidates.contacts
        on = np.flatnonzero(touches.touching > 0)
        i = touches.body[on] if floor else touches.body_a[on]
        k = unit[i]
        touching = np.zeros(n, bool)
        touching[k] = True
        # A contact that ended did so a step ago, so the energy is that of free flight.
        results += _results(np.flatnonzero(touched & ~touching), energy, before, brought, stored, lever, switched)
        normal = touches.normal[on] if floor else -touches.direction[on]  # points into a
        inverse, approach = _normal_motion(b, rotation, i, touches.point[on], normal, v, w)
        mass = b.mass[i]
        if not floor:
            j = touches.body_b[on]
            other = _normal_motion(b, rotation, j, touches.point[on] + x[i] - x[j], -normal, v, w)
            inverse, approach = inverse + other[0], approach + other[1]
            mass = mass * b.mass[j] / (mass + b.mass[j])
        # In an old contact, a change of the deepest feature changes the speed of approach by more than the force does.
        old = touched[k]
        o = k[old]
        jump = np.abs(approach[old] - speeds[o] + braking[o])
        stiffness = bed.law.stiffness * mass
        force = stiffness * touches.overlap[on]
        switched[o] += 0.5 * dt * np.maximum(push[o], force[old]) * jump
        new = k[~old]
        brought[new] = (0.5 * approach**2 / inverse)[~old]
        lever[new], before[new], stored[new], switched[new] = (mass * inverse)[~old], energy[new], 0.0, 0.0
        stored[k] = np.maximum(stored[k], 0.5 * force * touches.overlap[on])
        lever[k] = np.maximum(lever[k], mass * inverse)
        push[k], speeds[k], braking[k] = force, approach, dt * force * inverse
        touched, energy = touching, motion(b, unit, n)
    # Overdamped contacts never end: they are at rest.
    results += _results(np.flatnonzero(touched), energy, before, brought, stored, lever, switched)
    return Impacts(*np.array(results).T)


def motion(b, unit, n):
    """Return the kinetic energy (n,) [J] of n units of bodies; unit: index of the unit of each body."""
    energies = 0.5 * b.mass * (b.velocity**2).sum(axis=1) + 0.5 * (b.angular_momentum * b.angular_velocity).sum(axis=1)
    return np.bincount(unit, energies, n)


def _results(ended, energy, before, brought, stored, lever, switched):
    unit = np.maximum(brought, stored)
    return [((energy[k] - before[k]) / unit[k], lever[k], switched[k] / unit[k]) for k in ended]


def _normal_motion(b, rotation, i, point, normal, v, w):
    """Return (inverse mass along the normal, speed against it) of bodies i (m,) at points (m, 3) from their centres."""
    arm = np.cross(point, normal)
    turned = np.einsum("kji,kj->ki", rotation[i], arm) if len(rotation) else arm
    inverse = 1.0 / b.mass[i] + (turned**2 / b.inertia[i]).sum(axis=1)
    return inverse, -((v[i] + np.cross(w[i], point)) * normal).sum(axis=1)


def bed_features(kind, patch):
    from simcore.dem.shapes.polyhedra import ELLIPSOID, POLYHEDRON, SPHERE
    from simcore.dem.state.features import Features

    number = {"sphere": SPHERE, "ellipsoid": ELLIPSOID, "polyhedron": POLYHEDRON}[kind]
    return Features(number, friction=False, shaken=False, patch=patch)


BEDS = [("sphere", False), ("ellipsoid", False), ("polyhedron", False), ("polyhedron", True)]


def beds(duration, all_steps):
    from simcore.compilation import source_digest

    print("kind,region,grains,steps_per_contact_time,steps,rms_error,largest_error,largest_raw_error,drift,"
          "energy_in_springs,contacts,us_per_grain_and_step,digest")  # fmt: skip
    for kind, patch in BEDS:
        features = bed_features(kind, patch)
        jumping_bed(kind, features).advance(1e-6, 2)  # compile
        for steps in all_steps:
            bed = jumping_bed(kind, features)
            n = len(bed.bodies.mass)
            started = time.process_time()
            followed = follow(bed, duration, steps, 1000)
            cost = (time.process_time() - started) * 1e6 / n / bed.step
            region = ("patch" if patch else "deepest point") if kind == "polyhedron" else ""
            figures = (
                f"{followed.rms:.3e},{np.abs(followed.error).max():.3e},{np.abs(followed.raw).max():.3e},{followed.drift:.3e},"
                f"{followed.springs.mean():.4f},{followed.contacts:.1f},{cost:.3f},{source_digest()}"
            )
            print(f"{kind},{region},{n},{steps},{round(duration / CONTACT_TIME * steps)},{figures}", flush=True)


def single_contacts(all_steps, n=300):
    from simcore.compilation import source_digest

    print("form,region,against,restitution,steps_per_contact_time,contacts,largest_gain,mean_gain,mean_std_error,"
          "std_gain,largest_share_of_band,largest_share_of_band_and_switches,digest")  # fmt: skip
    for form, (kind, _) in FORMS.items():
        for patch in (False, True) if kind == "polyhedron" else (False,):
            features = bed_features(kind, patch)
            for restitution in (1.0, 0.1):
                for steps in all_steps:
                    for floor in (False, True):
                        measured = impacts(form, features, restitution, steps, n, floor)
                        band = measured.band(steps)
                        region = ("patch" if patch else "deepest point") if kind == "polyhedron" else ""
                        shares = ","
                        if restitution == 1.0:
                            gain = np.abs(measured.gain)
                            shares = f"{(gain / band).max():.3f},{(gain / (band + measured.switched)).max():.3f}"
                        figures = (
                            f"{len(measured.gain)},{measured.gain.max():.3e},{measured.gain.mean():.3e},"
                            f"{measured.gain.std() / len(measured.gain) ** 0.5:.1e},{measured.gain.std():.3e},{shares}"
                        )
                        against = "floor" if floor else "grain"
                        print(
                            f"{form},{region},{against},{restitution},{steps},{figures},{source_digest()}", flush=True
                        )


def main():
    os.environ.setdefault("NUMBA_NUM_THREADS", "1")
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--time", type=float, default=2.5)
    parser.add_argument("--steps", default="20,40,80,160")
    parser.add_argument("--impacts", action="store_true")
    options = parser.parse_args()
    all_steps = [int(steps) for steps in options.steps.split(",")]
    if options.impacts:
        single_contacts(all_steps)
    else:
        beds(options.time, all_steps)


if __name__ == "__main__":
    main()
