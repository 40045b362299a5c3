"""Correlations, feature sets and fitted models of the form mixtures, their prediction of unseen packings, figures."""

import logging

import pandas as pd

from simcore.campaign.study_tables import mark
from simcore.models.files import models_dataset
from simcore.models.mixtures import application_table, mixture_models
from simcore.models.tables import compare_predictions
from simcore.reference.r22_tables import add_reference, read_study_table
from simcore.report.figures.models import prediction_figure
from simcore.report.figures.saving import save_figure
from simcore.report.figures.zingg import form_sets_figure

logging.basicConfig(filename=snakemake.log[0], level=logging.INFO)
test_only = snakemake.params.test_only
packings = pd.read_csv(snakemake.input.packings)
tables, models = mixture_models(
    packings.drop(columns=["packing", "kind", "note"], errors="ignore"),
    read_study_table("correlations"),
    read_study_table("table10_form_mixture_features"),
    read_study_table("models"),
    seed=snakemake.params.seed,
    folds=snakemake.params.folds,
)
if snakemake.input.application:
    unseen = pd.read_csv(snakemake.input.application)
    tables["application"] = application_table(models, unseen, read_study_table("table11_application"))
for name, table in tables.items():
    mark(table, test_only).to_csv(snakemake.output[name], index=False)
dataset = models_dataset(models, tables["models"], "Models of porosity, packings with a distribution of form")
dataset.assign_attrs(test_only=int(test_only)).to_netcdf(snakemake.output.dataset)

rows = add_reference(pd.read_csv(snakemake.input.rows), "form_mixtures")
table = packings.merge(rows[["packing", "n_std_error", "study_n"]], on="packing")
predictions = compare_predictions(models, "form_mixture", table)
save_figure(form_sets_figure(packings), snakemake.output.sets, test_only)
save_figure(prediction_figure(predictions, list(models.values())), snakemake.output.prediction, test_only)
