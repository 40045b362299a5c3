"""The grains of a specification: warnings about them, files that are left out, and the digest of their content."""

import os
import shutil

import numpy as np
import pandas as pd
import pytest
import trimesh

from simcore.grains.grain_set import read_grains, write_grains
from simcore.grains.mesh import decimate
from simcore.grains.sources import content_digest, grain_warnings, left_out_files, load_grains, set_name, size_note
from simcore.grains.tables import form_table
from simcore.scene.specification import resolve


def group(source, **settings):
    specification = {
        "domain": {"width": "30 mm", "height": "1 m"},
        "sizes": {"case": "U1"},
        "amount": {"grains": 10},
        "grains": {"source": source if isinstance(source, list) else str(source), "unit": "mm", **settings},
    }
    return resolve(specification)["grains"]


def dented_ball():
    """Return a ball with a deep dent, whose hull has 1.2 times its volume."""
    mesh = trimesh.creation.icosphere(3, 5.0)
    mesh.vertices[mesh.vertices[:, 2] > 2.5] *= [1.0, 1.0, 0.0]
    return mesh


@pytest.fixture
def folder(tmp_path):
    place = tmp_path / "scans"
    place.mkdir()
    trimesh.creation.icosphere(2, 5.0).export(place / "round.stl")
    dented_ball().export(place / "dented.stl")
    np.savetxt(
        place / "cloud.csv", trimesh.creation.icosphere(2, 4.0).vertices, "%.6f", ",", header="x,y,z", comments=""
    )
    (place / "axes.csv").write_text("L,I,S\n5,4,3\n6,4,2\n")
    (place / "notes.txt").write_text("by hand")
    (place / "photo.jpg").write_bytes(b"")
    (place / "._round.stl").write_bytes(b"\x00\x05\x16\x07")
    (place / "old").mkdir()
    return place


def test_each_file_that_is_left_out_is_named_with_its_reason(folder):
    assert [grain.name for grain in load_grains(group(folder))] == ["cloud", "dented", "round"]
    said = dict(line.split(": ", 1) for line in left_out_files(group(folder)))
    assert set(said) == {"axes.csv", "notes.txt", "photo.jpg", "._round.stl", "old"}
    assert "table of axes" in said["axes.csv"] and "macOS" in said["._round.stl"] and "folder" in said["old"]
    assert "coefficients" in said["notes.txt"] and "'.jpg'" in said["photo.jpg"]


def test_a_folder_of_nothing_but_other_files_is_refused_with_their_reasons(folder):
    for name in ("round.stl", "dented.stl", "cloud.csv"):
        (folder / name).unlink()
    with pytest.raises(ValueError, match=r"contains no grain files.*axes\.csv: it is a table of axes"):
        load_grains(group(folder))


def test_warnings_name_concave_grains_notes_and_files_that_are_left_out(folder):
    grains = load_grains(group(folder))
    ratio = dented_ball().convex_hull.volume / dented_ball().volume
    assert ratio > 1.15
    warnings = grain_warnings(grains, group(folder))
    assert len(warnings) == 2 and "1 of 3 grains is concave" in warnings[0] and f"dented {ratio:.2f}" in warnings[0]
    assert warnings[1].startswith("5 files were left out: ._round.stl: ")
    assert grain_warnings(grains) == warnings[:1] and grain_warnings([]) == []


def test_ratio_and_notes_survive_the_grain_set_its_table_and_decimation(folder, tmp_path):
    two = trimesh.util.concatenate([dented_ball(), trimesh.creation.icosphere(2, 1.0).apply_translation([20, 0, 0])])
    two.export(folder / "two.stl")
    grains = load_grains(group(folder, bodies="largest"))
    write_grains(tmp_path / "set.nc", grains, left_out="\n".join(left_out_files(group(folder))))
    again = read_grains(tmp_path / "set.nc")
    for before, after in zip(grains, again, strict=True):
        np.testing.assert_equal(after.hull_ratio, before.hull_ratio)
        assert after.notes == before.notes
        np.testing.assert_equal(decimate(after, 60).hull_ratio, before.hull_ratio)
        assert decimate(after, 60).notes == before.notes
    assert grain_warnings(again, group(tmp_path / "set.nc")) == grain_warnings(grains, group(folder))
    assert any("largest of 2 bodies" in warning for warning in grain_warnings(again))
    table = form_table(again)
    pd.testing.assert_series_equal(
        table.hull_ratio, pd.Series([g.hull_ratio for g in grains], table.index, name="hull_ratio")
    )
    assert np.isnan(table.hull_ratio["cloud"]) and table.hull_ratio["round"] == pytest.approx(1, rel=1e-6)


