"""A packing and its file."""

import json
import subprocess
import sys

import numpy as np
import pytest
import trimesh
import xarray as xr

import simcore
from simcore.packing.file import packing_dataset, read_packing, write_packing
from simcore.packing.process import pack
from simcore.scene.specification import resolve
from tests.helpers.few_spheres import FEW_SPHERES, set_up_few_spheres


@pytest.fixture(scope="module")
def made():
    specification = resolve(FEW_SPHERES)
    setup = set_up_few_spheres()
    packed = pack(setup.scene, setup.bases, setup.draw)
    sample = setup.sample(np.arange(len(packed.bodies.mass)))
    attributes = {"largest_sieve_size": setup.curve.largest}
    return packed, packing_dataset(setup.scene, setup.bases, packed, sample, specification, setup.curve, **attributes)


def test_the_file_has_the_distance_of_the_time_step_from_its_limits(made):
    packed, dataset = made
    attrs = dataset.attrs
    assert attrs["steps_per_contact_time"] == 40.0
    assert attrs["stability_margin_expected"] > 1.0 > attrs["stability_margin_cautious"]
    # This margin is sampled from single grains at some steps, which need fewer steps than the worst case of a bed.
    assert attrs["stability_margin_sampled"] > attrs["stability_margin_expected"]
    assert attrs["stability_margin_sampled"] * packed.stability.needed == pytest.approx(40.0)
    assert 0 <= attrs["stiffest_grain"] < 40 and attrs["stiffest_grain_contacts"] >= 3
    assert 0.0 < attrs["deepest_overlap_in_half_thicknesses"] < 1.0


def test_a_single_grain_in_a_cylinder_has_a_file():
    """The number of the wall, -2, is not that of a grain."""
    setup = set_up_few_spheres(
        domain={"type": "cylinder", "width": "9 mm", "height": "0.3 m"},
        amount={"grains": 1},
        sizes={"bounds": ["7 mm", "7.001 mm"], "allow_few_top_grains": True},
    )
    packed = pack(setup.scene, setup.bases, setup.draw)
    dataset = packing_dataset(setup.scene, setup.bases, packed, setup.sample(np.arange(1)), resolve(FEW_SPHERES))
    assert dataset["contact_body"].values[:, 0].tolist() == [0, 0]
    assert sorted(dataset["contact_body"].values[:, 1]) == [-2, -1]


def test_the_file_holds_what_was_packed(made, tmp_path):
    packed, dataset = made
    path = tmp_path / "filed.nc"
    write_packing(path, dataset)
    assert [file.name for file in tmp_path.iterdir()] == ["filed.nc"]  # no .part is left
    read = read_packing(path)
    xr.testing.assert_identical(read, read_packing(path))
    for name in dataset.data_vars:
        np.testing.assert_array_equal(read[name].values, dataset[name].values)
    assert read.attrs["converged"] == 1
    assert read.attrs["seed"] == 1
    assert json.loads(read.attrs["scene"]) == json.loads(json.dumps(resolve(FEW_SPHERES)))
    assert read.attrs["code_version"].startswith("0.")
    assert all("units" in read[name].attrs for name in read.data_vars if read[name].dtype.kind == "f")


def test_centres_are_in_the_box_and_contacts_still_meet(made):
    packed, dataset = made
    position = dataset["position"].values
    assert ((position[:, :2] >= 0.0) & (position[:, :2] < 0.025)).all()
    moved = (position - packed.bodies.position)[:, :2] / 0.025
    np.testing.assert_allclose(moved, np.round(moved), atol=1e-9)
    body, image = dataset["contact_body"].values, dataset["contact_image"].values
    grains = body[:, 1] >= 0
    assert grains.sum() > 40 and (body[~grains, 1] == -1).all() and (~grains).sum() > 0
    a, b = body[grains].T
    between = position[b] - position[a]
    between[:, :2] += 0.025 * image[grains]
    radius = dataset["scale"].values[:, 0]
    overlap = radius[a] + radius[b] - np.linalg.norm(between, axis=1)
    np.testing.assert_allclose(overlap, dataset["contact_overlap"].values[grains], atol=1e-15)
    normal = dataset["contact_normal"].values[grains]
    np.testing.assert_allclose(normal, between / np.linalg.norm(between, axis=1, keepdims=True), atol=1e-12)
    point = dataset["contact_point"].values[grains]
    middle = position[a] + normal * (radius[a] - 0.5 * overlap)[:, None]
    np.testing.assert_allclose(point, middle, atol=1e-15)


