"""Statistics of axes, compared with closed forms, and their errors, compared with the scatter of random axes."""

import numpy as np
import pytest
from scipy.stats import binom, chi2

from simcore.evaluation.axis_statistics import (
    MAGIC_ANGLE,
    azimuth_moments,
    density_per_solid_angle,
    equal_solid_angles,
    grain_axes,
    legendre_moments,
    rayleigh_test,
    second_rank_tensor,
    tensor_invariants,
)
from simcore.evaluation.slicing import vertical_axes
from tests.helpers.packings import make_packing
from tests.helpers.rotations import random_orientations


def random_axes(n, seed):
    vectors = np.random.default_rng(seed).normal(size=(n, 3))
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def sphere_rule(n_heights=12, n_azimuths=24):
    """Return directions and weights that integrate polynomials up to degree 23 over the sphere exactly."""
    height, weight = np.polynomial.legendre.leggauss(n_heights)
    phi = 2.0 * np.pi * (np.arange(n_azimuths) + 0.5) / n_azimuths
    z, phi = (grid.ravel() for grid in np.meshgrid(height, phi, indexing="ij"))
    across = np.sqrt(1.0 - z**2)
    return np.column_stack([across * np.cos(phi), across * np.sin(phi), z]), np.repeat(weight, n_azimuths)


@pytest.mark.parametrize("edges", [equal_solid_angles(12), np.radians([0, 10, 30, 45, 80, 90])])
def test_isotropic_axes_have_a_flat_density(edges):
    n = 5000
    density, error = density_per_solid_angle(random_axes(n, 1), np.ones(n), edges)
    share = -np.diff(np.cos(edges))
    assert np.sum(density * share) == pytest.approx(1.0, rel=1e-12)
    # Pearson's test has the level 1e-4, and the error of each bin is binomial.
    assert n * np.sum(share * (density - 1.0) ** 2) < chi2.ppf(1 - 1e-4, len(share) - 1)
    counts = density * share
    assert error == pytest.approx(np.sqrt(counts * (1 - counts) / (n - 1)) / share, rel=1e-9)


def test_stated_errors_are_the_scatter_over_samples():
    """The ratio of scatter to stated error over 400 samples has an error of 1/√800; four of these are allowed."""
    found = []
    for seed in range(400):
        axes, ones = random_axes(300, seed), np.ones(300)
        found.append(
            [density_per_solid_angle(axes, ones, equal_solid_angles(5)), legendre_moments(axes, ones, (2, 4, 6))[:2]]
        )
    for k in range(2):
        values, errors = (np.array([sample[k][part] for sample in found]) for part in range(2))
        assert values.std(axis=0, ddof=1) / np.sqrt(np.mean(errors**2, axis=0)) == pytest.approx(1.0, abs=4 / 800**0.5)


def test_weights_count_as_repeated_axes_do():
    axes = random_axes(30, 2)
    weights = np.arange(30) % 3
    many = np.repeat(axes, weights, axis=0)
    some, ones = weights.astype(float), np.ones(len(many))
    edges = equal_solid_angles(4)
    for mean in (
        lambda a, w: density_per_solid_angle(a, w, edges)[0],
        lambda a, w: legendre_moments(a, w)[0],
        lambda a, w: second_rank_tensor(a, w)[0],
        lambda a, w: azimuth_moments(a, w)[0],
    ):
        np.testing.assert_allclose(mean(axes, some), mean(many, ones), rtol=1e-12, atol=1e-14)
    # An axis of weight 2 is still one observation, so the error does not fall.
    single, double = (legendre_moments(axes, np.full(30, w))[1] for w in (1.0, 2.0))
    np.testing.assert_allclose(double, single, rtol=1e-12)


def test_moments_of_known_distributions():
    axes, weights = sphere_rule()
    # f = 1 + 5 a P2 + 9 b P4 + 13 c P6 has the moments a, b, c, whatever they are.
    series = np.polynomial.legendre.legval(axes[:, 2], [1, 0, 5 * 0.12, 0, 9 * -0.03, 0, 13 * 0.01])
    mean, _ = legendre_moments(axes, weights * series)
    np.testing.assert_allclose(mean, [0.12, -0.03, 0.01], atol=1e-14)
    # cos² theta: <cos²> = 3/5, so P2 = 2/5; sin² theta: <cos²> = 1/5, so P2 = -1/5.
    assert legendre_moments(axes, weights * axes[:, 2] ** 2)[0][0] == pytest.approx(0.4, rel=1e-12)
    assert legendre_moments(axes, weights * (1 - axes[:, 2] ** 2))[0][0] == pytest.approx(-0.2, rel=1e-12)
    upright, level = np.array([[0.0, 0, -1]]), np.array([[0.6, 0.8, 0]])
    assert legendre_moments(upright, np.ones(1))[0] == pytest.approx([1.0, 1.0, 1.0])
    assert legendre_moments(level, np.ones(1))[0] == pytest.approx([-1 / 2, 3 / 8, -5 / 16])
    assert np.polynomial.legendre.legval(np.cos(MAGIC_ANGLE), [0, 0, 1]) == pytest.approx(0.0, abs=1e-15)


