"""Write the errors of attitude and energy of free bodies against the time step and the CPU time."""

from simcore.campaign.job_log import log_to
from simcore.report.figures.saving import save_figure
from simcore.report.figures.work_precision import work_precision_figure
from simcore.verification.machine import describe_machine
from simcore.verification.rotation import rotation_runs

log_to(snakemake.log[0])
machine = describe_machine()
runs = rotation_runs().assign(machine=machine)
runs.to_csv(snakemake.output.runs, index=False)
labels = {"attitude": "error of the attitude [rad]", "energy": "relative error of the energy [-]"}
figure = work_precision_figure(runs, "CPU time of one turn", labels, "steps per turn", note=machine)
for path in (snakemake.output.figure, snakemake.output.vector):
    save_figure(figure, path)
