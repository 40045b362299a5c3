# Validation and tables, before any job.
report: "../report/workflow.rst"


import os
import sys
from pathlib import Path

import numpy as np
from snakemake.exceptions import WorkflowError
from snakemake.io import ancient

from simcore.campaign import deposits
from simcore.campaign.biases import bias_note, measured_biases
from simcore.campaign.plan import (
    check_beds,
    describe_studies,
    estimate_studies,
    number_pieces,
)
from simcore.campaign.gathering import not_gathered
from simcore.packing.cost import estimate
from simcore.paths import REFERENCE, ROOT
from simcore.provenance.digest import digest
from simcore.campaign.showpieces import corner_mixtures, showpieces
from simcore.grains.sources import set_name, source_files, source_name
from simcore.scene.specification import resolve
from simcore.verification.outside import packings as outside_packings
from simcore.campaign.studies import expand

try:
    campaign = resolve(config, "config", unused="refuse")
    packings = expand(campaign)
    # Jobs read this file too, and need no check. Of deposits the fabric is evaluated, with other cuts.
    if workflow.is_main_process:
        check_beds(
            packings[~packings.study.str.startswith(deposits.PREFIX)],
            campaign["porosity"]["cut"],
        )
    # What a packing asks of the machine. No result depends on it, so nothing of it may stand in `params`.
    packings["cost"] = packings.specification.map(estimate)
except ValueError as error:
    raise WorkflowError(f"config: {error}") from None

# Paths of rules begin with <results>, which Snakemake takes from the same key.
results = campaign["pathvars"]["results"]
overlays = [os.path.relpath(path) for path in workflow.overwrite_configfiles]
packings["is_first"] = ~packings.study.duplicated()
all_studies = list(packings.study.unique())
studies = [name for name in all_studies if campaign["studies"][name]["in_all"]]
titles = {name: campaign["studies"][name]["title"] or name for name in studies}


# The grains behind each set, by its name. Another source, or other content of its files, is another set beside it, so that
# campaigns in one folder do not write over each other's grains. The report shows the campaign's own set.
grain_groups = {set_name(campaign["grains"]): campaign["grains"]}
for group in packings.grains[packings.grains.notna()]:
    grain_groups[set_name(group)] = group
packings["grain_folder"] = packings.grain_set.str.partition("/")[0]
packings["source"] = [
    source_name((group or campaign["grains"])["source"]) for group in packings.grains
]


# The name of the set is of what the files hold: how old they are decides nothing.
def files_of_set(wildcards):
    return [ancient(path) for path in source_files(grain_groups[wildcards.grains])]


def group_of_set(wildcards):
    return grain_groups[wildcards.grains]


hours = np.array([cost.cpu_seconds / 3600.0 for cost in packings.cost])
seeds = np.array([specification["seed"] for specification in packings.specification])
packings["piece"] = 0
for rows in packings.groupby("study").indices.values():
    packings.loc[rows, "piece"] = number_pieces(
        hours[rows], seeds[rows], campaign["piece_hours"]
    )
packings["ranks"] = [
    cost.ranks(campaign["ranks"], campaign["grains_per_rank"]) for cost in packings.cost
]


def plans_of(study):
    """Packings of a study as simcore.campaign.gathering takes them, dict from the name of their grains' source."""
    sources = packings.source[packings.study == study].unique()
    return {source: plan_of(study, source) for source in sources}


def plan_of(study, source=None):
    """Packings of a study, of grains of one source or of all."""
    return [
        {
            "row": packing.row,
            "specification": packing.specification,
            "cpu_h": packing.cost.cpu_seconds / 3600.0,
        }
        for packing in packings[packings.study == study].itertuples()
        if source in (None, packing.source)
    ]


def files_left(study):
    """What is evaluated of those packings of a study that have no row in the committed tables yet."""
    folder, plans = "porosity", plans_of(study)
    if study.startswith(deposits.PREFIX):
        folder, plans = "fabric", {deposits.SOURCE: plan_of(study)}
    return [
        f"<results>/{folder}/{study}/{packing['row']['packing']}.nc"
        for source, plan in plans.items()
        for packing in not_gathered(campaign["reference"], study, source, plan)
    ]


def unless_none(paths, there_are, overlay):
    """Input function: these paths, or an error that names the overlay where the campaign has none of such studies."""

    def inputs(wildcards):
        if not there_are:
            raise WorkflowError(
                f"this campaign has no such study; name one that has: --configfile {overlay}"
            )
        return paths

    return inputs


# A dry run says what the campaign will cost. Snakemake tells no workflow that it is one before all rules are read.
if {"-n", "--dry-run", "--dryrun"} & set(sys.argv):
    print(
        describe_studies(estimate_studies(packings, studies), campaign["piece_hours"]),
        file=sys.stderr,
    )


def of_packing(wildcards, column):
    return packings.set_index(["study", "packing"])[column][
        wildcards.study, wildcards.packing
    ]


def ranks(wildcards):
    return int(of_packing(wildcards, "ranks"))


def cores(wildcards):
    return ranks(wildcards) * campaign["threads"]


def memory_mb(wildcards, attempt):
    return attempt * of_packing(wildcards, "cost").memory_mb(ranks(wildcards))


def minutes(wildcards, attempt):
    return attempt * of_packing(wildcards, "cost").minutes(cores(wildcards))


# One rank needs nothing to start it, and the executor for Slurm refuses to hear of MPI then.
def mpiexec(wildcards):
    return campaign["mpiexec"] if ranks(wildcards) > 1 else ""


# What is known of how far off the porosities of each study are.
def bias_notes(names):
    biases = measured_biases(REFERENCE)
    specifications = packings.groupby("study").specification
    return {
        name: bias_note(list(specifications.get_group(name)), biases) for name in names
    }


# Packings of one form that stand in for cases which this campaign has not.
cases_packed = {
    specification["sizes"]["case"]
    for specification in packings.specification[
        packings.study.str.startswith("single_form")
    ]
}
cases_committed = sorted(set(campaign["models"]["committed"]) - cases_packed)
committed_rows = REFERENCE / "single_form.csv"


# A figure as PNG, which Snakemake's report shows under its caption, and as PDF.
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
