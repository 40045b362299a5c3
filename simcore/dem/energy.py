"""Mechanical energy of bodies: kinetic energy, potential energy of the height, and energy of the springs."""

from typing import NamedTuple

import numpy as np

from simcore.dem.forces.hertz import local_law
from simcore.dem.state.bodies import Bodies
from simcore.dem.state.contacts import CandidatePairs


class TotalEnergy(NamedTuple):
    """Energy of all bodies together [J]."""

    moving: float  # kinetic energy and energy of the springs
    height: float
    distance: float  # sum of the absolute values of the bodies' height energies: the scale of their round-off


class Energy(NamedTuple):
    """Energy of each body (n,) [J]; each body of a contact gets half of the spring's energy."""

    motion: np.ndarray  # kinetic energy of translation and rotation
    height: np.ndarray  # energy of the weight less buoyancy, above the floor
    springs: np.ndarray  # energy of normal springs; tangential springs are not counted

    @property
    def total(self) -> float:
        """Sum of all energies [J]."""
        return float(self.motion.sum() + self.height.sum() + self.springs.sum())


def mechanical_energy(bodies: Bodies, candidates: CandidatePairs, law, gravity: float, dt: float = 0.0) -> Energy:
    """Return the Energy of a state whose forces have been evaluated (a step of dt = 0). law: ContactLaw or HertzLaw.

    dt: time step [s]. Semi-implicit Euler is a leapfrog scheme whose velocities lag the positions by half a step. The
    velocities are advanced by half a step, so that the energy is accurate to second order. With dt = 0 they are used
    unchanged.
    """
    n = len(bodies.mass)
    contacts, walls = candidates
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


def spring_energy(bodies: Bodies, candidates: CandidatePairs, law) -> np.ndarray:
    """Return the energy (n,) [J] of normal and tangential springs and twisted patches; each body gets half."""
    energy = np.zeros(len(bodies.mass))
    contacts, walls = candidates
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
    """Return the sum (k,) [m²] of the squared springs of rows p, scaled to the stiffness of the normal spring.

    mass (k,): effective masses. share: factor on the squared overlap.

    A tangential spring counts only as far as friction can hold it. If a contact slips at speed u, cutting the spring
    back to the friction limit leaves d u / k in it: 1.4 times the energy of that motion at e = 0.1, which is never
    released.
    """
    square = share * rows.overlap[p] ** 2
    if len(rows.spring):
        push = np.abs((rows.force[p] * normal[p]).sum(axis=1))
        limit = (law.friction * push / (law.tangential * law.stiffness * mass)) ** 2
        square += law.tangential * np.minimum((rows.spring[p] ** 2).sum(axis=1), limit)
    if len(rows.twist):
        twist = np.maximum(rows.spread[p, :3].sum(axis=1), 0.0) * rows.twist[p] ** 2
        square += law.tangential * np.minimum(twist, limit)
    return square
