"""The script that kills packings, with the stand-in: surviving runs are counted, and differences are reported."""

import shutil
import sys

import netCDF4
import pytest

from benchmarks.correctness import faults

from .test_launch import STAND_IN


@pytest.fixture
def specification(tmp_path):
    path = tmp_path / "spec.yaml"
    path.write_text("{numbers: 16, steps: 60, step: 10 ms}")
    return path


def survive(specification, *arguments):
    program = f"{sys.executable} {STAND_IN}"
    return faults.main(["--specification", str(specification), "--program", program, "--patience", "60", *arguments])


def test_killed_and_interrupted_runs_survive(specification, capsys):
    kinds = ["one rank killed", "interrupted", "disk full", "output path bad"]
    assert survive(specification, "--runs", "4", "--seed", "3", "--faults", *kinds) == 0
    table = capsys.readouterr().out
    assert "4 of 4 survived" in table and table.count("same bits") == 4
    assert all(kind in table for kind in kinds)


def test_other_bits_are_reported(specification, capsys, monkeypatch):
    monkeypatch.setattr(faults, "differing", lambda *arguments: ["numbers"])
    assert survive(specification, "--runs", "1", "--faults", "all ranks killed") == 1
    table = capsys.readouterr().out
    assert "0 of 1 survived" in table and "differs in numbers" in table


def test_one_flipped_bit_is_a_difference(tmp_path):
    def write(path, value, seconds):
        with netCDF4.Dataset(path, "w") as file:
            file.createDimension("number", 1)
            file.createVariable("numbers", float, ("number",))[:] = value
            file.setncatts({"cpu_seconds": seconds, "steps": 7})

    write(tmp_path / "a.nc", 0.1, 1.0)
    write(tmp_path / "b.nc", 0.1, 2.0)
    write(tmp_path / "c.nc", 0.1 + 2e-17, 1.0)
    shutil.copy(tmp_path / "a.nc", tmp_path / "d.nc")
    with netCDF4.Dataset(tmp_path / "d.nc", "a") as file:
        file.steps = 8
    a, b, c, d = (faults.contents(tmp_path / f"{name}.nc") for name in "abcd")
    assert faults.differing(a, b) == []
    assert faults.differing(a, c) == ["numbers"]
    assert faults.differing(a, d) == [":steps"]
