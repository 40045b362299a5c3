"""Profile and bulk porosity: lattices, the evaluated interval, and errors for beds that have none."""

import numpy as np
import pytest

from simcore.evaluation.interval import end_cuts
from simcore.evaluation.porosity import bed_top, bulk_porosity, evaluation_interval, porosity_profile
from tests.helpers.packings import make_packing, sphere_lattice
from tests.helpers.polyhedra import CUBE

# The values are the porosity and the height after which the layers repeat, in sphere diameters.
LATTICES = {
    "sc": (1 - np.pi / 6, 1.0),
    "bcc": (1 - np.pi * np.sqrt(3) / 8, 2 / np.sqrt(3)),
    "fcc": (1 - np.pi / (3 * np.sqrt(2)), np.sqrt(2)),
}


@pytest.fixture
def simple_cubic():
    """Return a simple cubic bed of 4 x 4 x 12 spheres of 10 mm."""
    centres, width = sphere_lattice("sc", 4, 12)
    return make_packing(1e-2 * centres, 5e-3, width=1e-2 * width, seed=3)


@pytest.mark.parametrize("method", ["spheres", "exact"])
@pytest.mark.parametrize("kind", LATTICES)
def test_lattices_have_their_porosity(kind, method):
    expected, period = LATTICES[kind]
    centres, width = sphere_lattice(kind, 3, 8)
    bed = make_packing(centres, 0.5, width=width)
    top = bed_top(porosity_profile(bed, 0.05, method))
    bulk = bulk_porosity(bed, method, cut=0.5 * (top - 5 * period), slice_height=0.05)
    assert float(bulk["n"]) == pytest.approx(expected, rel=1e-12)
    # A lattice has no scatter; spheres placed independently would have (1 - n) / sqrt(number).
    in_interval = (1 - expected) * width**2 * 5 * period * 6 / np.pi
    assert float(bulk["n_std_error"]) < 0.1 * (1 - expected) / np.sqrt(in_interval)


def test_profile_counts_all_solid_volume(simple_cubic):
    for height in (1e-3, 0.7e-3):
        profile = porosity_profile(simple_cubic, height)
        assert float(profile["solid_volume"].sum()) == pytest.approx(float(simple_cubic["volume"].sum()), rel=1e-12)
        assert float(profile["solid_volume_below_floor"]) == 0.0
        assert float(profile["porosity"][-1]) == 1.0


def test_the_profile_gives_the_volume_below_the_floor():
    flat = make_packing([[0, 0, 1e-3]], [[4e-3, 4e-3, 1e-3]])
    assert float(porosity_profile(flat, method="exact")["solid_volume_below_floor"]) == pytest.approx(0.0, abs=1e-20)
    spheres = porosity_profile(flat)
    below = float(spheres["solid_volume_below_floor"])
    r = 1e-3 * 16 ** (1 / 3)
    h = r - 1e-3
    assert below == pytest.approx(np.pi * h**2 * (r - h / 3), rel=1e-12)
    assert below + float(spheres["solid_volume"].sum()) == pytest.approx(float(flat["volume"][0]), rel=1e-12)


def test_profile_follows_cf(simple_cubic):
    profile = porosity_profile(simple_cubic)
    assert profile.attrs["Conventions"].startswith("CF-") and profile.attrs["seed"] == 3
    for dataset in (profile, bulk_porosity(simple_cubic)):
        assert all({"units", "long_name"} <= set(dataset[name].attrs) for name in dataset if name != "z_bounds")
    assert profile["z"].attrs["bounds"] == "z_bounds"


def test_cylinder_is_measured_from_the_floor_on_its_own_area():
    # An upright prism has the same solid area in every slice, so the bulk porosity is known exactly.
    cube = make_packing([[0, 0, 10e-3]], [[8e-3, 8e-3, 20e-3]], vertices=CUBE, width=1e-2, domain="cylinder")
    bulk = bulk_porosity(cube, "exact")
    assert (float(bulk["z_lower"]), float(bulk["z_upper"])) == (0.0, pytest.approx(20e-3))
    assert float(bulk["n"]) == pytest.approx(1 - 64e-6 / (np.pi / 4 * 1e-4), rel=1e-12)


@pytest.mark.parametrize("cut", [-0.01, (0.0, -1e-3), np.nan, np.inf])
def test_a_cut_is_a_height(cut):
    with pytest.raises(ValueError, match="is no height to leave out; give lengths"):
        end_cuts(True, 0.1, 8e-3, 7e-3, cut)


