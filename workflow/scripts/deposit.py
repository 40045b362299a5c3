"""Fabric of a deposit's bulk."""

from simcore.evaluation.deposit import deposit
from simcore.packing.file import read_packing

deposit(read_packing(snakemake.input.packing)).to_netcdf(snakemake.output.fabric)
