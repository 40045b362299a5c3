"""Free rotation of a top, a needle and a plate: error of attitude and energy after some turns, against the time step.

Our scheme is `rotate_free` of the core. It is compared with textbook schemes, which are implemented here and used for
nothing else. All start from the angular momentum in world axes and a unit quaternion from body to world axes.

A free body favours Runge-Kutta. In a bed, the torque is constant within a step because contacts are evaluated once;
Runge-Kutta would need four evaluations to retain its order. Our scheme conserves the angular momentum exactly, and its
energy does not drift.

Reference: Jacobi's elliptic functions give the angular velocity in body axes, and a quadrature gives the precession
about the angular momentum. Its error is its distance from an integration of the equations of motion at 1e-13.
"""

import time
from typing import NamedTuple

import numba
import numpy as np
import pandas as pd
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from scipy.special import ellipj

from simcore.dem.step.motion import Quaternion, rotate_free
from simcore.dem.vectors import Vec

REPEATS = 5
TIMED_STEPS = 20_000  # minimum number of steps in a measurement of CPU time: some milliseconds
TURN_STEPS = (12, 25, 50, 100, 200, 400, 800, 1600, 3200, 6400, 12800)  # per turn
NODES = 24  # of the quadrature, in each of its intervals


class Top(NamedTuple):
    """A free body that starts with its axes along the world's."""

    inertia: tuple  # (3,) [kg m²], ascending
    spin: tuple  # (3,) [1/s], without a component about the second axis
    duration: float  # [s]


# Cases A, C and D of the verification references.
TOPS = {
    "top": Top((1.0, 2.0, 3.0), (1.0, 0.0, 1.0), 20.0),
    "needle": Top((0.01, 1.0, 1.0001), (100.0, 0.0, 1.0), 1.0),
    "plate": Top((0.202, 0.2021, 0.4), (3.0, 0.0, 5.0), 10.0),
}
# A grain of a shaken bed turns by about 1e-3 rad per step at the default contact time: 2 π / 1e-3 steps per turn.
DEFAULT = ("symmetric splitting (ours)", 6400)

# Not cached: the disk cache detects changes only of the file itself, but these functions call the core.
_compiled = numba.njit(error_model="numpy")


# -- reference ----------------------------------------------------------------------------------------------


def body_spin(top: Top, t):
    """Return the angular velocity in body axes (n, 3) at times t (n,) [s]: Jacobi's solution without initial spin about
    the second axis.
    """
    (i1, i2, i3), (w1, _, w3) = top.inertia, top.spin
    twice_energy = i1 * w1**2 + i3 * w3**2
    squared_momentum = (i1 * w1) ** 2 + (i3 * w3) ** 2
    about_third = squared_momentum > i2 * twice_energy
    if not about_third:  # the same solution with the first and the third axis exchanged
        i1, i3, w1, w3 = i3, i1, w3, w1
    ratio = (i3 - i2) * (squared_momentum - twice_energy * i1) / (i1 * i2 * i3)
    modulus = (i2 - i1) * (twice_energy * i3 - squared_momentum) / (i3 - i2) / (squared_momentum - twice_energy * i1)
    second = np.sqrt((twice_energy * i3 - squared_momentum) / (i2 * (i3 - i2)))
    sn, cn, dn, _ = ellipj(np.sqrt(ratio) * np.asarray(t), modulus)
    # The sign of the second component follows from ω2' = (I3 − I1) ω1 ω3 / I2.
    second *= np.sign((top.inertia[2] - top.inertia[0]) * w1 * w3)
    spin = np.stack([w1 * cn, second * sn, w3 * dn], axis=-1)
    return spin if about_third else spin[..., ::-1]


def reference_attitude(top: Top):
    """Return the orientation (4,) at the end, and a bound of its error [rad]."""
    exact, integrated = _attitude_in_closed_form(top), _attitude_by_integration(top)
    rounding = np.finfo(float).eps * np.linalg.norm(top.spin) * top.duration  # rounding of the total angle
    return exact, max(attitude_error(exact, integrated), rounding)


