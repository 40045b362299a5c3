"""Write the effect of each change on porosity: the difference to the first setting of its study, paired by seed."""

import pandas as pd

from simcore.campaign.job_log import log_to
from simcore.campaign.study_tables import mark
from simcore.verification.packings import change_errors

log_to(snakemake.log[0])
p = snakemake.params
table = change_errors(list(map(pd.read_csv, snakemake.input.tables)), p.varied)
mark(table, p.test_only).to_csv(snakemake.output.table, index=False)
