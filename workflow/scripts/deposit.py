"""Write the fabric of the bulk of a deposit."""

from simcore.campaign.job_log import log_to
from simcore.evaluation.deposit import deposit
from simcore.packing.file import read_packing

log_to(snakemake.log[0])
deposit(read_packing(snakemake.input.packing)).to_netcdf(snakemake.output.fabric)
