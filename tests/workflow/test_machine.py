"""Ranks, threads, memory and time of packings, as Snakemake plans them, here and on a cluster."""

import pytest

from tests.helpers.workplace import NULL_STUDIES

pytestmark = pytest.mark.workflow

CAMPAIGN = f"""
packing: {{domain: {{width: 45 mm, height: 0.8 m}}, sizes: {{case: U1}}, shapes: {{kind: sphere}}}}
studies:
  spheres:
    varies: {{amount.grains: [500, 5000]}}
{NULL_STUDIES}
"""


@pytest.fixture
def planned(workplace):
    """Return a function that returns the texts of a dry run for the packings of 500 and of 5000 grains."""
    (workplace.folder / "spheres.yaml").write_text(CAMPAIGN)

    def plan(*arguments):
        status, said = workplace.run(
            "--dry-run", "--printshellcmds", "spheres", "--configfile", "spheres.yaml", *arguments
        )
        assert status == 0, said
        jobs = said.split("rule packing:")[1:]
        return [next(job for job in jobs if f"packing=grains_{grains}\n" in job) for grains in (500, 5000)]

    return plan


def asked(job):
    """Return the resources of a planned job as a dict of text."""
    line = next(line for line in job.splitlines() if line.strip().startswith("resources:"))
    return {key: value for key, _, value in (each.strip().partition("=") for each in line.split(":", 1)[1].split(","))}


def test_one_rank_with_one_thread_where_nothing_is_said(planned):
    for job in planned():
        assert (asked(job)["tasks"], asked(job)["cpus_per_task"], asked(job)["mpi"]) == ("1", "1", "")
        assert "threads:" not in job
        assert "--ranks 1 --threads 1 --mpiexec= --checkpoints results/checkpoints/" in job
        assert "--force" not in job and "--cut" not in job
    for job in planned("--config", "porosity={cut: 5 mm}"):
        assert "--cut 0.005 " in job


def test_ranks_and_threads_of_the_config_are_accounted(planned):
    """Cores are ranks times threads, and few grains take fewer ranks."""
    small, large = planned("--config", "ranks=4", "threads=2", "--cores", "16")
    assert "threads: 2" in small and "--ranks 1 --threads 2" in small
    assert "threads: 8" in large and "--ranks 4 --threads 2" in large


def test_the_profile_for_slurm_asks_for_tasks_memory_and_time(planned):
    """One rank is no MPI job: the executor refuses MPI with one task."""
    small, large = planned("--workflow-profile", "profiles/slurm")
    assert "--ranks 1 --threads 1 --mpiexec= " in small
    assert "--ranks 5 --threads 1 --mpiexec='srun --mpi=pmi2' " in large
    few, many = asked(small), asked(large)
    assert (few["tasks"], few["mpi"], many["tasks"], many["mpi"]) == ("1", "", "5", "srun --mpi=pmi2")
    # 500 MB for each rank, since the profile compiles first, 300 MB for the job, and little for the arrays.
    assert 800 <= int(few["mem_mb"]) < 900 and 2800 <= int(many["mem_mb"]) < 2900
    assert 15 <= int(few["runtime"]) <= int(many["runtime"]) < 60


def test_jobs_take_the_python_that_runs_snakemake(workplace):
    """This also works if its environment is not activated; the system's Python has no simcore."""
    (workplace.folder / "spheres.yaml").write_text(CAMPAIGN)
    specification = "results/packings/spheres/grains_500.yaml"
    status, said = workplace.run(specification, "--configfile", "spheres.yaml", path="/usr/bin:/bin")
    assert status == 0, said
    assert (workplace.folder / specification).exists()


def test_steps_are_compiled_by_a_job_that_packings_wait_for(workplace):
    (workplace.folder / "spheres.yaml").write_text(CAMPAIGN)
    first = ["--configfile", "spheres.yaml", "--config", "compile_first=True"]
    assert ("compiled_steps", None) in workplace.plan("spheres", *first)
    assert "compiled_steps" not in {rule for rule, _ in workplace.plan("spheres", *first[:2])}
    status, said = workplace.run("results/compiled/all.txt", *first)
    assert status == 0, said
    assert (workplace.folder / "results/compiled/all.txt").read_text() == "Compiled steps: 1\n"
