"""Write the number of steps per contact time at which a bed comes to rest, for each dashpot."""

from simcore.campaign.job_log import log_to
from simcore.compilation import set_threads
from simcore.report.figures.saving import save_figure
from simcore.report.figures.work_precision import rest_figure
from simcore.verification.machine import describe_machine
from simcore.verification.rest import rest_table

log_to(snakemake.log[0])
set_threads(1)
table = rest_table()
table.assign(machine=describe_machine()).to_csv(snakemake.output.table, index=False)
for path in (snakemake.output.figure, snakemake.output.vector):
    save_figure(rest_figure(table), path)
