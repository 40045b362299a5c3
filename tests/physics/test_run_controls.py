"""Gravity, damping and shaking of Rettinger et al. (2022) against closed forms."""

import numpy as np
import pytest

from simcore.dem.forces.spring_dashpot import contact_law
from simcore.dem.from_scene import compose
from simcore.dem.shapes.polyhedra import ELLIPSOID, SPHERE
from simcore.scene.scene import Material, Shaking
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve
from tests.helpers.stepped_bodies import SteppedBodies

DT = 5e-6
LAW = contact_law(0.1, 2e-4, 0.22, 0.5)
GRAVITY = Material(2650.0, 1000.0, 9.81, 0.1, 0.22, 0.5, "attractive").effective_gravity


def test_gravity_less_buoyancy():
    assert pytest.approx(6.108113208, abs=5e-10) == GRAVITY


def test_free_fall():
    """With semi-implicit Euler v is exact, and z is ahead by g t dt / 2."""
    grain = SteppedBodies(SPHERE, LAW, [3e-3] * 3, [[0, 0, 10.0]], [0.1, 0, -1.0], gravity=GRAVITY, skin=500.0)
    grain.advance(DT, 40000)
    t = 40000 * DT
    # Each of 40 000 additions has a rounding error of eps.
    np.testing.assert_allclose(grain.bodies.velocity[0], [0.1, 0.0, -1.0 - GRAVITY * t], rtol=40000 * 2.3e-16)
    expected = 10.0 - t - 0.5 * GRAVITY * t * (t + DT)
    assert grain.bodies.position[0, 2] == pytest.approx(expected, rel=1e-11)
    assert grain.bodies.position[0, 0] == pytest.approx(0.1 * t, rel=1e-11)


def test_terminal_speed_of_damping():
    factor = 1e-3**DT
    assert factor == pytest.approx(0.9999654618200617, abs=1e-16)
    grain = SteppedBodies(
        SPHERE, LAW, [3e-3] * 3, [[0, 0, 10.0]], [0.0, 0, -0.88], gravity=GRAVITY, damping=factor, skin=500.0
    )
    grain.advance(DT, 400_000)
    # A step accelerates, then damps; 1e-3^2 of the initial deviation of 0.004 m/s are left.
    assert -grain.bodies.velocity[0, 2] == pytest.approx(0.884224683, abs=1e-8)


def test_damping_takes_spin_as_it_takes_speed():
    factor = 1e-3**DT
    law = LAW._replace(friction=0.0)
    for kind, scale in ((SPHERE, [3e-3] * 3), (ELLIPSOID, [3e-3, 2e-3, 1e-3])):
        grain = SteppedBodies(kind, law, scale, [[0, 0, 1.0]], [0.1, 0, 0], [0, 0, 7.0], damping=factor)
        grain.advance(DT, 2000)
        assert grain.bodies.velocity[0, 0] == pytest.approx(0.1 * 1e-3 ** (2000 * DT), rel=1e-11)
        assert grain.bodies.angular_velocity[0, 2] == pytest.approx(7.0 * 1e-3 ** (2000 * DT), rel=1e-11)


def test_shaking_of_a_free_grain():
    """The peak acceleration is A (2π/T)², and the grain drifts: x(t) = A (ωt − sin ωt)."""
    shaking = Shaking(3e-4, 0.025, 1.0)
    assert shaking.acceleration == pytest.approx(18.94964, abs=1e-5)
    amplitude, rate = shaking.amplitude, shaking.rate
    assert amplitude * rate == pytest.approx(0.0753982, abs=1e-7)
    errors = []
    for dt in (2e-5, 1e-5):
        grain = SteppedBodies(
            SPHERE, LAW, [3e-3] * 3, [[0, 0, 10.0]], [0, 0, 0],
            shaking=shaking.acceleration, shaking_rate=rate, skin=500.0,
        )  # fmt: skip
        n = round(0.06 / dt)
        grain.advance(dt, n)
        t = n * dt
        errors.append(abs(grain.bodies.position[0, 0] - amplitude * (rate * t - np.sin(rate * t))))
        assert grain.bodies.position[0, 1] == 0.0
    # The positions are of second order in the time step.
    assert errors[0] < 0.01 * amplitude * rate * 2e-5
    assert errors[1] == pytest.approx(0.25 * errors[0], rel=0.01)


def test_grains_are_shaken_from_the_first_on_though_shaking_ends_with_the_last():
    """The duration, also 0, counts from the last insertion, as in Rettinger et al.; amplitude 0 means no shaking."""

    def shaken(**shaking):
        spheres = {
            "domain": {"width": "25 mm", "height": "0.2 m"},
            "sizes": {"bounds": ["5.6 mm", "8 mm"], "mass_fractions": [1.0]},
            "shapes": {"kind": "sphere"},
            "amount": {"grains": 30},
        }
        return compose(set_up(resolve({**spheres, "shaking": shaking}), None).scene).features.shaken

    assert shaken(duration="0 s") and shaken(duration="1 s")
    assert not shaken(duration="0 s", amplitude="0 m") and not shaken(duration="1 s", amplitude="0 m")
