"""Fit one model for single forms and mixtures, and compare it with the separate models, per sieve curve."""

from simcore.campaign.job_log import log_to
from simcore.reference.named_tables import read_named_table
from simcore.report.models import unified_findings

log_to(snakemake.log[0])
p = snakemake.params
tables = [read_named_table(snakemake.input[name]) for name in ("single_forms", "mixtures", "features")]
findings = unified_findings(*tables, p.seed, p.folds)
findings.write(snakemake.output, p.test_only)
title = "Models of porosity, for one form and for a distribution of form"
findings.write_models(snakemake.output.dataset, title, p.test_only)
