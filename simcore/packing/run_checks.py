"""Checks of a running packing: each function returns a problem, or None if there is none.

Every check covers all ranks and returns the same on each. docs/explanation/constants_packing.md justifies the limits.
"""

from typing import NamedTuple

import numpy as np

from simcore.dem.energy import TotalEnergy, spring_energy
from simcore.dem.from_scene import Composition
from simcore.dem.overlaps import DEEPEST, deepest_overlap, half_thickness
from simcore.dem.state.bodies import Bodies
from simcore.dem.state.contacts import CandidatePairs
from simcore.packing.expectation import depth_of_impact, fall_speed

SPEED_MARGIN = 5.0  # factor on the speed that fall and shaking cause
PINCHING = 20.0  # times lighter than the heaviest grain are pebbles that may overlap deeply while grains fall
ENERGY_SLACK = 0.1  # share of the kinetic and spring energy that a stable bed may gain between two checks
LIFT = 0.01  # share of their half thickness by which all grains may be lifted: this changes no porosity
ROUNDING = 1e-9  # share of the kinetic, spring and height energy that may be round-off


class NotFinite(NamedTuple):
    """A grain whose position or angular momentum is not finite."""

    grain: int


class TooFast(NamedTuple):
    """A grain that is faster than fall and shaking allow."""

    grain: int
    speed: float  # [m/s]
    limit: float  # [m/s], speed that fall and shaking cause


class DeepImpact(NamedTuple):
    """A grain that will sink deep into what it falls on."""

    grain: int
    speed: float  # [m/s]
    depth: float  # [m], overlap that the impact would cause


class DeepOverlap(NamedTuple):
    """The deepest overlap of two grains, or of a grain and a wall."""

    ratio: float  # overlap over the thinner grain's half thickness
    overlap: float  # [m]
    grain: int  # the thinner of the two
    partner: int  # the thicker of the two; -1: a wall


class EnergyGain(NamedTuple):
    """Energy that fall, shaking and springs do not explain."""

    gained: float  # [J]
    allowed: float  # [J], that fall, shaking and springs explain
    time: float  # [s], since the previous check
    grain: int  # the one with the most kinetic and spring energy


def check_finite(bodies: Bodies, ranks) -> NotFinite | None:
    """Check that all positions and angular momenta are finite."""
    own = bodies.own
    bad = ~np.isfinite(bodies.position[own]).all(axis=1) | ~np.isfinite(bodies.angular_momentum[own]).all(axis=1)
    worst, grain = ranks.largest(bad, bodies.id[own])
    return NotFinite(grain) if worst > 0.0 else None


def check_speed(bodies: Bodies, scene, ranks) -> TooFast | None:
    """Check that no grain is far faster than a fall through the domain and shaking can make it.

    A grain that fast means that a contact became unstable.
    """
    own = bodies.own
    speed = np.sqrt((bodies.velocity[own] ** 2).sum(axis=1))
    limit = fall_speed(scene) + scene.shaking.acceleration / scene.shaking.rate
    top, fastest = ranks.largest(speed, bodies.id[own])
    return TooFast(fastest, top, limit) if top > SPEED_MARGIN * limit else None


def check_impact(bodies: Bodies, thickness, scene, backing: float, ranks) -> DeepImpact | None:
    """Check that no grain would overlap an equally heavy one on the floor by more than its half thickness.

    An impact takes about one contact time, mostly between two checks, so its depth is predicted from the speed before.
    thickness (n,) [m]: half_thickness. backing: of simcore.packing.expectation.
    """
    own = bodies.own
    speed = np.sqrt((bodies.velocity[own] ** 2).sum(axis=1))
    depth = backing * depth_of_impact(scene, speed, bodies.mass[own])
    relative, grain, speed, depth = ranks.largest(depth / thickness[own], bodies.id[own], speed, depth)
    return DeepImpact(grain, speed, depth) if relative > DEEPEST else None


def deepest_on_all_ranks(bodies: Bodies, candidates: CandidatePairs, thickness, ranks, counted=None) -> DeepOverlap:
    """Return the overlap of all ranks with the largest ratio to the thinner grain's half thickness; ratio 0: none."""
    overlap, (thin, other), ratio = deepest_overlap(candidates, thickness, bodies.id, counted)
    thin, other = (int(bodies.id[row]) if row >= 0 else -1 for row in (thin, other))
    # If several are equally deep, the one with the lowest ids is returned.
    order = ratio, other >= 0, -min(thin, other), -max(thin, other)
    ratio, *_, overlap, thin, other = ranks.first((*order, overlap, thin, other), len(order))
    return DeepOverlap(ratio, overlap, thin, other)


def too_deep(overlap: DeepOverlap) -> bool:
    """Return whether an overlap exceeds the half thickness: the grain's centre has reached its partner's surface."""
    return overlap.ratio > DEEPEST


def pinched(bodies: Bodies, ranks) -> np.ndarray:
    """Return a mask (n,) of the bodies that a stone may press flat, and of all bodies of other ranks.

    They are PINCHING times lighter than the heaviest body of all ranks. They need not touch a stone, because grains
    pass its weight on to others. The other ranks check their own bodies.
    """
    own = bodies.own
    heaviest, _ = ranks.largest(bodies.mass[own], bodies.id[own])
    return ~bodies.moves_here | (heaviest > PINCHING * bodies.mass)


def total_energy(bodies: Bodies, candidates: CandidatePairs, law, drive, ranks):
    """Return the TotalEnergy of all ranks, and the kinetic and spring energy (k,) [J] of each own body.

    Positions are those of the last force evaluation, and velocities the mean of those before and after it. The energy
    of rotation is that after the step.
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
    """Return TotalEnergy now, and an EnergyGain if the energy grew by more than the interval explains, or None.

    Contacts only dissipate energy, so the mechanical energy grows by at most the work of shaking: ∫ a(t) P dt with the
    momentum P <= M V along the shaking. V is the speed that corresponds to all kinetic and spring energy; shaking and
    fall limit its growth. The work is therefore at most M U (V + U + g T) with U = ∫ |a| dt over the time T. The error
    of the time step is added as a share of the kinetic and spring energy. Two small amounts are allowed too: a lift of
    all grains by LIFT of their half thickness, and ROUNDING. before: None after bodies were added.
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
