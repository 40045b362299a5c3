"""Correlations, second features and fitted models of the single-form study, per case, with their figures."""

import logging

import pandas as pd

from simcore.figures.models import form_figure, prediction_figure
from simcore.figures.saving import save_figure
from simcore.grains.form import features
from simcore.model_tables import models_dataset, single_form_models
from simcore.reference import read_study_table
from simcore.study_tables import compare_predictions, mark

logging.basicConfig(filename=snakemake.log[0], level=logging.INFO)
test_only = snakemake.params.test_only
packings, correlations = pd.read_csv(snakemake.input.packings), read_study_table("correlations")
tables, models = single_form_models(
    packings,
    correlations,
    read_study_table("table9_second_factor_mae"),
    read_study_table("models"),
    seed=snakemake.params.seed,
)
for name, table in tables.items():
    mark(table, test_only).to_csv(snakemake.output[name], index=False)
dataset = models_dataset(models, tables["models"], "Models of porosity, packings of one form")
dataset.assign_attrs(test_only=int(test_only)).to_netcdf(snakemake.output.dataset)

table = pd.concat([packings[["case", "n"]], features(packings.L, packings.I, packings.S)], axis=1)
predictions = compare_predictions(models, "single_form", table)
shown = [model for (name, _), model in models.items() if name == "single_form"]
save_figure(form_figure(packings, study=correlations), snakemake.output.features, test_only)
save_figure(prediction_figure(predictions, shown), snakemake.output.prediction, test_only)
