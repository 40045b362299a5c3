"""Write tables of deposits: packings, means over seeds, maxima, symmetry, crossing angles, effects of changes."""

import xarray as xr

from simcore.campaign.deposit_findings import crossings, findings
from simcore.campaign.deposits import tabulate_deposits
from simcore.campaign.evaluations import check_evaluations
from simcore.campaign.job_log import log_to
from simcore.report.findings import Findings

log_to(snakemake.log[0])
p = snakemake.params
fabrics = [xr.load_dataset(path) for path in snakemake.input.fabrics]
for study in dict.fromkeys(p.studies):
    own = [k for k, name in enumerate(p.studies) if name == study]
    parts = (snakemake.input.fabrics, fabrics, p.specifications)
    check_evaluations(study, *([part[k] for k in own] for part in parts))
packings = tabulate_deposits(p.studies, p.rows, fabrics)
tables = {"packings": packings, "crossings": crossings(p.studies, fabrics)} | findings(packings)
Findings(tables).write(snakemake.output, p.test_only)
