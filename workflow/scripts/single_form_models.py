"""Correlations, second features and fitted models of the single-form study, per case."""

import logging

import pandas as pd

from simcore.model_tables import single_form_models, table_dataset
from simcore.reference import read_study_table
from simcore.study_tables import mark

logging.basicConfig(filename=snakemake.log[0], level=logging.INFO)
tables, _ = single_form_models(
    pd.read_csv(snakemake.input.packings),
    read_study_table("correlations"),
    read_study_table("table9_second_factor_mae"),
    read_study_table("models"),
    seed=snakemake.params.seed,
)
for name, table in tables.items():
    mark(table, snakemake.params.test_only).to_csv(snakemake.output[name], index=False)
dataset = table_dataset(tables["models"], "Models of porosity, packings of one form")
dataset.assign_attrs(test_only=int(snakemake.params.test_only)).to_netcdf(snakemake.output.dataset)
