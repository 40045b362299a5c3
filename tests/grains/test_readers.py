"""Every format gives the same grain, and every kind of bad input gives one clear error."""

import os
import warnings
from pathlib import Path

import numpy as np
import pytest
import trimesh

from simcore.grains.mesh import make_grain
from simcore.grains.readers import read_grain, read_grain_files

SHARED = Path(os.environ.get("SCREE_SHARED", "/work/shared")) / "grains"


@pytest.fixture(scope="module")
def body():
    """Return a pebble of about 10 mm, in mm, as a closed mesh."""
    points = np.random.default_rng(8).normal(size=(120, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    points *= (1 + 0.2 * points[:, :1]) * [3, 4.5, 6.5]
    return trimesh.convex.convex_hull(points)


@pytest.mark.parametrize("extension", ["stl", "ply", "obj", "off"])
def test_mesh_formats_give_the_same_grain(tmp_path, body, extension):
    path = tmp_path / f"G07.{extension}"
    body.export(path)
    grain, expected = read_grain(path, "mm"), make_grain("G07", body.vertices * 1e-3)
    assert grain.name == "G07"
    # STL and PLY have single precision, the others eight digits.
    assert (grain.L, grain.I, grain.S) == pytest.approx((expected.L, expected.I, expected.S), rel=1e-6)
    assert len(grain.faces) == len(expected.faces)


def test_metres_and_millimetres(tmp_path, body):
    body.export(tmp_path / "a.ply")
    body.copy().apply_scale(1e-3).export(tmp_path / "b.ply")
    assert read_grain(tmp_path / "a.ply", "mm").L == pytest.approx(read_grain(tmp_path / "b.ply", "m").L, rel=1e-6)


def test_a_dented_mesh_becomes_its_hull(tmp_path, body):
    dented = body.copy()
    dented.vertices[np.argmax(dented.vertices[:, 2])] *= 0.3
    dented.export(tmp_path / "a.ply")
    grain = read_grain(tmp_path / "a.ply", "mm")
    assert grain.volume == pytest.approx(dented.convex_hull.volume * 1e-9, rel=1e-6)
    assert grain.volume > dented.volume * 1e-9


def test_point_clouds(tmp_path, body):
    expected = make_grain("p", body.vertices * 1e-3)
    np.savetxt(tmp_path / "a.xyz", body.vertices, header="points in mm")
    np.savetxt(tmp_path / "b.csv", body.vertices, delimiter=",", header="x,y,z", comments="")
    both = np.column_stack([body.vertices, body.vertices])
    np.savetxt(tmp_path / "c.xyz", both, header="x y z nx ny nz", comments="")
    np.save(tmp_path / "d.npy", body.vertices)
    grains = read_grain_files(tmp_path, "mm")
    assert [grain.name for grain in grains] == ["a", "b", "c", "d"]
    for grain in grains:
        assert grain.volume == pytest.approx(expected.volume, rel=1e-12)


def test_voxel_masks(tmp_path):
    x = np.stack(np.meshgrid(*[np.arange(44) - 21.7] * 3, indexing="ij"), -1)
    mask = ((x / [10, 15, 20]) ** 2).sum(-1) <= 1
    np.save(tmp_path / "a.npy", mask)
    np.savez(tmp_path / "b.npz", mask=mask, spacing=0.2)
    first = read_grain(tmp_path / "a.npy", "mm", spacing=0.2)
    second = read_grain(tmp_path / "b.npz", "mm")
    assert first.L == second.L
    assert (first.L, first.I, first.S) == pytest.approx((8e-3, 6e-3, 4e-3), abs=0.2e-3 * 0.3)
    with pytest.raises(ValueError, match=r"a\.npy.*`spacing`"):
        read_grain(tmp_path / "a.npy", "mm")


def test_coefficient_files_by_either_name(tmp_path):
    text = f"0 0 {5 * np.sqrt(4 * np.pi)} 0\n1 0 1 0\n"
    (tmp_path / "A_1.sh.txt").write_text("# comment\n" + text)
    (tmp_path / "A0.5-anm-00002.dat").write_text(text)
    (tmp_path / "B_1.SH.TXT").write_text(text)
    (tmp_path / "B-ANM-1.DAT").write_text(text)
    (tmp_path / "length-stats.dat").write_text("no coefficients")
    (tmp_path / "notes.txt").write_text("no coefficients")
    grains = read_grain_files(tmp_path, "mm")
    assert [grain.name for grain in grains] == ["A0.5-anm-00002", "A_1", "B-ANM-1", "B_1"]
    assert grains[0].L == grains[1].L == pytest.approx(0.01, rel=0.01)


def bad_meshes(body):
    opened, turned, half = body.copy(), body.copy(), body.copy()
    opened.update_faces(np.arange(len(body.faces)) > 2)
    turned.invert()
    half.faces[: len(half.faces) // 2] = half.faces[: len(half.faces) // 2, ::-1]
    nan = body.copy()
    nan.vertices[3, 1] = np.nan
    flat = trimesh.Trimesh([[0, 0, 0], [5, 0, 0], [0, 5, 0]], [[0, 1, 2], [0, 2, 1]], process=False)
    plane = trimesh.Trimesh(body.vertices * [1, 1, 0], body.faces, process=False)
    return {
        "open": (opened, "open"),
        "inverted": (turned, "inverted"),
        "half inverted": (half, "inverted"),
        "NaN": (nan, "NaN"),
        "flat": (flat, "flat"),
        "plane": (plane, "flat"),
    }


@pytest.mark.parametrize("kind", ["open", "inverted", "half inverted", "NaN", "flat", "plane"])
@pytest.mark.parametrize("extension", ["ply", "stl", "obj", "off"])
def test_bad_meshes_are_refused(tmp_path, body, kind, extension):
    mesh, reason = bad_meshes(body)[kind]
    path = tmp_path / f"bad.{extension}"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the writer warns
        path.write_bytes(data if isinstance(data := mesh.export(file_type=extension), bytes) else data.encode())
    with pytest.raises(ValueError, match=rf"bad\.{extension}: .*{reason}") as error:
        read_grain(path, "mm")
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    "name, content, reason",
    [
        ("a.stl", "", "neither STL text nor binary STL"),
        ("a.ply", "", "not a PLY file"),
        ("a.obj", "# nothing\n", "the mesh is empty"),
        ("a.off", "OFF\n0 0 0\n", "the mesh is empty"),
        ("a.ply", "not a mesh", "not a PLY file"),
        ("a.xyz", "", "contains no points"),
        ("a.csv", "x,y,z\n", "contains no points"),
        ("a.csv", "x,y,z\n1,2,3\n1,2,3,4\n", "row 3 has 4 fields"),
        ("a.xyz", "1 2\n3 4\n", "2 columns and no header"),
        ("a.xyz", "1 2 3\n1 2 nan\n2 3 4\n4 5 6\n", "NaN"),
        ("a.npy", "", "not a file of NumPy arrays"),
        ("a.npz", "text", "not a file of NumPy arrays"),
        ("a.dat", "text", "n m re im"),
        ("a.step", "", r"unknown extension '.step'.*\.stl"),
    ],
)
def test_broken_files_are_refused(tmp_path, name, content, reason):
    (tmp_path / name).write_text(content)
    with pytest.raises(ValueError, match=reason):
        read_grain(tmp_path / name, "mm")


@pytest.mark.parametrize("factor, unit", [(1.0, "m"), (1e-3, "mm")])
def test_units_wrong_by_a_thousand_are_refused(tmp_path, body, factor, unit):
    for size in (0.3, 1.0, 4.0):  # grains of 3 to 40 mm, the sizes of Rettinger et al.
        body.copy().apply_scale(factor * size).export(tmp_path / "a.ply")
        with pytest.raises(ValueError, match=r"a\.ply.*sieve size.*`unit`"):
            read_grain(tmp_path / "a.ply", unit)


def test_a_cobble_in_metres_whose_unit_is_given_as_mm_has_a_note(tmp_path, body):
    body.copy().apply_scale(0.12 / body.extents.max()).export(tmp_path / "cobble.ply")
    (note,) = read_grain(tmp_path / "cobble.ply", "mm").notes
    assert note == "a sieve size below 0.5 mm; if these are cobbles, the unit of the files is m instead of mm"
    assert read_grain(tmp_path / "cobble.ply", "m").notes == ()


@pytest.mark.parametrize("unit", [None, "", "inch"])
def test_units_must_be_stated(tmp_path, body, unit):
    body.export(tmp_path / "a.ply")
    with pytest.raises(ValueError, match=r"a\.ply.*state `unit`"):
        read_grain(tmp_path / "a.ply", unit)


def test_missing_files_empty_folders_and_equal_names_are_refused(tmp_path, body):
    with pytest.raises(ValueError, match=r"none\.stl does not exist"):
        read_grain(tmp_path / "none.stl", "mm")
    with pytest.raises(ValueError, match="contains no grain files"):
        read_grain_files(tmp_path, "mm")
    body.export(tmp_path / "a.ply")
    body.export(tmp_path / "a.stl")
    with pytest.raises(ValueError, match="named 'a'"):
        read_grain_files(tmp_path, "mm")


@pytest.mark.skipif(not SHARED.is_dir(), reason="the two published Rhine meshes are not part of the project")
def test_published_rhine_meshes_have_their_axes():
    axes = [(g.L, g.I, g.S) for g in read_grain_files(SHARED / "rhine", "mm")]
    np.testing.assert_allclose(
        np.array(axes) * 1e3, [[2.40093, 1.29165, 0.57588], [2.04439, 1.07447, 0.91951]], rtol=1e-5
    )
