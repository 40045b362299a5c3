"""Write the fabric of the bulk of a deposit."""

from simcore.evaluation.deposit import deposit
from simcore.packing.file import read_packing

deposit(read_packing(snakemake.input.packing)).to_netcdf(snakemake.output.fabric)
