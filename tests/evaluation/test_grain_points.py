"""Integrals over grains by points, compared with closed forms and with a fine grid."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.special import spherical_jn

from simcore.evaluation.grain_points import disc_rule, grain_points, half_axes_of
from simcore.evaluation.slicing import slab_volumes
from simcore.grains.mesh import make_grain
from tests.helpers.packings import make_packing

WAVE = np.array([0.9, -0.4, 1.3])


def ellipsoids(number, seed=3):
    rng = np.random.default_rng(seed)
    return make_packing(
        rng.uniform(0, 6, (number, 3)),
        rng.uniform(0.2, 1.5, (number, 3)),
        orientation=Rotation.random(number, rng=seed).as_quat(scalar_first=True),
        width=6.0,
    )


def rotation(bed, grain):
    return Rotation.from_quat(bed["orientation"].values[grain], scalar_first=True).as_matrix()


def wave_integral(points, wave):
    return (points.volume * np.exp(1j * points.position @ wave)).sum()


def test_whole_ellipsoids_have_their_closed_form():
    """An ellipsoid is an affine image of the ball, whose mean of a wave is 3 j1(q) / q with q = |A^T k|."""
    bed = ellipsoids(40)
    points = grain_points(bed, -10.0, 20.0, np.linalg.norm(WAVE))
    position, scale = bed["position"].values, bed["scale"].values
    for grain in range(40):
        of_grain = points.grain == grain
        q = np.linalg.norm(scale[grain] * (rotation(bed, grain).T @ WAVE))
        volume = 4.0 / 3.0 * np.pi * scale[grain].prod()
        expected = volume * 3.0 * spherical_jn(1, q) / q * np.exp(1j * position[grain] @ WAVE)
        got = (points.volume[of_grain] * np.exp(1j * points.position[of_grain] @ WAVE)).sum()
        assert abs(got - expected) < 1e-3 * volume
        assert points.volume[of_grain].sum() == pytest.approx(volume, rel=1e-12)


def test_volumes_between_two_heights_are_those_of_the_slices():
    bed = ellipsoids(200)
    points = grain_points(bed, 2.0, 3.1, 1.0)
    volumes = np.bincount(points.grain, points.volume, 200)
    np.testing.assert_allclose(volumes, slab_volumes(bed, [2.0, 3.1], "exact", per_grain=True)[:, 0], atol=1e-12)
    assert points.position[:, 2].min() > 2.0 and points.position[:, 2].max() < 3.1


def test_cut_ellipsoid_agrees_with_a_fine_grid():
    bed = ellipsoids(1, seed=8)
    low, high = bed["position"].values[0, 2] + np.array([-0.2, 0.5])
    got = wave_integral(grain_points(bed, low, high, np.linalg.norm(WAVE)), WAVE)
    step = 0.02
    around = np.arange(-1.6, 1.6, step) + 0.5 * step
    relative = np.stack(np.meshgrid(around, around, around, indexing="ij"), axis=-1).reshape(-1, 3)
    inside = (((relative @ rotation(bed, 0)) / bed["scale"].values[0]) ** 2).sum(axis=1) < 1.0
    place = relative + bed["position"].values[0]
    inside &= (place[:, 2] > low) & (place[:, 2] < high)
    expected = np.exp(1j * place[inside] @ WAVE).sum() * step**3
    assert abs(got - expected) < 0.01 * abs(expected)


def test_polyhedron_is_represented_by_the_ellipsoid_of_its_second_moments():
    corners = np.array(np.meshgrid([-1.0, 1.0], [-2.0, 2.0], [-3.0, 3.0])).reshape(3, -1).T
    grain = make_grain("box", corners)
    bed = make_packing(np.zeros((1, 3)), 0.5, vertices=grain.vertices)
    bed = bed.assign({name: ("grain", [0.5 * getattr(grain, name)]) for name in "LIS"})
    half = half_axes_of(bed)[0]
    np.testing.assert_allclose(half, 0.5 * np.sqrt(5.0 / 3.0) * np.array([1.0, 2.0, 3.0]))
    points = grain_points(bed, -10.0, 10.0, 0.1)
    assert points.volume.sum() == pytest.approx(6.0)
    means = (points.volume[:, None] * points.position**2).sum(axis=0) / 6.0
    np.testing.assert_allclose(means, np.array([1.0, 4.0, 9.0]) / 12.0, rtol=1e-9)


@pytest.mark.parametrize("order", [1, 2, 3, 4, 7])
def test_disc_rule_integrates_polynomials(order):
    points, weights = disc_rule(order)
    assert weights.sum() == pytest.approx(1.0)
    for i in range(order):
        for j in range(order - i):
            # The mean of x^2i y^2j over the disc
            mean = np.prod(np.arange(1, 2 * i, 2)) * np.prod(np.arange(1, 2 * j, 2))
            mean /= np.prod(np.arange(2, 2 * (i + j) + 1, 2)) * (i + j + 1)
            assert weights @ (points[:, 0] ** (2 * i) * points[:, 1] ** (2 * j)) == pytest.approx(mean)
            if 2 * (i + j) + 1 < 2 * order:
                odd = points[:, 0] ** (2 * i + 1) * points[:, 1] ** (2 * j)
                assert weights @ odd == pytest.approx(0.0, abs=1e-14)
