"""Voxels: volumes compared with exact slices and the derived error, spacing, and files for other programs."""

import numpy as np
import pytest
import pyvista
import tifffile

from simcore.evaluation.slicing import slab_volumes
from simcore.export.export import export
from simcore.export.surfaces import surface_areas
from simcore.export.voxels import GRID_VARIANCE, voxels
from simcore.grains.voxels import image_bodies
from tests.helpers.packings import make_packing, sphere_lattice
from tests.helpers.polyhedra import CUBE
from tests.helpers.random_beds import HEIGHT, KINDS, WIDTH, strew


def spaced(kind, seed=0):
    """Return grains on a lattice with random forms and orientations; none overlaps, and many cross the sides."""
    n = 27
    bed = strew(kind, n, seed)
    places = np.stack(np.meshgrid(*[np.arange(3)] * 3, indexing="ij"), -1).reshape(-1, 3) * 0.01
    shift = np.random.default_rng(seed).uniform(0.0, 0.001, (n, 3))
    bed["position"] = ("grain", "xyz"), (places + shift + [0.0, 0.0, 0.006]) % [WIDTH, WIDTH, np.inf]
    return bed


def test_the_constant_is_epsteins_sum():
    """The sum has the terms up to |k| = R = 60 and the integral 4 π / R of the rest; its error is of order 1/R²."""
    k = np.arange(-60, 61)
    squares = (k[:, None, None] ** 2 + k[:, None] ** 2 + k**2).ravel().astype(float)
    squares = squares[(squares > 0) & (squares <= 60.0**2)]
    total = np.sum(squares**-2) + 4.0 * np.pi / 60.0
    assert GRID_VARIANCE == pytest.approx(total / (8.0 * np.pi**3), rel=1e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_volumes_scatter_about_the_exact_ones_as_derived(kind):
    """The errors of 5 beds of 27 grains, divided by the derived ones, have the mean 0 and standard deviation 1.

    A sphere has no orientation to average over, but its size varies; the edges of polyhedra have higher-order effects.
    """
    ratios = []
    for seed in range(5):
        bed = spaced(kind, seed)
        grid = voxels(bed, 0.5e-3, "leave")
        counts = np.bincount(grid.labels.ravel(), minlength=28)[1:]
        error = counts * grid.spacing.prod() - bed["volume"].values
        ratios.append(error / np.sqrt(GRID_VARIANCE * surface_areas(bed) * 0.5e-3**4))
    ratios = np.concatenate(ratios)
    n = len(ratios)
    assert abs(ratios.mean()) < 4.0 / np.sqrt(n)
    assert ratios.std() == pytest.approx(1.0, abs=4.0 / np.sqrt(2.0 * n))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("size", [1e-3, 0.5e-3, 0.25e-3])
def test_porosity_is_that_of_exact_slices_within_its_error(kind, size):
    """The planes are faces of voxels, so the cut itself has no error; four standard errors are allowed."""
    bed = spaced(kind)
    grid = voxels(bed, size)
    low, high = 0.008, 0.022
    assert low / size == pytest.approx(round(low / size)) and high / size == pytest.approx(round(high / size))
    assert not grid.origin.any()
    part = grid.labels[:, :, round(low / size) : round(high / size)]
    porosity = 1.0 - np.count_nonzero(part) / part.size
    volume = WIDTH**2 * (high - low)
    exact = 1.0 - slab_volumes(bed, [low, high], "exact")[0] / volume
    assert porosity == pytest.approx(exact, abs=4.0 * grid.volume_error / volume)
    # The strict bound: a voxel can be wrong only if the surface is within half its diagonal.
    assert abs(porosity - exact) < surface_areas(bed).sum() * np.sqrt(3.0) * size / volume


def test_a_lattice_has_its_porosity():
    """In a simple cubic lattice all grains have the same error, so the bound is four times that of a single grain."""
    centres, width = sphere_lattice("sc", 3, 3)
    bed = make_packing(1e-2 * centres, 5e-3, width=1e-2 * width)
    grid = voxels(bed, 0.25e-3)
    assert grid.labels.shape == (120, 120, 120)
    single = 4.0 * np.sqrt(GRID_VARIANCE * np.pi * 1e-4 * 0.25e-3**4) / 1e-6
    assert grid.porosity == pytest.approx(1.0 - np.pi / 6.0, abs=single)


def test_an_upright_cube_fills_its_voxels_and_no_other():
    bed = make_packing([[0.010, 0.012, 0.006]], [[8e-3, 6e-3, 4e-3]], vertices=CUBE, width=WIDTH)
    grid = voxels(bed, 1e-3)
    expected = np.zeros_like(grid.labels)
    expected[6:14, 9:15, 4:8] = 1
    np.testing.assert_array_equal(grid.labels, expected)


def test_an_upright_prism_ends_at_its_sides():
    """The cube is turned by 45° about the vertical, so its base is no box along the grid."""
    turned = [[np.cos(np.pi / 8), 0.0, 0.0, np.sin(np.pi / 8)]]
    bed = make_packing([[0.0151, 0.0152, 0.006]], [[1e-2, 1e-2, 4e-3]], turned, CUBE, width=WIDTH)
    grid = voxels(bed, 1e-3)
    x, y = np.meshgrid((np.arange(30) + 0.5) * 1e-3 - 0.0151, (np.arange(30) + 0.5) * 1e-3 - 0.0152, indexing="ij")
    np.testing.assert_array_equal(grid.labels[:, :, 5] > 0, np.abs(x) + np.abs(y) <= 1e-2 / np.sqrt(2.0))


def test_the_grid_of_a_periodic_box_continues_on_its_other_side():
    bed = make_packing([[0.001, 0.015, 0.004]], 3e-3, width=WIDTH)
    grid = voxels(bed, 0.7e-3)  # no divisor of the width
    assert grid.spacing[0] * grid.labels.shape[0] == pytest.approx(WIDTH, rel=1e-14)
    assert grid.labels[0].any() and grid.labels[-1].any()
    whole = voxels(bed, 0.7e-3, "leave")
    assert whole.origin[0] == pytest.approx(-2e-3) and whole.labels[-1].any()


def test_copies_extend_the_grid():
    bed = make_packing([[0.001, 0.015, 0.004]], 3e-3, width=WIDTH)
    grid = voxels(bed, 0.5e-3, "copy")
    size = grid.spacing * grid.labels.shape
    assert size[0] == pytest.approx(WIDTH + 6e-3, abs=1e-3)  # two whole copies
    single = voxels(bed, 0.5e-3, "leave")
    assert np.count_nonzero(grid.labels) == pytest.approx(2 * np.count_nonzero(single.labels), rel=0.02)


def test_npz_and_vti_have_labels_and_spacing(tmp_path):
    bed = spaced("ellipsoid")
    grid = voxels(bed, 0.5e-3)
    export(bed, tmp_path / "bed.npz", voxel=0.5e-3)
    with np.load(tmp_path / "bed.npz") as file:
        np.testing.assert_array_equal(file["labels"], grid.labels)
        np.testing.assert_array_equal(file["spacing"], grid.spacing)
        np.testing.assert_array_equal(file["origin"], grid.origin)
    export(bed, tmp_path / "bed.vti", voxel=0.5e-3)
    image = pyvista.read(tmp_path / "bed.vti")
    np.testing.assert_allclose(image.spacing, grid.spacing, rtol=1e-14)
    np.testing.assert_array_equal(image["label"].reshape(grid.labels.shape, order="F"), grid.labels)
    # The voxel at the centre of a grain has the label of the grain.
    x, y, z = bed["position"].values[5]
    assert image["label"][image.find_containing_cell((x, y, z))] == 6


def test_tif_has_its_spacing_and_is_read_as_grains(tmp_path):
    bed = spaced("polyhedron")
    export(bed, tmp_path / "bed.tif", "leave", voxel=0.25e-3)
    with tifffile.TiffFile(tmp_path / "bed.tif") as file:
        labels, about = file.asarray(), file.imagej_metadata
        pages, (numerator, denominator) = len(file.pages), file.pages[0].tags["XResolution"].value
    assert about["unit"] == "mm" and about["spacing"] == pytest.approx(0.25)
    assert denominator / numerator == pytest.approx(0.25, rel=1e-6)
    grid = voxels(bed, 0.25e-3, "leave")
    np.testing.assert_array_equal(labels.transpose(2, 1, 0), grid.labels)
    assert pages == labels.shape[0]
    # Our own reader of label images returns the grains with their volumes.
    bodies = image_bodies(labels.transpose(2, 1, 0), 0.25e-3)
    volumes = [sum(body.volume for body in parts) for _, parts in bodies]
    assert [name for name, _ in bodies] == [str(grain + 1) for grain in range(27)]
    np.testing.assert_allclose(volumes, bed["volume"], atol=5.0 * grid.volume_error / np.sqrt(27))


@pytest.mark.parametrize(
    "size, message",
    [(-1e-3, "must be more than 0"), (1e-2, "at most the smallest axis"), (1e-7, "choose a larger --voxel")],
)
def test_a_wrong_size_is_refused(size, message):
    with pytest.raises(ValueError, match=message):
        voxels(strew("sphere"), size)


def test_the_default_size_resolves_small_grains_too():
    bed = make_packing([[0.01, 0.01, 0.01], [0.02, 0.02, 0.02]], [5e-3, 0.25e-3], width=WIDTH)
    grid = voxels(bed)
    assert grid.spacing[0] == pytest.approx(0.5e-3 / 4, rel=0.01)
    assert np.count_nonzero(grid.labels == 2) > 10
    assert grid.spacing[2] * grid.labels.shape[2] <= HEIGHT


@pytest.mark.parametrize("suffix", [".npz", ".tif"])
def test_voxels_outside_a_cylinder_are_neither_pores_nor_grains(tmp_path, suffix):
    """The share of pores among the voxels in the cylinder is its porosity, and the grid is as wide as the cylinder."""
    radius = 0.01
    bed = make_packing([[0.001, 0.0, 0.004], [-0.003, 0.002, 0.012]], 0.004, width=2 * radius, domain="cylinder")
    export(bed, tmp_path / f"bed{suffix}", None, voxel=0.2e-3)
    if suffix == ".npz":
        with np.load(tmp_path / "bed.npz") as file:
            labels = file["labels"]
    else:
        labels = tifffile.imread(tmp_path / "bed.tif").transpose(2, 1, 0)
    assert labels.shape[:2] == (100, 100) and set(np.unique(labels)) == {0, 1, 2, 65535}
    inside = labels[labels != 65535]
    height = 0.2e-3 * labels.shape[2]
    exact = 1.0 - 2 * (4 / 3 * np.pi * 0.004**3) / (np.pi * radius**2 * height)
    assert np.mean(inside == 0) == pytest.approx(exact, abs=0.002)
