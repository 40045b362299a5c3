"""Hulls of voxel masks: the bias of the hull of voxel centres is removed."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from simcore.grains.mesh import make_grain
from simcore.grains.voxels import mask_surface

ELLIPSOID = np.array([0.5, 0.75, 1.0]) / np.cbrt(0.375)
RNG = np.random.default_rng(2)


def digitised(semi_axes, rng):
    """Voxels whose centres lie in a turned ellipsoid at a random place of the lattice, edge 1."""
    n = int(2 * semi_axes.max()) + 4
    centre, turn = n / 2 + rng.random(3), Rotation.random(rng=rng).as_matrix()
    x = np.stack(np.meshgrid(*[np.arange(n)] * 3, indexing="ij"), -1) - centre
    return (((x @ turn) / semi_axes) ** 2).sum(-1) <= 1


def errors(shape, radius, points, repeats=6):
    """Mean error of the semi-axes [voxels] (3,) and of the volume, relative."""
    semi_axes = radius * np.array(shape)
    found = [make_grain("v", points(digitised(semi_axes, RNG))) for _ in range(repeats)]
    axes = np.mean([[g.S, g.I, g.L] for g in found], axis=0) / 2 - semi_axes
    return axes, np.mean([g.volume for g in found]) / (4 / 3 * np.pi * semi_axes.prod()) - 1


@pytest.mark.parametrize("shape", [np.ones(3), ELLIPSOID], ids=["sphere", "ellipsoid"])
def test_bias_is_removed(shape):
    # a first-order bias is constant in voxels; the mean over the axes has none, single axes keep 0.1 voxel
    for radius, tolerance in ((10, 0.015), (20, 0.006), (30, 0.005)):
        axes, volume = errors(shape, radius, lambda mask: mask_surface(mask, 1.0))
        centres_axes, centres_volume = errors(shape, radius, np.argwhere)
        assert np.abs(axes).max() < 0.15 and abs(axes.mean()) < 0.05
        assert abs(volume) < tolerance
        assert centres_axes.mean() < -0.12 and abs(volume) < abs(centres_volume) / 3


def test_spacing_scales_and_place_is_kept():
    mask = digitised(8 * ELLIPSOID, RNG)
    points = mask_surface(mask, 1.0)
    np.testing.assert_allclose(mask_surface(mask, (1e-4, 2e-4, 3e-4)), points * [1e-4, 2e-4, 3e-4], rtol=1e-12)
    shifted = mask_surface(np.pad(mask, ((3, 0), (0, 5), (7, 7))), 1.0)
    np.testing.assert_allclose(shifted, points + [3, 0, 7], atol=1e-9)
    assert np.abs(points.mean(0) - np.argwhere(mask).mean(0)).max() < 0.1


def test_box_on_the_lattice_keeps_its_faces():
    # a box of 24 x 32 x 40 voxels: faces lie half a voxel outside the centres, edges are smoothed away a little
    mask = np.ones((24, 32, 40), bool)
    points = mask_surface(mask, 1.0)
    # on a plane face the smoothed step crosses 1/2 at its middle; linear interpolation keeps it by symmetry
    middle = points[np.all(np.abs(points[:, 1:] - [15.5, 19.5]) < 3, axis=1)]
    np.testing.assert_allclose(np.abs(middle[:, 0] - 11.5), 12.0, atol=1e-3)


@pytest.mark.parametrize(
    "mask, spacing, reason",
    [
        (np.zeros((4, 4, 4)), 1.0, "solid voxel"),
        (np.ones((4, 4)), 1.0, "three dimensions"),
        (np.ones((4, 4, 4)), 0.0, "positive"),
        (np.ones((4, 4, 4)), np.nan, "positive"),
    ],
)
def test_impossible_masks_are_refused(mask, spacing, reason):
    with pytest.raises(ValueError, match=reason):
        mask_surface(mask, spacing)
