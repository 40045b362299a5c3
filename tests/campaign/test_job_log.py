"""The log of a job of the workflow."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPTS = sorted((Path(__file__).parents[2] / "workflow" / "scripts").glob("*.py"))


def outcome(folder, line):
    """Return what a job of this one line left in its log, and what the terminal showed of it."""
    path = folder / "job.log"
    lines = (
        "import logging, warnings",
        "from simcore.campaign.job_log import log_to",
        f"log = log_to({str(path)!r})",
        line,
    )
    said = subprocess.run([sys.executable, "-c", "\n".join(lines)], capture_output=True, text=True, check=False)
    return path.read_text(encoding="utf-8"), said.stderr, said.returncode


def test_messages_go_to_the_log_alone_and_warnings_also_to_the_terminal(tmp_path):
    log, terminal, status = outcome(tmp_path, "log.info('a row'); warnings.warn('a bed of 3 grains')")
    assert status == 0
    assert "a row" in log and "a row" not in terminal
    assert "a bed of 3 grains" in log and "a bed of 3 grains" in terminal


def test_messages_of_other_libraries_are_left_out(tmp_path):
    log, terminal, _ = outcome(tmp_path, "logging.getLogger('fontTools').info('glyphs')")
    assert log == terminal == ""


@pytest.mark.parametrize("kind", ["ValueError", "FileNotFoundError"])
def test_wrong_input_is_one_line_in_the_terminal_and_a_traceback_in_the_log(tmp_path, kind):
    log, terminal, status = outcome(tmp_path, f"raise {kind}('grains/a.stl is empty')")
    assert status == 1
    assert terminal == f"grains/a.stl is empty\n(The traceback is in {tmp_path / 'job.log'}.)\n"
    assert "Traceback" in log and log.endswith(f"{kind}: grains/a.stl is empty\n")


def test_an_error_of_the_program_is_a_traceback_in_both(tmp_path):
    log, terminal, status = outcome(tmp_path, "1 / 0")
    assert status == 1
    assert all("Traceback" in text and "ZeroDivisionError" in text for text in (log, terminal))


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_each_script_writes_the_log_that_its_rule_declares(script):
    assert re.search(r"^(log = )?log_to\(snakemake\.log\[0\]\)$", script.read_text(encoding="utf-8"), re.MULTILINE)
