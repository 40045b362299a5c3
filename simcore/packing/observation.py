"""Measures of a running packing for its convergence checks: energy, speed, unbalanced force, height."""

from typing import NamedTuple

import numpy as np

from simcore.dem.ranks.one_rank import ONE_RANK
from simcore.dem.state.bodies import Bodies
from simcore.dem.state.contacts import CandidatePairs


class Observation(NamedTuple):
    """Measures of the whole packing at one step."""

    kinetic_energy: float  # [J], of translation and rotation
    max_speed: float  # [m/s], of the fastest centre
    mean_height: float  # [m], mass-averaged
    mean_overlap: float  # [m], over grain-grain contacts; 0 without contacts
    max_overlap: float  # [m], over all contacts
    unbalanced_force: float  # mean net force on a grain over the mean contact force; inf if nothing touches
    coordination: float  # grain-grain contacts per grain, each counted for both


def observe(bodies: Bodies, candidates: CandidatePairs, ranks=ONE_RANK) -> Observation:
    """Return the Observation of the state of all ranks; forces and overlaps are those of the last evaluation."""
    own = bodies.own
    contacts, walls = candidates
    # A contact is counted once, on the rank that moves its first body.
    touching = (contacts.touching > 0) & bodies.moves_here[contacts.body_a]
    wall = walls.touching > 0
    speed2 = (bodies.velocity[own] ** 2).sum(axis=1)
    n, n_contacts, n_walls = ranks.add([len(own), touching.sum(), wall.sum()])
    fastest, deepest, deepest_wall = ranks.maximum(
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
        # Without contacts it is not 0, so that grains which have just begun to fall do not count as at rest.
        unbalanced_force=net / n / (force / (n_contacts + n_walls)) if force > 0.0 else np.inf,
        coordination=2.0 * float(n_contacts) / float(n),
    )
