"""Rotation, compared with closed forms of the free asymmetric top, and impacts that must keep energy and momentum."""

import numba
import numpy as np
import pytest

from simcore.dem.forces.spring_dashpot import contact_law
from simcore.dem.shapes.polyhedra import ELLIPSOID, SPHERE, unit_sphere
from simcore.dem.state.bodies import make_bodies, rotation_matrix
from simcore.dem.state.features import Features
from simcore.dem.step.motion import Quaternion, _cos_sin, derive_rotation, rotate_free, turn
from simcore.dem.vectors import Vec
from tests.helpers.stepped_bodies import SteppedBodies

CASE_A = {
    0.5: ((0.88071981, 0.47363764, 0.96188485), (0.93956818, 0.23003974, 0.05874113, 0.24666341)),
    1.0: ((0.57780247, 0.81617664, 0.88201582), (0.7790396, 0.35820927, 0.19582997, 0.47585086)),
    2.0: ((-0.21637837, 0.97630958, 0.8259983), (0.31471045, 0.23269407, 0.37018177, 0.8424822)),
    5.0: ((-0.16435043, -0.98640202, 0.8219917), (-0.89205938, 0.34571996, -0.24610292, 0.15537414)),
    10.0: ((-0.92107, 0.38939704, 0.97440066), (0.86144117, 0.10734076, 0.22094732, -0.44449898)),
    20.0: ((0.70984394, -0.70435898, 0.91357875), (0.58403954, -0.35261047, 0.20195319, -0.7026938)),
}
INERTIA = np.array([1.0, 2.0, 3.0])


@numba.njit(error_model="numpy")
def spin_freely(q, momentum, inertia, dt, n_steps):
    """Return the orientation after n_steps, and the largest relative deviation of the energy on the way."""
    w, x, y, z = q
    worst = 0.0
    energy0 = 0.0
    for step in range(n_steps + 1):
        r00, r01, r02 = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
        r10, r11, r12 = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
        r20, r21, r22 = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
        energy = 0.0
        energy += (r00 * momentum[0] + r10 * momentum[1] + r20 * momentum[2]) ** 2 / inertia[0]
        energy += (r01 * momentum[0] + r11 * momentum[1] + r21 * momentum[2]) ** 2 / inertia[1]
        energy += (r02 * momentum[0] + r12 * momentum[1] + r22 * momentum[2]) ** 2 / inertia[2]
        if step == 0:
            energy0 = energy
        worst = max(worst, abs(energy / energy0 - 1.0))
        if step == n_steps:
            break
        w, x, y, z = rotate_free(
            Quaternion(w, x, y, z),
            Vec(momentum[0], momentum[1], momentum[2]),
            Vec(inertia[0], inertia[1], inertia[2]),
            dt,
        )
    return np.array([w, x, y, z]), worst


def free_top(spin, time, n_steps, inertia=INERTIA):
    """Return body angular velocity, orientation and largest energy error after `time`, of a top that starts upright."""
    inertia = np.asarray(inertia, float)
    momentum = inertia * np.asarray(spin, float)
    q, worst = spin_freely(np.array([1.0, 0, 0, 0]), momentum, inertia, time / n_steps, n_steps)
    return rotation_matrix(q[None])[0].T @ momentum / inertia, q, worst


def attitude_error(q, reference):
    reference = np.asarray(reference) / np.linalg.norm(reference)
    return 2.0 * np.arccos(min(abs(q @ reference), 1.0))


def test_case_a_at_second_order():
    for time, (omega, q_true) in CASE_A.items():
        steps = round(time / 20.0 * 3200)
        found, q, _ = free_top((1, 0, 1), time, steps)
        # The error of this scheme is 2.7e-5 rad at t = 20 s with 3200 steps and grows with time at most linearly.
        assert attitude_error(q, q_true) < 6e-5
        np.testing.assert_allclose(found, omega, atol=6e-5)
    errors = [attitude_error(free_top((1, 0, 1), 20.0, n)[1], CASE_A[20.0][1]) for n in (400, 800, 1600)]
    assert errors[0] == pytest.approx(1.7e-3, rel=0.05)  # a separate program of this scheme
    np.testing.assert_allclose(np.log2(np.array(errors[:-1]) / errors[1:]), 2.0, atol=0.15)


