"""Voxels of the evaluated part of a bed: porosity, layers, the cylinder's wall, and sizes."""

import numpy as np
import pytest

from simcore.evaluation.porosity import bulk_porosity, domain_area
from simcore.evaluation.slicing import slab_volumes
from simcore.pores import image
from simcore.pores.image import TooManyVoxels, pore_image, voxel_sizes
from tests.helpers.packings import make_packing, sphere_lattice
from tests.helpers.random_beds import strew


def lattice(domain="periodic"):
    centres, width = sphere_lattice("sc", 3, 6)
    if domain == "cylinder":
        centres = centres - [1.0, 1.0, 0.0]
        centres = centres[np.hypot(centres[:, 0], centres[:, 1]) < 1.2]
    return make_packing(0.01 * centres, 0.005, width=0.01 * width, domain=domain)


def test_porosity_is_that_of_the_bulk():
    bed = lattice()
    bulk = bulk_porosity(bed, method="exact", cut=0.01)
    low, high = float(bulk["z_lower"]), float(bulk["z_upper"])
    found = pore_image(bed, low, high, 0.25e-3)
    assert found.height == pytest.approx(high - low, rel=1e-9)
    assert found.porosity == pytest.approx(float(bulk["n"]), abs=0.005)
    assert found.periodic and found.inside.shape == found.pores.shape


def test_the_error_of_the_porosity_is_that_of_counting_voxels():
    """Beds at random places in the grid scatter by the stated error; that of the layers is part of that of the grid."""
    errors, stated = [], []
    for seed in range(12):
        bed = strew("ellipsoid", seed=seed)
        found = pore_image(bed, 0.004, 0.012, 0.4e-3)
        fine = pore_image(bed, 0.004, 0.012, 0.1e-3)
        assert found.height == pytest.approx(fine.height)
        errors.append(found.porosity - fine.porosity)
        stated.append(found.porosity_error)
    assert 0.5 < np.std(errors) / np.mean(stated) < 2.0


@pytest.mark.parametrize("domain", ["periodic", "cylinder"])
def test_the_porosity_is_that_of_slices_between_the_same_heights(domain):
    """The heights are planes between layers, and the area of a cylinder is that of its voxels."""
    rng = np.random.default_rng(1)
    for _ in range(8):
        bed, (low, high) = lattice(domain), rng.uniform([0.01, 0.035], [0.02, 0.045])
        if domain == "periodic":
            bed["position"][:, :2] += rng.uniform(0.0, 0.002, 2)
        found = pore_image(bed, low, high, rng.uniform(0.35e-3, 0.5e-3))
        exact = 1.0 - slab_volumes(bed, [low, high], "exact")[0] / (domain_area(bed) * (high - low))
        assert found.height == pytest.approx(high - low, rel=1e-9)
        # Five columns of equal spheres are cut by the layers at the same heights.
        tolerance = 5.0 * found.porosity_error if domain == "periodic" else 0.003
        assert found.porosity == pytest.approx(exact, abs=tolerance)


@pytest.mark.parametrize("edge", [0.8e-3, 0.6e-3, 0.45e-3, 0.3e-3])
def test_the_error_of_the_porosity_in_a_cylinder_contains_that_of_its_area(edge):
    rng = np.random.default_rng(2)
    places = 7.5e-3 * (np.stack(np.unravel_index(np.arange(27), (3, 3, 3)), axis=1) - [1, 1, -0.5])
    places += rng.uniform(-5e-4, 5e-4, places.shape)
    bed = make_packing(places, 3e-3, width=0.03, domain="cylinder")
    found = pore_image(bed, 0.004, 0.012, edge)
    exact = 1.0 - slab_volumes(bed, [0.004, 0.012], "exact")[0] / (domain_area(bed) * 0.008)
    assert found.area_error == pytest.approx(abs(found.area - domain_area(bed))) and found.area_error > 0.0
    assert abs(found.porosity - exact) < 3.0 * found.porosity_error


def test_the_porosity_between_the_grains_of_a_cylinder_is_1():
    """The area of the circle of voxels is that over which their volume is divided."""
    bed = make_packing([[0.0, 0.0, 0.005], [0.0, 0.0, 0.045]], 0.005, width=0.03, domain="cylinder")
    assert pore_image(bed, 0.015, 0.035, 0.47e-3).porosity == pytest.approx(1.0, rel=1e-12)


def test_outside_a_cylinder_there_are_no_pores():
    """The porosity is that of the whole section of a cylinder with five columns of spheres, except a rim of 0.5 %."""
    found = pore_image(lattice("cylinder"), 0.01, 0.03, 0.2e-3)
    exact = 1.0 - 5.0 * (np.pi / 6.0) / (np.pi * 1.5**2)
    assert not found.periodic
    assert found.porosity == pytest.approx(exact, rel=0.005)


def test_grains_in_the_middle_of_a_cylinder_leave_its_rim_to_the_pores():
    centres = np.column_stack([np.full((4, 2), 1e-3), 0.005 + 0.01 * np.arange(4)])
    bed = make_packing(centres, 0.005, width=0.03, domain="cylinder")
    found = pore_image(bed, 0.01, 0.03, 0.25e-3)
    assert found.porosity == pytest.approx(1.0 - np.pi / 6.0 / (np.pi * 1.5**2), abs=0.002)


def test_a_margin_adds_layers_that_do_not_count():
    plain = pore_image(lattice(), 0.02, 0.03, 0.5e-3)
    wide = pore_image(lattice(), 0.02, 0.03, 0.5e-3, margin=0.01)
    assert wide.pores.shape[2] == plain.pores.shape[2] + 40
    np.testing.assert_array_equal(wide.inside, plain.inside)
    assert wide.porosity == plain.porosity


def test_sizes_are_a_fortieth_and_larger_for_large_beds(monkeypatch):
    bed = lattice()
    assert voxel_sizes(bed, 0.01, 0.03) == pytest.approx((0.01 / 20, 0.01 / 40))
    assert voxel_sizes(bed, 0.01, 0.03, 1e-4) == (2e-4, 1e-4)
    monkeypatch.setattr(image, "DEFAULT_MOST", 18_000)
    coarse, fine = voxel_sizes(bed, 0.01, 0.03)
    assert fine == pytest.approx(1e-3) and coarse == 2.0 * fine


def test_voxels_are_never_larger_than_the_smallest_grain(monkeypatch):
    bed = make_packing([[0.01, 0.01, 0.01], [0.03, 0.03, 0.001]], [0.01, 0.001])
    assert voxel_sizes(bed, 0.0, 0.02)[0] <= 2e-3
    monkeypatch.setattr(image, "DEFAULT_MOST", 100_000)
    with pytest.raises(TooManyVoxels, match="2 mm thick, needs 0.2 million voxels, .* give --voxel '1 mm'"):
        voxel_sizes(bed, 0.0, 0.02)
    assert voxel_sizes(bed, 0.0, 0.02, 1e-3) == (2e-3, 1e-3)


def test_too_thin_slabs_are_refused():
    with pytest.raises(ValueError, match="fewer than two layers"):
        pore_image(lattice(), 0.02, 0.0205, 0.5e-3)
