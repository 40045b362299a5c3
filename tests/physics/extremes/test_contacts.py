"""Single contacts at extreme contact times, restitutions, frictions, depths and speeds, compared with closed forms."""

import numpy as np
import pytest

from simcore.dem.from_scene import compose
from tests.helpers.hand_placed_bodies import (
    UNDAMPED,
    floor_force,
    make_scene,
    pair_overlap,
    place_bodies,
    run_watched,
    total_energy,
)

R = 3e-3
GRAVITY = 9.81


@pytest.mark.parametrize("contact_time", [2e-6, 2e-5, 2e-4, 2e-3, 1e-2])
def test_a_column_of_spheres_stands_at_its_static_overlaps(contact_time):
    """Static overlaps are the weight above over k m_eff, for contact times from 2 µs to 10 ms.

    Rounding limits them to 1e-16 m: positions of 0.03 m are rounded to 4e-18 m, each step adds half of that, and a
    contact that sticks keeps the errors of some 40 steps. The slowest mode decays as exp(-t / 2 T_c).
    """
    made = make_scene(numerics={"contact_time": contact_time}, convergence={"interval": 10 * contact_time})
    height = R * (1.0 + 2.0 * np.arange(5))
    column = place_bodies(made, R, np.column_stack([0 * height, 0 * height, height]))
    run_watched(column, 600 * contact_time, damped=True)
    mass, stiffness = column.bodies.mass, compose(made).law.stiffness
    above = GRAVITY * np.cumsum(mass[::-1])[::-1]
    expected = above / (stiffness * np.where(np.arange(5) == 0, mass, 0.5 * mass))
    found = [R - column.bodies.position[0, 2], *(pair_overlap(column, k, k + 1) for k in range(4))]
    np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-16)
    assert floor_force(column) == pytest.approx(above[0], rel=1e-6)
    assert not column.bodies.position[:, :2].any()  # by symmetry there is no lateral motion at all


@pytest.mark.parametrize("restitution", [0.01, 0.1, 0.5, 0.9, 1.0])
def test_a_bouncing_sphere_gains_nothing(restitution):
    """The speed after the first impact is right to the error of e, and in about twenty impacts the energy never rises.

    At 40 steps the error of e is 0.010 (tests/physics/test_contact_law.py); an elastic contact keeps its energy to a
    share of (ω dt)² = (π / 40)² (tests/physics/test_energy.py).
    """
    contact_time = 1e-4
    made = make_scene(
        material={"restitution": restitution}, numerics={"contact_time": contact_time}, convergence={"interval": 1e-3}
    )
    speed = 0.1
    ball = place_bodies(made, R, [0, 0, R], velocity=[0, 0, -speed])
    run_watched(ball, 3 * contact_time)
    assert ball.bodies.velocity[0, 2] == pytest.approx(restitution * speed, abs=0.0105 * speed + GRAVITY * 3e-4)
    start = total_energy(ball)
    energies = run_watched(ball, 20 * 2 * speed / GRAVITY)
    slack = (np.pi / 40) ** 2 * 0.5 * ball.bodies.mass[0] * speed**2
    assert (energies - start).max() < slack * (1.0 if restitution == 1.0 else 1e-3)
    if restitution < 0.6:
        assert abs(R - ball.bodies.position[0, 2] - GRAVITY / compose(made).law.stiffness) < 1e-6 * R
    if restitution == 1.0:
        assert (energies - start).min() > -slack


@pytest.mark.parametrize("friction", [0.0, 0.01, 0.5, 10.0])
def test_a_sliding_sphere_ends_rolling_whatever_the_friction(friction):
    """Angular momentum about the contact is constant: u = 5/7 u0 for any µ > 0, and u = u0 without friction.

    The contact is half an overlap inside the sphere, so the arm is shorter by that.
    """
    contact_time, speed = 1e-4, 0.02
    made = make_scene(material={"friction": max(friction, 1e-300)}, numerics={"contact_time": contact_time})
    sunk = GRAVITY / compose(made).law.stiffness
    ball = place_bodies(made, R, [0, 0, R - sunk], velocity=[speed, 0, 0])
    slips = 2.0 * speed / (7.0 * friction * GRAVITY) if friction > 0.0 else 0.1
    run_watched(ball, max(1.5 * slips, 100 * contact_time))
    expected = 5.0 / 7.0 * speed if friction > 0.0 else speed
    assert ball.bodies.velocity[0, 0] == pytest.approx(expected, rel=2.0 * sunk / R + 1e-6)
    turns = expected / R if friction > 0.0 else 0.0
    assert ball.bodies.angular_velocity[0, 1] == pytest.approx(turns, rel=2.0 * sunk / R + 1e-6, abs=1e-9)


@pytest.mark.parametrize("contact_time", [2e-4, 1e-2])
@pytest.mark.parametrize("share", [0.5, 1.0, 2.0])
def test_spheres_that_start_with_deep_overlaps_separate(contact_time, share):
    """Spheres separate that overlap by half a radius, by a radius, or entirely.

    Elastic spheres would separate at π/T_c times the overlap: 50 m/s at the contact time of Rettinger et al., more than
    in any fall.
    """
    made = make_scene(numerics={"contact_time": contact_time}, domain={"height": 0.1})
    distance = R * (2.0 - share)
    pair = place_bodies(made, R, [[0, 0, R], [distance, 0, R]])
    energies = run_watched(pair, 100 * contact_time + 0.3, damped=True)
    assert np.isfinite(pair.bodies.position).all()
    assert np.linalg.norm(pair.bodies.position[1] - pair.bodies.position[0]) >= 2.0 * R * (1.0 - 1e-3)
    assert energies[-1] < energies[0]


@pytest.mark.parametrize("contact_time", [2e-4, 1e-3])
def test_a_drop_from_ten_metres(contact_time):
    """A sphere lands at √(2 g h), sinks in by 0.129 v T_c, rebounds, and comes to rest at its static overlap.

    It sinks in by 0.4 mm at the contact time of Rettinger et al. and by 1.8 mm at 1 ms.
    """
    height = 10.0
    made = make_scene(domain={"height": 12.0}, numerics={"contact_time": contact_time})
    ball = place_bodies(made, R, [0, 0, R + height])
    falls = np.sqrt(2.0 * height / GRAVITY)
    ball.advance(round((falls - 2 * contact_time) / ball.dt), UNDAMPED)
    speed, deepest = np.sqrt(2.0 * GRAVITY * height), 0.0
    for _ in range(round(5 * contact_time / ball.dt)):
        ball.advance(1, UNDAMPED)
        deepest = max(deepest, R - ball.bodies.position[0, 2])
    # The first-order error at 40 steps is 1/40 of the depth, and that of e as in tests/physics/test_contact_law.py.
    assert deepest == pytest.approx(0.1290665 * speed * contact_time, rel=0.05)
    away = ball.bodies.velocity[0, 2]
    assert away == pytest.approx(0.0899 * speed, abs=0.0065 * speed + 5 * GRAVITY * contact_time)
    run_watched(ball, 0.5, damped=True)
    assert R - ball.bodies.position[0, 2] == pytest.approx(GRAVITY / compose(made).law.stiffness, rel=1e-3)
