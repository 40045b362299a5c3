"""Write the grains of the source: synthetic, read from files, or from an existing set."""

import sys

from simcore.grains.grain_set import write_grains
from simcore.grains.sources import grain_warnings, left_out_files, load_grains

group = snakemake.params.grains
grains = load_grains(group)
with open(snakemake.log[0], "w", encoding="utf-8") as log:
    for warning in grain_warnings(grains, group):
        print(f"warning: {warning}", file=log)
        print(f"warning: {warning}", file=sys.stderr)
write_grains(snakemake.output.grains, grains, left_out="\n".join(left_out_files(group)))
