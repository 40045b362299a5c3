"""Hulls of voxel masks: the bias of the hull of voxel centres is removed."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from simcore.grains.mesh import make_grain
from simcore.grains.readers import read_grain, read_grains_of
from simcore.grains.voxels import mask_surface

ELLIPSOID = np.array([0.5, 0.75, 1.0]) / np.cbrt(0.375)
RNG = np.random.default_rng(2)


def digitised(semi_axes, rng):
    """Return the voxels of edge 1 whose centres are in a turned ellipsoid at a random place of the lattice."""
    n = int(2 * semi_axes.max()) + 4
    centre, turn = n / 2 + rng.random(3), Rotation.random(rng=rng).as_matrix()
    x = np.stack(np.meshgrid(*[np.arange(n)] * 3, indexing="ij"), -1) - centre
    return (((x @ turn) / semi_axes) ** 2).sum(-1) <= 1


def errors(shape, radius, points, repeats=6):
    """Return the mean error of the semi-axes [voxels] (3,) and the relative mean error of the volume."""
    semi_axes = radius * np.array(shape)
    found = [make_grain("v", points(digitised(semi_axes, RNG))) for _ in range(repeats)]
    axes = np.mean([[g.S, g.I, g.L] for g in found], axis=0) / 2 - semi_axes
    return axes, np.mean([g.volume for g in found]) / (4 / 3 * np.pi * semi_axes.prod()) - 1


@pytest.mark.parametrize("shape", [np.ones(3), ELLIPSOID], ids=["sphere", "ellipsoid"])
def test_bias_is_removed(shape):
    # A bias of first order is constant in voxels. The mean over the axes has none; single axes keep 0.1 voxel.
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
    # The faces of a box of 24 x 32 x 40 voxels are half a voxel outside the centres; edges are smoothed a little.
    mask = np.ones((24, 32, 40), bool)
    points = mask_surface(mask, 1.0)
    # On a plane face the smoothed step crosses 1/2 at its middle, which linear interpolation keeps by symmetry.
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


def ball_image(shape, *balls):
    """Return an image with the labels 1, 2, … of balls (x, y, z, radius) in voxels."""
    image = np.zeros(shape, np.uint16)
    places = np.stack(np.meshgrid(*[np.arange(n) for n in shape], indexing="ij"), -1)
    for number, (*centre, radius) in enumerate(balls, start=1):
        image[((places - centre) ** 2).sum(-1) <= radius**2] = number
    return image


APART = ball_image((50, 30, 30), (13, 15, 15, 9), (36, 15, 15, 7))
TOUCHING = ball_image((50, 30, 30), (13, 15, 15, 9), (29, 15, 15, 8))
SIZES = (0.05 * np.array([18.0, 14.0])).tolist()


def read(tmp_path, image, bodies="one"):
    np.save(tmp_path / "a.npy", image)
    return read_grains_of(tmp_path / "a.npy", "mm", 0.05, bodies)


@pytest.mark.parametrize("dtype", [np.uint8, np.int32, np.uint32, float])
@pytest.mark.parametrize("labels", [(1, 2), (7, 250), (5, 3)])
@pytest.mark.parametrize("image", [APART, TOUCHING], ids=["apart", "touching"])
def test_each_label_is_a_grain(tmp_path, dtype, labels, image):
    labelled = np.array([0, *labels])[image].astype(dtype)
    grains = {grain.name: grain for grain in read(tmp_path, labelled)}
    assert set(grains) == {f"a_{label}" for label in labels}
    first = grains[f"a_{labels[0]}"]
    assert first.L * 1e3 == pytest.approx(SIZES[0], abs=0.05) and first.notes == ()
    assert first.hull_ratio == pytest.approx(1, abs=0.03)


def test_parts_of_a_mask_are_refused_or_split(tmp_path):
    mask = APART > 0
    with pytest.raises(ValueError, match=r"a\.npy: it has 2 separate bodies, of 0\.3\d*, 0\.1\d* mm³"):
        read(tmp_path, mask)
    grains = read(tmp_path, mask, "split")
    assert [grain.name for grain in grains] == ["a_1", "a_2"]
    assert [grain.L * 1e3 for grain in grains] == pytest.approx(SIZES, abs=0.05)
    (largest,) = read(tmp_path, mask, "largest")
    assert largest.L == grains[0].L


def test_parts_of_a_label_are_refused_with_the_label(tmp_path):
    image = APART.copy()
    image[20:24, 3:6, 3:6] = 2
    with pytest.raises(ValueError, match=r"a\.npy: label 2: it has 2 separate bodies"):
        read(tmp_path, image)
    assert [grain.name for grain in read(tmp_path, image, "split")] == ["a_1", "a_2_1", "a_2_2"]
    assert [grain.name for grain in read(tmp_path, image, "largest")] == ["a_1", "a_2"]


def test_voxels_that_touch_at_a_corner_are_one_body(tmp_path):
    mask = np.zeros((20, 20, 20), bool)
    mask[3:10, 3:10, 3:10] = mask[10:17, 10:17, 10:17] = True
    assert len(read(tmp_path, mask)) == 1


def smooth_grey():
    """Return a grain of grey values, bright in the middle, in air of 0."""
    places = np.stack(np.meshgrid(*[np.arange(40) - 19.5] * 3, indexing="ij"), -1)
    return np.clip(300 - (places**2).sum(-1), 0, 255)


NO_MASK = {
    "inverted": (APART == 0, "seems inverted"),
    "grey values with noise": (RNG.integers(1, 200, (30, 30, 30)).astype(np.uint8), "no 0 among them"),
    "grey grain in air": (np.where(APART > 0, RNG.integers(90, 200, APART.shape), 0), "grey values"),
    "smooth grey": (smooth_grey().astype(np.uint8), "grey values"),
    "fractions": (smooth_grey() / 255, "grey values"),
    "NaN outside": (np.where(APART > 0, 1.0, np.nan), r"NaN.*np\.isfinite"),
    "infinite": (np.where(APART > 0, np.inf, 0.0), "infinite"),
    "all solid": (np.ones((30, 30, 30), bool), "no 0 among them"),
    "labels without 0": (APART + 1, "no 0 among them"),
    "grain fills the box": (np.pad(np.ones((20, 20, 20)), ((0, 0), (0, 0), (0, 1))), r"np\.pad"),
    "negative": (np.where(APART > 0, -APART.astype(int), 0), "grey values"),
    "text": (np.full((4, 4, 4), "grain"), "not numbers"),
    "empty": (np.zeros((9, 9, 9)), "at least one solid voxel"),
}


@pytest.mark.parametrize("kind", NO_MASK)
def test_what_is_no_mask_is_refused_with_how_to_make_one(tmp_path, kind):
    image, reason = NO_MASK[kind]
    for bodies in ("one", "split", "joined"):
        with pytest.raises(ValueError, match=rf"a\.npy: .*({reason})") as error:
            read(tmp_path, image, bodies)
        assert "\n" not in str(error.value)


def test_a_grain_at_the_border_is_noted_with_its_sides(tmp_path):
    mask = ball_image((30, 30, 30), (15, 15, 15, 9)) > 0
    (whole,), (cut,) = read(tmp_path, mask), read(tmp_path, mask[:, 3:, :15])
    assert whole.notes == ()
    assert len(cut.notes) == 1 and "border of its voxel image (z = 14)" in cut.notes[0]
    labelled = read(tmp_path, APART[5:])
    assert [bool(grain.notes) for grain in labelled] == [True, False] and "(x = 0)" in labelled[0].notes[0]


@pytest.mark.parametrize("array", [np.ones((5, 4)), np.ones(7), np.ones((2, 3, 4, 5)), np.full((5, 3), "a")])
def test_arrays_that_are_neither_points_nor_images_are_refused(tmp_path, array):
    with pytest.raises(ValueError, match=r"a\.npy: an array .* neither points"):
        read(tmp_path, array)


def test_an_archive_without_a_mask_is_refused_with_its_names(tmp_path):
    np.savez(tmp_path / "a.npz", image=APART)
    with pytest.raises(ValueError, match=r"a\.npz: it has no array mask, but image"):
        read_grains_of(tmp_path / "a.npz", "mm", 0.05)


def test_a_sheet_thinner_than_the_smoothing_has_a_surface():
    """The smoothing of a sheet of 60 x 60 voxels is wider than the sheet, which is one voxel thick."""
    mask = np.zeros((64, 64, 5), bool)
    mask[2:62, 2:62, 2] = True
    points = mask_surface(mask, 1.0)
    assert np.ptp(points, axis=0) == pytest.approx([60.0, 60.0, 1.0], abs=1.0)


@pytest.mark.parametrize("spacing", ["0.1 mm", [0.1, 0.2], True, 1j])
def test_a_spacing_that_is_no_length_is_refused(tmp_path, spacing):
    np.savez(tmp_path / "a.npz", mask=np.pad(np.ones((8, 8, 8)), 2), spacing=spacing)
    with pytest.raises(ValueError, match="its array `spacing` has the shape .*; give one number or three"):
        read_grain(tmp_path / "a.npz", "mm")


def test_the_spacing_of_a_file_counts_before_that_of_the_specification(tmp_path):
    """A folder may have images with a spacing of their own beside others, for which the specification gives it."""
    mask = np.pad(np.ones((20, 14, 10)), 2)
    np.savez(tmp_path / "a.npz", mask=mask, spacing=[0.1, 0.1, 0.2])
    own, given = read_grain(tmp_path / "a.npz", "mm"), read_grain(tmp_path / "a.npz", "mm", spacing=0.1)
    assert own.sieve_size == given.sieve_size and own.S / own.L > 0.6


def test_labels_that_may_be_noise_have_a_note(tmp_path):
    image = np.zeros((40, 20, 20), np.uint8)
    image[2:16, 2:16, 2:16], image[20:34, 2:16, 2:16], image[37, 10, 10:12] = 1, 2, 7
    np.save(tmp_path / "a.npy", image)
    grains = read_grains_of(tmp_path / "a.npy", "mm", spacing=0.5)
    assert [bool(grain.notes) for grain in grains] == [False, False, True]
    assert (
        grains[2].name == "a_7"
        and "of the volume of the largest label of its image; if it is noise" in grains[2].notes[0]
    )
