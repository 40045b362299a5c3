"""The grains of the source: synthetic, read from files, or a set that was prepared before."""

from simcore.grains.grain_set import write_grains
from simcore.grains.sources import load_grains

write_grains(snakemake.output.grains, load_grains(snakemake.params.grains))
