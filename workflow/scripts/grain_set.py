"""Write the grains of the source: synthetic, read from files, or from an existing set."""

from simcore.campaign.job_log import log_to
from simcore.grains.grain_set import write_grains
from simcore.grains.sources import grain_warnings, left_out_files, load_grains

log = log_to(snakemake.log[0])
group = snakemake.params.grains
grains = load_grains(group)
for warning in grain_warnings(grains, group):
    log.warning("warning: %s", warning)
write_grains(snakemake.output.grains, grains, left_out="\n".join(left_out_files(group)))
