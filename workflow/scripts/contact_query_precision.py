"""Write errors of depth and normal of touching pairs against the CPU time of a query."""

from simcore.campaign.job_log import log_to
from simcore.compilation import set_threads
from simcore.report.figures.saving import save_figure
from simcore.report.figures.work_precision import work_precision_figure
from simcore.verification.contact_query import query_runs
from simcore.verification.machine import describe_machine

log_to(snakemake.log[0])
set_threads(1)
machine = describe_machine()
runs = query_runs().assign(machine=machine)
runs.to_csv(snakemake.output.runs, index=False)
labels = {
    "depth": "largest error of the depth,\nrelative to the pair's size [-]",
    "normal": "largest error of the normal [rad]",
}
figure = work_precision_figure(runs, "CPU time of one query", labels, "directions, or tolerance", note=machine)
for path in (snakemake.output.figure, snakemake.output.vector):
    save_figure(figure, path)
