"""One impact on the floor: error of the normal and tangential restitution against the time step.

Reference: the normal motion is a damped oscillation with a closed form. Its force drives the tangential spring, whose
motion has a closed form both while the contact sticks and while it slips; only the instants of change between the two
are found numerically.
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
from simcore.dem.shapes.polyhedra import SPHERE, collect_shapes, unit_sphere
from simcore.dem.stability import longest_stable_step
from simcore.dem.state.bodies import make_bodies
from simcore.dem.state.contacts import Box, State
from simcore.dem.state.features import Features
from simcore.dem.step.candidate_pairs import list_candidates
from simcore.dem.step.step import STAGES, Drive, make_advance

RESTITUTION, POISSON_RATIO, FRICTION = 0.1, 0.22, 0.5  # of Rettinger et al. (2022)
ANGLE = np.radians(45.0)  # from the normal: the contact slips and sticks
# The lever arm of friction is the radius minus half the overlap; the sphere is so large that the overlap is negligible.
RADIUS, SPEED, CONTACT_TIME = 1.0, 1e-3, 1e-3
LEVER = 3.5  # inverse effective mass of a sphere along the tangent
STEPS = (5, 6, 8, 10, 14, 20, 28, 40, 80, 160, 320, 640)
DEFAULT = ("explicit", 40)
PHASES = 256
REPEATS = 5
TIMED_STEPS = 500  # minimum number of steps in a measurement of CPU time: some milliseconds
ROUND_OFF = 1e-13  # for accelerations of order one
ONE, MEAN = "one impact", "mean"


class Impact(NamedTuple):
    """Restitution: velocity after the impact relative to before, with the errors of the reference."""

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
        """Return ∫ |force|, the change of velocity, piecewise about the change of sign."""
        middle = min(max(self.turn, t0), t1)
        return abs(self.rate(t0) - self.rate(middle)) + abs(self.rate(middle) - self.rate(t1))


def reference_impact(attractive, angle=ANGLE, restitution=RESTITUTION, friction=FRICTION) -> Impact:
    """Return the impact without a time step, of a sphere so large that the overlap does not shorten the lever arm."""
    fall = _Fall(restitution, attractive)
    ratio = 2.0 * (1.0 - POISSON_RATIO) / (2.0 - POISSON_RATIO)
    k, d = ratio * fall.stiffness, np.sqrt(ratio) * fall.damping
    start = np.tan(angle)  # slip per unit of normal speed
    t, s, u = 0.0, 0.0, start
    slips = d * u > friction * fall.force(0.0)
    while t < fall.end:
        if slips:
            # Where the normal force changes its sign, the friction cone closes and opens again.
            last = fall.turn if t < fall.turn else fall.end
            t, s, u = _slip(fall, k, d, friction, t, last, s, u)
            slips = t == last
        else:
            t, s, u = _stick(fall, k, d, friction, t, s, u)
            slips = True
    rebound = -fall.rate(fall.end)
    # The sphere does not rotate before the impact; the centre takes the part 1 / LEVER of a change of slip.
    tangential = 1.0 + (u - start) / (LEVER * start)
    closed = np.exp(-fall.beta * fall.end)
    shortened = 0.5 * fall.overlap(np.arctan(fall.omega / fall.beta) / fall.omega) * SPEED * CONTACT_TIME / RADIUS
    rounding = np.finfo(float).eps * RADIUS / (SPEED * CONTACT_TIME)  # rounding of the overlap, a difference of heights
    return Impact(closed if attractive else rebound, tangential, abs(rebound - closed) + rounding, shortened + rounding)


def _first_time(condition, t0, t1):
    """Return the first time from t0 on at which `condition` exceeds round-off, or t1."""
    times = np.linspace(t0, t1, 4001)
    above = np.flatnonzero(condition(times) > ROUND_OFF)
    if not len(above) or above[0] == 0:
        return times[0] if len(above) else t1
    k = above[0]
    return brentq(lambda x: float(condition(np.array([x]))[0]) - ROUND_OFF, times[k - 1], times[k], xtol=1e-15)


def _stick(fall, k, d, friction, t0, s0, u0):
    """Return time, spring and slip velocity when the force leaves the friction cone: s'' = −LEVER (k s + d s')."""
    rates = np.roots([1.0, LEVER * d, LEVER * k]).astype(complex)
    weights = np.linalg.solve(np.array([[1.0, 1.0], rates]), np.array([s0, u0], complex))

    def state(t):
        grown = weights[:, None] * np.exp(np.multiply.outer(rates, np.asarray(t) - t0))
        return grown.sum(axis=0).real, (rates[:, None] * grown).sum(axis=0).real

    def beyond(t):
        s, u = state(t)
        return np.abs(k * s + d * u) - friction * np.abs(fall.force(t))

    end = _first_time(beyond, t0, fall.end)
    (s,), (u,) = state(np.array([end]))
    return end, s, u


def _slip(fall, k, d, friction, t0, last, s0, u0):
    """Return time, spring and slip velocity at the end of slip, when the trial force grows less than its limit."""
    trial = k * s0 + d * u0
    sense = np.sign(trial if abs(trial) > ROUND_OFF else k * u0)

    def velocity(t):
        return u0 - sense * LEVER * friction * np.array([fall.impulse(t0, x) for x in np.atleast_1d(t)])

    def excess(t):
        limit = friction * np.abs(fall.force(t))
        limit_rate = friction * fall.force_rate(t) * np.where(t < fall.turn, 1.0, -1.0)
        return limit_rate - sense * (k * velocity(t) - sense * LEVER * d * limit)

    end = _first_time(excess, t0, last)
    u = float(velocity(end)[0])
    return end, (sense * friction * abs(fall.force(end)) - d * u) / k, u


def impulse_by_quadrature(attractive, restitution=RESTITUTION):
    """Return ∫ |force| over the impact by quadrature, to test the closed form."""
    fall = _Fall(restitution, attractive)
    value, _ = quad(lambda t: abs(fall.force(t)), 0.0, fall.end, points=[fall.turn], epsabs=1e-13, epsrel=1e-13)
    return value


def simulate(dashpot, attractive, steps, phases=PHASES, angle=ANGLE, repeats=1):
    """Simulate impacts with the compiled step, one per phase of the first touch within a step, far from each other.

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
    # All spheres must have left the floor: attractive contacts last one contact time, clamped ones end more slowly.
    count = int(np.ceil(1.5 * steps)) + 2 if attractive else 3 * steps
    workspace, clock = make_workspace(shapes, numba.get_num_threads()), np.zeros(len(STAGES), np.int64)
    rounds = -(-TIMED_STEPS // count) if repeats else 1
    spent = []
    for repeat in range(repeats + 1):
        elapsed = 0.0
        for _ in range(rounds if repeat else 1):  # the first repeat only loads or compiles the code
            bodies = make_bodies(
                [base], np.zeros(phases, int), np.full((phases, 3), RADIUS),
                position, upright, thrown, still, 1.0, features=features,
            )  # fmt: skip
            candidates = list_candidates(bodies, shapes, box, 0.5 * skin, features, None)
            began = time.process_time()
            advance(State(shapes, bodies, *candidates, workspace), law, drive, clock, 0, count)
            elapsed += time.process_time() - began
        if repeat:
            spent.append(elapsed / rounds / phases)
    return bodies.velocity[:, 2] / SPEED, bodies.velocity[:, 0] / thrown[:, 0], np.array(spent)


def impact_runs(steps=STEPS, phases=PHASES, repeats=REPEATS) -> pd.DataFrame:
    """Return rows for figures.work_precision: RMS error of one impact, and error of the mean over phases."""
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
                for quantity, simulated, true, reference_error in (
                    ("restitution", normal, exact.normal, exact.normal_error),
                    ("tangential restitution", tangential, exact.tangential, exact.tangential_error),
                ):
                    error = simulated - true
                    for average, value in ((ONE, np.sqrt((error**2).mean())), (MEAN, abs(error.mean()))):
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
                                "reference_error": reference_error,
                            }
                            for repeat, cpu in enumerate(spent)
                        ]
    return pd.DataFrame(rows)
