"""Fit models of beds with a distribution of form; write them, their predictions of unseen packings, and figures."""

from simcore.campaign.job_log import log_to
from simcore.reference.named_tables import read_named_table
from simcore.report.models import form_mixture_findings

log_to(snakemake.log[0])
files, p = snakemake.input, snakemake.params
application = read_named_table(files.application) if files.application else None
features, packings = read_named_table(files.packings), read_named_table(files.rows)
findings = form_mixture_findings(features, packings, application, p.seed, p.folds)
findings.write(snakemake.output, p.test_only)
findings.write_models(snakemake.output.dataset, "Models of porosity, packings with a distribution of form", p.test_only)
