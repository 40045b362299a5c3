"""Write the evaluation of one packing: porosity and its error, coordination, trends over height, form."""

from simcore.campaign.evaluations import SETTINGS, settings_text
from simcore.campaign.job_log import log_to
from simcore.evaluation.evaluate import evaluate
from simcore.evaluation.interval import campaign_cut
from simcore.packing.file import read_packing

log_to(snakemake.log[0])
settings, packing = snakemake.params.settings, read_packing(snakemake.input.packing)
cut = campaign_cut(settings["cut"], packing.attrs["domain_shape"] == "periodic")
evaluation = evaluate(packing, settings["slice_height"], cut)
evaluation.attrs[SETTINGS] = settings_text(settings)
evaluation.to_netcdf(snakemake.output.evaluation)
