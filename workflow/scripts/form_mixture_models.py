"""Fit models of beds with a distribution of form; write them, their predictions of unseen packings, and figures."""

import pandas as pd

from simcore.campaign.job_log import log_to
from simcore.report.models import form_mixture_findings

log_to(snakemake.log[0])
files, p = snakemake.input, snakemake.params
application = pd.read_csv(files.application) if files.application else None
findings = form_mixture_findings(pd.read_csv(files.packings), pd.read_csv(files.rows), application, p.seed, p.folds)
findings.write(snakemake.output, p.test_only)
findings.write_models(snakemake.output.dataset, "Models of porosity, packings with a distribution of form", p.test_only)
