"""`python -m simcore`: exit status, errors of one line, and no half-written file."""

import json
import re
import shutil
import subprocess
import sys

import pytest
import trimesh
import xarray as xr

from simcore.__main__ import main
from simcore.evaluation.porosity import bulk_porosity
from simcore.packing.file import read_packing, write_packing
from simcore.paths import ROOT
from tests.helpers.packings import make_packing, sphere_lattice

GOOD = """
name: tiny
domain: {width: 25 mm, height: 0.2 m}
shapes: {kind: sphere}
sizes: {bounds: [5.6 mm, 8 mm], mass_fractions: [1]}
amount: {grains: 40}
shaking: {duration: 0.05 s}
numerics: {contact_time: 1 ms, progress_interval: 0 s}
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "good.yaml").write_text(GOOD)
    return tmp_path


def names(folder):
    return sorted(path.name for path in folder.iterdir())


@pytest.mark.parametrize("command", ["porosity", "fabric"])
def test_a_bed_of_overlapping_grains_has_no_porosity(command, tmp_path, capsys):
    centres, width = sphere_lattice("sc", 4, 8)
    bed = make_packing(0.01 * centres, 0.009, width=0.01 * width)
    write_packing(tmp_path / "deep.nc", bed)
    assert main([command, str(tmp_path / "deep.nc")]) == 2
    assert "but that of a bed is between 0 and 1. Check that the grains do not overlap" in capsys.readouterr().err


def test_pack_then_porosity(folder, capsys):
    output = folder / "deep" / "tiny.nc"
    arguments = ["pack", str(folder / "good.yaml"), str(output), "--log", str(folder / "logs" / "tiny.log")]
    assert main(arguments) == 0
    assert names(output.parent) == ["tiny.nc"]
    printed = capsys.readouterr()
    assert printed.out == ""
    log = (folder / "logs" / "tiny.log").read_text()
    assert log == printed.err
    for part in (
        "40 grains inserted",
        "shaking",
        "damping",
        "kinetic energy",
        "mean overlap",
        "steps/s",
        "converged after",
    ):
        assert part in log, part
    assert main(["porosity", str(output), "--cut", "0.002", "--json"]) == 0
    bulk = json.loads(capsys.readouterr().out)
    expected = bulk_porosity(read_packing(output), cut=2e-3)
    assert bulk["n"] == float(expected.n) and 0.3 < bulk["n"] < 0.6
    assert main(["porosity", str(output), "--cut", "2 mm", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == bulk
    for cut, reason in (
        ("-0.01", "'-0.01' is not a length of at least 0; give one such as '8 mm'"),
        ("nan", "'nan' is not a number with a unit"),
        ("inf", "'inf' is not a number with a unit"),
        ("-2 mm", "is not a length of at least 0"),
        ("8 kg", "'8 kg' is a mass; a length is needed"),
        ("much", "'much' is not a number with a unit"),
    ):
        for command in ("porosity", "fabric"):
            assert main([command, str(output), f"--cut={cut}"]) == 2
            printed = capsys.readouterr()
            assert printed.err.startswith(f"scree {command}: --cut: ") and reason in printed.err
            assert printed.err.count("\n") == 1 and printed.out == ""


def test_fabric_of_one_packing_and_of_two_seeds(folder, capsys):
    beds = []
    for seed in (1, 2):
        (folder / f"{seed}.yaml").write_text(GOOD + f"seed: {seed}\n")
        beds.append(str(folder / f"{seed}.nc"))
        assert main(["pack", str(folder / f"{seed}.yaml"), beds[-1]]) == 0
    capsys.readouterr()
    assert main(["fabric", beds[0], "--cut", "0.003"]) == 0
    assert "standard error within the packing" in capsys.readouterr().out
    written = folder / "out" / "fabric.nc"
    assert main(["fabric", *beds, "--cut", "0.003", "--bearing-contacts", "3", "--out", str(written)]) == 0
    printed = capsys.readouterr().out
    assert printed.startswith("2 packings, ") and "rattlers (fewer than 3 contacts)" in printed
    with xr.open_dataset(written) as fabric:
        assert fabric["seed"].values.tolist() == [1, 2]
        assert 0.4 < float(fabric["solid_fraction"]) < 0.7 and 3.0 < float(fabric["coordination_number"]) < 12.0
        assert f"{float(fabric['solid_fraction']):.4f} ± {float(fabric['solid_fraction_std_error']):.4f}" in printed
    # A bed of forty spheres is too low for the rule; the error names the file and what to do.
    assert main(["fabric", beds[0]]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and re.search(r"scree fabric: .*1\.nc: .*too low to cut .* smaller cut", error)
    assert main(["fabric", beds[0], beds[0], "--cut", "0.003"]) == 2
    assert "1.nc has the seed 1, as has" in capsys.readouterr().err


@pytest.mark.parametrize(
    "change, message",
    [
        (("grains: 40", "grains: many"), r"bad.yaml: amount.grains"),
        (("name: tiny", "nam: tiny"), r"bad.yaml: .*nam"),
        (("25 mm", "25 kg"), r"bad.yaml: domain.width: '25 kg' is a mass; a length is needed"),
        (("mass_fractions: [1]", "mass_fractions: [0.5]"), r"sum"),
        (("contact_time: 1 ms", "contact_time: 1 ms, steps_per_contact_time: 5.5"), r"is unstable"),
        (("{width", "{{width"), r"bad.yaml"),
    ],
)
def test_a_wrong_specification_is_one_line_and_status_two(folder, capsys, change, message):
    (folder / "bad.yaml").write_text(GOOD.replace(*change))
    assert main(["pack", str(folder / "bad.yaml"), str(folder / "bad.nc")]) == 2
    printed = capsys.readouterr()
    assert printed.err.count("\n") == 1 and printed.err.startswith("scree pack: ")
    assert re.search(message, printed.err), printed.err
    assert names(folder) == ["bad.yaml", "good.yaml"]


def test_a_missing_file_and_too_many_threads(folder, capsys):
    assert main(["pack", str(folder / "none.yaml"), str(folder / "out.nc")]) == 2
    assert "none.yaml: there is no such file" in capsys.readouterr().err
    assert main(["pack", str(folder / "good.yaml"), str(folder / "out.nc"), "--threads", "1000"]) == 2
    assert capsys.readouterr().err.startswith("scree pack: threads: 1000 is not possible, since numba can use")
    assert main(["porosity", str(folder / "none.nc")]) == 2
    assert "none.nc: there is no such file" in capsys.readouterr().err
    (folder / "cut.nc").write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(100))
    assert main(["porosity", str(folder / "cut.nc")]) == 2
    printed = capsys.readouterr().err
    assert printed.count("\n") == 1 and "truncated" in printed


def test_a_packing_that_fails_leaves_no_file_and_status_one(folder, capsys):
    (folder / "bad.yaml").write_text(GOOD.replace("height: 0.2 m", "height: 30 mm"))
    assert main(["pack", str(folder / "bad.yaml"), str(folder / "bad.nc")]) == 1
    assert "failed: tiny: " in capsys.readouterr().err
    assert names(folder) == ["bad.yaml", "good.yaml"]


def test_an_output_that_cannot_be_written_is_an_error_before_the_work(folder, capsys):
    (folder / "file").write_text("")
    assert main(["pack", str(folder / "good.yaml"), str(folder / "file" / "out.nc")]) == 2
    printed = capsys.readouterr().err
    assert printed.count("\n") == 1 and "generating" not in printed


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["predict", "grains.csv", "--sieve", "curve.csv", "--pack", "curve.csv"], "curve.csv is read by this command"),
        (["predict", "grains.csv", "--sieve", "curve.csv", "--pack", "./grains.csv"], "grains.csv is read by"),
        (["predict", "grains.csv", "--sieve", "curve.csv", "--pack", "bed.xlsx"], "bed.xlsx must end in .yaml or .yml"),
        (["sieve", "curve.csv", "--specification", "curve.csv"], "curve.csv is read by this command"),
        (["fit", "beds.csv", "--case", "one-class", "--out", "beds.csv"], "beds.csv is read by this command"),
        (["fit", "beds.csv", "--case", "one-class", "--out", "model.txt"], "model.txt must end in .json"),
        (["fit", "beds.csv", "--case", "one-class", "--out", "."], ". must end in .json"),
        (["pack", "good.yaml", "good.yaml"], "good.yaml is read by this command"),
        (["pack", "good.yaml", "bed.nc", "--log", "good.yaml"], "good.yaml is read by this command"),
        (["pack", "good.yaml", "bed.nc", "--log", "./bed.nc"], "--log: bed.nc is the file of the packing"),
        (["pack", "scanned.yaml", "scan.stl"], "scan.stl is read by this command"),
        (["pack", "scanned.yaml", "bed.nc", "--log", "scan.stl"], "scan.stl is read by this command"),
        (["pack", "good.yaml", "bed.nc", "--checkpoint-interval", "1 min"], "it has no effect without --checkpoints"),
    ],
)
def test_an_output_that_is_an_input_or_has_the_wrong_ending_is_refused(folder, capsys, monkeypatch, arguments, message):
    monkeypatch.chdir(folder)
    for name, example in (("grains", "grains"), ("curve", "sieve_curve"), ("beds", "measured")):
        shutil.copy(ROOT / "examples" / f"{example}.csv", folder / f"{name}.csv")
    trimesh.creation.box((6, 7, 8)).export(folder / "scan.stl")
    scanned = "shapes: {choice: random}\ngrains: {source: scan.stl, unit: mm}\n"
    (folder / "scanned.yaml").write_text(GOOD.replace("shapes: {kind: sphere}\n", scanned))
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert message in error and error.count("\n") == 1
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


def test_a_written_specification_is_named(folder, capsys, monkeypatch):
    monkeypatch.chdir(folder)
    shutil.copy(ROOT / "examples" / "sieve_curve.csv", "curve.csv")
    assert main(["sieve", "curve.csv", "--finest", "2 mm", "--specification", "curve.yaml"]) == 0
    assert "curve.yaml is written; `scree pack curve.yaml bed.nc` packs this curve" in capsys.readouterr().err
    assert main(["predict", "--sieve", "curve.csv", "--finest", "2 mm", "--pack", "bed.yaml"]) == 0
    assert "bed.yaml is written; `scree pack bed.yaml bed.nc` packs this bed" in capsys.readouterr().err


def test_pack_with_several_samples_is_refused_before_the_prediction(folder, capsys, monkeypatch):
    monkeypatch.chdir(folder)
    shutil.copy(ROOT / "examples" / "sieve_curve.csv", "curve.csv")
    (folder / "two.csv").write_text("sample,FL,EL\na,0.6,0.7\nb,0.5,0.7\n")
    words = ["predict", "two.csv", "--sieve", "curve.csv", "--finest", "2 mm", "--pack", "two.yaml"]
    assert main(words) == 2
    printed = capsys.readouterr()
    assert printed.out == "" and "two.csv: there are 2 samples, but --pack writes one specification" in printed.err


def test_an_interrupted_command_ends_without_a_traceback(folder, capsys, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("simcore.packing.file.read_packing", interrupted)
    assert main(["porosity", str(folder / "good.yaml")]) == 130
    assert capsys.readouterr().err == "scree porosity: interrupted; the same command starts again\n"


def test_a_closed_pipe_ends_without_a_traceback():
    command = f"{sys.executable} -m simcore --print-completion bash | head -n 1"
    done = subprocess.run(command, shell=True, cwd=ROOT, capture_output=True, text=True)
    assert done.stdout.count("\n") == 1 and done.stderr == ""