def _attitude_in_closed_form(top):
    inertia = np.array(top.inertia)
    momentum = np.linalg.norm(inertia * top.spin)
    about = 2 if momentum**2 > inertia[1] * (inertia * np.square(top.spin)).sum() else 0
    others = [axis for axis in range(3) if axis != about]
    # Rate of precession about the momentum: L (2 T − L_a² / I_a) / (L² − L_a²), where a is the axis of steady rotation.
    edges = np.linspace(0.0, top.duration, 401)
    x, weight = np.polynomial.legendre.leggauss(NODES)
    half = 0.5 * np.diff(edges)
    t = 0.5 * (edges[1:] + edges[:-1])[:, None] + half[:, None] * x
    spin = body_spin(top, t.ravel()).reshape(*t.shape, 3)
    rate = momentum * (inertia * spin**2)[..., others].sum(axis=-1) / ((inertia * spin)[..., others] ** 2).sum(axis=-1)
    precession = float((half[:, None] * weight * rate).sum())
    start, end = (_frame(inertia * body_spin(top, at), about) for at in (0.0, top.duration))
    about_momentum = Rotation.from_rotvec([0.0, 0.0, precession]).as_matrix()
    return Rotation.from_matrix(start.T @ about_momentum @ end).as_quat(scalar_first=True)


def _frame(momentum, about):
    """Return a frame in body axes as rows: the third along the momentum, the first normal to it and to axis `about`."""
    third = momentum / np.linalg.norm(momentum)
    first = np.cross(np.eye(3)[about], third)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(third, first), third])


def _attitude_by_integration(top):
    inertia = np.array(top.inertia)

    def slope(_, y):
        w, (a, b, c, d) = y[:3], y[3:]
        turning = 0.5 * np.array(
            [-b * w[0] - c * w[1] - d * w[2], a * w[0] + c * w[2] - d * w[1],
             a * w[1] + d * w[0] - b * w[2], a * w[2] + b * w[1] - c * w[0]]
        )  # fmt: skip
        return np.concatenate([np.cross(inertia * w, w) / inertia, turning])

    solution = solve_ivp(slope, (0, top.duration), [*top.spin, 1, 0, 0, 0], method="DOP853", rtol=1e-13, atol=1e-15)
    return solution.y[3:, -1] / np.linalg.norm(solution.y[3:, -1])


def attitude_error(first, second) -> float:
    """Return the angle [rad] between two orientations (4,)."""
    a, b = (Rotation.from_quat(q, scalar_first=True) for q in (first, second))
    return float((a.inv() * b).magnitude())


# -- schemes ------------------------------------------------------------------------------------------------
# step(q, momentum, inertia, dt) -> (q, momentum): Quaternion, and Vec of the angular momentum in world axes.


@_compiled
def _rotated(q, v):
    """Return vector v of body axes in world axes."""
    w, x, y, z = q
    a, b, c = v
    s, t, u = 2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)
    return Vec(a + w * s + y * u - z * t, b + w * t + z * s - x * u, c + w * u + x * t - y * s)


@_compiled
def _spin_of(q, momentum, inertia):
    """Return the angular velocity in body axes."""
    turned = _rotated(Quaternion(q.w, -q.x, -q.y, -q.z), momentum)
    return Vec(turned.x / inertia.x, turned.y / inertia.y, turned.z / inertia.z)


@_compiled
def _momentum_of(q, spin, inertia):
    """Return the momentum in world axes of an angular velocity in body axes."""
    return _rotated(q, Vec(inertia.x * spin.x, inertia.y * spin.y, inertia.z * spin.z))


