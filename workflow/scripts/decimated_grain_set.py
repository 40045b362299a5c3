"""Write the grains of the set, decimated to the given maximum number of faces."""

from simcore.campaign.job_log import log_to
from simcore.grains.grain_set import read_grains, write_grains
from simcore.grains.mesh import decimate

log_to(snakemake.log[0])
faces = int(snakemake.wildcards.faces)
grains = [decimate(grain, faces) for grain in read_grains(snakemake.input.grains)]
write_grains(snakemake.output.grains, grains, faces=faces)