def test_case_b_turns_over_in_time():
    """The intermediate axis flips every 19.552867099 s, and at t = 40 s ω is known."""
    reference = np.array([0.00201721, 1.00004796, 0.00824761])
    errors = [np.abs(free_top((0.01, 1, 0.01), 40.0, n)[0] - reference).max() for n in (800, 1600, 3200)]
    np.testing.assert_allclose(np.log2(np.array(errors[:-1]) / errors[1:]), 2.0, atol=0.15)
    # Errors grow over each half period, so 20000 steps per flip resolve four flips.
    for flips in range(1, 5):
        omega = free_top((0.01, 1, 0.01), flips * 19.552867099, flips * 20000)[0]
        assert omega[1] == pytest.approx((-1.0) ** flips, abs=1e-4)


# Inertia, spin, time, steps; ω and q at the end by DOP853 (rtol 1e-13), and the attitude error of this scheme
SLENDER_AND_FLAT = {
    "needle": (
        (0.01, 1, 1.0001), (100, 0, 1), 1.0, 800, (99.9999495701, -0.999306264286, 0.0398458429762),
        (0.866444901085, -0.195545242795, -0.318297220058, 0.331243371416), 1.1e-7,
    ),
    "plate": (
        (0.202, 0.2021, 0.4), (3, 0, 5), 10.0, 800, (0.85665535567, -2.87510457878, 4.99978906066),
        (-0.470576837594, 0.230806841514, -0.172098799788, 0.834066930732), 1.9e-2,
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", SLENDER_AND_FLAT)
def test_cases_c_and_d_at_second_order(case):
    inertia, spin, time, steps, omega, q_true, expected = SLENDER_AND_FLAT[case]
    errors = []
    for n in (steps, 2 * steps, 4 * steps):
        found, q, _ = free_top(spin, time, n, inertia)
        # Near one, arccos resolves angles only from about 1e-8; the vector part of q* q_true resolves all.
        errors.append(2.0 * np.linalg.norm(q - np.sign(q @ q_true) * np.asarray(q_true)))
        # ω turns with the body, so an attitude error of a radian changes it by its own length.
        assert np.abs(found - omega).max() < 2.0 * errors[-1] * np.linalg.norm(spin)
    assert errors[0] < 1.1 * expected
    np.testing.assert_allclose(np.log2(np.array(errors[:-1]) / errors[1:]), 2.0, atol=0.15)


def test_energy_does_not_drift_and_the_quaternion_stays_unit():
    """The scheme is symmetric: over 300 periods the deviation is no larger than over three."""
    period = 6.935667541
    _, _, few = free_top((1, 0, 1), 3 * period, 3 * 200)
    _, q, many = free_top((1, 0, 1), 300 * period, 300 * 200)
    assert 0.0 < many < 1.02 * few
    assert abs(np.linalg.norm(q) - 1.0) < 1e-15
    energies = []
    momentum = INERTIA * [1.0, 0.0, 1.0]
    q = np.array([1.0, 0.0, 0.0, 0.0])
    for _ in range(300):
        q, _ = spin_freely(q, momentum, INERTIA, period / 200, 200)
        energies.append(((rotation_matrix(q[None])[0].T @ momentum) ** 2 / INERTIA).sum() / 4.0)
    assert abs(np.polyfit(np.arange(300), energies, 1)[0]) < 1e-7  # per period
    _, q, _ = free_top((1, 0, 1), 5000.0, 1_000_000)
    assert abs(np.linalg.norm(q) - 1.0) < 1e-12


@pytest.mark.parametrize("angle", [0.1, 0.3, 0.5, 1.0, 2.0])
def test_high_spin_does_not_blow_up(angle):
    """With |ω| dt up to half a radian, the energy error does not grow in 10^5 steps and is of order angle².

    From about one radian on, a needle's energy changes irregularly (steps of packings turn by 1e-3). As L is constant
    to the bit, it cannot leave [L²/2 I3, L²/2 I1].
    """
    rng = np.random.default_rng(3)
    for inertia in np.array([(1, 2, 3), (0.01, 1, 1.0001), (0.202, 0.2021, 0.4), (1, 1, 1)]):
        spin = rng.standard_normal(3)
        spin *= angle / np.linalg.norm(spin)
        _, _, early = free_top(spin, 1000.0, 1000, inertia)
        _, q, late = free_top(spin, 100_000.0, 100_000, inertia)
        assert abs(np.linalg.norm(q) - 1.0) < 1e-15
        if angle <= 0.5:
            assert early < angle**2
            assert late <= 1.2 * early + 1e-12
        momentum = inertia * spin
        assert late <= momentum @ momentum / inertia.min() / (momentum @ spin) * (1.0 + 1e-12)


def test_the_series_of_cosine_and_sine_goes_over_smoothly():
    """On either side of 0.05, the limit of the series, both agree with numpy to two units in the last place."""
    angles = np.concatenate([0.05 + np.arange(-50, 51) * np.spacing(0.05), np.linspace(-0.06, 0.06, 1001)])
    found = np.array([_cos_sin(angle) for angle in angles])
    assert np.abs(found[:, 0] - np.cos(angles)).max() <= 2 * np.spacing(0.5)
    assert (np.abs(found[:, 1] - np.sin(angles)) <= 2 * np.spacing(np.abs(np.sin(angles)))).all()


def test_no_point_turns_farther_than_turned():
    """The neighbour list relies on `turned`: it is at least the path of any point, and exceeds it only slightly."""
    rng = np.random.default_rng(4)
    n, steps = 50, 200
    scale = rng.uniform(0.1, 1.0, (n, 3))
    spins = rng.standard_normal((n, 3)) * 10.0 ** rng.uniform(-4, 0.3, (n, 1))  # up to some radians a step of 1
    still = np.zeros((n, 3))
    bodies = make_bodies(
        [unit_sphere()], np.zeros(n, int), scale, still, rng.standard_normal((n, 4)), still, spins, 1.0
    )
    points = rng.standard_normal((n, 2000, 3))
    points *= bodies.radius[:, None, None] / np.linalg.norm(points, axis=2, keepdims=True)
    way, farthest = np.zeros((n, 2000)), np.zeros(n)
    for _ in range(steps):
        before, turned = bodies.rotation.copy(), bodies.turned.copy()
        for i in range(n):
            turn(bodies, i, 1.0, 1.0)
        chords = np.linalg.norm(np.einsum("nij,nkj->nki", bodies.rotation - before, points), axis=2)
        way += chords
        farthest += chords.max(axis=1)
        assert (chords.max(axis=1) <= bodies.turned - turned).all()
    assert (way.max(axis=1) <= bodies.turned).all()
    # One of 2000 points is within 0.1 rad of the circle that moves farthest.
    assert (bodies.turned <= farthest * 1.002 / np.cos(0.1)).all()


def test_spheres_carry_no_rotation():
    """The orientation of a sphere has no effect: there is no array for it, and the angular velocity is L / I."""
    bodies = make_bodies(
        [unit_sphere()],
        [0],
        [[1.0] * 3],
        [[0.0] * 3],
        [[1.0, 0, 0, 0]],
        [[0.0] * 3],
        [[3.0, 1.0, 2.0]],
        1.0,
        features=Features(SPHERE, True),
    )
    empty = [name for name in bodies._fields if len(getattr(bodies, name)) == 0]
    assert empty == ["orientation", "turned", "listed_turned", "rotation", "form_matrix", "effective_contacts"]
    still = SteppedBodies(SPHERE, contact_law(1.0, 1e-3, 0.22, 0.0), [1.0] * 3, [0, 0, 5.0], [0, 0, 0], [3.0, 1.0, 2.0])
    before = [getattr(still.bodies, name).copy() for name in empty]
    still.advance(1e-3, 100)  # this one has the arrays, and no step touches them
    for name, value in zip(empty, before, strict=True):
        np.testing.assert_array_equal(getattr(still.bodies, name), value)


@numba.njit(error_model="numpy")
def turn_repeatedly(bodies, dt, n_steps):
    for _ in range(n_steps):
        turn(bodies, 0, dt, 1.0)


def test_a_free_body_keeps_its_angular_momentum_to_the_bit():
    spin = [[3.0, -1.0, 2.0]]
    bodies = make_bodies(
        [unit_sphere()], [0], [[1, 0.7, 0.5]], [[0.0] * 3], [[0.3, 0.5, -0.7, 0.2]], [[0.0] * 3], spin, 1.0
    )
    derive_rotation(bodies, 0)
    before = bodies.angular_momentum.copy()
    energy = (bodies.angular_momentum * bodies.angular_velocity).sum()
    turn_repeatedly(bodies, 1e-3, 100_000)
    assert (bodies.angular_momentum == before).all()
    # ω from L and the orientation: rotation matrix and quaternion agree
    np.testing.assert_allclose(bodies.rotation[0], rotation_matrix(bodies.orientation)[0], atol=1e-15)
    # The deviation of this scheme is (ω dt)² times a number of order one.
    assert (bodies.angular_momentum * bodies.angular_velocity).sum() == pytest.approx(energy, rel=(4e-3) ** 2)
    assert abs(np.linalg.norm(bodies.orientation) - 1.0) < 1e-15


def off_centre(dt, restitution=1.0, friction=0.0):
    """Return two ellipsoids after an off-centre impact without gravity, and their energy and momenta before it."""
    law = contact_law(restitution, 1e-2, 0.22, friction)
    q = np.array([[0.9, 0.1, 0.3, -0.2], [0.5, -0.5, 0.6, 0.1]])
    pair = SteppedBodies(
        ELLIPSOID,
        law,
        [[1.0, 0.75, 0.5], [0.8, 0.6, 0.7]],
        [[0, 0, 50.0], [1.55, 0.35, 50.2]],
        [[0, 0, 0], [-1.0, 0, 0]],
        [[0.3, -0.2, 0.5], [0.1, 0.4, -0.3]],
        orientation=q / np.linalg.norm(q, axis=1, keepdims=True),
        skin=1.0,
    )
    before = pair.energy(), momenta(pair)
    met = 0
    for _ in range(60):
        pair.advance(dt, round(0.01 / dt))
        met += int((pair.contacts.touching > 0).any())
    assert met > 0 and not (pair.contacts.touching > 0).any(), "they have not met, or not parted"
    return pair, before


def momenta(pair):
    b = pair.bodies
    linear = (b.mass[:, None] * b.velocity).sum(axis=0)
    angular = (np.cross(b.position, b.mass[:, None] * b.velocity) + b.angular_momentum).sum(axis=0)
    return linear, angular


def test_an_elastic_off_centre_impact_keeps_its_energy():
    """A normal that is not that of both surfaces would do work. The remaining error is that of the time step."""
    errors = []
    for n in (40, 80, 160, 320):
        pair, (energy, _) = off_centre(0.01 / n)
        errors.append(abs(pair.energy() / energy - 1.0))
    assert pair.bodies.velocity[0, 0] < -0.1, "hardly an impact"
    # Semi-implicit Euler keeps a nearby energy, so first-order errors of touch and release cancel up to the phase of
    # first touch. The error has a bound that falls with dt, but no clean order.
    assert errors[0] < 1e-2
    assert errors[3] < 2e-3
    assert np.mean(errors[2:]) < 0.5 * np.mean(errors[:2])


def test_momentum_is_kept_to_rounding_with_friction():
    pair, (_, (linear, angular)) = off_centre(0.01 / 40, restitution=0.1, friction=0.5)
    after_linear, after_angular = momenta(pair)
    mass = pair.bodies.mass.sum()
    np.testing.assert_allclose(after_linear, linear, atol=1e-13 * mass)
    # Forces act in one point, but semi-implicit Euler moves the bodies between torque and cross product by v dt,
    # parallel to p: nothing is lost. Levers are 50.
    np.testing.assert_allclose(after_angular, angular, atol=1e-11 * mass)
    assert pair.energy() < 0.999 * (0.5 * pair.bodies.mass[1] + 1.0)
