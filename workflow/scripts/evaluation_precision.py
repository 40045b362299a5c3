"""Write the error of the porosity of a packing against the CPU time of its evaluation, by method."""

from simcore.campaign.job_log import log_to
from simcore.packing.file import read_packing
from simcore.report.figures.saving import save_figure
from simcore.report.figures.work_precision import work_precision_figure
from simcore.verification.machine import describe_machine
from simcore.verification.porosity_evaluation import evaluation_runs

log_to(snakemake.log[0])
machine = describe_machine()
runs = evaluation_runs([read_packing(path) for path in snakemake.input.packings]).assign(machine=machine)
runs.to_csv(snakemake.output.runs, index=False)
figure = work_precision_figure(
    runs,
    "CPU time of one evaluation",
    {"porosity": "error of the\nporosity [-]"},
    "slice height [mm]",
    micro=False,
    note=machine,
)
for path in (snakemake.output.figure, snakemake.output.vector):
    save_figure(figure, path)
