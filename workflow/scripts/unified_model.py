"""The model for beds of one form and for mixtures alike, beside the separate ones, per case."""

import logging

import pandas as pd

from simcore.campaign.study_tables import mark
from simcore.models.files import models_dataset
from simcore.models.unified import unified_models
from simcore.reference.r22_tables import read_study_table

logging.basicConfig(filename=snakemake.log[0], level=logging.INFO)
test_only = snakemake.params.test_only
means = ["packing", "mean_FL", "mean_EL"]
varied = pd.read_csv(snakemake.input.mixtures)
features = pd.read_csv(snakemake.input.features)
tables, models = unified_models(
    pd.read_csv(snakemake.input.single_forms),
    features.merge(varied[means], on="packing") if set(means) <= set(varied) else features,
    read_study_table("models"),
    seed=snakemake.params.seed,
    folds=snakemake.params.folds,
)
for name, table in tables.items():
    mark(table, test_only).to_csv(snakemake.output[name], index=False)
dataset = models_dataset(models, tables["models"], "Models of porosity, for one form and for a distribution of form")
dataset.assign_attrs(test_only=int(test_only)).to_netcdf(snakemake.output.dataset)
