"""Choice of the format, refusals, and `scree export` on the command line."""

import sys

import numpy as np
import pytest

from simcore.__main__ import main
from simcore.export.export import SUFFIXES, export
from simcore.packing.file import write_packing
from tests.helpers.packings import make_packing
from tests.helpers.random_beds import strew

NEEDS = {".vtu": "meshio", ".vtp": "pyvista", ".vti": "pyvista", ".graphml": "networkx", ".tif": "tifffile"}


@pytest.fixture
def bed(tmp_path):
    path = tmp_path / "bed.nc"
    write_packing(path, strew("polyhedron", contacts=[(0, 1), (2, -1)]))
    return path


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_command_writes_every_format(bed, tmp_path, capsys, suffix):
    output = tmp_path / "new" / f"out{suffix.upper()}"
    assert main(["export", str(bed), str(output)]) == 0
    written = [line.removeprefix("wrote ") for line in capsys.readouterr().out.splitlines()]
    assert written[0] == str(output) and len(written) == (2 if suffix in (".vtu", ".vtp") else 1)
    assert sorted(written) == sorted(str(path) for path in output.parent.iterdir())


@pytest.mark.parametrize("suffix", [".vtp", ".vti"])
def test_a_file_that_vtk_cannot_write_is_an_error(tmp_path, suffix, monkeypatch):
    def fail(writer):
        return 0

    vtk = pytest.importorskip("vtkmodules.vtkIOXML")
    for name in ("vtkXMLPolyDataWriter", "vtkXMLImageDataWriter"):
        writer = type(name, (getattr(vtk, name),), {"Write": fail})
        monkeypatch.setattr(vtk, name, writer)
    with pytest.raises(OSError, match=f"out{suffix} cannot be written"):
        export(strew("polyhedron", contacts=[(0, 1), (2, -1)]), tmp_path / f"out{suffix}")


@pytest.mark.parametrize("suffix", (".vtu", ".vtp"))
def test_a_file_of_contacts_that_cannot_be_written_is_found_first(bed, tmp_path, capsys, suffix):
    (tmp_path / f"out_contacts{suffix}").mkdir()
    assert main(["export", str(bed), str(tmp_path / f"out{suffix}")]) == 2
    assert f"out_contacts{suffix} is a folder" in capsys.readouterr().err
    assert not (tmp_path / f"out{suffix}").exists()


@pytest.mark.parametrize("suffix", NEEDS)
def test_a_library_that_is_not_installed_is_named_with_its_extra(bed, tmp_path, capsys, monkeypatch, suffix):
    monkeypatch.setitem(sys.modules, NEEDS[suffix], None)
    assert main(["export", str(bed), str(tmp_path / f"out{suffix}")]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and f"needs the library {NEEDS[suffix]}" in error
    assert "pip install '.[view]'" in error
    assert not (tmp_path / f"out{suffix}").exists()


@pytest.mark.parametrize(
    "arguments, message",
    [
        (["bed.obj"], "suffix '.obj' is unknown; give one of .glb, .stl"),
        (["bed"], "suffix '' is unknown"),
        (["bed.csv", "--periodic", "cut"], "--periodic has no effect on a .csv file"),
        (["bed.glb", "--voxel", "1 mm"], "--voxel has no effect on a .glb file"),
        (["bed.npz", "--divisions", "2"], "--divisions has no effect on a .npz file"),
        (["bed.glb", "--divisions", "2"], "--divisions has no effect on a packing of polyhedra"),
        (["bed.npz", "--voxel", "1 kg"], "--voxel: '1 kg' is a mass; a length is needed"),
        (["bed.npz", "--voxel", "1 m"], "choose another --voxel"),
        (["bed.stl", "--divisions", "9"], "divisions: 9 is not possible; give 0 to 5"),
    ],
)
def test_wrong_options_are_one_line(bed, tmp_path, capsys, arguments, message):
    if arguments[0] == "bed.stl":
        write_packing(bed, strew("sphere"))
    assert main(["export", str(bed), str(tmp_path / arguments[0]), *arguments[1:]]) == 2
    printed = capsys.readouterr()
    assert printed.err.startswith("scree export: ") and message in printed.err and printed.err.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["bed.nc"]


def test_an_empty_packing_is_refused(tmp_path):
    with pytest.raises(ValueError, match="no grain"):
        export(make_packing(np.zeros((0, 3)), np.zeros((0, 3))), tmp_path / "bed.stl")


def test_an_unknown_way_of_images_is_refused(tmp_path):
    with pytest.raises(ValueError, match="'wrap' is unknown; choose one of cut, copy, leave"):
        export(strew("sphere"), tmp_path / "bed.stl", periodic="wrap")


def test_sides_of_a_cylinder_have_no_option(tmp_path):
    bed = make_packing([[0.0, 0.0, 0.005]], 0.005, width=0.03, domain="cylinder")
    with pytest.raises(ValueError, match="--periodic has no effect on a packing in a cylinder"):
        export(bed, tmp_path / "bed.stl", periodic="cut")
    assert export(bed, tmp_path / "bed.stl", divisions=1) == [tmp_path / "bed.stl"]
