"""Fabric of crystals in exact numbers, of random beds within stated errors, of several seeds, and its text."""

import json

import numpy as np
import pytest
import xarray as xr
from scipy.stats import norm

from simcore.evaluation.bulk_region import bulk
from simcore.evaluation.contact_radius import BIN_WIDTH
from simcore.evaluation.fabric import fabric, fabric_over_seeds
from simcore.evaluation.fabric_text import fabric_text
from tests.helpers.packings import make_packing, sphere_lattice, touching_pairs
from tests.helpers.polyhedra import CUBE
from tests.helpers.rotations import random_orientations

# kind: (contacts per sphere, <P4> of the normals)
CRYSTALS = {"sc": (6, (2 * 3 / 8 + 1) / 3), "bcc": (8, -7 / 18), "fcc": (12, -7 / 48)}


def crystal(kind, cells=3, layers=7, **attrs):
    centres, width = sphere_lattice(kind, cells, layers)
    pairs, images = touching_pairs(centres, width)
    return make_packing(centres, 0.5, width=width, contacts=pairs, images=images, **attrs)


def random_bed(seed, n=600, semi_axes=(0.3, 0.4, 0.5), scene=None, turned=None):
    """Return grains at random places of a tall box, with random pairs as contacts: normals and axes are isotropic."""
    rng = np.random.default_rng(seed)
    position = rng.uniform(0, 1, (n, 3)) * [6.0, 6.0, 12.0]
    pairs = rng.integers(0, n, (3 * n, 2))
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    scene = {"shapes": {"kind": "ellipsoid"}, "seed": seed} if scene is None else scene
    turned = random_orientations(n, seed) if turned is None else turned
    bed = make_packing(
        position, np.tile(semi_axes, (n, 1)), turned, width=6.0, contacts=pairs, seed=seed, scene=json.dumps(scene)
    )
    normals = rng.normal(size=(len(pairs), 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    for name in ("contact_normal", "contact_force"):
        bed[name] = (("contact", "xyz"), normals)
    # With larger volumes the bed is solid everywhere, so its surface is at the highest grains.
    bed["volume"] = bed["volume"] * 3.0
    return bed


@pytest.mark.parametrize("kind", CRYSTALS)
def test_crystals(kind):
    neighbours, fourth = CRYSTALS[kind]
    found = fabric(crystal(kind))
    # The number is exact although contacts across the ends of the bulk have only one end in it.
    assert float(found["coordination_number"]) == neighbours
    assert float(found["coordination_number_without_rattlers"]) == neighbours
    assert float(found["coordination_number_std_error"]) == 0.0 == float(found["rattler_fraction"])
    normal = found.sel(direction="contact_normal")
    assert float(normal["legendre"].sel(order=2)) == pytest.approx(0.0, abs=1e-12)
    assert float(normal["legendre"].sel(order=4)) == pytest.approx(fourth, rel=1e-9)
    np.testing.assert_allclose(normal["tensor"], np.eye(3) / 3, atol=1e-12)
    assert float(normal["anisotropy"]) == pytest.approx(0.0, abs=1e-12)
    # Spheres have no axes, and all their contacts are at the radius.
    assert np.isnan(found["density"].sel(direction=["long_axis", "short_axis"])).all()
    assert float(found["contact_radius"]) == pytest.approx(1.0, rel=1e-9)
    at_one = np.isclose(found["radius"], 1.0) / BIN_WIDTH
    np.testing.assert_allclose(found["contact_radius_density"], at_one)
    np.testing.assert_allclose(found["surface_radius_density"], at_one)


def test_normals_of_a_face_centred_crystal_are_in_two_bins():
    found = fabric(crystal("fcc")).sel(direction="contact_normal")
    # Two of six normals are horizontal and four at 45°; each of 20 bins of equal height has 1/20 of the hemisphere.
    expected = np.zeros(20)
    expected[19], expected[5] = 20 * 2 / 6, 20 * 4 / 6  # the sixth from the pole reaches from 0.75 down to 0.70
    np.testing.assert_allclose(found["density"], expected, rtol=1e-12)
    bounds = np.degrees(found["angle_bounds"].values)
    assert bounds[5][0] < 45.0 < bounds[5][1]
    # Horizontal normals are along the diagonals, the others along x and y.
    np.testing.assert_allclose(found["azimuth_moment"], [[0, 0], [1 / 3, 0]], atol=1e-12)


def test_solid_fraction_is_that_of_the_porosity_of_the_bulk():
    bed = crystal("fcc")
    found = fabric(bed)
    inner = bulk(bed).porosity
    assert float(found["solid_fraction"]) == pytest.approx(1 - float(inner["n"]), rel=1e-12)
    # The ends may cut a layer, so the mean over the bulk differs from the crystal's by a part of one layer.
    assert float(found["solid_fraction"]) == pytest.approx(np.pi / np.sqrt(18), abs=0.05)
    assert float(found["z_lower"]) == pytest.approx(2.0)


def test_contacts_with_walls_are_no_normals_but_bear():
    centres, width = sphere_lattice("sc", 3, 6)
    pairs, images = touching_pairs(centres, width)
    lowest = np.flatnonzero(centres[:, 2] < 0.6)
    walls = np.column_stack([lowest, np.full(len(lowest), -1)])
    bed = make_packing(
        centres,
        0.5,
        width=width,
        contacts=np.concatenate([pairs, walls]),
        images=np.concatenate([images, np.zeros_like(walls)]),
    )
    found = fabric(bed, cut=0.35)  # from the lowest layer to the highest but one
    assert int(found["grains"]) == 45
    layers = np.array([5, 6, 6, 6, 6])
    assert float(found["coordination_number"]) == pytest.approx(layers.mean())
    ends = np.array([[1, 2, 2, 2, 2, 1][: len(layers)], [4] * len(layers)]).sum(axis=1)
    tensor = found["tensor"].sel(direction="contact_normal")
    assert float(tensor.sel(row="z", column="z")) == pytest.approx(ends[0] / ends.sum(), rel=1e-12)
    one = make_packing([[0, 0, 0.5]], 0.5, width=1.0, domain="cylinder", contacts=[[0, -1], [0, -2]])
    assert float(fabric(one, cut=0.0)["coordination_number"]) == 0.0


def test_random_beds_are_isotropic_within_their_errors():
    """No statistic deviates by more standard errors than a normal variable with probability 1e-5."""
    found = fabric(random_bed(1))
    limit = norm.isf(0.5e-5)
    for name, expected in (("density", 1.0), ("legendre", 0.0)):
        pulls = (found[name] - expected) / found[f"{name}_std_error"]
        assert np.abs(pulls).max() < limit, name
    pulls = (found["tensor"] - np.eye(3) / 3) / found["tensor_std_error"]
    assert np.abs(pulls).max() < limit
    assert (found["azimuth_p_value"] > 1e-5).all()
    assert (found["vectors"].sel(direction=["long_axis", "short_axis"]) == found["grains"]).all()


def test_turning_the_bed_about_the_vertical_changes_no_statistic():
    bed = random_bed(2)
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    turned = bed.copy(deep=True)
    for name in ("contact_normal", "contact_force"):
        turned[name] = (bed[name].dims, bed[name].values @ turn.T)
    half = [np.cos(0.35), np.sin(0.35)]
    w, x, y, z = bed["orientation"].values.T
    turned["orientation"].values[:] = np.stack(
        [half[0] * w - half[1] * z, half[0] * x - half[1] * y, half[0] * y + half[1] * x, half[0] * z + half[1] * w], 1
    )
    first, second = fabric(bed), fabric(turned)
    for name in (
        "density", "legendre", "eigenvalues", "anisotropy", "determinant", "azimuth_resultant", "azimuth_p_value",
    ):  # fmt: skip
        np.testing.assert_allclose(second[name], first[name], rtol=1e-9, atol=1e-12, err_msg=name)
    expected = np.einsum("ij,djk,lk->dil", turn, first["tensor"].values, turn)
    np.testing.assert_allclose(second["tensor"], expected, atol=1e-12)
    assert np.abs(second["tensor"] - first["tensor"]).max() > 1e-3


def test_lying_grains():
    """All long axes are horizontal and all short ones vertical, as in flat stones at rest."""
    rng = np.random.default_rng(3)
    half = np.sqrt(0.5)
    # A quarter turn about y takes the long axis (z) to x and the short one (x) to -z; a random turn about z follows.
    angle = rng.uniform(0, np.pi, 600)
    lying = half * np.stack([np.cos(angle), -np.sin(angle), np.cos(angle), np.sin(angle)], axis=1)
    found = fabric(random_bed(3, turned=lying))
    assert found["legendre"].sel(order=2, direction="long_axis") == pytest.approx(-0.5)
    assert found["legendre"].sel(order=2, direction="short_axis") == pytest.approx(1.0)
    assert float(found["density"].sel(direction="long_axis")[-1]) == pytest.approx(20.0)
    assert float(found["density"].sel(direction="short_axis")[0]) == pytest.approx(20.0)
    np.testing.assert_allclose(found["eigenvalues"].sel(direction="short_axis"), [1, 0, 0], atol=1e-12)
    assert float(found["azimuth_p_value"].sel(direction="long_axis", fold=2)) > 1e-5
    assert np.isnan(found["azimuth_p_value"].sel(direction="short_axis")).all()


def test_polyhedra_are_served():
    centres, width = sphere_lattice("sc", 3, 6)
    pairs, images = touching_pairs(centres, width)
    apart = 1.1
    bed = make_packing(apart * centres, 1.0, vertices=CUBE, width=apart * width, contacts=pairs, images=images)
    # make_packing puts contacts at the first body's scale, 1; here they are in the middle between two.
    bed["contact_point"] -= (1.0 - 0.5 * apart) * bed["contact_normal"]
    found = fabric(bed, cut=1.0)
    # The ends of the interval, which is about 4 high, may include one gap of 0.1 more or less.
    assert float(found["solid_fraction"]) == pytest.approx(apart**-3, abs=0.1 / 4)
    assert float(found["contact_radius"]) == pytest.approx(0.5 * apart / (3 / (4 * np.pi)) ** (1 / 3), rel=1e-9)
    assert float((found["surface_radius_density"] * BIN_WIDTH).sum()) == pytest.approx(1.0)


def test_over_seeds():
    single = [fabric(random_bed(seed)) for seed in range(1, 6)]
    found = fabric_over_seeds(single)
    for name in ("solid_fraction", "coordination_number", "density", "legendre", "tensor", "contact_radius"):
        values = np.stack([one[name].values for one in single])
        np.testing.assert_allclose(found[name], values.mean(axis=0), rtol=1e-12)
        np.testing.assert_allclose(found[f"{name}_std_error"], values.std(axis=0, ddof=1) / np.sqrt(5), rtol=1e-9)
        np.testing.assert_array_equal(found[f"{name}_of_seed"], values)
    assert found["seed"].values.tolist() == [1, 2, 3, 4, 5] and "seed" not in found.attrs
    assert int(found["grains"]) == sum(int(one["grains"]) for one in single)
    # The eigenvalues are those of the mean tensor, because finite samples push the eigenvalues of one apart.
    tensor = np.mean([one["tensor"].values for one in single], axis=0)
    np.testing.assert_allclose(found["eigenvalues"], np.linalg.eigvalsh(tensor)[:, ::-1], rtol=1e-12)
    assert (found["anisotropy"] < found["anisotropy_of_seed"].mean("seed")).all()
    assert (found["anisotropy_std_error"] > 0).all()
    assert (found["azimuth_number"] > 4.9 * single[0]["azimuth_number"]).all()
    assert (found["azimuth_p_value"] > 1e-5).all()


def test_jackknife_of_a_linear_invariant_is_the_error_of_the_mean():
    """Vertical and horizontal axes have shares that differ by seed, so the anisotropy is linear in the tensor."""
    single = []
    for seed, share in enumerate((0.6, 0.7, 0.75, 0.9)):
        one = fabric(random_bed(seed + 1)).copy(deep=True)
        one["tensor"].values[:] = np.diag([(1 - share) / 2, (1 - share) / 2, share])
        single.append(one)
    found = fabric_over_seeds(single)
    expected = 1.5 * np.std([0.6, 0.7, 0.75, 0.9], ddof=1) / 2
    np.testing.assert_allclose(found["anisotropy_std_error"], expected, rtol=1e-9)


def test_radial_bins_of_several_seeds_are_put_together():
    """The contacts of the second bed are at the centre of one sphere and at twice the radius of the other."""
    first, second = (crystal("sc", seed=seed) for seed in (1, 2))
    second["contact_point"] += 0.5 * second["contact_normal"]
    found = fabric_over_seeds([fabric(first), fabric(second)])
    radius, share = found["radius"].values, found["contact_radius_density"].values * BIN_WIDTH
    assert radius[-1] == pytest.approx(2.0)
    assert share[np.isclose(radius, 1.0)] == pytest.approx(1 / 2) and share[-1] == pytest.approx(1 / 4, abs=0.05)
    np.testing.assert_allclose(found["surface_radius_density"], np.isclose(radius, 1.0) / BIN_WIDTH)


def test_packings_that_do_not_belong_together_are_refused():
    first, second = (fabric(random_bed(seed)) for seed in (1, 2))
    with pytest.raises(ValueError, match="needs two packings"):
        fabric_over_seeds([first])
    with pytest.raises(ValueError, match="fabric 2 has the seed 1, as has fabric 1"):
        fabric_over_seeds([first, first])
    unnamed = second.copy()
    del unnamed.attrs["seed"]
    with pytest.raises(ValueError, match="fabric 2: it has no attribute seed"):
        fabric_over_seeds([first, unnamed])
    other = {"shapes": {"kind": "polyhedron"}, "seed": 2, "name": "x"}
    with pytest.raises(
        ValueError, match="b.nc differs from a.nc in shapes.kind; give packings that differ only in their seed"
    ):
        fabric_over_seeds([first, second.assign_attrs(scene=json.dumps(other))], ["a.nc", "b.nc"])
    coarse, loose = (fabric(random_bed(2), **options) for options in ({"n_bins": 5}, {"bearing_contacts": 4}))
    for different, name in ((coarse, "n_bins"), (loose, "bearing_contacts")):
        with pytest.raises(ValueError, match=f"differs from fabric 1 in {name}"):
            fabric_over_seeds([first, different])
    with pytest.raises(ValueError, match="at least one bin"):
        fabric(random_bed(2), n_bins=0)


def test_everything_has_units_and_goes_through_a_file(tmp_path):
    single = [fabric(random_bed(seed)) for seed in (1, 2)]
    for number, found in enumerate((single[0], fabric_over_seeds(single))):
        assert all({"units", "long_name"} <= set(found[name].attrs) for name in found)
        path = tmp_path / f"{number}.nc"
        found.to_netcdf(path)
        with xr.open_dataset(path) as read:
            xr.testing.assert_allclose(read.load(), found)


def test_the_text_has_the_values_of_the_dataset():
    single = [fabric(random_bed(seed)) for seed in (1, 2)]
    text = fabric_text(fabric_over_seeds(single))
    assert text.startswith("2 packings, ") and "standard error over seeds" in text
    lines = {line[:26].strip(): line[26:].split() for line in text.splitlines()}
    both = fabric_over_seeds(single)
    normal = both["legendre"].sel(order=2, direction="contact_normal")
    assert float(lines["<P2> about the vertical"][0]) == pytest.approx(float(normal), abs=5e-5)
    assert max(map(len, text.splitlines())) <= 120
    spheres = fabric_text(fabric(crystal("fcc")))
    assert max(map(len, spheres.splitlines())) <= 120
    assert [line.split()[-1] for line in spheres.splitlines() if line.startswith("<P2>")] == ["-"]
    assert "12.0000" in spheres
