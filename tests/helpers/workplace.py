"""Snakemake on this project in a folder of its own."""

import os
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

from simcore.paths import ROOT

STUDIES = {
    "mesh_resolution",
    "shaking_cylinder",
    "validation",
    "domain_size",
    "shaking_periodic",
    "single_form",
    "equivalent_ellipsoids",
    "near_spheres",
    "form_mixtures",
    "application",
}
# Lines under `studies:` of an overlay that leave out all studies of config.yaml.
NULL_STUDIES = "\n".join(f"  {study}: null" for study in sorted(STUDIES))


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
        """Run Snakemake; return its exit status and its output, (int, str)."""
        environment = {**os.environ, "PATH": path}
        command = [sys.executable, "-m", "snakemake", "--cores", "2", "--nocolor", *arguments]
        done = subprocess.run(command, cwd=self.folder, env=environment, capture_output=True, text=True)
        return done.returncode, done.stdout + done.stderr

    def jobs(self, *arguments):
        """Return the jobs of a dry run, a list of `Job`."""
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
        """Return the jobs of a dry run, as a list of (rule, study)."""
        return [(job.rule, job.study) for job in self.jobs(*arguments)]
