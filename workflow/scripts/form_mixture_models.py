"""Correlations, feature sets and fitted models of the form mixtures, and their prediction of unseen packings."""

import logging

import pandas as pd

from simcore.model_tables import application_table, mixture_models, table_dataset
from simcore.reference import read_study_table
from simcore.study_tables import mark

logging.basicConfig(filename=snakemake.log[0], level=logging.INFO)
packings = pd.read_csv(snakemake.input.packings)
tables, models = mixture_models(
    packings.drop(columns=["packing", "kind", "note"], errors="ignore"),
    read_study_table("correlations"),
    read_study_table("table10_form_mixture_features"),
    read_study_table("models"),
    seed=snakemake.params.seed,
)
if snakemake.input.application:
    unseen = pd.read_csv(snakemake.input.application)
    tables["application"] = application_table(models, unseen, read_study_table("table11_application"))
for name, table in tables.items():
    mark(table, snakemake.params.test_only).to_csv(snakemake.output[name], index=False)
dataset = table_dataset(tables["models"], "Models of porosity, packings with a distribution of form")
dataset.assign_attrs(test_only=int(snakemake.params.test_only)).to_netcdf(snakemake.output.dataset)
