"""Impacts and creep of spheres in the compiled step, with Hertzian contacts and viscous friction.

All tests use one variant of the step: clamped, with viscous friction up to Coulomb's limit, and µ = 0 for no friction.
"""

import numpy as np
import pytest

from simcore.dem.energy import mechanical_energy
from simcore.dem.forces.hertz import HertzLaw
from simcore.dem.forces.viscous_friction import CAPPED
from simcore.dem.shapes.polyhedra import SPHERE
from simcore.scene.impact import DURATION, damping_number, impact_depth, restitution
from tests.helpers.stepped_bodies import SteppedBodies

R, DENSITY = 3e-3, 2650.0
MASS = 4.0 / 3.0 * np.pi * R**3 * DENSITY
MODULUS = 1e7
SIZE = float(np.cbrt(3.0 / (4.0 * np.pi * DENSITY)))


def hertz(damping_time=0.0, friction=0.0, sliding_time=1.0):
    ratio = 2.0 * (1.0 - 0.22) / (2.0 - 0.22)
    return HertzLaw(MODULUS, damping_time, 1.5 * ratio, np.sqrt(ratio), friction, 1.0 / sliding_time, SIZE)


def spheres(law, position, velocity, **drive):
    return SteppedBodies(
        SPHERE, law, [R] * 3, position, velocity, attractive=False, friction=False, hertz=True, sliding=CAPPED,
        density=DENSITY, **drive,
    )  # fmt: skip


def thrown_at_floor(law, velocity, dt, starts=None):
    """Throw spheres, one for each row of velocity (n, 3), at the floor and step until all have left.

    starts (n,) [m]: their gaps. It returns the SteppedBodies, the largest overlaps and the times of contact.
    """
    velocity = np.atleast_2d(np.asarray(velocity, float))
    n = len(velocity)
    position = np.column_stack([10.0 * R * np.arange(n), np.zeros(n), R + (np.zeros(n) if starts is None else starts)])
    thrown = spheres(law, position, velocity)
    deepest, steps, met = np.zeros(n), np.zeros(n), np.zeros(n, bool)
    for _ in range(100_000):
        thrown.advance(dt, 1)
        overlap = R - thrown.bodies.position[:, 2]
        deepest, steps = np.maximum(deepest, overlap), steps + (thrown.floor_force() > 0.0)
        met |= thrown.on_floor()
        if (met & (overlap < 0.0)).all():
            return thrown, deepest, steps * dt
    raise AssertionError("they did not leave the floor")


def duration(speed, mass=MASS, radius=R):
    return DURATION * impact_depth(MODULUS, mass, radius, speed) / speed


def phases(n, speed, dt):
    return (np.arange(n) + 0.5) / n * speed * dt


@pytest.mark.parametrize("speed", [0.01, 1.0])
def test_an_elastic_impact_lasts_goes_deep_and_returns_as_hertz_has_it(speed):
    time = duration(speed)
    dt = time / 400
    thrown, deepest, lasted = thrown_at_floor(hertz(), [[0.0, 0.0, -speed]] * 10, dt, phases(10, speed, dt))
    assert np.abs(lasted - time).max() <= 2.0 * dt  # a step at either end
    # The overlap is sampled up to half a step from the turning point, where its error is of second order.
    np.testing.assert_allclose(deepest, impact_depth(MODULUS, MASS, R, speed), rtol=3.0 / 400**2 * 10)
    # The step conserves a nearby energy, so errors at either end are of second order.
    np.testing.assert_allclose(thrown.bodies.velocity[:, 2], speed, rtol=10.0 / 400**2)


def test_two_spheres_meet_with_the_effective_mass_and_radius():
    speed = 0.5
    time = duration(speed, 0.5 * MASS, 0.5 * R)
    dt, steps = time / 400, 0
    pair = spheres(
        hertz(), [[0, 0, 1.0], [2.0 * R + 0.3 * speed * dt, 0, 1.0]], [[0.5 * speed, 0, 0], [-0.5 * speed, 0, 0]]
    )
    before = 0.5 * MASS * speed**2 / 2.0
    deepest = 0.0
    for _ in range(420):
        pair.advance(dt, 1)
        steps += int(pair.contacts.touching[0])
        deepest = max(deepest, pair.contacts.overlap[0] * pair.contacts.touching[0])
        if deepest > 0.0:
            # Springs store the lost kinetic energy, to second order in the step: (ω h)² = 1e-4 where it is stiffest.
            pair.advance(0.0, 1)
            now = mechanical_energy(pair.bodies, pair.candidates, pair.law, 0.0, dt)
            assert now.total == pytest.approx(before, rel=1e-4)
    assert steps * dt == pytest.approx(time, abs=2.0 * dt)
    assert deepest == pytest.approx(impact_depth(MODULUS, 0.5 * MASS, 0.5 * R, speed), rel=2e-4)
    np.testing.assert_allclose(pair.bodies.velocity[:, 0], [-0.5 * speed, 0.5 * speed], rtol=1e-4)


