"""Compare packings with known results: measured and expected values."""

from pathlib import Path

import xarray as xr

from simcore.campaign.job_log import log_to
from simcore.report.figures.outside import outside_figure
from simcore.report.figures.saving import save_figure
from simcore.verification.machine import describe_machine
from simcore.verification.outside.table import case_table

log_to(snakemake.log[0])
paths = {Path(path).stem: path for path in snakemake.input.packings}
table = case_table(lambda run: xr.load_dataset(paths[run]))
table.assign(machine=describe_machine()).to_csv(snakemake.output.table, index=False)
save_figure(outside_figure(table), [snakemake.output.figure, snakemake.output.vector])
