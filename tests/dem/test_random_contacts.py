"""The estimate from random contacts: its parts against closed forms, and how it depends on forms, sizes and numbers."""

import numpy as np
import pytest

from simcore.dem.forces.spring_dashpot import contact_law
from simcore.dem.random_contacts import _contacts, _covered, _random_sets, estimate_implicit_steps
from simcore.dem.shapes.polyhedra import unit_sphere
from simcore.dem.spread_contacts import _mean_over_surface
from simcore.dem.stability import contact_load
from tests.helpers.polyhedra import make_box

LAW = contact_law(0.1, 2e-4, 0.22, 0.5)


def estimate(bases, scale, **options):
    scale = np.atleast_2d(scale)
    return estimate_implicit_steps(LAW, True, bases, np.zeros(len(scale), int), scale, **options)


def test_loads_of_an_array_are_those_of_each_number_of_contacts():
    numbers = np.array([0.5, 1.0, 3.7, 12.0])
    together = contact_load(LAW, 2e-5, True, numbers)
    for k, number in enumerate(numbers):
        alone = contact_load(LAW, 2e-5, True, number)
        assert (together.normal[k], together.tangential[k]) == (alone.normal, alone.tangential)


def test_twelve_equal_spheres_fit_around_one():
    """Each covers 0.067 of the solid angle, and all of them cover 0.80; a wall covers a half sphere."""
    assert 12.0 * _covered(0.5) == pytest.approx(0.804, abs=1e-3)
    assert _covered(1.0) == pytest.approx(0.5)


@pytest.mark.parametrize("base", [unit_sphere(), make_box()])
def test_the_mean_of_random_contacts_is_the_mean_over_the_surface(base):
    """40 000 contacts: the standard error of an entry of the matrices of this size is below 0.01."""
    scale = np.array([1.0, 0.7, 0.4])
    sampled = _contacts(base, scale, 40_000, np.random.default_rng(1))
    for matrices, expected in zip(sampled, _mean_over_surface(base, scale), strict=True):
        np.testing.assert_allclose(matrices.mean(axis=0), expected, atol=0.05)


def test_equal_spheres_have_five_contacts_of_half_their_stiffness():
    """The trace of the matrix of a frictionless set of fixed equal neighbours is half their number."""
    (sets,) = _random_sets([unit_sphere()], np.zeros(50, int), np.ones((50, 3)), (0.0,))
    traces = sets.normal[:, :3, :3].trace(axis1=1, axis2=2)
    np.testing.assert_allclose(traces, 0.5 * np.maximum(np.round(2.0 * traces), 1.0))
    assert traces.mean() == pytest.approx(2.5, abs=0.05)  # 12 places, taken with 5/12
    np.testing.assert_allclose(sets.effective_contacts, 2.0 * traces, rtol=1e-12)


def test_longer_and_flatter_grains_need_more_steps():
    box, alike = [make_box()], np.ones((100, 3))
    round_, long_ = estimate(box, alike), estimate(box, alike * [4.0, 1.0, 1.0])
    flat = estimate(box, alike * [4.0, 4.0, 1.0])
    assert round_.expected < long_.expected and round_.expected < flat.expected


def test_the_stiffest_of_many_grains_needs_more_steps_and_the_bound_is_above():
    scale = np.ones((100, 3)) * [3.0, 2.0, 1.0]
    few, many, most = (estimate([make_box()], scale, number=number) for number in (5, 200, 1e6))
    assert few.expected < many.expected == most.expected
    assert many == estimate([make_box()], scale, number=200)  # the random sets are the same in every run
    assert many.cautious > many.expected
    assert estimate([make_box()], scale[:1], number=1).expected > 0.0