def test_contact_forces_carry_the_weight(made):
    packed, dataset = made
    floor = dataset["contact_body"].values[:, 1] == -1
    force = dataset["contact_force"].values[floor]
    assert (force[:, 2] < 0.0).all()  # on the floor
    weight = dataset["volume"].values.sum() * 2650.0 * 9.81 * (1.0 - 1000.0 / 2650.0)
    unbalanced = packed.bodies.net_force[:, 2].sum()
    assert -force[:, 2].sum() == pytest.approx(weight + unbalanced, rel=1e-12)


def test_files_that_cannot_be_read_give_an_error_of_one_line(made, tmp_path):
    _, dataset = made
    with pytest.raises(ValueError, match=r"none.nc: there is no such file. Make it with"):
        read_packing(tmp_path / "none.nc")
    path = tmp_path / "filed.nc"
    write_packing(path, dataset)
    short = tmp_path / "short.nc"
    short.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    (tmp_path / "bed.yaml").write_text("name: bed\n")
    with pytest.raises(
        ValueError, match=r"bed.yaml is a specification. Pack it first: `scree pack .*bed.yaml .*bed.nc`"
    ):
        read_packing(tmp_path / "bed.yaml")
    with pytest.raises(ValueError, match=r"short.nc cannot be read as netCDF .*It may be truncated"):
        read_packing(short)
    other = tmp_path / "other.nc"
    xr.Dataset({"n": ("z", [0.4])}).to_netcdf(other)
    with pytest.raises(ValueError, match=r"other.nc is not a packing: position, .* missing"):
        read_packing(other)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda packing: packing.attrs.pop("domain_shape"), "is not a packing: domain_shape missing"),
        (lambda packing: packing.attrs.update(scene="[]"), "the attribute scene is not a specification"),
        (
            lambda packing: packing.attrs.update(scene="{"),
            "the attribute scene is not JSON, so that the file is damaged",
        ),
        (lambda packing: packing.attrs.update(domain_shape="Periodic"), "the attribute domain_shape is 'Periodic' and"),
        (
            lambda packing: packing.attrs.update(domain_width=0.0),
            "the attribute domain_width is .* but must be a positive number",
        ),
        (lambda packing: packing.attrs.update(domain_width="25 mm"), "domain_width is '25 mm', but must be a positive"),
        (lambda packing: packing["scale"].values.__setitem__((5, 0), np.nan), "scale of grain 5 is"),
        (
            lambda packing: packing["contact_overlap"].values.__setitem__(2, np.nan),
            "contact_overlap of contact 2",
        ),
        (lambda packing: packing["shape"].values.__setitem__(5, 7), "shape of grain 5 is 7"),
        (lambda packing: packing["position"].values.__setitem__((5, 0), np.nan), "position of grain 5 is"),
        (lambda packing: packing["position"].values.__setitem__((5, 2), 1e300), "position of grain 5 is"),
        (lambda packing: packing["orientation"].values.__setitem__(3, 0.0), "orientation of grain 3 is"),
        (lambda packing: packing["volume"].values.__setitem__(4, -1e-9), "volume of grain 4 is -1e-09"),
        (
            lambda packing: packing["contact_body"].values.__setitem__((0, 0), 10**6),
            "a contact is of a grain that does",
        ),
    ],
)
def test_a_damaged_file_is_refused(made, tmp_path, change, message):
    dataset = made[1].copy(deep=True)
    change(dataset)
    dataset.to_netcdf(tmp_path / "filed.nc")
    with pytest.raises(ValueError, match=f"filed.nc.*{message}"):
        read_packing(tmp_path / "filed.nc")


def test_volumes_in_another_unit_and_diameters_as_semi_axes_are_refused(made, tmp_path):
    """Results of another program that are put into a Dataset are checked as files are."""
    dataset = made[1].copy(deep=True)
    dataset["scale"].values[:] *= 2.0
    with pytest.raises(
        ValueError, match=r"porosity: the Dataset: volume of grain 0 is .* semi-axes \[m\], not diameters"
    ):
        simcore.porosity(dataset)
    dataset = made[1].copy(deep=True)
    dataset["volume"].values[:] *= 1e9
    with pytest.raises(ValueError, match=r"write_packing: the Dataset: volume of grain 0 .*volume is in m³"):
        write_packing(tmp_path / "mm3.nc", dataset)
    with pytest.raises(ValueError, match="porosity: the Dataset is not a packing: D missing"):
        simcore.porosity(made[1].drop_vars("D"))
    with pytest.raises(ValueError, match="a contact is of a grain that does not exist, which no packing has. Correct"):
        simcore.coordination_number(made[1].isel(grain=slice(0, 20)))
    with pytest.raises(ValueError, match="porosity: the packing is of the type dict; give the path"):
        simcore.porosity({})
    with pytest.raises(
        ValueError, match="write_packing: the path is of the type Dataset; give the name of a file first"
    ):
        write_packing(made[1], tmp_path / "bed.nc")
    with pytest.raises(ValueError, match="has the name of a specification"):
        write_packing(tmp_path / "bed.yaml", made[1])
    with pytest.raises(OSError, match=r"the folder .*absent does not exist; make it first"):
        write_packing(tmp_path / "absent" / "bed.nc", made[1])
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["shape_kind", "shape_faces", "contact_overlap", "contact_force"])
def test_a_file_without_what_an_evaluation_needs_is_no_packing(made, tmp_path, name):
    made[1].drop_vars(name).to_netcdf(tmp_path / "filed.nc")
    with pytest.raises(ValueError, match=f"filed.nc is not a packing: {name} missing"):
        read_packing(tmp_path / "filed.nc")


