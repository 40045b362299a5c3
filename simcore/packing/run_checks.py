"""What shows that a run has gone wrong: one function for each check, which returns a problem or None.

Every check is made of all ranks together and returns the same on each. The limits: docs/constants_packing.md.
"""

from typing import NamedTuple

import numpy as np

from simcore.dem.from_scene import Composition
from simcore.dem.state.bodies import Bodies
from simcore.dem.state.contacts import CandidatePairs
from simcore.packing.energy import TotalEnergy, spring_energy
from simcore.packing.expectation import depth_of_impact, fall_speed

SPEED_MARGIN = 5.0  # over the speed that fall and shaking give
DEEPEST = 1.0  # overlap over the thinner grain's half thickness
PINCHING = 20.0  # ratio of masses above which a stone may land deep in a pebble while grains fall
ENERGY_SLACK = 0.1  # share of the energy of motion and springs that a sound bed may gain between two checks
LIFT = 0.01  # of their half thickness, by which all grains may be lifted: it changes no porosity
ROUNDING = 1e-9  # of all energy above the floor


class NotFinite(NamedTuple):
    grain: int


class TooFast(NamedTuple):
    grain: int
    speed: float  # [m/s]
    limit: float  # [m/s], that fall and shaking give


class DeepImpact(NamedTuple):
    grain: int
    speed: float  # [m/s]
    depth: float  # [m], that it would sink


class DeepOverlap(NamedTuple):
    ratio: float  # overlap over the thinner grain's half thickness
    overlap: float  # [m]
    grain: int  # the thinner of the two
    partner: int  # -1: a wall


class EnergyGain(NamedTuple):
    gained: float  # [J]
    allowed: float  # [J], by fall, shaking and springs
    time: float  # [s], since the check before
    grain: int  # that has most energy of motion and springs


def half_thickness(bodies: Bodies) -> np.ndarray:
    """Shortest semi-axis (n,) [m] of the ellipsoid of the same mass and moments of inertia."""
    moments = 0.5 * bodies.inertia.sum(axis=1) - bodies.inertia.max(axis=1)
    return np.sqrt(5.0 * moments / bodies.mass)


def check_finite(bodies: Bodies, ranks) -> NotFinite | None:
    """Whether all positions and angular momenta are numbers."""
    own = bodies.own
    bad = ~np.isfinite(bodies.position[own]).all(axis=1) | ~np.isfinite(bodies.angular_momentum[own]).all(axis=1)
    worst, grain = ranks.largest(bad, bodies.id[own])
    return NotFinite(grain) if worst > 0.0 else None


def check_speed(bodies: Bodies, scene, ranks) -> TooFast | None:
    """Whether a grain is far faster than a fall through the domain and shaking make it: then a contact blew up."""
    own = bodies.own
    speed = np.sqrt((bodies.velocity[own] ** 2).sum(axis=1))
    limit = fall_speed(scene) + scene.shaking.acceleration / scene.shaking.rate
    top, fastest = ranks.largest(speed, bodies.id[own])
    return TooFast(fastest, top, limit) if top > SPEED_MARGIN * limit else None


def check_impact(bodies: Bodies, thickness, scene, backing: float, ranks) -> DeepImpact | None:
    """Whether a grain would sink deeper than its half thickness into one as heavy that lies on the floor.

    Impacts are over within a contact time, mostly between two checks, so they are judged by the speed before them.
    thickness (n,) [m]: half_thickness; backing: of simcore.packing.expectation.
    """
    own = bodies.own
    speed = np.sqrt((bodies.velocity[own] ** 2).sum(axis=1))
    depth = backing * depth_of_impact(scene, speed, bodies.mass[own])
    relative, grain, speed, depth = ranks.largest(depth / thickness[own], bodies.id[own], speed, depth)
    return DeepImpact(grain, speed, depth) if relative > DEEPEST else None


def deepest_of_all(bodies: Bodies, candidates: CandidatePairs, thickness, ranks, counted=None) -> DeepOverlap:
    """The deepest overlap of all ranks against the thinner grain's half thickness; ratio 0 where nothing touches."""
    overlap, (thin, other), ratio = deepest_overlap(candidates, thickness, bodies.id, counted)
    thin, other = (int(bodies.id[row]) if row >= 0 else -1 for row in (thin, other))
    # Of several as deep, that of the lowest grains.
    order = ratio, other >= 0, -min(thin, other), -max(thin, other)
    ratio, *_, overlap, thin, other = ranks.first((*order, overlap, thin, other), len(order))
    return DeepOverlap(ratio, overlap, thin, other)


def too_deep(overlap: DeepOverlap) -> bool:
    """Whether it is deeper than half a grain is thick: the grain's centre has reached its partner's surface."""
    return overlap.ratio > DEEPEST