def test_restitution_falls_with_speed_as_kuwabara_and_kono_have_it():
    """The error is of first order in the step; the extrapolated value is that of the equation of motion."""
    damping_time = 2e-5
    for speed in (1e-3, 0.1, 10.0):
        expected = restitution(damping_number(damping_time, MODULUS, MASS, R, speed), attractive=False)
        found = []
        for steps in (400, 800):
            dt = duration(speed) / steps
            throws = [[0.0, 0.0, -speed]] * 20
            thrown, _, _ = thrown_at_floor(hertz(damping_time), throws, dt, phases(20, speed, dt))
            found.append(thrown.bodies.velocity[:, 2].mean() / speed)
        assert found[1] == pytest.approx(expected, abs=3.0 / 800)
        assert abs(found[1] - expected) < 0.7 * abs(found[0] - expected)
        # Richardson extrapolation leaves the square of the relative error.
        assert 2.0 * found[1] - found[0] == pytest.approx(expected, abs=2e-4)


def test_sliding_never_takes_more_than_coulombs_limit():
    """If a contact slides throughout, tangential and normal impulse have the ratio µ in every step and in total."""
    friction, speed, angle = 0.3, 1.0, np.radians(80.0)
    velocity = [[speed * np.sin(angle), 0.0, -speed * np.cos(angle)]]
    thrown, _, _ = thrown_at_floor(hertz(2e-5, friction, 1e-9), velocity, duration(0.1) / 100)
    lost = np.array(velocity[0]) - thrown.bodies.velocity[0]
    assert lost[0] == pytest.approx(-friction * lost[2], rel=1e-9)
    # The torque is R times that force.
    spin = thrown.bodies.angular_velocity[0]
    assert 0.4 * R * spin[1] == pytest.approx(lost[0], rel=2e-2)  # the arm is shorter by the overlap


def pulled(pull, friction, sliding_time, seconds):
    """Return the speed along x [m/s] of a sphere too heavy to turn that is pulled on the floor, as by a slope."""
    gravity = 6.0
    resting = (MASS * gravity / (MODULUS * np.sqrt(R))) ** (2.0 / 3.0)
    # The pull is shaking at its maximum during the whole run: step 1e12 is a quarter of its period.
    dt = 2e-5
    resting_on = spheres(
        hertz(1e-4, friction, sliding_time), [[0.0, 0.0, R - resting]], [0.0, 0.0, 0.0],
        gravity=gravity, shaking=pull, shaking_rate=0.5 * np.pi / (1e12 * dt),
    )  # fmt: skip
    resting_on.step = 10**12
    resting_on.bodies.inertia[:] *= 1e15
    resting_on.advance(dt, round(seconds / dt))
    assert resting_on.on_floor().all()
    return resting_on.bodies.velocity[0, 0]


def test_a_grain_on_a_slope_creeps_at_the_speed_of_the_viscous_law():
    """No static force holds it: a pull of a fifth of the limit gives a speed of a t_s, to 6e-6 after 12 t_s."""
    friction, sliding_time = 0.5, 5e-3
    for pull in (0.6, 1e-3):
        creep = pulled(pull, friction, sliding_time, 12.0 * sliding_time)
        assert creep == pytest.approx(pull * sliding_time, rel=1e-4)
    # Beyond the limit µ g = 3 m/s² the rest of the pull accelerates it; in its first step nothing slides yet.
    assert pulled(4.0, friction, 1e-6, 0.01) == pytest.approx((4.0 - 3.0) * 0.01 + 3.0 * 2e-5, rel=1e-6)


def test_a_sphere_that_slides_rolls_in_the_end():
    """It rolls at 5/7 of its speed at any friction, because no moment acts about the contact point."""
    gravity, speed = 6.0, 0.05
    resting = (MASS * gravity / (MODULUS * np.sqrt(R))) ** (2.0 / 3.0)
    slid = spheres(hertz(1e-4, 0.5, 1e-3), [[0, 0, R - resting]], [speed, 0.0, 0.0], gravity=gravity)
    slid.advance(2e-5, 3000)
    # The arm is shorter by the overlap, 4e-4 of the radius.
    assert slid.bodies.velocity[0, 0] == pytest.approx(5.0 / 7.0 * speed, rel=1e-3)
    assert slid.bodies.angular_velocity[0, 1] * (R - resting) == pytest.approx(slid.bodies.velocity[0, 0], rel=1e-3)
