# Validation and tables, before any job.
from snakemake.exceptions import WorkflowError

from simcore.provenance import digest
from simcore.sources import source_files
from simcore.specification import resolve
from simcore.studies import expand

try:
    campaign = resolve(config, "config")
    packings = expand(campaign)
except ValueError as error:
    raise WorkflowError(f"config: {error}") from None

packings["is_first"] = ~packings.study.duplicated()
all_studies = list(packings.study.unique())
studies = [name for name in all_studies if campaign["studies"][name]["in_all"]]
titles = {name: campaign["studies"][name]["title"] or name for name in studies}


wildcard_constraints:
    study="|".join(all_studies),
    packing=r"[A-Za-z0-9_.+-]+",
    faces=r"\d+",
