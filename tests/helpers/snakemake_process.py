"""Snakemake in a process forked from one in which all modules are loaded, which halves the time of a dry run."""

import multiprocessing
import os
import sys

# Loaded once, in the process from which all others are forked.
PRELOADED = [
    "snakemake.cli",
    "snakemake.api",
    "snakemake.report",
    "snakemake.storage",
    "snakemake.profiles",
    "simcore.campaign.plan",
    "simcore.campaign.deposits",
    "simcore.campaign.showpieces",
    "simcore.grains.sources",
    "simcore.verification.outside",
]
_processes = multiprocessing.get_context("forkserver")
_processes.set_forkserver_preload(PRELOADED)


def run_snakemake(arguments, folder, environment, output):
    """Run Snakemake in a folder, as the command would; return its exit status.

    arguments, environment: those of the command, list and dict. output: paths of files for what it prints on standard
    output and on standard error.
    """
    process = _processes.Process(target=_main, args=(arguments, folder, environment, output))
    process.start()
    process.join()
    return process.exitcode


def _main(arguments, folder, environment, output):
    for descriptor, path in zip((1, 2), output, strict=True):
        os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), descriptor)
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    sys.argv = ["snakemake", *arguments]
    from snakemake.cli import main

    main(arguments)
