"""Snakemake on this project in a folder of its own."""

import os
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

from simcore.paths import ROOT
from tests.helpers.snakemake_process import run_snakemake

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
        with tempfile.TemporaryDirectory() as scratch:
            output = [Path(scratch) / name for name in ("stdout", "stderr")]
            arguments = ["--cores", "2", "--nocolor", *arguments]
            status = run_snakemake(arguments, self.folder, environment, output)
            return status, "".join(path.read_text(encoding="utf-8") for path in output)

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
