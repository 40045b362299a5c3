"""Correlations, second features and fitted models of the single-form study, per case, with their figures."""

import logging

import pandas as pd

from simcore.campaign.study_tables import compare_predictions, mark
from simcore.grains.form import features
from simcore.models.tables import models_dataset, single_form_models
from simcore.reference.committed_rows import read_single_forms
from simcore.reference.r22_tables import add_reference, read_study_table
from simcore.report.figures.models import form_figure, prediction_figure
from simcore.report.figures.saving import save_figure
from simcore.report.figures.zingg import porosity_zingg_figure

logging.basicConfig(filename=snakemake.log[0], level=logging.INFO)
test_only = snakemake.params.test_only
packings = add_reference(pd.concat(map(pd.read_csv, snakemake.input.packings), ignore_index=True), "single_form")
fitted = packings
if snakemake.input.committed:
    committed = read_single_forms(snakemake.input.committed)
    fitted = pd.concat([packings, committed[committed.case.isin(snakemake.params.committed)]], ignore_index=True)
correlations, study_models = read_study_table("correlations"), read_study_table("models")
tables, models = single_form_models(
    fitted,
    correlations,
    read_study_table("table9_second_factor_mae"),
    study_models,
    seed=snakemake.params.seed,
    folds=snakemake.params.folds,
)
own = set(packings.case)
for name, table in tables.items():
    table["packed_by"] = ["this campaign" if case in own else "committed rows" for case in table.case]
    mark(table, test_only).to_csv(snakemake.output[name], index=False)
dataset = models_dataset(models, tables["models"], "Models of porosity, packings of one form")
dataset.assign_attrs(test_only=int(test_only)).to_netcdf(snakemake.output.dataset)

columns = ["case", "n", "n_std_error", "study_n"]
table = pd.concat([packings[columns], features(packings.L, packings.I, packings.S)], axis=1)
predictions = compare_predictions(models, "single_form", table)
shown = {case: model for (name, case), model in models.items() if name == "single_form" and case in own}
figures = {
    "features": form_figure(packings, study=correlations, study_models=study_models),
    "zingg": porosity_zingg_figure(packings, shown),
    "prediction": prediction_figure(predictions, list(shown.values())),
}
for name, figure in figures.items():
    save_figure(figure, snakemake.output[name], test_only)