def test_what_becomes_of_the_grains_own_sizes_is_said(folder):
    grains = load_grains(group(folder))
    low, high = (f"{f(grain.sieve_size for grain in grains) * 1e3:.3g}" for f in (min, max))
    assert f"{low} to {high} mm; they are scaled" in size_note(grains, {"own": False})
    assert f"{low} to {high} mm, which they keep" in size_note(grains, {"own": True})
    assert size_note([], {"own": False}) is None


def test_bodies_of_a_specification_reach_the_reader(tmp_path):
    balls = [trimesh.creation.icosphere(2, 5.0).apply_translation([x, 0, 0]) for x in (0, 30)]
    trimesh.util.concatenate(balls).export(tmp_path / "two.stl")
    with pytest.raises(ValueError, match="2 separate bodies"):
        load_grains(group(tmp_path / "two.stl"))
    assert [g.name for g in load_grains(group(tmp_path / "two.stl", bodies="split"))] == ["two_1", "two_2"]


def digest_of(paths):
    """Return the digest of the content of these files and folders."""

    return content_digest(paths)


def test_the_digest_follows_the_content_of_the_grain_files_alone(folder):
    first = digest_of([folder])
    assert len(first) == 16 and digest_of([str(folder)]) == first
    (folder / "notes.txt").write_text("something else")
    os.utime(folder / "round.stl", (1, 1))
    assert digest_of([folder]) == first
    times = os.stat(folder)
    before = (folder / "round.stl").read_bytes()
    trimesh.creation.icosphere(2, 5.1).export(folder / "round.stl")  # the same name and length
    os.utime(folder, (times.st_atime, times.st_mtime))
    assert digest_of([folder]) != first
    (folder / "round.stl").write_bytes(before)
    assert digest_of([folder]) == first
    (folder / "round.stl").rename(folder / "pebble.stl")
    assert digest_of([folder]) != first


def test_the_digest_of_nothing_and_of_missing_files_raises_nothing(tmp_path):
    assert content_digest([]) == content_digest([tmp_path])
    assert content_digest([tmp_path / "none.stl"]) != content_digest([])


def test_names_select_the_files_and_their_order(folder):
    named = group(folder, names=["round", "cloud"])
    assert [grain.name for grain in load_grains(named)] == ["round", "cloud"]
    assert left_out_files(named) == [] and left_out_files(group(folder)) != []
    assert [grain.name for grain in load_grains(group([str(folder)], names=None))] == ["cloud", "dented", "round"]
    with pytest.raises(
        ValueError,
        match=r"grains\.source has no file 'oval', and 1 of 2 names are missing; .*files of grains are cloud, dented",
    ):
        load_grains(group(folder, names=["round", "oval"]))
    with pytest.raises(ValueError, match="'round' is listed twice; remove one"):
        load_grains(group(folder, names=["round", "round"]))


def test_the_name_of_a_set_follows_names_and_degree_if_they_are_given(folder):
    everything = set_name(group(folder))
    some = set_name(group(folder, names=["round", "cloud"]))
    assert len({everything, some, set_name(group(folder, names=["cloud", "round"]))}) == 3
    assert set_name(group(folder, degree=10)) not in (everything, some)
    more = shutil.copytree(folder, folder.parent / "copy" / "scans")
    assert set_name(group(more)) == everything
    more = shutil.copytree(folder, folder.parent / "another" / "scans")
    trimesh.creation.icosphere(2, 6.0).export(more / "another.stl")
    assert set_name(group(more)) != everything and set_name(group(more, names=["round", "cloud"])) == some


def test_a_set_without_names_and_degree_has_the_name_that_it_had_before_these_keys(tmp_path):
    (tmp_path / "old").mkdir()
    (tmp_path / "old" / "one.xyz").write_text("0 0 0\n1 0 0\n0 1 0\n0 0 1\n")
    assert set_name(group(tmp_path / "old")) == "old_0f2c8ec2"


def test_the_degree_of_a_specification_reaches_the_reader(tmp_path):
    rows = f"0 0 {5 * np.sqrt(4 * np.pi)} 0\n2 0 1 0\n"
    (tmp_path / "a-anm.dat").write_text(rows)
    (smooth,), (whole,) = load_grains(group(tmp_path, degree=0)), load_grains(group(tmp_path))
    assert smooth.elongation == pytest.approx(1.0, abs=1e-3) and whole.elongation < 0.9
    with pytest.raises(ValueError, match=r"a-anm\.dat: grains\.degree is 3, but"):
        load_grains(group(tmp_path, degree=3))


def test_a_degree_is_refused_for_files_without_coefficients(folder):
    with pytest.raises(ValueError, match=r"grains\.degree is for coefficients of spherical harmonics; set it to null"):
        load_grains(group(folder, degree=10, names=["round"]))
