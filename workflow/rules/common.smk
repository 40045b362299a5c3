# Validation of the configuration, and thin input functions over the plan of the campaign.
report: "../report/workflow.rst"


import os
import sys
from pathlib import Path

from snakemake.exceptions import WorkflowError
from snakemake.io import ancient
from snakemake.utils import update_config

from simcore.campaign.command_line import campaign_command, typed_values
from simcore.campaign.plan import Plan, is_dry_run
from simcore.campaign.plan_checks import height_option
from simcore.grains.sources import source_files
from simcore.paths import R22_TABLES, REFERENCE, ROOT, find_this_python_first
from simcore.provenance.digest import digest
from simcore.scene.specification import read_yaml, resolve
from simcore.verification.outside import packings as outside_packings

# Jobs use the Python that runs Snakemake.
find_this_python_first()

overlays = [os.path.relpath(path) for path in workflow.overwrite_configfiles]
options = typed_values(workflow.config_settings.config)
update_config(config, options)

try:
    # Snakemake would use the last one of two equal keys without a message.
    if workflow.is_main_process:
        for path in {*workflow.configfiles, *workflow.overwrite_configfiles}:
            read_yaml(Path(path))
    campaign = resolve(config, "config", unused="refuse")
    plan = Plan(campaign, campaign_command(overlays, options))
    # Jobs read this file too, but need no check.
    if workflow.is_main_process:
        plan.check()
except ValueError as error:
    raise WorkflowError(f"config: {error}") from None

# Paths of rules begin with <results>, which Snakemake replaces by the same key of the configuration.
packings, studies, all_studies = plan.packings, plan.studies, plan.all_studies

# Scripts compare with these tables, so that their results depend on them.
published = sorted(str(path.relative_to(ROOT)) for path in R22_TABLES.glob("*.csv"))
published += ["config/cases.tsv"]

# A dry run prints the estimated cost of the campaign. The command line is read because Snakemake does not report a dry
# run to the workflow before all rules are read.
if is_dry_run(sys.argv):
    print(plan.description(), file=sys.stderr)


# The name of the set has a digest of the files' contents, so their modification times are ignored.
def files_of_set(wildcards):
    return [ancient(path) for path in source_files(plan.grain_group(wildcards.grains))]


def group_of_set(wildcards):
    return plan.grain_group(wildcards.grains)


# The value of one packing in a column of the plan, as a list. A query of the whole table takes much longer, and a
# campaign has hundreds of packings.
def value_of(column):
    def values(wildcards):
        try:
            return [plan.value(wildcards.study, wildcards.packing, column)]
        except ValueError as error:
            raise WorkflowError(f"config: {error}") from None

    return values


def has_value(column):
    values = value_of(column)

    def is_given(wildcards):
        return bool(*values(wildcards))

    return is_given


def unless(problem, paths):
    """Return an input function: these paths, or an error with this problem unless it is empty."""

    def inputs(wildcards):
        if problem:
            raise WorkflowError(problem)
        return paths

    return inputs


def unless_none(paths, there_are, overlay):
    """Return an input function: these paths, or an error that names the overlay if the campaign has no such studies."""
    problem = f"this campaign has no such study; use a configuration that has one: --configfile {overlay}"
    return unless("" if there_are else problem, paths)


def curve(wildcards):
    return plan.curve(wildcards.study, wildcards.packing)


def ranks(wildcards):
    return plan.ranks(wildcards.study, wildcards.packing)


def cores(wildcards):
    return plan.cores(wildcards.study, wildcards.packing)


def nodes(wildcards):
    return plan.nodes(wildcards.study, wildcards.packing)


def memory_mb(wildcards, attempt):
    return plan.memory_mb(wildcards.study, wildcards.packing, attempt)


def minutes(wildcards, attempt):
    return plan.minutes(wildcards.study, wildcards.packing, attempt)


# An input that packings wait for, but that does not make finished ones outdated.
def compiled_steps(wildcards):
    path = f"{plan.results}/compiled/{plan.compiled_with(wildcards.study)}.txt"
    return [ancient(path)] if campaign["compile_first"] else []


def specifications_to_compile(wildcards):
    return plan.steps_to_compile(wildcards.studies)


def mpiexec(wildcards):
    return plan.mpiexec(wildcards.study, wildcards.packing)


def check_of_height(wildcards):
    specification = plan.value(wildcards.study, wildcards.packing, "specification")
    return height_option(wildcards.study, specification, campaign["porosity"]["cut"])


def bias_effects(wildcards):
    return plan.bias_effects()


def specification_from_outside(wildcards):
    return outside_packings.specification(
        wildcards.outside, f"{plan.results}/verification/dice"
    )


# A figure as PNG, which Snakemake's report shows with its caption, and as PDF.
def figure(path, category, caption=None, **labels):
    caption = caption or "_".join(path.split("/")[-2:])
    shown = report(
        f"{path}.png",
        caption=f"../report/{caption}.rst",
        category=category,
        labels={"figure": caption.split("_", 1)[1].replace("_", " "), **labels},
    )
    return [shown, f"{path}.pdf"]


wildcard_constraints:
    study="|".join(all_studies),
    packing=r"[A-Za-z0-9_.+-]+",
    faces=r"\d+",
    grains=r"[A-Za-z0-9_.+-]+",
    studies="|".join(["all", *all_studies]),
