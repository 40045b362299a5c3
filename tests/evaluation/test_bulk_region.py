"""The bulk region excludes the floor, the surface and the side wall by the stated rule."""

import numpy as np
import pytest

from simcore.evaluation.bulk_region import FLOOR_LAYER, SURFACE_LAYER, WALL_LAYER, bulk
from tests.helpers.packings import make_packing, sphere_lattice


def test_default_leaves_out_the_stated_number_of_long_axes():
    centres, width = sphere_lattice("fcc", 3, 6)
    bed = make_packing(1e-2 * centres, 5e-3, width=1e-2 * width)
    inner = bulk(bed)
    z = bed["position"].values[:, 2]
    low, high, top = (float(inner.porosity[name]) for name in ("z_lower", "z_upper", "bed_top"))
    assert low == pytest.approx(FLOOR_LAYER * 1e-2) and high == pytest.approx(top - SURFACE_LAYER * 1e-2)
    np.testing.assert_array_equal(inner.grains, (z >= low) & (z <= high))
    # The surface is where the bed is half solid: within the topmost layer of spheres.
    assert z.max() - 5e-3 < top < z.max() + 5e-3


def test_deposits_of_four_long_axes_keep_a_bulk():
    """The beds of upright and horizontal ellipsoids are four to four and a half long axes high."""
    semi_axes = np.array([2e-3, 3e-3, 6e-3])
    lying = np.sqrt([0.5, 0.0, 0.5, 0.0])  # long axis along x
    for orientation, cell in (([1.0, 0, 0, 0], 2 * semi_axes), (lying, 2 * semi_axes[[2, 1, 0]])):
        layers = int(np.ceil(4.0 * 12e-3 / cell[2] + 0.1))
        number = np.array([*np.round(24e-3 / cell[:2]).astype(int), layers])
        centres = (np.stack(np.meshgrid(*map(np.arange, number), indexing="ij"), -1).reshape(-1, 3) + 0.5) * cell
        bed = make_packing(centres, np.tile(semi_axes, (len(centres), 1)), [orientation] * len(centres), width=24e-3)
        inner = bulk(bed)
        assert 0 < inner.grains.sum() < len(centres)
        assert float(inner.porosity["n"]) == pytest.approx(1 - np.pi / 6, abs=0.12)  # the ends may cut a layer


def test_one_long_grain_does_not_move_the_ends():
    centres, width = sphere_lattice("sc", 5, 12)
    scale = np.full((len(centres), 3), 0.5)
    usual = bulk(make_packing(centres, scale, width=width))
    scale[7] = [0.1, 0.1, 2.0]
    one = bulk(make_packing(centres, scale, width=width))
    assert float(one.porosity["z_lower"]) == pytest.approx(float(usual.porosity["z_lower"]), rel=0.01)


def test_size_of_the_grains_does_not_matter():
    centres, width = sphere_lattice("bcc", 3, 7)
    small, large = (bulk(make_packing(size * centres, 0.5 * size, width=size * width)) for size in (1e-5, 10.0))
    np.testing.assert_array_equal(small.grains, large.grains)
    assert float(small.porosity["n"]) == pytest.approx(float(large.porosity["n"]), rel=1e-9)


def test_grains_beside_a_cylinder_s_wall_are_left_out():
    centres, width = sphere_lattice("sc", 9, 8)
    centres[:, :2] -= 4.0
    bed = make_packing(centres, 0.5, width=10.0, domain="cylinder")
    inner = bulk(bed).grains
    distance = 5.0 - np.hypot(*centres[:, :2].T)
    assert inner.any() and distance[inner].min() >= WALL_LAYER
    narrower = bulk(bed, cut=1.0).grains
    assert narrower.sum() > inner.sum() and distance[narrower].min() >= 1.0


def test_a_narrow_cylinder_and_a_low_bed_are_errors():
    centres, _ = sphere_lattice("sc", 3, 8)
    centres[:, :2] -= 1.0
    narrow = make_packing(1e-2 * centres, 5e-3, width=3.5e-2, domain="cylinder")
    with pytest.raises(ValueError, match="no grain is left .*, 20.0 mm from the wall; use more grains"):
        bulk(narrow)
    low, width = sphere_lattice("sc", 3, 2)
    with pytest.raises(ValueError, match="too low to cut 20.0 mm from its floor and 10.0 mm from its surface"):
        bulk(make_packing(1e-2 * low, 5e-3, width=1e-2 * width))
    with pytest.raises(ValueError, match="contains no grain"):
        bulk(make_packing(np.zeros((0, 3)), np.zeros((0, 3))))
