"""Write the effect of each change on porosity: the difference to the first setting of its study, paired by seed."""

from simcore.campaign.job_log import log_to
from simcore.campaign.study_tables import mark
from simcore.reference.named_tables import read_named_table
from simcore.verification.packings import change_errors

log_to(snakemake.log[0])
p = snakemake.params
table = change_errors(list(map(read_named_table, snakemake.input.tables)), p.varied)
mark(table, p.test_only).to_csv(snakemake.output.table, index=False)
