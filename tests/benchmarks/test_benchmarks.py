"""The benchmarks run and report what they document. Their speed is not tested."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from benchmarks import beds, measurement
from benchmarks.speed import features, predictions, throughput
from benchmarks.studies import bed_size, height
from simcore.evaluation.porosity import bulk_porosity
from simcore.packing.file import packing_dataset, read_packing, write_packing
from simcore.packing.process import pack
from simcore.scene.specification import resolve
from tests.helpers.few_spheres import set_up_few_spheres, specify_few_spheres


@pytest.fixture
def quick(monkeypatch):
    """Shorten the phases of a packing, so that a bed of spheres is made in a second; it need not be at rest."""
    monkeypatch.setattr(beds, "POURING_SHAKEN", 0.0)
    monkeypatch.setattr(beds, "RELAXING", 0.001)
    monkeypatch.setattr(measurement, "REMEMBERING", 1e-4)


def options(folder, *more):
    return throughput.parse(
        ["--shape", "sphere", "--grains", "30", "--duration", "1e-4", "--beds", str(folder), *map(str, more)]
    )


def test_throughput_writes_every_key_and_keeps_the_bed(tmp_path, quick):
    first = throughput.run(options(tmp_path), least_solid_fraction=0.0)
    (kept,) = tmp_path.iterdir()
    written = kept.stat().st_mtime_ns
    again = throughput.run(options(tmp_path, "--set", "numerics.steps_per_contact_time=20"), least_solid_fraction=0.0)
    assert [kept] == list(tmp_path.iterdir()) and kept.stat().st_mtime_ns == written
    assert (first["time_step"], again["time_step"]) == (5e-6, 1e-5)
    keys = {"cpu_us_per_grain_step", "cpu_us_per_contact_step", "contacts_per_grain", "solid_fraction", "compile_s"}
    keys |= {"bytes_per_grain", "bytes_per_contact_pair", "wall_us_per_grain_step", "shares", "machine"}
    assert keys <= first.keys()
    assert first["cpu_us_per_grain_step"] > 0.0 and 0.2 < first["solid_fraction"] < 0.8
    assert json.loads(json.dumps(first)) == first
    assert "µs CPU per grain and step" in throughput.line(first)


def test_pairs_on_levels_are_those_on_one(tmp_path, quick):
    options = SimpleNamespace(shape="sphere", grains=30, beds=tmp_path)
    levels, one = features.levels(options)
    assert levels["what"] == "list on 2 levels" and one["what"] == "list on one level"
    assert levels["near_pairs_per_grain"] == one["near_pairs_per_grain"] > 0.0
    assert levels["cpu_us_per_grain_step"] > 0.0


def test_what_decides_the_bed_makes_another(tmp_path, quick):
    throughput.run(options(tmp_path), least_solid_fraction=0.0)
    throughput.run(options(tmp_path, "--set", "material.friction=0.3"), least_solid_fraction=0.0)
    assert len(list(tmp_path.iterdir())) == 2


def test_a_loose_bed_is_refused(tmp_path, quick):
    with pytest.raises(measurement.LooseBed, match="has not settled"):
        throughput.run(options(tmp_path), least_solid_fraction=0.9)


def test_overrides_of_the_command_line():
    assert beds.read_overrides(["material.friction=0.3", "numerics.contact_time=1 ms", "faces=original"]) == {
        "material": {"friction": 0.3},
        "numerics": {"contact_time": "1 ms"},
        "faces": "original",
    }
    with pytest.raises(ValueError, match="group.key=value"):
        beds.read_overrides(["friction"])


def test_tiled_and_exported_beds_hold_the_same_grains(tmp_path, quick):
    settings = beds.bed_settings("sphere", 30)
    setup, bed = beds.prepare(settings), beds.settled_bed(settings, tmp_path)
    wide, tiled = beds.tile(setup, bed, 2)
    one, four = beds.start(setup, bed), beds.start(wide, tiled)
    assert len(tiled.shape) == 120 and wide.scene.domain.width == 2 * setup.scene.domain.width
    # Each copy has as many candidate pairs as the bed, although some cross the sides of the box.
    assert len(four.contacts.body_a) == 4 * len(one.contacts.body_a)
    beds.export_bed(tmp_path / "out.npz", setup, bed, steps=7)
    with np.load(tmp_path / "out.npz") as file:
        assert file["steps"] == 7 and file["position"].shape == (30, 3)
        assert (file["position"][:, :2] < file["width"]).all() and (file["position"][:, :2] >= 0.0).all()


def test_ellipsoids_have_the_axes_promised():
    setup = beds.prepare(beds.bed_settings("ellipsoid", 20))
    scale = setup.draw(np.arange(20)).scale
    np.testing.assert_allclose(scale / scale[:, 2:], [[0.5, 0.75, 1.0]] * 20, rtol=1e-12)


def test_height_separates_the_ends_of_a_bed_from_its_middle():
    """Grains of 1 mm fill 20 mm; the porosity is 0.02 lower in the upper 3 mm and 0.1 higher in the lowest 1 mm."""
    z = 1e-3 * (np.arange(0.0, 22.0, 0.25) + 0.125)
    n = np.where(z > 17e-3, 0.33, np.where(z < 1e-3, 0.45, 0.35))
    bed = xr.Dataset(
        {"profile_exact": ("z", n), "bed_top": 20e-3, "D_mean": ("layer", np.full(3, 1e-3))}, coords={"z": z}
    )
    found = height.profile_of(bed).set_index(["end", "grains_from_it"])["difference"]
    assert found["floor"].to_numpy() == pytest.approx([0.1, *np.zeros(7)])
    assert found["surface"].to_numpy() == pytest.approx([*np.full(3, -0.02), *np.zeros(5)])
    assert height.profile_of(bed.assign(bed_top=13e-3)) is None


def packed(path, **changes):
    setup = set_up_few_spheres(**changes)
    found = pack(setup.scene, setup.bases, setup.draw)
    sample = setup.sample(np.arange(len(found.bodies.mass)))
    specification = resolve(specify_few_spheres(**changes))
    more = {"largest_sieve_size": setup.curve.largest, "cpu_seconds": 1.0}
    dataset = packing_dataset(setup.scene, setup.bases, found, sample, specification, **more)
    write_packing(path, dataset)
    return str(path)


def test_bed_size_compares_what_differs_in_size_alone(tmp_path):
    few_grains = packed(tmp_path / "few.nc")
    more = packed(tmp_path / "more.nc", amount={"grains": 60}, domain={"width": "30 mm"}, seed=2)
    rows = bed_size.table([more, few_grains])
    assert rows[["width_mm", "grains", "seed"]].to_numpy().tolist() == [[25.0, 40, 1], [30.0, 60, 2]]
    assert rows.n.tolist() == [pytest.approx(float(bulk_porosity(read_packing(path)).n)) for path in (few_grains, more)]
    smoother = packed(tmp_path / "smoother.nc", material={"friction": 0.1})
    with pytest.raises(ValueError, match="is of other settings than"):
        bed_size.table([few_grains, smoother])


def test_predictions_of_both_uses_are_counted(capsys):
    predictions.main(["--number", "3"])
    head, *rows = (line.split(",") for line in capsys.readouterr().out.splitlines())
    assert head[:4] == ["use", "predictions", "refused", "cpu_s"] and [row[1:3] for row in rows] == [["3", "0"]] * 2
