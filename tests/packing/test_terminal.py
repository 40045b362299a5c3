"""Progress is a bar in a terminal and lines elsewhere; a log has the lines in both cases."""

import io
import sys

import pytest

from simcore.packing import terminal
from simcore.packing.terminal import expect, reporter
from simcore.scene.specification import resolve
from tests.helpers.few_spheres import FEW_SPHERES

LINES = [
    "few: 40 grains inserted, 0.01 kg",
    "few: shaking, t = 0.050 s, 40 grains, kinetic energy 1.00e-04 J, mean overlap 1.0e-06 m, 500 steps/s, about 1 s "
    "left in this phase",
    "few: wrote few.nc after 3 s",
]


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.fixture(autouse=True)
def wide(monkeypatch):
    monkeypatch.setenv("COLUMNS", "120")
    monkeypatch.setenv("TERM", "xterm")


def report_all(stream, log=None):
    report = reporter(log, stream)
    expect(report, resolve(FEW_SPHERES))
    for line in LINES:
        report(line)
    if report.bar is not None:
        report.bar.progress.stop()
    return stream.getvalue()


def test_elsewhere_every_line_is_printed():
    assert report_all(io.StringIO()).splitlines() == LINES


def test_in_a_terminal_progress_is_a_bar_and_other_lines_stay(tmp_path):
    text = report_all(Terminal(), tmp_path / "new" / "few.log")
    assert LINES[0] in text and LINES[2] in text
    assert "mean overlap" not in text and "few: shaking" in text and "40 grains, 500 steps/s" in text
    assert " % " in text.replace("%,", "% ,") and "left" in text and "━" in text
    assert (tmp_path / "new" / "few.log").read_text().splitlines() == LINES


def test_a_log_that_cannot_be_written_does_not_end_the_packing(tmp_path):
    log, stream = tmp_path / "logs" / "few.log", io.StringIO()
    report = reporter(log, stream)
    report(LINES[0])
    log.unlink()
    log.parent.rmdir()
    report(LINES[1])
    report(LINES[2])
    said = f"{log} cannot be written (No such file or directory); the lines that follow are missing in it"
    assert stream.getvalue().splitlines() == [LINES[0], said, *LINES[1:]]


def test_the_share_is_that_of_the_outlook(monkeypatch):
    shares = []
    monkeypatch.setattr(terminal._Bar, "move", lambda self, line, ahead: shares.append(ahead.share))
    report_all(Terminal())
    (share,) = shares
    specification = resolve(FEW_SPHERES)
    cost = terminal.estimate(specification)
    done = 0.05 / cost.time_step
    assert share == pytest.approx(done / (done + 500 + cost.damping))


def test_a_specification_without_estimate_and_a_missing_library_do_no_harm(monkeypatch):
    def fail(specification):
        raise ValueError("no estimate")

    monkeypatch.setattr(terminal, "estimate", fail)
    text = report_all(Terminal())
    assert "few: shaking" in text and "%" not in text
    monkeypatch.setitem(sys.modules, "rich.progress", None)
    assert report_all(Terminal()).splitlines() == LINES


def test_a_log_is_emptied_first(tmp_path):
    (tmp_path / "few.log").write_text("old\n")
    report_all(io.StringIO(), tmp_path / "few.log")
    assert (tmp_path / "few.log").read_text().splitlines() == LINES
