"""One impact on the floor: restitution along the normal and the tangent, against the time step.

Reference: the normal motion is a damped oscillation in closed form. Its force drives the tangential spring, whose
motion is closed too while it sticks and while it slips; only the instants between the two are searched for.
"""

import time
from typing import NamedTuple

import numba
import numpy as np
import pandas as pd
from scipy.integrate import quad
from scipy.optimize import brentq

from simcore.dem.contact.patch.workspace import make_workspace
from simcore.dem.forces.spring_dashpot import contact_law, implicit_law
from simcore.dem.shapes.hulls import SPHERE, collect_shapes, unit_sphere
from simcore.dem.stability import longest_stable_step
from simcore.dem.state.bodies import make_bodies
from simcore.dem.state.contacts import Box, State
from simcore.dem.state.features import Features
from simcore.dem.step.candidate_pairs import list_candidates
from simcore.dem.step.step import STAGES, Drive, make_advance

RESTITUTION, POISSON_RATIO, FRICTION = 0.1, 0.22, 0.5  # the study's
ANGLE = np.radians(45.0)  # from the normal: the contact slips and sticks
# The arm of friction is the radius less half the overlap: a sphere so large that this is lost (SHORTER_ARM).
RADIUS, SPEED, CONTACT_TIME = 1.0, 1e-3, 1e-3
LEVER = 3.5  # inverse effective mass of a sphere along the tangent
STEPS = (5, 6, 8, 10, 14, 20, 28, 40, 80, 160, 320, 640)
DEFAULT = ("explicit", 40)
PHASES = 256
REPEATS = 5
TIMED_STEPS = 500  # at least, of one measurement of CPU time: some milliseconds
ROUND_OFF = 1e-13  # of accelerations of order one
ONE, MEAN = "one impact", "mean"


class Impact(NamedTuple):
    """What is left of the velocity at the impact, and how much of it the reference does not know."""

    normal: float
    tangential: float  # of the centre
    normal_error: float
    tangential_error: float


class _Fall:
    """Normal motion per effective mass and unit speed, in units of the contact time."""

    def __init__(self, restitution, attractive):
        logarithm = np.log(restitution)
        self.stiffness, self.damping = np.pi**2 + logarithm**2, -2.0 * logarithm
        beta, omega = 0.5 * self.damping, np.pi
        self.beta, self.omega = beta, omega
        # The force changes its sign where tan ωt = 2 β ω / (β² − ω²).
        self.turn = np.arctan2(2.0 * beta * omega, beta**2 - omega**2) / omega
        self.end = 1.0 if attractive else self.turn

    def overlap(self, t):
        return np.exp(-self.beta * t) * np.sin(self.omega * t) / self.omega

    def rate(self, t):
        return np.exp(-self.beta * t) * (np.cos(self.omega * t) - self.beta / self.omega * np.sin(self.omega * t))

    def force(self, t):
        return self.stiffness * self.overlap(t) + self.damping * self.rate(t)

    def force_rate(self, t):
        return self.stiffness * self.rate(t) - self.damping * self.force(t)

    def impulse(self, t0, t1):
        """∫ |force|: the velocity it takes, piecewise about the change of sign."""
        middle = min(max(self.turn, t0), t1)
        return abs(self.rate(t0) - self.rate(middle)) + abs(self.rate(middle) - self.rate(t1))


def reference_impact(attractive, angle=ANGLE, restitution=RESTITUTION, friction=FRICTION) -> Impact:
    """An impact without a time step, of a sphere so large that the overlap shortens no arm."""
    fall = _Fall(restitution, attractive)
    ratio = 2.0 * (1.0 - POISSON_RATIO) / (2.0 - POISSON_RATIO)
    k, d = ratio * fall.stiffness, np.sqrt(ratio) * fall.damping
    start = np.tan(angle)  # slip per unit of normal speed
    t, s, u = 0.0, 0.0, start
    slips = d * u > friction * fall.force(0.0)
    while t < fall.end:
        if slips:
            # Where the normal force changes its sign the friction cone closes and opens anew.
            last = fall.turn if t < fall.turn else fall.end
            t, s, u = _slip(fall, k, d, friction, t, last, s, u)
            slips = t == last
        else:
            t, s, u = _stick(fall, k, d, friction, t, s, u)
            slips = True
    rebound = -fall.rate(fall.end)
    # A sphere is thrown by its centre: of the slip 1 / LEVER is the centre's.
    tangential = 1.0 + (u - start) / (LEVER * start)
    closed = np.exp(-fall.beta * fall.end)
    shortened = 0.5 * fall.overlap(np.arctan(fall.omega / fall.beta) / fall.omega) * SPEED * CONTACT_TIME / RADIUS
    rounding = np.finfo(float).eps * RADIUS / (SPEED * CONTACT_TIME)  # of the overlap, a difference of heights
    return Impact(closed if attractive else rebound, tangential, abs(rebound - closed) + rounding, shortened + rounding)


def _first(condition, t0, t1):
    """Where `condition` first exceeds round-off from t0 on, or t1."""
    times = np.linspace(t0, t1, 4001)
    above = np.flatnonzero(condition(times) > ROUND_OFF)
    if not len(above) or above[0] == 0:
        return times[0] if len(above) else t1
    k = above[0]
    return brentq(lambda x: float(condition(np.array([x]))[0]) - ROUND_OFF, times[k - 1], times[k], xtol=1e-15)


