"""Write the grains in the order that spreads their forms over the Zingg diagram."""

from simcore.campaign.job_log import log_to
from simcore.grains.grain_set import read_grains
from simcore.grains.spread import spread_table

log_to(snakemake.log[0])
spread_table(read_grains(snakemake.input.grains)).to_csv(snakemake.output.forms, index=False)
