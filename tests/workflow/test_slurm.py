"""Requests to Slurm: the command lines that the executor gives to a stand-in for sbatch."""

import os
import shlex
import sys
from pathlib import Path

import pytest

from simcore.packing.cost import COMPILING_MEMORY, JOB_MEMORY
from tests.helpers.workplace import NULL_STUDIES

pytestmark = pytest.mark.workflow

CAMPAIGN = f"""
grains_per_rank: 10
packing:
  accuracy: r22
  domain: {{width: 45 mm, height: 0.8 m}}
  sizes: {{case: U1}}
  shapes: {{kind: sphere}}
  amount: {{grains: 5000}}
studies:
  spheres:
    varies: {{seed: [1, 2, 3]}}
{NULL_STUDIES}
"""
PACKING = "results/packings/spheres/seed_1.nc"
# This program refuses every job, as a cluster without nodes does, so that each attempt submits again.
SBATCH = f"""#!{sys.executable}
import sys
with open("sbatch.txt", "a") as file:
    file.write("\\x1f".join(sys.argv[1:]) + "\\x1e")
sys.exit("no nodes")
"""
OTHERS = {"sinfo": "echo 'day*'", "sacctmgr": "echo lab", "sshare": "echo lab", "scontrol": "true", "sacct": "true"}


@pytest.fixture
def slurm(workplace):
    """Return a function that runs Snakemake with the profile and returns the words of each call of sbatch."""
    programs = workplace.folder / "programs"
    programs.mkdir()
    for name, text in {"sbatch": SBATCH, **{name: f"#!/bin/sh\n{text}\n" for name, text in OTHERS.items()}}.items():
        (programs / name).write_text(text)
        (programs / name).chmod(0o755)
    (workplace.folder / "spheres.yaml").write_text(CAMPAIGN)
    path = os.pathsep.join([str(programs), str(Path(sys.executable).parent), os.environ["PATH"]])

    def run(target, *arguments):
        calls = workplace.folder / "sbatch.txt"
        calls.unlink(missing_ok=True)
        account = ["--default-resources", "mem_mb=4000", "runtime=60", "slurm_account=lab", "slurm_partition=day"]
        profile = ["--workflow-profile", "profiles/slurm", "--configfile", "spheres.yaml", *account]
        quick = ["--slurm-init-seconds-before-status-checks", "1"]
        status, said = workplace.run(*profile, *quick, *arguments, "--", *target, path=path)
        assert status != 0 and "no nodes" in said, said
        return [call.split("\x1f") for call in calls.read_text().split("\x1e") if call]

    run.workplace = workplace
    return run


def asked(call):
    """Return the options of a call of sbatch up to the command as a dict; `-t 10` counts as `-t=10`."""
    words = call[: next(i for i, word in enumerate(call) if word.startswith("--wrap"))]
    options = {}
    for word, following in zip(words, [*words[1:], ""], strict=True):
        if word.startswith("-"):
            name, equals, value = word.partition("=")
            options[name] = value if equals else following
    return options


def machine(ranks, **keys):
    """Return keys of the configuration that replace those of the profile."""
    keys = {"cores_per_node": 64, "longest_job": "24 h", "mpiexec": "srun --mpi=pmi2"} | keys
    return ["--config", f"ranks={ranks}", *(f"{key}={value}" for key, value in keys.items())]


@pytest.mark.parametrize("ranks, nodes, on_a_node", [(1, 1, 1), (64, 1, 64), (400, 7, 64)])
def test_ranks_nodes_and_the_memory_of_a_node(slurm, ranks, nodes, on_a_node):
    (call,) = slurm([PACKING], *machine(ranks), "--retries", "0")
    options = asked(call)
    assert (options["--ntasks"], options["--nodes"], options["--cpus-per-task"]) == (str(ranks), str(nodes), "1")
    # The keys of `machine` do not compile first. Arrays of 5000 grains are small beside the processes.
    processes = JOB_MEMORY + on_a_node * COMPILING_MEMORY
    assert processes <= 1e6 * int(options["--mem"]) < processes + 100e6
    assert (options["-A"], options["-p"]) == ("lab", "day")
    command = shlex.join(call)
    assert f"tasks={ranks}" in command and f"nodes={nodes}" in command


def test_threads_of_ranks_are_cores_of_the_node(slurm):
    (call,) = slurm([PACKING], *machine(64, threads=4), "--retries", "0")
    options = asked(call)
    assert (options["--ntasks"], options["--nodes"], options["--cpus-per-task"]) == ("64", "4", "4")
    assert 0.3e9 + 16 * 1.3e9 <= 1e6 * int(options["--mem"]) < 0.4e9 + 16 * 1.3e9


def test_attempts_ask_for_more_time_up_to_the_longest_job_and_for_more_memory(slurm):
    calls = [asked(call) for call in slurm([PACKING], *machine(1, longest_job="2.5 h"), "--retries", "3")]
    times, memory = [int(call["-t"]) for call in calls], [int(call["--mem"]) for call in calls]
    assert len(calls) == 4
    assert times == [min(attempt * times[0], 150) for attempt in (1, 2, 3, 4)]
    assert times[0] < times[1] < times[3] == 150
    assert memory == [memory[0]] + 3 * [memory[1]] and memory[0] < memory[1] < memory[0] + 100


def test_a_job_compiles_before_the_first_packing(slurm):
    """The keys are those of the profile itself; nothing else is submitted before this job has ended."""
    (call,) = slurm([PACKING], "--retries", "0")
    options = asked(call)
    assert "rule_compiled_steps" in options["--comment"]
    assert (options["--ntasks"], options["--mem"], options["-t"]) == ("1", "4000", "60")


def test_evaluations_are_one_array(slurm):
    packings = [PACKING.replace("seed_1", f"seed_{seed}") for seed in (1, 2, 3)]
    for packing in packings:
        path = slurm.workplace.folder / packing
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("")
    targets = [packing.replace("/packings/", "/porosity/") for packing in packings]
    (call,) = slurm(targets, *machine(1), "--retries", "0", "--rerun-triggers", "mtime")
    options = asked(call)
    assert options["--array"] == "1-3"
    assert "rule_porosity" in options["--comment"]
