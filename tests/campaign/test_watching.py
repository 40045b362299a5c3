"""The states of a campaign's packings, from files as its jobs write them, and `scree watch`."""

import os
import sys
import time

import numpy as np
import pytest
import yaml

from simcore.__main__ import main
from simcore.campaign.watching import DONE, FAILED, INTERRUPTED, RUNNING, SILENCE, SILENT, WAITING, Watcher
from simcore.campaign.watching_text import summary, watched_text
from tests.helpers.few_spheres import FEW_SPHERES
from tests.packing.test_outlook import progress_line


def write(folder, name, log=None, done=False, beat=None):
    """Write the files of one packing: its specification and, if given, log, output and heartbeat of this age [s]."""
    specification = folder / "packings" / f"{name}.yaml"
    specification.parent.mkdir(parents=True, exist_ok=True)
    specification.write_text(yaml.safe_dump(FEW_SPHERES))
    if log is not None:
        path = folder / "logs" / "packing" / f"{name}.log"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(log)
    if done:
        specification.with_name(f"{specification.stem}.nc").write_bytes(b"")
    if beat is not None:
        path = specification.with_name(f"{specification.stem}.nc.heartbeat")
        path.write_text("")
        os.utime(path, (time.time() - beat,) * 2)


@pytest.fixture
def campaign(tmp_path):
    line = progress_line("shaking", 300, 40, 500, "few")
    write(tmp_path, "a/done_1.4kg", log="few: wrote it\n", done=True)
    write(tmp_path, "a/running_1.4kg", log=f"few: 40 grains inserted\n{line}\n", beat=1.0)
    write(tmp_path, "a/compiling", log="few: Compiling the step for spheres\n", beat=5.0)
    write(tmp_path, "b/silent", log=f"{line}\n", beat=SILENCE + 30.0)
    write(tmp_path, "b/failed", log=f"{line}\nfailed: few: grain 3 moves at 9 m/s\n")
    write(tmp_path, "b/crashed", log="Traceback\nKeyError: 'x'\n")
    write(tmp_path, "b/stopped", log=f"{line}\nfew: interrupted at step 300, t = 0.3 s, by request.\n")
    write(tmp_path, "b/waiting")
    # This packing is made again while its former output still exists.
    write(tmp_path, "b/again", log=f"{line}\n", done=True, beat=0.0)
    return tmp_path


def test_every_packing_has_its_state(campaign):
    watched = {one.name: one for one in Watcher(campaign).look()}
    states = {name: one.state for name, one in watched.items()}
    assert states == {
        "a/running_1.4kg": RUNNING,
        "a/compiling": RUNNING,
        "b/again": RUNNING,
        "b/silent": SILENT,
        "b/failed": FAILED,
        "b/crashed": FAILED,
        "b/stopped": INTERRUPTED,
        "b/waiting": WAITING,
        "a/done_1.4kg": DONE,
    }
    running = watched["a/running_1.4kg"]
    assert running.phase == "shaking" and running.rate == pytest.approx(100.0, rel=0.02)
    assert 0.0 < running.share < 1.0 and running.left > 1.9
    assert watched["b/failed"].note == "failed: few: grain 3 moves at 9 m/s"
    assert watched["b/crashed"].note == "KeyError: 'x'" and "no heartbeat for 2.5 min" in watched["b/silent"].note
    assert watched["a/compiling"].note.startswith("few: Compiling") and watched["a/compiling"].share == 0.0
    assert watched["a/done_1.4kg"].share == 1.0 and np.isnan(watched["b/silent"].left)


def test_what_needs_attention_comes_first(campaign):
    order = [one.state for one in Watcher(campaign).look()]
    assert order == [RUNNING] * 3 + [SILENT] + [FAILED] * 2 + [INTERRUPTED, WAITING, DONE]


def test_a_campaign_goes_on_between_two_looks(campaign):
    watcher = Watcher(campaign)
    before = {one.name: one for one in watcher.look()}
    log = campaign / "logs" / "packing" / "a" / "running_1.4kg.log"
    log.write_text(log.read_text() + progress_line("shaking", 450, 40, 500, "few") + "\n")
    (campaign / "packings" / "b" / "waiting.nc").write_bytes(b"")
    after = {one.name: one for one in watcher.look()}
    assert after["a/running_1.4kg"].share > before["a/running_1.4kg"].share
    assert after["b/waiting"].state == DONE


def test_text_has_every_packing_and_a_summary(campaign):
    watched = Watcher(campaign).look()
    text = watched_text(watched)
    assert all(one.name in text for one in watched)
    line = next(line for line in text.splitlines() if line.startswith("a/running_1.4kg"))
    running = next(one for one in watched if one.name == "a/running_1.4kg")
    assert "running, shaking" in line and f"{100 * running.share:.0f} %" in line and f"{running.rate:.0f}" in line
    counts = "9 packings: 1 done, 1 waiting, 1 interrupted, 2 failed, 1 silent, 3 running; the running ones need about"
    assert summary(watched).startswith(counts)


def test_logs_of_single_packings_are_watched_too(tmp_path):
    line = progress_line("damping", 600, 40, 5000, "few")
    logs = {
        "goes_on": f"{line}\n",
        "ready": f"{line}\nfew: wrote few.nc after 3 s\n",
        "wrong": "scree pack: few.yaml: there is no such file\n",
        "other": "something else\n",
        "old": f"{line}\n",
        "ended": f"{line}\nfew: interrupted at step 5, t = 1 s, by request.\n",
    }
    for name, text in logs.items():
        (tmp_path / f"{name}.log").write_text(text)
    os.utime(tmp_path / "old.log", (time.time() - 1000.0,) * 2)
    watched = {one.name: one for one in Watcher(tmp_path).look()}
    states = {name: one.state for name, one in watched.items()}
    assert states == {"goes_on": RUNNING, "ready": DONE, "wrong": FAILED, "old": SILENT, "ended": INTERRUPTED}
    assert watched["goes_on"].phase == "damping" and np.isnan(watched["goes_on"].share)


def test_the_command_prints_once_where_there_is_no_terminal(campaign, capsys):
    for arguments in ([], ["--once"]):
        assert main(["watch", str(campaign), *arguments]) == 0
        text = capsys.readouterr().out
        assert text.startswith("9 packings: ") and "b/waiting" in text


def test_in_a_terminal_the_table_refreshes_until_ctrl_c(campaign, capsys, monkeypatch):
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    monkeypatch.setenv("COLUMNS", "130")
    monkeypatch.setenv("LINES", "30")
    monkeypatch.setenv("TERM", "xterm")
    naps = []

    def sleep(seconds):
        naps.append(seconds)
        if len(naps) == 1:
            (campaign / "packings" / "b" / "waiting.nc").write_bytes(b"")
        else:
            raise KeyboardInterrupt

    monkeypatch.setattr(time, "sleep", sleep)
    assert main(["watch", str(campaign), "--interval", "7"]) == 0
    text = capsys.readouterr().out
    assert naps == [7.0, 7.0]
    assert "1 done, 1 waiting" in text and "2 done, 1 interrupted" in text and "a/running_1.4kg" in text


def test_wrong_input_is_one_line(tmp_path, capsys, monkeypatch):
    (tmp_path / "empty").mkdir()
    for arguments, message in (
        ([str(tmp_path / "none")], "there is no such folder"),
        ([str(tmp_path / "empty")], "there is no packing in it"),
        ([str(tmp_path / "empty"), "--interval", "0"], "--interval: 0 s is not possible"),
    ):
        assert main(["watch", *arguments]) == 2
        printed = capsys.readouterr().err
        assert message in printed and printed.count("\n") == 1
