"""The watchdog with a stand-in for the packing: no hang, no orphan, no half file, one clear line, and a resumed run."""

import contextlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import netCDF4
import numpy as np
import psutil
import pytest

from benchmarks.correctness.faults import mark_of
from simcore.packing.launch import MARK

STAND_IN = Path(__file__).with_name("stand_in.py")
ROOT = Path(__file__).resolve().parents[2]
LONG, STEPS, SHORT = 2000, 100, 10  # steps of 10 ms
# Longest time that anything here may take [s]; each wait below ends as soon as it can.
PATIENCE = 60.0


class Run:
    """A launch of the stand-in in a folder, in a process of its own."""

    def __init__(self, folder, ranks=2, steps=LONG, output="bed.nc", silence="30 s", parent=(), more=()):
        self.output = folder / output
        specification = folder / "spec.yaml"
        specification.write_text(f"{{numbers: 64, steps: {steps}, step: 10 ms}}")
        command = [*parent, sys.executable, STAND_IN, "launch", specification, self.output, "--ranks", ranks]
        command += ["--silence", silence, "--startup", "30 s", "--grace", "1 s", "--checkpoints", folder / "kept"]
        command += ["--checkpoint-interval", "0.1 s", *more]
        self.process = subprocess.Popen(
            [str(word) for word in command],
            env={**os.environ, "PYTHONPATH": str(ROOT)},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        self.ranks = ranks

    def rank(self, number):
        """Return the process id of a rank, once it makes steps."""
        file = self.output.with_name(f"{self.output.name}.pid.{number}")
        wait_until(lambda: file.exists() and file.read_text())
        wait_until(self.begun)
        return int(file.read_text())

    def begun(self):
        return (self.output.parent / "kept" / "stand_in.npz").exists()

    def family(self):
        """Return all processes of this launch except the launcher, found by the mark that they inherited."""
        return marked(self.process.pid)

    def end(self):
        """Return the exit status and the last line of the output."""
        said, _ = self.process.communicate(timeout=PATIENCE)
        assert "Traceback" not in said, said
        return self.process.returncode, said.strip().splitlines()[-1] if said.strip() else ""


def wait_until(condition):
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline, "the condition was not met in time"
        time.sleep(0.02)


def marked(launcher):
    """Return the living processes that have the mark of the children of this launcher."""
    with contextlib.suppress(psutil.Error):
        tokens = {child.environ().get(MARK) for child in psutil.Process(launcher).children()} - {None}
        return [process for process in psutil.process_iter() if mark_of(process) in tokens]
    return []


def assert_none_left(family):
    assert family
    _, alive = psutil.wait_procs(family, timeout=5.0)
    assert [process for process in alive if process.status() != psutil.STATUS_ZOMBIE] == []


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory):
    """Return the numbers after these steps on one rank, without an interruption."""
    run = Run(tmp_path_factory.mktemp("whole"), ranks=1, steps=STEPS)
    assert run.end()[0] == 0
    return numbers(run.output)


def numbers(path):
    with netCDF4.Dataset(path) as file:
        return np.ma.getdata(file["numbers"][:])


@pytest.mark.parametrize("ranks", [1, 2, 3])
def test_a_run_that_nothing_disturbs(tmp_path, ranks):
    run = Run(tmp_path, ranks=ranks, steps=SHORT)
    status, line = run.end()
    assert (status, line) == (0, f"simcore stand-in: wrote {run.output}")
    assert {path.name for path in tmp_path.iterdir() if ".pid." not in path.name} <= {"bed.nc", "spec.yaml", "kept"}


@pytest.mark.parametrize(("ranks", "killed"), [(1, [0]), (2, [0]), (2, [1]), (3, [0, 1, 2])])
def test_killed_ranks_take_the_others_down(tmp_path, ranks, killed, uninterrupted):
    run = Run(tmp_path, ranks=ranks, steps=STEPS)
    victims = [run.rank(number) for number in killed]
    family = run.family()
    for victim in victims:
        with contextlib.suppress(ProcessLookupError):  # the end of the first rank may have ended the others already
            os.kill(victim, signal.SIGKILL)
    status, line = run.end()
    assert status == 1
    assert line.startswith(f"scree launch: {run.output}: a rank was ended by SIGKILL")
    assert line.endswith("run the same command again: it resumes from its last checkpoint")
    assert_none_left(family)
    assert not run.output.exists()
    again = Run(tmp_path, ranks=2, steps=STEPS)
    assert again.end()[0] == 0
    np.testing.assert_array_equal(numbers(again.output), uninterrupted)


@pytest.mark.parametrize(("ranks", "stopped"), [(1, 0), (2, 0), (2, 1)])
def test_a_stopped_rank_is_silence(tmp_path, ranks, stopped):
    run = Run(tmp_path, ranks=ranks, silence="2 s")
    victim = run.rank(stopped)
    family = run.family()
    os.kill(victim, signal.SIGSTOP)
    status, line = run.end()
    assert status == 1
    assert f"{run.output}: no heartbeat for 2 s, but at most 2 s are allowed" in line
    assert "resumes from its last" in line
    assert_none_left(family)
    assert not run.output.exists()


