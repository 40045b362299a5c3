"""What a running packing is judged by: energy, speed, unbalanced force, height; all sums in the order of ids."""

from typing import NamedTuple

import numpy as np

from simcore.dem.bodies import Bodies
from simcore.dem.neighbors import Near


class Observation(NamedTuple):
    kinetic_energy: float  # [J], of translation and rotation
    max_speed: float  # [m/s], of the fastest centre
    mean_height: float  # [m], mass-averaged
    mean_overlap: float  # [m], over grain-grain contacts; 0 without contacts
    max_overlap: float  # [m], over all contacts
    unbalanced_force: float  # mean net force on a grain over the mean force of a contact; 0 without contacts
    coordination: float  # grain-grain contacts per grain, each counted for both


def observe(bodies: Bodies, near: Near) -> Observation:
    """Observation of the current state; forces and overlaps are those of the last evaluation."""
    n = len(bodies.mass)
    contacts, walls = near
    touching, wall = contacts.touching > 0, walls.touching > 0
    forces = np.concatenate(
        [np.linalg.norm(contacts.force[touching], axis=1), np.linalg.norm(walls.force[wall], axis=1)]
    )
    overlaps = contacts.overlap[touching]
    net = np.linalg.norm(bodies.net_force, axis=1)
    spin = 0.5 * (bodies.angular_momentum * bodies.angular_velocity).sum()
    return Observation(
        kinetic_energy=float(0.5 * (bodies.mass[:, None] * bodies.velocity**2).sum() + spin),
        max_speed=float(np.sqrt((bodies.velocity**2).sum(axis=1).max())),
        mean_height=float((bodies.mass * bodies.position[:, 2]).sum() / bodies.mass.sum()),
        mean_overlap=float(overlaps.mean()) if len(overlaps) else 0.0,
        max_overlap=float(max(overlaps.max(initial=0.0), walls.overlap[wall].max(initial=0.0))),
        unbalanced_force=float(net.mean() / forces.mean()) if len(forces) and forces.mean() > 0.0 else 0.0,
        coordination=2.0 * float(touching.sum()) / n,
    )
