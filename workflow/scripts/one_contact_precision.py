"""Write the error of the restitution of one impact against the time step and the CPU time."""

from simcore.campaign.job_log import log_to
from simcore.compilation import set_threads
from simcore.report.figures.saving import save_figure
from simcore.report.figures.work_precision import work_precision_figure
from simcore.verification.machine import describe_machine
from simcore.verification.one_contact import impact_runs

log_to(snakemake.log[0])
set_threads(1)
machine = describe_machine()
runs = impact_runs().assign(machine=machine)
runs.to_csv(snakemake.output.runs, index=False)
labels = {quantity: "error of the\n" + quantity.replace(", ", ",\n") + " [-]" for quantity in runs["quantity"].unique()}
figure = work_precision_figure(runs, "CPU time of one impact", labels, "steps per contact time", note=machine)
for path in (snakemake.output.figure, snakemake.output.vector):
    save_figure(figure, path)
