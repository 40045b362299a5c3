"""Impacts of viscoelastic spheres: closed forms, the series of small damping, and parameters of a material."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import beta

from simcore.scene.impact import (
    DURATION,
    damping_number,
    derive_hertzian,
    fall_speed,
    impact_depth,
    impact_duration,
    number_of_restitution,
    restitution,
    sphere_radius,
)

# C1 belongs to the series 1 - C1 β + (3/5) C1² β² of Ramírez et al. (1999), 1.15344 there. The energy that the dashpot
# takes along the elastic path is ∫ β √x v dx there and back, with v² = 1 - (4/5) x^2.5.
C1 = 2.0 * 1.25**0.6 * 0.4 * beta(0.6, 1.5)
MATERIAL = SimpleNamespace(
    density=2650.0,
    effective_gravity=6.0,
    poisson_ratio=0.22,
    youngs_modulus=5e6,
    overlap_at_rest=None,
    restitution=0.4,
    restitution_speed=0.7,
    end_of_contact="clamped",
)


def test_the_elastic_impact_lasts_as_hertz_has_it():
    """The duration is 2.94 depth/speed (Landau & Lifshitz § 9), and the energy at the depth is (2/5) k ξ^2.5."""
    modulus, mass, radius, speed = 1e7, 3e-4, 2e-3, 0.8
    depth = impact_depth(modulus, mass, radius, speed)
    k = modulus * np.sqrt(radius)
    assert 0.4 * k * depth**2.5 == pytest.approx(0.5 * mass * speed**2, rel=1e-12)
    # In the integral of dx / v, x = 1 - s² removes the pole at the turning point.
    half, _ = quad(lambda s: 2.0 * s / np.sqrt(1.0 - (1.0 - s * s) ** 2.5) if s > 0.0 else 2.0 / np.sqrt(5.0), 0.0, 1.0)
    assert pytest.approx(2.0 * half, rel=1e-6) == DURATION
    assert impact_duration(modulus, mass, radius, speed) == pytest.approx(DURATION * depth / speed, rel=1e-12)
    assert impact_duration(modulus, mass, radius, speed) == pytest.approx(
        2.94 * (mass**2 / ((0.8 * k) ** 2 * speed)) ** 0.2, rel=2e-3
    )


@pytest.mark.parametrize("attractive", [True, False])
def test_restitution_is_that_of_the_series_for_small_damping(attractive):
    """The next term is β³ times a factor of order one; the end of a contact has an effect from β^2.2 on."""
    assert pytest.approx(1.15344, abs=1e-5) == C1
    for number in (1e-3, 1e-2):
        expected = 1.0 - C1 * number + 0.6 * (C1 * number) ** 2
        assert restitution(number, attractive) == pytest.approx(expected, abs=2.0 * number**2.2)


def test_restitution_falls_with_the_fifth_root_of_speed():
    known = 1e-5, 1e7, 3e-4, 2e-3
    slow, fast = (damping_number(*known, speed) for speed in (1e-3, 1e2))
    assert fast / slow == pytest.approx(1e5**0.2, rel=1e-12)
    lost = [1.0 - restitution(number, False) for number in (slow, 2.0 * slow)]
    assert lost[1] / lost[0] == pytest.approx(2.0, rel=3.0 * C1 * slow)


def test_clamped_contacts_keep_more_and_the_number_is_found_again():
    for number in (0.5, 2.0):
        assert restitution(number, False) > restitution(number, True) > 0.0
    for attractive in (True, False):
        for wanted in (0.05, 0.1, 0.5, 0.95):
            assert restitution(number_of_restitution(wanted, attractive), attractive) == pytest.approx(wanted, rel=1e-6)
        assert number_of_restitution(1.0, attractive) == 0.0


def test_a_material_becomes_what_it_asks_for():
    mean, least = 3e-4, 1e-4
    found = derive_hertzian(MATERIAL, mean, least, speed=2.0)
    assert found.modulus == pytest.approx(4.0 / 3.0 * 5e6 / (2.0 * (1.0 - 0.22**2)), rel=1e-12)
    radius = sphere_radius(np.array([mean, least]), 2650.0)
    assert 4.0 / 3.0 * np.pi * radius**3 * 2650.0 == pytest.approx([mean, least], rel=1e-12)
    number = damping_number(found.damping_time, found.modulus, 0.5 * mean, 0.5 * radius[0], 0.7)
    assert restitution(number, False) == pytest.approx(0.4, rel=1e-6)
    assert found.duration == impact_duration(found.modulus, 0.5 * least, 0.5 * radius[1], 2.0)
    assert found.deepest == impact_depth(found.modulus, 0.5 * least, 0.5 * radius[1], 2.0)


def test_an_overlap_at_rest_is_that_of_a_grain_on_the_floor():
    soft = SimpleNamespace(**{**vars(MATERIAL), "youngs_modulus": None, "overlap_at_rest": 1e-3})
    mean = 3e-4
    found, radius = derive_hertzian(soft, mean, mean, speed=2.0), sphere_radius(mean, 2650.0)
    assert found.modulus * np.sqrt(radius) * (2e-3 * radius) ** 1.5 == pytest.approx(mean * 6.0, rel=1e-12)


def test_a_grain_falls_the_given_height():
    inserted = SimpleNamespace(velocity_z=-3.0, velocity_horizontal=0.0)
    assert fall_speed(inserted, 0.8, 10.0) == pytest.approx(5.0, rel=1e-12)
