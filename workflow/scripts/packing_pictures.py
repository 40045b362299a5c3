"""Draw several packings side by side with one colour scale of sizes."""

from simcore.campaign.job_log import log_to
from simcore.packing.file import read_packing
from simcore.report.figures.packings import packings_figure
from simcore.report.figures.saving import save_figure

log_to(snakemake.log[0])
params = snakemake.params
packings = [read_packing(path) for path in snakemake.input.packings]
figure = packings_figure(list(zip(params.labels, packings, strict=True)), params.azimuth, params.elevation, pixels=900)
save_figure(figure, snakemake.output.figure, params.test_only)
