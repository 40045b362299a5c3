"""What a running packing is judged by: energy, speed, unbalanced force, height."""

from typing import NamedTuple

import numpy as np

from simcore.dem.forces.hertz import local_law
from simcore.dem.ranks.one_rank import ONE_RANK
from simcore.dem.state.bodies import Bodies
from simcore.dem.state.contacts import Near


class Observation(NamedTuple):
    kinetic_energy: float  # [J], of translation and rotation
    max_speed: float  # [m/s], of the fastest centre
    mean_height: float  # [m], mass-averaged
    mean_overlap: float  # [m], over grain-grain contacts; 0 without contacts
    max_overlap: float  # [m], over all contacts
    unbalanced_force: float  # mean net force on a grain over the mean force of a contact; inf where nothing is touched
    coordination: float  # grain-grain contacts per grain, each counted for both


def observe(bodies: Bodies, near: Near, ranks=ONE_RANK) -> Observation:
    """Observation of the current state, of all ranks; forces and overlaps are those of the last evaluation."""
    own = bodies.own
    contacts, walls = near
    # A contact counts where its first body moves: once.
    touching = (contacts.touching > 0) & bodies.moves_here[contacts.body_a]
    wall = walls.touching > 0
    speed2 = (bodies.velocity[own] ** 2).sum(axis=1)
    n, n_contacts, n_walls = ranks.add([len(own), touching.sum(), wall.sum()])
    fastest, deepest, deepest_wall = ranks.most(
        [speed2.max(initial=0.0), contacts.overlap[touching].max(initial=0.0), walls.overlap[wall].max(initial=0.0)]
    )
    motion, spin, mass, height, overlap, net, force = ranks.totals(
        bodies.mass[own] * speed2,
        bodies.angular_momentum[own] * bodies.angular_velocity[own],
        bodies.mass[own],
        bodies.mass[own] * bodies.position[own, 2],
        contacts.overlap[touching],
        np.linalg.norm(bodies.net_force[own], axis=1),
        np.concatenate([np.linalg.norm(contacts.force[touching], axis=1), np.linalg.norm(walls.force[wall], axis=1)]),
    )
    return Observation(
        kinetic_energy=0.5 * (motion + spin),
        max_speed=float(np.sqrt(fastest)),
        mean_height=height / mass,
        mean_overlap=overlap / n_contacts if n_contacts else 0.0,
        max_overlap=float(max(deepest, deepest_wall)),
        # Not 0 without contacts: grains that have just begun to fall would be taken for a bed at rest.
        unbalanced_force=net / n / (force / (n_contacts + n_walls)) if force > 0.0 else np.inf,
        coordination=2.0 * float(n_contacts) / float(n),
    )


class Energy(NamedTuple):
    """Each body's share (n,) [J]; of a contact's spring half is each body's."""

    motion: np.ndarray  # of translation and rotation
    height: np.ndarray  # above the floor, of the weight less buoyancy
    springs: np.ndarray  # of normal springs; the tangential ones are not counted

    @property
    def total(self) -> float:
        return float(self.motion.sum() + self.height.sum() + self.springs.sum())


def mechanical_energy(bodies: Bodies, near: Near, law, gravity: float, dt: float = 0.0) -> Energy:
    """Energy of a state whose forces have been evaluated (a step of dt = 0). law: ContactLaw or HertzLaw.

    dt: the step [s]. Semi-implicit Euler is leapfrog whose velocities are known half a step before the positions;
    they are brought up to them, so that the energy is seen at second order. With 0 they are taken as they stand.
    """
    n = len(bodies.mass)
    contacts, walls = near
    touching, wall = contacts.touching > 0, walls.touching > 0
    body_a, body_b, walled = contacts.body_a[touching], contacts.body_b[touching], walls.body[wall]
    torque = np.zeros((n, 3))
    np.add.at(torque, body_a, contacts.torque_a[touching])
    np.add.at(torque, body_b, contacts.torque_b[touching])
    np.add.at(torque, walled, walls.torque[wall])
    velocity = bodies.velocity + 0.5 * dt * bodies.net_force / bodies.mass[:, None]
    momentum = bodies.angular_momentum + 0.5 * dt * torque
    if len(bodies.rotation):
        momentum = np.einsum("nji,nj->ni", bodies.rotation, momentum)
    mass = bodies.mass[body_a] * bodies.mass[body_b] / (bodies.mass[body_a] + bodies.mass[body_b])
    at, share = local_law(law, bodies.mass[body_a], bodies.mass[body_b], contacts.overlap[touching])
    stored = 0.5 * at.stiffness * mass * (share * contacts.overlap[touching] ** 2)
    springs = np.zeros(n)
    np.add.at(springs, body_a, 0.5 * stored)
    np.add.at(springs, body_b, 0.5 * stored)
    at, share = local_law(law, bodies.mass[walled], np.full(len(walled), np.inf), walls.overlap[wall])
    np.add.at(springs, walled, 0.5 * at.stiffness * bodies.mass[walled] * (share * walls.overlap[wall] ** 2))
    return Energy(
        motion=0.5 * bodies.mass * (velocity**2).sum(axis=1) + 0.5 * (momentum**2 / bodies.inertia).sum(axis=1),
        height=bodies.mass * gravity * bodies.position[:, 2],
        springs=springs,
    )
