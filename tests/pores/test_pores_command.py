"""The command `scree pores`: text, JSON, figure, and what it does without the extra."""

import json

import pytest

from simcore.__main__ import main
from simcore.packing.file import write_packing
from simcore.pores import image, pores
from simcore.pores.pores_text import _with_error
from tests.helpers.packings import make_packing, sphere_lattice

D = 0.01


@pytest.fixture
def bed(tmp_path):
    centres, width = sphere_lattice("sc", 2, 5)
    path = tmp_path / "bed.nc"
    write_packing(path, make_packing(D * centres, 0.5 * D, width=D * width, scene="{}", seed=1))
    return str(path)


@pytest.fixture
def without_extra(monkeypatch):
    monkeypatch.setattr(pores, "missing_libraries", lambda: ["porespy", "openpnm"])


def test_voxels_on_which_the_tortuosity_is_below_1_are_refused(bed, without_extra, capsys, monkeypatch):
    """Coarse voxels close pores, so that the value on them is far too large and the extrapolation far too small."""
    values = iter((7.0, 2.6))
    monkeypatch.setattr(pores, "tortuosity", lambda image: next(values))
    assert main(["pores", bed, "--cut", "9 mm", "--voxel", "0.5 mm"]) == 2
    error = capsys.readouterr().err
    assert "the voxels of 0.5 mm are too large for the tortuosity, which is 7 on voxels of twice this edge" in error


def test_without_the_extra_the_rest_is_printed_with_how_to_install_it(bed, without_extra, capsys):
    assert main(["pores", bed, "--cut", "9 mm", "--voxel", "0.5 mm"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert any(line.startswith("surface of the grains") and "600 m²/m³ of grains" in line for line in lines)
    assert any(line.startswith("tortuosity along z") for line in lines)
    assert not any("network," in line or line.startswith("pore diameter") for line in lines)
    assert (
        lines[-1]
        == "Pore sizes and pore network need porespy and openpnm: pip install '.[pores]' in the folder of Scree"
    )


def test_json_is_in_si_units(bed, without_extra, capsys):
    assert main(["pores", bed, "--cut", "9 mm", "--voxel", "0.25 mm", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["specific_surface"] == pytest.approx(6.0 / D)
    assert (found["z_lower"], found["z_upper"]) == pytest.approx((0.009, 0.039))  # three periods of the lattice
    assert (found["voxel_coarse"], found["voxel_fine"]) == pytest.approx((0.5e-3, 0.25e-3))
    # The bounds are that of Hashin and Shtrikman and the path along half a circle.
    assert 1.0 + 0.5 * (1.0 - found["porosity"]) < found["tortuosity"] < 0.5 * 3.1416
    assert found["tortuosity_resolution"] > 0.0
    assert found["kozeny_carman_permeability"] == pytest.approx(2.19e-3 * D**2, rel=0.01)
    assert "network_permeability" not in found


def test_without_voxels_only_the_bulk_is_printed(bed, capsys):
    assert main(["pores", bed, "--no-voxels"]) == 0
    printed = capsys.readouterr().out
    assert "Kozeny–Carman" in printed and "tortuosity" not in printed and "pip install" not in printed


def test_a_bed_that_needs_too_many_voxels_has_the_first_block(bed, without_extra, monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(image, "DEFAULT_MOST", 10)
    assert main(["pores", bed, "--cut", "9 mm"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("porosity n") and not any(line.startswith("tortuosity") for line in lines)
    assert lines[-1].startswith("Nothing is computed on voxels: the smallest grain, 10 mm thick, needs")
    assert main(["pores", bed, "--cut", "9 mm", "--json"]) == 2
    printed = capsys.readouterr()
    assert "specific_surface" in json.loads(printed.out) and "give --voxel '5 mm'" in printed.err


def test_numbers_and_errors_of_any_size():
    assert _with_error(0.4537, 0.0016) == "0.4537 ± 0.0016"
    assert _with_error(0.43454, 4e-5) == "0.4345 ± 0.0000"
    assert _with_error(1e-3, 1e-5) == "(1.000 ± 0.010)e-3"
    assert _with_error(6.044e-8, 2.2e-10) == "(6.044 ± 0.022)e-8"
    assert _with_error(1.4, 1e-6) == "1.4000 ± 0.0000"
    assert _with_error(1.4, float("inf")) == "1.4, of unknown error: no path of pores on the coarse voxels"


def test_options_without_effect_and_bad_lengths_are_refused(bed, capsys):
    assert main(["pores", bed, "--no-voxels", "--voxel", "1 mm"]) == 2
    assert "--no-voxels" in capsys.readouterr().err
    assert main(["pores", bed, "--voxel", "0 mm"]) == 2
    assert "--voxel" in capsys.readouterr().err
    assert main(["pores", bed, "--voxel", "20 mm"]) == 2
    assert "--voxel: 20 mm is more than half of the smallest axis of a grain" in capsys.readouterr().err


def test_a_figure_without_the_extra_is_refused(bed, without_extra, tmp_path, capsys):
    assert main(["pores", bed, "--plot", str(tmp_path / "sizes.png")]) == 2
    assert "pip install '.[pores]'" in capsys.readouterr().err
    assert not (tmp_path / "sizes.png").exists()


def test_with_the_extra_everything_is_printed_and_drawn(bed, tmp_path, capsys):
    pytest.importorskip("porespy")
    pytest.importorskip("openpnm")
    figure = tmp_path / "sizes.png"
    assert main(["pores", bed, "--cut", "9 mm", "--voxel", "0.5 mm", "--plot", str(figure)]) == 0
    starts = [line.split("  ")[0] for line in capsys.readouterr().out.splitlines()]
    for title in ("permeability, pore network", "conductivity, pore network", "pore diameter d50"):
        assert title in starts
    assert figure.read_bytes().startswith(b"\x89PNG")
    assert main(["pores", bed, "--plot", str(tmp_path / "sizes.jpg")]) == 2
    assert "must end in .png, .pdf or .svg" in capsys.readouterr().err