def test_a_run_that_never_begins_is_ended(tmp_path):
    run = Run(tmp_path, ranks=1, more=["--startup", "1 s"])
    os.kill(rank_that_starts(run), signal.SIGSTOP)
    status, line = run.end()
    assert status == 1 and "no first heartbeat after 1 s" in line and "raise --startup" in line


def rank_that_starts(run):
    wait_until(run.family)
    return run.family()[0].pid


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
@pytest.mark.parametrize("ranks", [1, 2])
def test_an_interruption_reaches_the_ranks(tmp_path, number, ranks, uninterrupted):
    run = Run(tmp_path, ranks=ranks, steps=STEPS)
    run.rank(0)
    family = run.family()
    run.process.send_signal(number)
    status, line = run.end()
    assert status == 75 and line.startswith("simcore stand-in: interrupted at step ")
    assert_none_left(family)
    with np.load(tmp_path / "kept" / "stand_in.npz") as kept:
        assert line == f"simcore stand-in: interrupted at step {kept['step']}, go on by running it again"
    again = Run(tmp_path, ranks=1, steps=STEPS)
    assert again.end()[0] == 0
    np.testing.assert_array_equal(numbers(again.output), uninterrupted)


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux notifies a child that its parent died")
@pytest.mark.parametrize(("ranks", "stopped"), [(1, False), (2, False), (2, True)])
def test_a_killed_launcher_leaves_no_orphans(tmp_path, ranks, stopped):
    run = Run(tmp_path, ranks=ranks)
    victim = run.rank(ranks - 1)
    family = run.family()
    if stopped:
        os.kill(victim, signal.SIGSTOP)
    run.process.kill()
    run.process.communicate(timeout=PATIENCE)
    assert_none_left(family)
    # Its lock is not left either.
    again = Run(tmp_path, ranks=1, steps=SHORT)
    assert again.end()[0] == 0


def test_a_run_ends_with_its_parent_process_if_specified(tmp_path):
    shell = ["bash", "-c", '"$@" & wait', "shell"]
    run = Run(tmp_path, parent=shell, more=["--with-parent"])
    run.rank(0)
    (launcher,) = psutil.Process(run.process.pid).children()
    family = [launcher, *marked(launcher.pid)]
    run.process.kill()
    said, _ = run.process.communicate(timeout=PATIENCE)
    assert "the parent process has ended" in said
    assert "simcore stand-in: interrupted at step" in said
    assert_none_left(family)


def test_two_runs_do_not_write_one_file(tmp_path):
    first = Run(tmp_path)
    first.rank(0)
    second = Run(tmp_path, ranks=1)
    (line,) = (second.process.stdout.readline(),)
    assert f"waiting for another run that writes it to end (process {first.process.pid})" in line
    second.process.terminate()
    status, line = second.end()
    assert status == 2 and f"is being written by another run (process {first.process.pid})" in line
    first.process.terminate()
    assert first.end()[0] == 75


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"output": "file/bed.nc"}, "Not a directory"),
        ({"ranks": 0}, "ranks: 0 is not possible; give 1 or more"),
        ({"more": ["--mpiexec", "/nowhere/srun"]}, "/nowhere/srun cannot be started (No such file or directory)"),
        ({"silence": "3 kg"}, "--silence: '3 kg' is a mass"),
    ],
)
def test_what_cannot_be_started_is_one_clear_line(tmp_path, arguments, message):
    (tmp_path / "file").touch()
    run = Run(tmp_path, **arguments)
    status, line = run.end()
    assert status == 2 and message in line
    assert not list(tmp_path.rglob("*.nc"))


def test_an_exit_status_is_no_signal_on_one_rank(tmp_path):
    run = "import sys; from pathlib import Path; from simcore.packing.launch import launch; "
    run += (
        f"command = [sys.executable, '-c', 'raise SystemExit(3)']; launch(command, Path({str(tmp_path / 'bed.nc')!r}))"
    )
    ended = subprocess.run(
        [sys.executable, "-c", run], env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True
    )
    assert ended.stderr.endswith("bed.nc: the packing ended with status 3; run the same command again\n")


def test_the_command_of_srun(tmp_path):
    """A script instead of srun prints what it is given: the number of ranks and the threads of each."""
    srun = tmp_path / "srun"
    srun.write_text('#!/bin/sh\necho "$SRUN_CPUS_PER_TASK" "$@"\n')
    srun.chmod(0o755)
    run = Run(tmp_path, ranks=4, more=["--threads", "3", "--mpiexec", f"{srun} --mpi=pmi2"])
    status, line = run.end()
    assert status == 0 and line.startswith(f"3 --mpi=pmi2 -n 4 {sys.executable} {STAND_IN} pack ")


def test_a_bad_output_path_is_one_clear_line_of_simcore(tmp_path):
    (tmp_path / "file").touch()
    words = ["launch", tmp_path / "spec.yaml", tmp_path / "file" / "bed.nc", "--ranks", 2]
    done = subprocess.run(
        [sys.executable, "-m", "simcore", *map(str, words)], cwd=ROOT, capture_output=True, text=True, timeout=PATIENCE
    )
    assert done.returncode == 2
    assert done.stderr.startswith(f"scree launch: {tmp_path / 'file' / 'bed.nc'} cannot be written")
    assert len(done.stderr.splitlines()) == 1
