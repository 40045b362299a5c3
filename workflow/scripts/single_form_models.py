"""Fit models of beds of one form, per sieve curve, and write their tables and figures."""

from simcore.campaign.job_log import log_to
from simcore.reference.committed_rows import read_cases_of_single_forms
from simcore.reference.named_tables import read_named_table
from simcore.report.models import single_form_findings

log_to(snakemake.log[0])
p = snakemake.params
committed = read_cases_of_single_forms(snakemake.input.committed, p.committed)
findings = single_form_findings(list(map(read_named_table, snakemake.input.packings)), committed, p.seed, p.folds)
findings.write(snakemake.output, p.test_only)
findings.write_models(snakemake.output.dataset, "Models of porosity, packings of one form", p.test_only)