def test_surface_is_the_uppermost_crossing_and_ends_are_cut():
    # The solid fraction is 0.64 in 0-20 mm, 0.16 in 20-30 mm and 0.64 in 30-40 mm: a loose layer below the surface.
    width = 10e-3
    bed = make_packing(
        [[0, 0, 10e-3], [0, 0, 25e-3], [0, 0, 35e-3]],
        [[8e-3, 8e-3, 20e-3], [4e-3, 4e-3, 10e-3], [8e-3, 8e-3, 10e-3]],
        vertices=CUBE,
        width=width,
        largest=5e-3,
    )
    profile = porosity_profile(bed, method="exact")
    assert bed_top(profile) == pytest.approx(40e-3)
    n = float(bulk_porosity(bed, "exact", cut=5e-3)["n"])
    assert n == pytest.approx(1 - (15 * 0.64 + 10 * 0.16 + 5 * 0.64) / 30, rel=1e-12)
    # A cut inside a slice is exact too.
    n = float(bulk_porosity(bed, "exact", cut=7.3e-3)["n"])
    assert n == pytest.approx(1 - ((20 - 7.3) * 0.64 + 10 * 0.16 + (10 - 7.3) * 0.64) / (40 - 14.6), rel=1e-12)


@pytest.mark.parametrize("layers, refused", [(8, True), (2, False)])
def test_a_bed_less_than_half_solid_above_its_floor_is_refused(layers, refused):
    """The solid fraction is 0.64 in the floor layer and 0.45 above: the surface would be that of the floor layer.

    Two layers are less than one grain size thick, as the half-empty layer at the surface of a bed may be.
    """
    sides = np.array([8e-3] + [np.sqrt(0.45) * 1e-2] * layers)
    heights = 8e-3 * (np.arange(layers + 1) + 0.5)
    bed = make_packing(
        np.column_stack([0 * heights, 0 * heights, heights]),
        np.column_stack([sides, sides, np.full(layers + 1, 8e-3)]),
        vertices=CUBE,
        width=1e-2,
        largest=8e-3,
    )
    bed["D"] = bed["D"] * 0 + 8e-3
    profile = porosity_profile(bed, method="exact")
    if refused:
        with pytest.raises(ValueError, match=r"less than half solid above a height of 8.0 mm, where 85 % .* settled"):
            evaluation_interval(bed, profile, cut=1e-3)
    else:
        assert evaluation_interval(bed, profile, cut=1e-3) == (1e-3, pytest.approx(7e-3))


@pytest.mark.parametrize(
    ("layers", "at_surface"),
    [(20, 25.0), (10, 50.0 / 3.0), (4, 8.0)],
    ids=["five median grains", "a third of a low bed", "the largest size in a very low one"],
)
def test_what_shaking_packs_closer_at_the_surface_is_no_bulk(layers, at_surface):
    """The beds are stacked cubes of 5 mm, and the largest size of the sieve curve is 8 mm."""
    heights = 5e-3 * (np.arange(layers) + 0.5)
    bed = make_packing(
        np.column_stack([0 * heights, 0 * heights, heights]),
        np.full((layers, 3), 5e-3),
        vertices=CUBE,
        width=6e-3,
        largest=8e-3,
    )
    bed["D"] = bed["D"] * 0 + 5e-3
    low, high = evaluation_interval(bed, porosity_profile(bed, method="exact"))
    assert low == pytest.approx(8e-3)
    assert 5.0 * layers - 1e3 * high == pytest.approx(at_surface)


def test_a_bed_that_is_too_low_is_an_error(simple_cubic):
    with pytest.raises(ValueError, match="too low to cut 70.0 mm from its floor and 70.0 mm from its surface"):
        bulk_porosity(simple_cubic, cut=70e-3)


def test_a_loose_cloud_has_no_surface():
    with pytest.raises(ValueError, match="no slice .* has no surface"):
        bulk_porosity(make_packing([[0.01, 0.01, 0.02]], 5e-3))


def test_an_empty_packing_is_refused():
    with pytest.raises(ValueError, match="no grain"):
        porosity_profile(make_packing(np.zeros((0, 3)), np.zeros((0, 3))))


def test_a_bed_of_small_grains_has_thinner_slices():
    """The porosity of a bed does not depend on the unit of length; beds of at least 2 mm have slices of 1 mm."""
    found = []
    for diameter in (0.0002, 0.002, 0.02):
        centres, width = sphere_lattice("fcc", 3, 14)
        packing = make_packing(diameter * centres, 0.5 * diameter, width=diameter * width, largest=diameter)
        found.append(bulk_porosity(packing))
    assert [bulk.slice_height for bulk in found] == [0.0001, 0.001, 0.001]
    assert float(found[0].n) == pytest.approx(float(found[1].n), rel=1e-9)
    assert float(found[0].z_upper) == pytest.approx(0.1 * float(found[1].z_upper), rel=1e-9)


def test_a_bed_of_which_one_slice_is_left_is_evaluated():
    """11 mm without 5 mm at both ends is 1 mm, but a little less in floating-point numbers."""
    prism = make_packing([[0, 0, 5.5e-3]], [[8e-3, 8e-3, 11e-3]], vertices=CUBE, width=1e-2)
    assert 11e-3 - 5e-3 - 5e-3 < 1e-3
    bulk = bulk_porosity(prism, "exact", cut=5e-3, slice_height=1e-3)
    assert float(bulk["n"]) == pytest.approx(1 - 0.64, rel=1e-9)
    with pytest.raises(ValueError, match="too low to cut 5.1 mm"):
        bulk_porosity(prism, "exact", cut=5.1e-3, slice_height=1e-3)
