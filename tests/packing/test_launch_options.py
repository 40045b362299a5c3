"""The options of `launch` that it passes on to `pack`."""

import pytest

import simcore.packing.launch as launching
from simcore.__main__ import main


@pytest.mark.parametrize(
    ("option", "value"), [("--silence", "0 s"), ("--silence", "-1 s"), ("--startup", "0 s"), ("--grace", "-1 s")]
)
def test_times_that_would_end_each_run_are_refused(tmp_path, capsys, option, value):
    assert main(["launch", str(tmp_path / "spec.yaml"), str(tmp_path / "bed.nc"), f"{option}={value}"]) == 2
    assert f"{option}: '{value}' is not a time above 0" in capsys.readouterr().err


@pytest.mark.parametrize(
    "options",
    [
        [],
        ["--frames", "0.1 s"],
        ["--checkpoints", "kept", "--checkpoint-interval", "1 s", "--log", "log.txt", "--cut", "5 mm", "--force"],
    ],
)
def test_options_of_pack_are_passed_on(tmp_path, monkeypatch, options):
    commands = []
    monkeypatch.setattr(launching, "launch", lambda command, output, **_: commands.append(command) or 0)
    specification, output = str(tmp_path / "spec.yaml"), str(tmp_path / "bed.nc")
    assert main(["launch", specification, output, *options]) == 0
    (command,) = commands
    assert command[-5 - len(options) :] == ["pack", specification, output, "--threads", "1", *options]
