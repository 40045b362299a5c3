"""Write the packings of a study, their forms and trends, and means over seeds beside values of Rettinger et al."""

import xarray as xr

from simcore.campaign.evaluations import check_evaluations
from simcore.campaign.job_log import log_to
from simcore.campaign.study_tables import mark, summarise, tabulate, tabulate_features
from simcore.campaign.trend_tables import tabulate_trends
from simcore.reference.r22_comparison import add_reference

log_to(snakemake.log[0])
p = snakemake.params
rows, study = p.rows, snakemake.wildcards.study
evaluations = [xr.load_dataset(path) for path in snakemake.input.evaluations]
check_evaluations(study, snakemake.input.evaluations, evaluations, p.specifications, p.porosity)
packings = tabulate(study, rows, evaluations)
tables = {
    "packings": packings,
    "features": tabulate_features(packings, evaluations),
    "trends": tabulate_trends(study, rows, evaluations),
    "table": add_reference(summarise(packings, rows[0]["varied"]), study),
}
for name, table in tables.items():
    mark(table, p.test_only).to_csv(snakemake.output[name], index=False)
