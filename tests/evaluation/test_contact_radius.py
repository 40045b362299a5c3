"""Radial distribution of contacts: distances of hand-made contacts, densities of surfaces in closed form."""

import numpy as np
import pytest

from simcore.evaluation.contact_radius import BIN_WIDTH, contact_radii, largest_radius, radius_bins, surface_radii
from tests.helpers.packings import make_packing
from tests.helpers.polyhedra import CUBE
from tests.helpers.rotations import random_orientations


def test_both_ends_of_a_contact_across_the_border():
    bed = make_packing([[0.2, 0.5, 1.0], [0.9, 0.5, 1.0]], [0.1, 0.2], width=1.0, contacts=[[0, 1]], images=[[-1, 0]])
    # The line of centres is 0.3 long, from x = 0.2 to -0.1, and the contact is on the surface of the first grain.
    radii = contact_radii(bed, np.array([0, 0]), np.array([False, True]))
    np.testing.assert_allclose(radii, [1.0, 1.0], rtol=1e-12)


def test_distance_is_over_the_equal_volume_radius():
    bed = make_packing([[0, 0, 1.0]], [[0.5, 1.0, 2.0]], contacts=[[0, -1]])
    assert contact_radii(bed, np.array([0]), np.array([False]))[0] == pytest.approx(2.0)


def test_bins_have_one_in_the_middle_and_reach_the_largest():
    for largest in (0.01, 1.0, 1.02, 2.51):
        edges, middles = radius_bins(largest)
        assert edges[-1] >= largest and len(edges) == len(middles) + 1
        assert edges[-1] < largest + BIN_WIDTH or len(middles) == 1
        np.testing.assert_allclose(np.diff(edges), BIN_WIDTH)
    edges, middles = radius_bins(1.0)
    assert 1.0 in middles.round(12)


def test_the_farthest_point_of_the_surface():
    r = (3 / (4 * np.pi)) ** (1 / 3)
    assert largest_radius(make_packing(np.zeros((2, 3)), [1.0, 4.0], vertices=CUBE), [0, 1]) == pytest.approx(
        np.sqrt(0.75) / r
    )
    bed = make_packing(np.zeros((2, 3)), [[1.0, 1.0, 8.0], [1.0, 1.0, 1.0]])
    assert largest_radius(bed, [0, 1]) == pytest.approx(4.0) and largest_radius(bed, [1]) == pytest.approx(1.0)


def test_surface_of_spheres_is_at_one():
    bed = make_packing(np.zeros((3, 3)), [1e-3, 2e-3, 5.0])
    edges, middles = radius_bins(1.2)
    density = surface_radii(bed, np.arange(3), np.ones(3), edges)
    np.testing.assert_allclose(density, np.isclose(middles, 1.0) / BIN_WIDTH)


def test_surface_of_a_prolate_spheroid():
    """The area between the equator and height z of a spheroid (a, a, c) with e² = 1 - a²/c² has a closed form.

    A(z) = 2 π a/c ∫ √(c² - e² z²) dz, and rho² = (a² + e² z²) / (a² c)^(2/3).
    """
    a, c = 1.0, 2.0
    e = np.sqrt(1 - (a / c) ** 2)
    r = (a * a * c) ** (1 / 3)
    edges, _ = radius_bins(c / r)
    z = np.sqrt(np.clip((edges * r) ** 2 - a**2, 0, None)) / e
    x = np.clip(e * z / c, 0, e)
    area = (np.arcsin(x) + x * np.sqrt(1 - x**2)) / (np.arcsin(e) + e * np.sqrt(1 - e**2))
    bed = make_packing([[0, 0, 0]], [[a, a, c]], random_orientations(1, 1))
    density = surface_radii(bed, np.array([0]), np.array([3.0]), edges)
    # Each end of a bin includes or excludes one of 4096 heights, each at most 1/2000 of the area.
    np.testing.assert_allclose(density * BIN_WIDTH, np.diff(area), atol=1e-3)
    assert np.sum(density) * BIN_WIDTH == pytest.approx(1.0)


def test_surface_of_a_cube_and_of_a_mixture():
    r = (3 / (4 * np.pi)) ** (1 / 3)
    cube = make_packing(np.zeros((2, 3)), [1.0, 4.0], vertices=CUBE)
    edges, _ = radius_bins(np.sqrt(0.75) / r)
    density = surface_radii(cube, np.arange(2), np.ones(2), edges)
    # Within 0.5 of a face's middle the area is that of a circle: π (rho² r² - 1/4), from the inscribed radius on.
    below = np.flatnonzero(edges * r < np.sqrt(0.5))[-1]
    circle = np.pi * ((edges[below] * r) ** 2 - 0.25)
    # A face is cut into 32 triangles, of which up to four, by symmetry, fall in or out of a bin together.
    assert np.sum(density[:below]) * BIN_WIDTH == pytest.approx(circle, abs=4 / 32)
    assert np.sum(density) * BIN_WIDTH == pytest.approx(1.0)
    weighted = make_packing(np.zeros((2, 3)), [[1.0, 1.0, 1.0], [1.0, 1.0, 2.0]])
    one, other, both = (
        surface_radii(weighted, np.arange(2), np.array(weights), edges) for weights in ([1.0, 0], [0, 1.0], [3.0, 1.0])
    )
    np.testing.assert_allclose(both, 0.75 * one + 0.25 * other, rtol=1e-12)