def test_a_file_that_another_program_writes_to_is_not_called_truncated(made, tmp_path):
    path = tmp_path / "filed.nc"
    write_packing(path, made[1])
    writer = (
        "import netCDF4, sys; file = netCDF4.Dataset(sys.argv[1], 'a'); print('open', flush=True); sys.stdin.read()"
    )
    command = [sys.executable, "-c", writer, str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "open\n"
        with pytest.raises(ValueError, match=r"filed\.nc is in use by another program"):
            read_packing(path)
        process.stdin.close()
    xr.testing.assert_identical(read_packing(path), read_packing(path))


def test_the_file_has_the_specified_and_the_drawn_sieve_fractions(made):
    """The curve of `made` has one class; a file of two classes is made here without a simulation."""
    packed, dataset = made
    assert dataset["mass_fraction_drawn"].values == dataset["mass_fraction_specified"].values == 1.0
    setup = set_up_few_spheres(sizes={"bounds": ["4 mm", "6 mm", "9 mm"], "mass_fractions": [0.4, 0.6]})
    sample = setup.sample(np.arange(40))
    two = packing_dataset(setup.scene, setup.bases, packed, sample, {}, setup.curve)
    np.testing.assert_array_equal(two["sieve_bounds"], [[4e-3, 6e-3], [6e-3, 9e-3]])
    np.testing.assert_array_equal(two["mass_fraction_specified"], [0.4, 0.6])
    fine = sample.volume[sample.D < 6e-3].sum() / sample.volume.sum()
    np.testing.assert_allclose(two["mass_fraction_drawn"], [fine, 1.0 - fine], rtol=1e-12)
    assert abs(fine - 0.4) > 1e-6  # forty grains do not match it
    assert "sieve_class" not in packing_dataset(setup.scene, setup.bases, packed, sample, {}).dims


def test_a_write_that_fails_leaves_the_old_file(made, tmp_path, monkeypatch):
    _, dataset = made
    path = tmp_path / "filed.nc"
    write_packing(path, dataset)
    before = path.read_bytes()

    def fail(self, target, **options):
        target.write_bytes(b"half")
        raise OSError("no space left on device")

    monkeypatch.setattr(xr.Dataset, "to_netcdf", fail)
    with pytest.raises(OSError, match="no space"):
        write_packing(path, dataset)
    assert path.read_bytes() == before


def test_base_shapes_are_closed_about_their_centre_of_mass(tmp_path):
    trimesh.creation.box((6.0, 5.0, 4.0)).export(tmp_path / "box.stl")
    settings = {
        "name": "boxes", "seed": 1, "grains": {"source": str(tmp_path / "box.stl"), "unit": "mm"},
        "domain": {"type": "periodic", "width": "25 mm", "height": "0.2 m"}, "amount": {"grains": 12},
        "sizes": {"bounds": ["5.6 mm", "8 mm"], "mass_fractions": [1]}, "shaking": {"duration": "0 s"},
    }  # fmt: skip
    bed = simcore.pack(settings, force=True)
    simcore.write_packing(tmp_path / "bed.nc", bed)
    moved = bed.copy(deep=True)
    moved["shape_vertices"].values[:] += 1.0
    with pytest.raises(ValueError, match="vertices of base shape 0 are not relative to its centre of mass"):
        simcore.write_packing(tmp_path / "moved.nc", moved)
    wrong = bed.copy(deep=True)
    wrong["shape_faces"].values[0, 0] = 10**6
    with pytest.raises(ValueError, match="base shape 0 has faces or vertices that do not exist"):
        simcore.write_packing(tmp_path / "wrong.nc", wrong)
