"""Draw the porosities of a study beside those of Rettinger et al., its first packing, and the porosity over height."""

import xarray as xr

from simcore.campaign.job_log import log_to
from simcore.packing.file import read_packing
from simcore.reference.named_tables import read_named_table
from simcore.report.figures.packings import packing_figure, profile_figure
from simcore.report.figures.saving import save_figure
from simcore.report.figures.studies import porosities_figure

log_to(snakemake.log[0])
files, test_only = snakemake.input, snakemake.params.test_only
table = read_named_table(files.table)
save_figure(porosities_figure(table, snakemake.params.rows[0]["varied"]), snakemake.output.porosities, test_only)

(packing,), (evaluation,) = files.packing, files.evaluation
bulk = xr.load_dataset(evaluation)
profiles = {"volume-equivalent spheres": bulk.profile, "the grains themselves": bulk.profile_exact}
save_figure(packing_figure(read_packing(packing)), snakemake.output.picture, test_only)
save_figure(profile_figure(profiles, bulk), snakemake.output.profile, test_only)
