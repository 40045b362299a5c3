"""Write tables and figures of the grains."""

from simcore.campaign.job_log import log_to
from simcore.grains.grain_set import read_grains
from simcore.report.grains import grain_findings

log_to(snakemake.log[0])
grain_findings(read_grains(snakemake.input.grains)).write(snakemake.output, snakemake.params.test_only)
