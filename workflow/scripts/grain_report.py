"""Tables and figures about the grains themselves."""

import pandas as pd

from simcore.grains.grain_set import read_grains
from simcore.grains.scan_shapes import scan_ranges, shape_table
from simcore.grains.tables import (
    decimation_summary,
    decimation_table,
    factor_correlations,
    form_statistics,
    form_table,
    principal_components,
    shape_comparison,
)
from simcore.reference.r22_tables import read_study_table
from simcore.report.figures import grains as figures
from simcore.report.figures.saving import save_figure

grains = read_grains(snakemake.input.grains)
forms, shapes, decimation = form_table(grains), shape_table(grains), decimation_table(grains)
correlations, summary = factor_correlations(forms), decimation_summary(decimation)
study = read_study_table("table2_form_statistics")
rhine = study.iloc[0]  # the study's own grains
tables = {
    "forms": forms,
    "statistics": pd.concat([form_statistics(forms).assign(source="this set"), study]).set_index("source"),
    "correlations": correlations,
    "components": principal_components(forms),
    "decimation": decimation.set_index("grain"),
    "decimation_summary": summary,
    "shapes": shape_comparison(shapes),
}
for name, table in tables.items():
    table.to_csv(snakemake.output[name])
pictures = {
    "zingg": figures.zingg_diagram({"this set": forms}, rhine),
    "histograms": figures.form_histograms(forms, rhine),
    "matrix": figures.correlation_matrix(correlations),
    "scans": figures.shapes_against_scans({"this set": shapes}, scan_ranges()),
    "changes": figures.decimation_changes(summary),
}
for name, figure in pictures.items():
    save_figure(figure, snakemake.output[name])
