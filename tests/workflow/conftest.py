"""Fixtures that run Snakemake on this project in a folder of their own."""

import os
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).resolve().parents[2]


class Job(NamedTuple):
    """A job that Snakemake plans."""

    rule: str
    study: str | None
    input: list
    output: list


class Workplace:
    """A folder with the project's workflow and config, in which Snakemake runs and writes."""

    def __init__(self, folder):
        self.folder = folder
        for name in ("Snakefile", "workflow", "config", "profiles"):
            (folder / name).symlink_to(ROOT / name)

    def run(self, *arguments, path=f"{Path(sys.executable).parent}:{os.environ['PATH']}"):
        """Snakemake's exit status and what it said, (int, str)."""
        environment = {**os.environ, "PATH": path}
        command = [sys.executable, "-m", "snakemake", "--cores", "2", "--nocolor", *arguments]
        done = subprocess.run(command, cwd=self.folder, env=environment, capture_output=True, text=True)
        return done.returncode, done.stdout + done.stderr

    def jobs(self, *arguments):
        """The jobs of a dry run, a list of `Job`."""
        status, said = self.run("--dry-run", *arguments)
        assert status == 0, said
        jobs = []
        for line in said.splitlines():
            name, _, rest = line.strip().partition(": ")
            if line.startswith(("rule ", "localrule ")):
                jobs.append(Job(line.split()[1].rstrip(":"), None, [], []))
            elif name in ("input", "output"):
                getattr(jobs[-1], name).extend(rest.split(", "))
            elif name == "wildcards" and "study=" in rest:
                jobs[-1] = jobs[-1]._replace(study=rest.split("study=")[1].split(",")[0])
        return jobs

    def plan(self, *arguments):
        """The jobs of a dry run, as a list of (rule, study)."""
        return [(job.rule, job.study) for job in self.jobs(*arguments)]


@pytest.fixture
def workplace(tmp_path):
    """An empty workplace."""
    return Workplace(tmp_path)


@pytest.fixture(scope="session")
def finished(tmp_path_factory):
    """A workplace in which a small campaign of three studies has run, and the arguments it was run with.

    What Snakemake said, with its own log, stands in the workplace's said.txt.
    """
    workplace = Workplace(tmp_path_factory.mktemp("campaign"))
    arguments = ["--configfile", "config/smoke.yaml", str(Path(__file__).with_name("three_studies.yaml"))]
    status, said = workplace.run(*arguments, "--verbose")
    assert status == 0, said
    (workplace.folder / "said.txt").write_text(said)
    return workplace, arguments