@_compiled
def _product(p, q):
    """Return the product of two quaternions."""
    w, x, y, z = p
    s, a, b, c = q
    return Quaternion(
        w * s - x * a - y * b - z * c, w * a + x * s + y * c - z * b,
        w * b + y * s + z * a - x * c, w * c + z * s + x * b - y * a,
    )  # fmt: skip


@_compiled
def _unit(q):
    """Return the quaternion normalised to length one."""
    w, x, y, z = q
    norm = np.sqrt(w * w + x * x + y * y + z * z)
    return Quaternion(w / norm, x / norm, y / norm, z / norm)


@_compiled
def _turned(q, v):
    """Return the orientation turned by the rotation vector v in body axes."""
    a, b, c = v
    angle = np.sqrt(a * a + b * b + c * c)
    s = 0.5 if angle < 1e-8 else np.sin(0.5 * angle) / angle
    return _product(q, Quaternion(np.cos(0.5 * angle), s * a, s * b, s * c))


@_compiled
def _ours(q, momentum, inertia, dt):
    w, x, y, z = rotate_free(q, momentum, inertia, dt)
    return Quaternion(w, x, y, z), momentum


@_compiled
def _euler_slope(spin, inertia):
    """Return the rate of the angular velocity in body axes."""
    a, b, c = spin
    i1, i2, i3 = inertia
    return Vec((i2 - i3) / i1 * b * c, (i3 - i1) / i2 * c * a, (i1 - i2) / i3 * a * b)


@_compiled
def _attitude_slope(q, spin):
    """Return the rate of the orientation."""
    return _product(q, Quaternion(0.0, 0.5 * spin.x, 0.5 * spin.y, 0.5 * spin.z))


@_compiled
def _stepped(v, h, rate):
    """Return the vector after h [s] at a rate."""
    return Vec(v.x + h * rate.x, v.y + h * rate.y, v.z + h * rate.z)


@_compiled
def _attitude_stepped(q, h, rate):
    """Return the quaternion after h [s] at a rate, not normalised."""
    return Quaternion(q.w + h * rate.w, q.x + h * rate.x, q.y + h * rate.y, q.z + h * rate.z)


@_compiled
def _explicit_euler(q, momentum, inertia, dt):
    """Advance spin and quaternion with rates before the step; the quaternion is normalised."""
    spin = _spin_of(q, momentum, inertia)
    after = _unit(_attitude_stepped(q, dt, _attitude_slope(q, spin)))
    return after, _momentum_of(after, _stepped(spin, dt, _euler_slope(spin, inertia)), inertia)


@_compiled
def _momentum_euler(q, momentum, inertia, dt):
    """Keep the momentum, and turn the orientation by its angular velocity before the step."""
    spin = _spin_of(q, momentum, inertia)
    return _turned(q, Vec(dt * spin.x, dt * spin.y, dt * spin.z)), momentum


@_compiled
def _leapfrog(q, momentum, inertia, dt):
    """Advance by the predictor-corrector of Zhao & van Wachem (2013), with the spin in mid-step, in body axes."""
    spin = _spin_of(q, momentum, inertia)
    middle = _stepped(spin, 0.5 * dt, _euler_slope(spin, inertia))
    after = _unit(_turned(q, Vec(dt * middle.x, dt * middle.y, dt * middle.z)))
    return after, _momentum_of(after, _stepped(spin, dt, _euler_slope(middle, inertia)), inertia)


@_compiled
def _runge_kutta(q, momentum, inertia, dt):
    """Advance spin and quaternion by the classical fourth-order scheme; the quaternion is normalised."""
    spin = _spin_of(q, momentum, inertia)
    attitude_sum, attitude_rate = Quaternion(0.0, 0.0, 0.0, 0.0), Quaternion(0.0, 0.0, 0.0, 0.0)
    spin_sum, spin_rate = Vec(0.0, 0.0, 0.0), Vec(0.0, 0.0, 0.0)
    for stage in range(4):
        h = 0.0 if stage == 0 else (dt if stage == 3 else 0.5 * dt)
        spin_there = _stepped(spin, h, spin_rate)
        attitude_rate = _attitude_slope(_attitude_stepped(q, h, attitude_rate), spin_there)
        spin_rate = _euler_slope(spin_there, inertia)
        weight = dt / 6.0 if stage == 0 or stage == 3 else dt / 3.0
        attitude_sum = _attitude_stepped(attitude_sum, weight, attitude_rate)
        spin_sum = _stepped(spin_sum, weight, spin_rate)
    after = _unit(_attitude_stepped(q, 1.0, attitude_sum))
    return after, _momentum_of(after, _stepped(spin, 1.0, spin_sum), inertia)


