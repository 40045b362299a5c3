"""Write tables and figures of the committed rows of deposits; no packing is made."""

from simcore.campaign.deposit_findings import findings
from simcore.campaign.deposits import read_deposits
from simcore.campaign.job_log import log_to
from simcore.report.figures.deposits import figures_of_rows
from simcore.report.findings import Findings

log_to(snakemake.log[0])
rows = read_deposits(snakemake.input.rows)
tables = findings(rows)
figures = {f"{name}_figure": figure for name, figure in figures_of_rows(rows, tables["maxima"]).items()}
Findings(tables, figures).write(snakemake.output)