def test_tensor_and_its_invariants():
    axes, weights = sphere_rule()
    isotropic, _ = second_rank_tensor(axes, weights)
    np.testing.assert_allclose(isotropic, np.eye(3) / 3, atol=1e-15)
    assert tensor_invariants(isotropic)["anisotropy"] == pytest.approx(0.0, abs=1e-14)
    # sin² about the z axis: eigenvalues 2/5, 2/5, 1/5; the anisotropy is the distance between them.
    flat = tensor_invariants(second_rank_tensor(axes, weights * (1 - axes[:, 2] ** 2))[0])
    np.testing.assert_allclose(flat["eigenvalues"], [0.4, 0.4, 0.2], rtol=1e-12)
    assert flat["anisotropy"] == pytest.approx(0.2, rel=1e-12)
    assert flat["determinant"] == pytest.approx((0.4 - 1 / 3) ** 2 * (0.2 - 1 / 3), rel=1e-12)
    upright = tensor_invariants(second_rank_tensor(np.array([[0.0, 0, 1]]), np.ones(1))[0])
    assert upright["anisotropy"] == pytest.approx(1.0) and upright["determinant"] > 0 > flat["determinant"]
    tensor, _ = second_rank_tensor(random_axes(50, 3), np.ones(50))
    assert np.trace(tensor) == pytest.approx(1.0) and tensor == pytest.approx(tensor.T)


def test_a_finite_sample_has_the_anisotropy_that_is_stated():
    squares = [
        tensor_invariants(second_rank_tensor(random_axes(100, seed), np.ones(100))[0])["anisotropy"] ** 2
        for seed in range(400)
    ]
    error = np.std(squares, ddof=1) / np.sqrt(400)
    assert np.mean(squares) == pytest.approx(1 / 100, abs=4 * error)


def test_rayleigh_s_test_is_right_where_azimuths_are_uniform_and_finds_a_direction():
    p_values = []
    for seed in range(1000):
        moments, number = azimuth_moments(random_axes(40, seed), np.ones(40))
        assert number == pytest.approx(40)
        p_values.append(rayleigh_test(np.hypot(*moments.T), number))
    for fold in np.transpose(p_values):
        for level in (0.5, 0.1, 0.02):
            assert binom.ppf(1e-4, 1000, level) <= np.sum(fold < level) <= binom.ppf(1 - 1e-4, 1000, level)
    tilted = random_axes(200, 1) * [2.0, 1.0, 1.0]
    tilted /= np.linalg.norm(tilted, axis=1, keepdims=True)
    moments, number = azimuth_moments(tilted, np.ones(200))
    assert rayleigh_test(np.hypot(*moments[0]), number) < 1e-6
    # Only the fourfold resultant detects a cross along x and y.
    cross = np.array([[1.0, 0, 0], [0, 1.0, 0]] * 10)
    moments, number = azimuth_moments(cross, np.ones(20))
    np.testing.assert_allclose(moments, [[0, 0], [1, 0]], atol=1e-15)
    assert rayleigh_test(1.0, 20) < 1e-6 and rayleigh_test(0.0, 20) == 1.0


def test_upright_axes_have_no_azimuth():
    moments, number = azimuth_moments(np.array([[0.0, 0, 1], [0.6, 0, 0.8]]), np.ones(2))
    assert number == 1.0
    np.testing.assert_allclose(moments, [[1, 0], [1, 0]])


def test_without_axes_there_is_nothing_to_say():
    none, no_weight = np.zeros((0, 3)), np.zeros(0)
    assert np.isnan(density_per_solid_angle(none, no_weight, equal_solid_angles(3))[0]).all()
    tensor = second_rank_tensor(none, no_weight)[0]
    assert np.isnan(tensor_invariants(tensor)["eigenvalues"]).all()
    assert azimuth_moments(none, no_weight)[1] == 0.0


def test_edges_out_of_order_are_refused():
    for edges in ([0.0, 1.0], [0.0, 1.2, 0.7, np.pi / 2], [0.1, np.pi / 2]):
        with pytest.raises(ValueError, match="increase from 0 to pi/2"):
            density_per_solid_angle(random_axes(3, 1), np.ones(3), edges)


def test_grain_axes_are_those_of_the_bodies():
    turned = random_orientations(3, 4)
    semi_axes = [[1.0, 2.0, 3.0], [2.0, 2.0, 3.0], [1.0, 3.0, 3.0]]  # triaxial, prolate, oblate
    axes = grain_axes(make_packing(np.zeros((3, 3)), semi_axes, turned))
    assert axes["long_axis"][1].tolist() == [0, 1] and axes["short_axis"][1].tolist() == [0, 2]
    z_in_body = vertical_axes(turned)
    np.testing.assert_allclose(axes["long_axis"][0][:, 2], z_in_body[:2, 2], atol=1e-15)
    np.testing.assert_allclose(axes["short_axis"][0][:, 2], z_in_body[[0, 2], 0], atol=1e-15)
    np.testing.assert_allclose(np.linalg.norm(axes["long_axis"][0], axis=1), 1.0)
    half = np.sqrt(0.5)
    lying = grain_axes(make_packing([[0, 0, 0]], [[1.0, 2.0, 3.0]], [[half, half, 0, 0]]))  # a quarter turn about x
    np.testing.assert_allclose(lying["long_axis"][0], [[0, -1, 0]], atol=1e-15)
    with pytest.raises(ValueError, match="grain 0 has the semi-axes .* must increase from x to z"):
        grain_axes(make_packing([[0, 0, 0]], [[3.0, 2.0, 1.0]]))
