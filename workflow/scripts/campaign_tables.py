"""Write tables over all studies: their cost, and the trends of size, form and orientation over the height."""

import pandas as pd

from simcore.campaign.cost_table import cost_table, read_packings
from simcore.campaign.job_log import log_to
from simcore.campaign.study_tables import mark
from simcore.campaign.trend_tables import summarise_trends
from simcore.reference.named_tables import read_named_table
from simcore.report.figures.saving import save_figure
from simcore.report.figures.studies import trends_figure

log_to(snakemake.log[0])
files, test_only = snakemake.input, snakemake.params.test_only
trends = summarise_trends(pd.concat([read_named_table(path) for path in files.trends], ignore_index=True))
mark(cost_table(read_packings(files.packings)), test_only).to_csv(snakemake.output.cost, index=False)
mark(trends, test_only).to_csv(snakemake.output.trends, index=False)
save_figure(trends_figure(trends), snakemake.output.figure, test_only)