def pinched(bodies: Bodies, candidates: CandidatePairs) -> np.ndarray:
    """Bodies (n,) that touch a PINCHING times heavier one, and those of other ranks, which judge them."""
    contacts = candidates.contacts
    p = np.flatnonzero(contacts.touching)
    a, b, mass = contacts.body_a[p], contacts.body_b[p], bodies.mass
    caught = ~bodies.moves_here
    caught[a[mass[b] > PINCHING * mass[a]]] = True
    caught[b[mass[a] > PINCHING * mass[b]]] = True
    return caught


def total_energy(bodies: Bodies, candidates: CandidatePairs, law, drive, ranks):
    """(TotalEnergy of all ranks, energy of motion and springs of the own bodies (k,) [J]) at the last force evaluation.

    Velocities are the means of those before and after it.
    """
    back = drive.dt / drive.damping
    velocity = bodies.velocity / drive.damping - 0.5 * drive.dt * bodies.net_force / bodies.mass[:, None]
    moving = 0.5 * bodies.mass * (velocity**2).sum(axis=1)
    moving += 0.5 * (bodies.angular_momentum * bodies.angular_velocity).sum(axis=1)
    height = bodies.mass * drive.gravity * (bodies.position[:, 2] - back * bodies.velocity[:, 2])
    moving = (moving + spring_energy(bodies, candidates, law))[bodies.own]
    height = height[bodies.own]
    return TotalEnergy(*ranks.totals(moving, height, np.abs(height))), moving


class Interval(NamedTuple):
    """The steps between two checks."""

    drive: object  # Drive of the steps
    time: float  # [s]
    composition: Composition  # laws of the contacts


def check_energy(bodies: Bodies, candidates: CandidatePairs, before: TotalEnergy | None, interval: Interval, ranks):
    """(TotalEnergy now, EnergyGain or None): whether more energy is there than before and than the interval explains.

    Contacts only take energy, so the mechanical energy grows by no more than shaking puts in: ∫ a(t) P dt with the
    momentum P <= M V along it, where V, the speed that all energy of motion and springs would make, grows by no more
    than shaking and fall give. So the work is at most M U (V + U + g T) with U = ∫ |a| dt over the time T. The step's
    own error comes on top, as a share of the energy of motion and springs. before: None after bodies were added.
    """
    drive, time = interval.drive, interval.time
    now, moving = total_energy(bodies, candidates, interval.composition.law, drive, ranks)
    if before is None:
        return now, None
    own = bodies.own
    mass, lift = ranks.totals(bodies.mass[own], bodies.mass[own] * half_thickness(bodies)[own])
    speed = np.sqrt(2.0 * before.moving / mass)
    push = drive.shaking * min(time, 2.0 / drive.shaking_rate * np.ceil(time * drive.shaking_rate / np.pi))
    allowed = mass * push * (speed + push + drive.gravity * time)
    slack = ENERGY_SLACK + interval.composition.stiffest_law.stiffness * drive.dt**2
    allowed += LIFT * drive.gravity * lift
    allowed += slack * before.moving + ROUNDING * (before.moving + before.distance)
    gained = now.moving + now.height - before.moving - before.height
    if gained <= allowed:
        return now, None
    _, grain = ranks.largest(moving, bodies.id[own])
    return now, EnergyGain(gained, allowed, time, grain)


def deepest_overlap(candidates: CandidatePairs, thickness, ids, counted=None):
    """The overlap [m] that is largest against the thinner grain's half thickness: (overlap, (thinner, other), ratio).

    thickness: of each grain, (n,) [m]; ids (n,): of two as thick the lower counts as thinner. counted (n,) bool: of
    contacts those whose thinner grain is; None: all. A wall counts as grain -1; (0, (-1, -1), 0) where nothing touches.
    """
    contacts, walls = candidates
    counted = np.ones(len(thickness), bool) if counted is None else counted
    deepest = 0.0, (-1, -1), 0.0
    p = np.flatnonzero(contacts.touching)
    a, b = contacts.body_a[p], contacts.body_b[p]
    a_thinner = (thickness[a] < thickness[b]) | ((thickness[a] == thickness[b]) & (ids[a] < ids[b]))
    thin, other = np.where(a_thinner, a, b), np.where(a_thinner, b, a)
    p, thin, other = p[counted[thin]], thin[counted[thin]], other[counted[thin]]
    if len(p):
        ratio = contacts.overlap[p] / thickness[thin]
        k = int(np.argmax(ratio))
        deepest = float(contacts.overlap[p[k]]), (int(thin[k]), int(other[k])), float(ratio[k])
    w = np.flatnonzero(walls.touching)
    w = w[counted[walls.body[w]]]
    if len(w):
        ratio = walls.overlap[w] / thickness[walls.body[w]]
        k = int(np.argmax(ratio))
        if ratio[k] > deepest[2]:
            deepest = float(walls.overlap[w[k]]), (int(walls.body[w[k]]), -1), float(ratio[k])
    return deepest
