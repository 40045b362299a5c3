"""Write the energy of spheres without dissipation over time."""

from pathlib import Path

import yaml

from simcore.campaign.job_log import log_to
from simcore.compilation import set_threads
from simcore.verification.outside.elastic import jump

log_to(snakemake.log[0])
set_threads(1)
specification = yaml.safe_load(Path(snakemake.input.specification).read_text(encoding="utf-8"))
jump(specification).to_netcdf(snakemake.output.record)
