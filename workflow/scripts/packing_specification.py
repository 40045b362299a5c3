"""Write the complete specification of one packing, with the name of its grain."""

from pathlib import Path

from simcore.campaign.job_log import log_to
from simcore.campaign.studies import specification_text
from simcore.grains.spread import read_spread

log_to(snakemake.log[0])
(specification,), (form,) = snakemake.params.specification, snakemake.params.form
names = read_spread(*snakemake.input.forms) if form else []
Path(snakemake.output.specification).write_text(specification_text(specification, form, names), encoding="utf-8")
