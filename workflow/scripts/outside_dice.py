"""Meshes of the Platonic solids, as a user would have them."""

from pathlib import Path

from simcore.verification.outside.solids import write_solid

for path in snakemake.output:
    write_solid(path, Path(path).stem, edge=10.0)  # [mm]