def _make_run(step):
    @_compiled
    def run(momentum, inertia, dt, n_steps):
        q, momentum, inertia = Quaternion(1.0, 0.0, 0.0, 0.0), Vec(*momentum), Vec(*inertia)
        for _ in range(n_steps):
            q, momentum = step(q, momentum, inertia, dt)
        spin = _spin_of(q, momentum, inertia)
        energy = inertia.x * spin.x * spin.x + inertia.y * spin.y * spin.y + inertia.z * spin.z * spin.z
        return (q.w, q.x, q.y, q.z), 0.5 * energy

    return run


SCHEMES = {
    "symmetric splitting (ours)": _make_run(_ours),
    "explicit Euler": _make_run(_explicit_euler),
    "Euler on the momentum": _make_run(_momentum_euler),
    "leapfrog (Zhao & van Wachem)": _make_run(_leapfrog),
    "Runge-Kutta 4": _make_run(_runge_kutta),
}
ORDERS = {
    "symmetric splitting (ours)": 2,
    "explicit Euler": 1,
    "Euler on the momentum": 1,
    "leapfrog (Zhao & van Wachem)": 2,
    "Runge-Kutta 4": 4,
}


def rotation_runs(turn_steps=TURN_STEPS, repeats=REPEATS, tops=None) -> pd.DataFrame:
    """Return rows for figures.work_precision: error of attitude [rad] and relative error of energy after all turns.

    turn_steps: numbers of steps in the time of one turn at the initial speed. cpu_s is the time of one turn. A scheme
    that diverges (the energy is not finite, or its relative error exceeds 1) has no row.
    """
    rows = []
    for case in tops or TOPS:
        top = TOPS[case]
        exact, exact_error = reference_attitude(top)
        inertia = tuple(map(float, top.inertia))
        momentum = tuple(float(i * w) for i, w in zip(top.inertia, top.spin, strict=True))
        energy = 0.5 * sum(i * w**2 for i, w in zip(top.inertia, top.spin, strict=True))
        turns = np.linalg.norm(top.spin) * top.duration / (2.0 * np.pi)
        for method, run in SCHEMES.items():
            run(momentum, inertia, 0.0, 1)  # compile before the measurement
            for per_turn in turn_steps:
                count = round(per_turn * turns)
                rounds = -(-TIMED_STEPS // count)
                spent = []
                for _ in range(repeats):
                    began = time.process_time()
                    for _ in range(rounds):
                        attitude, ended = run(momentum, inertia, top.duration / count, count)
                    spent.append((time.process_time() - began) / rounds / turns)
                if not np.isfinite(ended) or abs(ended / energy - 1.0) > 1.0:
                    continue
                for quantity, error, reference_error in (
                    ("attitude", attitude_error(exact, np.array(attitude)), exact_error),
                    ("energy", abs(ended / energy - 1.0), np.finfo(float).eps),
                ):
                    rows += [
                        {
                            "case": case,
                            "quantity": quantity,
                            "method": method,
                            "setting": per_turn,
                            "default": (method, per_turn) == DEFAULT,
                            "repeat": repeat,
                            "error": error,
                            "cpu_s": cpu,
                            "reference_error": reference_error,
                        }
                        for repeat, cpu in enumerate(spent)
                    ]
    return pd.DataFrame(rows)
