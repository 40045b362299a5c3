"""Fabric of a deposit's bulk."""

from simcore.deposits import deposit
from simcore.packing_io import read_packing

deposit(read_packing(snakemake.input.packing)).to_netcdf(snakemake.output.fabric)
