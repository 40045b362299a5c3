"""Text, JSON and profile of the bulk porosity, and the options of `scree porosity`."""

import json

import numpy as np
import pandas as pd
import pytest

from simcore.__main__ import main
from simcore.evaluation.porosity import bulk_porosity
from simcore.evaluation.porosity_text import profile_table
from simcore.evaluation.rounding import heights_in_mm
from simcore.packing.file import write_packing
from tests.helpers.packings import make_packing
from tests.helpers.polyhedra import CUBE
from tests.helpers.rotations import random_orientations


def cubes(warnings=""):
    """Return a bed of 300 tilted cubes of 4 to 6 mm, more than half solid; their overlaps do not matter."""
    rng = np.random.default_rng(1)
    position = rng.uniform([0, 0, 0.004], [0.04, 0.04, 0.034], (300, 3))
    scale = np.tile(rng.uniform(4e-3, 6e-3, (300, 1)), 3)
    attrs = {"warnings": warnings} if warnings else {}
    return make_packing(position, scale, random_orientations(300, 2), CUBE, width=0.04, largest=6e-3, **attrs)


@pytest.fixture
def path(tmp_path):
    write_packing(tmp_path / "bed.nc", cubes())
    return tmp_path / "bed.nc"


@pytest.mark.parametrize("method", ["spheres", "exact"])
def test_the_table_has_the_numbers_of_the_json(path, capsys, method):
    exact = ["--exact"] if method == "exact" else []
    assert main(["porosity", str(path), *exact]) == 0
    lines = dict(line.split("  ", 1) for line in capsys.readouterr().out.splitlines()[:5])
    lines = {label: value.strip() for label, value in lines.items()}
    assert main(["porosity", str(path), "--json", *exact]) == 0
    numbers = json.loads(capsys.readouterr().out)
    bulk = bulk_porosity(cubes(), method)
    assert numbers == {"method": method, **{name: float(bulk[name]) for name in bulk}, "warnings": []}
    assert lines["porosity n"] == f"{numbers['n']:.4f} ± {numbers['n_std_error']:.4f}"
    low, high, top = (1e3 * numbers[name] for name in ("z_lower", "z_upper", "bed_top"))
    assert lines["evaluated"] == f"{low:.1f} to {high:.1f} mm above the floor"
    assert lines["surface of the bed"].startswith(f"{top:.1f} mm") and lines["grains in the bed"] == "300"
    assert ("grains themselves" in lines["sliced"]) == (method == "exact")


def test_a_cut_has_a_unit(path, capsys):
    for cut, expected in (("7 mm", "7.0 to"), ("0.7 cm", "7.0 to"), ("0.009", "9.0 to")):
        assert main(["porosity", str(path), "--cut", cut]) == 0
        assert expected in capsys.readouterr().out


def test_warnings_of_the_packing_are_repeated(tmp_path, capsys):
    write_packing(tmp_path / "bed.nc", cubes("The first.\nThe second."))
    assert main(["porosity", str(tmp_path / "bed.nc")]) == 0
    assert capsys.readouterr().out.splitlines()[-2:] == ["warning: The first.", "warning: The second."]


def test_the_profile_is_written_and_its_mean_is_the_bulk_value(path, tmp_path, capsys):
    output = tmp_path / "new" / "profile.csv"
    assert main(["porosity", str(path), "--json", "--profile", str(output), "--cut", "8.3 mm"]) == 0
    numbers = json.loads(capsys.readouterr().out)
    table = pd.read_csv(output)
    assert list(table) == ["z", "z_lower", "z_upper", "n", "n_exact", "evaluated"]
    np.testing.assert_allclose(np.diff(table["z"]), 1e-3, rtol=1e-9)
    assert table["evaluated"].sum() * 1e-3 == pytest.approx(numbers["z_upper"] - numbers["z_lower"], rel=1e-8)
    # Slices that the interval cuts are not uniform, so that the mean over slices differs a little from n.
    assert np.average(table["n"], weights=table["evaluated"]) == pytest.approx(numbers["n"], abs=2e-3)
    bulk = bulk_porosity(cubes(), "exact", 8e-3)
    table = profile_table(cubes(), bulk)
    whole = table["evaluated"] == 1.0
    assert set(table["evaluated"]) == {0.0, 1.0}
    assert table["n_exact"][whole].mean() == pytest.approx(float(bulk["n"]), rel=1e-12)
    assert table["n_exact"].iloc[-1] == 1.0


def test_the_profile_of_flat_grains_on_the_floor_has_the_same_slices_for_both_methods():
    plates = make_packing([[0.005, 0.005, 1e-3]], [[9e-3, 1e-2, 2e-3]], vertices=CUBE, width=0.01, largest=1e-3)
    bulk = bulk_porosity(plates, "exact", cut=1e-9)
    table = profile_table(plates, bulk)
    np.testing.assert_allclose(table["n_exact"].iloc[:2], 0.1, rtol=1e-12)
    assert (table["n_exact"].iloc[2:] == 1.0).all() and table["n"].iloc[2] < 1.0
    assert table["n"].iloc[-1] == 1.0


def test_a_profile_that_cannot_be_written_is_told_first(path, tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert main(["porosity", str(path), "--profile", str(tmp_path / "file" / "out.csv")]) == 2
    printed = capsys.readouterr()
    assert "cannot be written" in printed.err and printed.out == ""


def test_each_command_on_a_bed_repeats_its_warnings(tmp_path, capsys):
    """A bed that vibrated has a porosity, a fabric and pores that may be wrong, so that each command says so."""
    beds = [tmp_path / "a.nc", tmp_path / "b.nc"]
    for seed, path in enumerate(beds):
        write_packing(path, cubes("It vibrated.").assign_attrs(seed=seed))
    for words in (["porosity", beds[0]], ["pores", "--no-voxels", beds[0]], ["fabric", beds[0]], ["compare", *beds]):
        assert main([str(word) for word in words]) == 0
        assert "warning: It vibrated." in capsys.readouterr().out, words
    for words in (["porosity", "--json", beds[0]], ["pores", "--no-voxels", "--json", beds[0]]):
        assert main([str(word) for word in words]) == 0
        assert json.loads(capsys.readouterr().out)["warnings"] == ["It vibrated."], words


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["porosity", "--profile", "n.xlsx"], "n.xlsx must end in .csv"),
        (["fabric", "--out", "f.csv"], "f.csv must end in .nc"),
        (["fabric", "--bearing-contacts", "0"], "--bearing-contacts 0: give a number of contacts from 1 upwards"),
    ],
)
def test_files_of_another_kind_and_impossible_numbers_are_refused(path, capsys, words, message):
    assert main([*words, str(path)]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("heights", "texts"),
    [((0.0081, 0.0353), ["8.1", "35.3"]), ((0.0021, 0.0089), ["2.10", "8.90"]), ((9e-5, 3.2e-4), ["0.090", "0.320"])],
)
def test_heights_of_thin_beds_have_three_digits(heights, texts):
    assert heights_in_mm(*heights) == texts
