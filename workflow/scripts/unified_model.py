"""Fit one model for single forms and mixtures, and compare it with the separate models, per sieve curve."""

import logging

import pandas as pd

from simcore.report.models import unified_findings

logging.basicConfig(filename=snakemake.log[0], level=logging.INFO)
p = snakemake.params
tables = [pd.read_csv(snakemake.input[name]) for name in ("single_forms", "mixtures", "features")]
findings = unified_findings(*tables, p.seed, p.folds)
findings.write(snakemake.output, p.test_only)
title = "Models of porosity, for one form and for a distribution of form"
findings.write_models(snakemake.output.dataset, title, p.test_only)
