"""Write mesh files of the Platonic solids, like files of a user."""

from pathlib import Path

from simcore.campaign.job_log import log_to
from simcore.verification.outside.solids import write_solid

log_to(snakemake.log[0])
for path in snakemake.output:
    write_solid(path, Path(path).stem, edge=10.0)  # [mm]