def _stick(fall, k, d, friction, t0, s0, u0):
    """Spring and slip velocity until the force leaves the friction cone: s'' = −LEVER (k s + d s')."""
    rates = np.roots([1.0, LEVER * d, LEVER * k]).astype(complex)
    weights = np.linalg.solve(np.array([[1.0, 1.0], rates]), np.array([s0, u0], complex))

    def state(t):
        grown = weights[:, None] * np.exp(np.multiply.outer(rates, np.asarray(t) - t0))
        return grown.sum(axis=0).real, (rates[:, None] * grown).sum(axis=0).real

    def beyond(t):
        s, u = state(t)
        return np.abs(k * s + d * u) - friction * np.abs(fall.force(t))

    end = _first(beyond, t0, fall.end)
    (s,), (u,) = state(np.array([end]))
    return end, s, u


def _slip(fall, k, d, friction, t0, last, s0, u0):
    """Spring and slip velocity while the force is the limit, until the trial force grows less than the limit does."""
    trial = k * s0 + d * u0
    sense = np.sign(trial if abs(trial) > ROUND_OFF else k * u0)

    def velocity(t):
        return u0 - sense * LEVER * friction * np.array([fall.impulse(t0, x) for x in np.atleast_1d(t)])

    def held(t):
        limit = friction * np.abs(fall.force(t))
        limit_rate = friction * fall.force_rate(t) * np.where(t < fall.turn, 1.0, -1.0)
        return limit_rate - sense * (k * velocity(t) - sense * LEVER * d * limit)

    end = _first(held, t0, last)
    u = float(velocity(end)[0])
    return end, (sense * friction * abs(fall.force(end)) - d * u) / k, u


def impulse_by_quadrature(attractive, restitution=RESTITUTION):
    """∫ |force| over the impact, for a test of the closed form."""
    fall = _Fall(restitution, attractive)
    value, _ = quad(lambda t: abs(fall.force(t)), 0.0, fall.end, points=[fall.turn], epsabs=1e-13, epsrel=1e-13)
    return value


def simulate(dashpot, attractive, steps, phases=PHASES, angle=ANGLE, repeats=1):
    """Impacts of the compiled step, one for each phase of the first touch, far from each other.

    Returns (restitution (phases,), tangential restitution (phases,), CPU time of one impact (repeats,) [s]).
    """
    dt = CONTACT_TIME / steps
    implicit = dashpot == "implicit"
    law = contact_law(RESTITUTION, CONTACT_TIME, POISSON_RATIO, FRICTION)
    law = implicit_law(law, dt) if implicit else law
    features = Features(SPHERE, True, attractive, implicit=implicit)
    advance, base = make_advance(features), unit_sphere()
    shapes, box, skin = collect_shapes([base]), Box(0.0), 0.2 * RADIUS
    position = np.zeros((phases, 3))
    position[:, 0] = 10.0 * RADIUS * np.arange(phases)
    position[:, 2] = RADIUS + (np.arange(phases) + 0.5) / phases * SPEED * dt
    thrown = np.tile([np.tan(angle) * SPEED, 0.0, -SPEED], (phases, 1))
    drive = Drive(dt, 0.0, 0.0, 0.0, 1.0, 0.0, np.inf)
    upright, still = np.tile([1.0, 0.0, 0.0, 0.0], (phases, 1)), np.zeros((phases, 3))
    # Until the last has left the floor: attractive contacts last a contact time, clamped ones creep out longer.
    count = int(np.ceil(1.5 * steps)) + 2 if attractive else 3 * steps
    room, clock = make_workspace(shapes, numba.get_num_threads()), np.zeros(len(STAGES), np.int64)
    rounds = -(-TIMED_STEPS // count) if repeats else 1
    spent = []
    for repeat in range(repeats + 1):
        elapsed = 0.0
        for _ in range(rounds if repeat else 1):  # the first repeat loads or compiles
            bodies = make_bodies(
                [base], np.zeros(phases, int), np.full((phases, 3), RADIUS),
                position, upright, thrown, still, 1.0, features=features,
            )  # fmt: skip
            candidates = list_candidates(bodies, shapes, box, 0.5 * skin, features, None)
            began = time.process_time()
            advance(State(shapes, bodies, *candidates, room), law, drive, clock, 0, count)
            elapsed += time.process_time() - began
        if repeat:
            spent.append(elapsed / rounds / phases)
    return bodies.velocity[:, 2] / SPEED, bodies.velocity[:, 0] / thrown[:, 0], np.array(spent)


def study(steps=STEPS, phases=PHASES, repeats=REPEATS) -> pd.DataFrame:
    """Rows for figures.work_precision: root mean square error of one impact, and error of the mean over phases."""
    rows = []
    continuous = contact_law(RESTITUTION, CONTACT_TIME, POISSON_RATIO, FRICTION)
    for attractive in (True, False):
        exact = reference_impact(attractive)
        for dashpot in ("explicit", "implicit"):
            longest = longest_stable_step(continuous, dashpot == "implicit", contacts=1.0)
            for n in steps:
                if CONTACT_TIME / n >= longest:
                    continue
                normal, tangential, spent = simulate(dashpot, attractive, n, phases, repeats=repeats)
                for quantity, found, true, error in (
                    ("restitution", normal, exact.normal, exact.normal_error),
                    ("tangential restitution", tangential, exact.tangential, exact.tangential_error),
                ):
                    off = found - true
                    for average, value in ((ONE, np.sqrt((off**2).mean())), (MEAN, abs(off.mean()))):
                        rows += [
                            {
                                "case": "attractive" if attractive else "clamped",
                                "quantity": f"{quantity}, {average}",
                                "method": dashpot,
                                "setting": n,
                                "default": (dashpot, n) == DEFAULT,
                                "repeat": repeat,
                                "error": value,
                                "cpu_s": cpu,
                                "reference_error": error,
                            }
                            for repeat, cpu in enumerate(spent)
                        ]
    return pd.DataFrame(rows)
