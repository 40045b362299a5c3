"""Tables and figures of a set of grains, compared with the grains of Rettinger et al. (2022) and published scans."""

import pandas as pd

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
from simcore.reference.r22_tables import read_r22_table
from simcore.report.figures import grains as figures
from simcore.report.figures.single_grains import grain_sheet, grain_steps
from simcore.report.findings import Findings


def grain_findings(grains) -> Findings:
    """Return form factors, their statistics and correlations, shapes compared with scans, and changes by decimation.

    grains: list of Grain. The first column of each table contains its row names.
    """
    forms, shapes, decimation = form_table(grains), shape_table(grains), decimation_table(grains)
    correlations, summary = factor_correlations(forms), decimation_summary(decimation)
    r22 = read_r22_table("table2_form_statistics")
    rhine_grains = r22.iloc[0]  # the grains of Rettinger et al. (2022)
    tables = {
        "forms": forms,
        "statistics": pd.concat([form_statistics(forms).assign(source="this set"), r22]).set_index("source"),
        "correlations": correlations,
        "components": principal_components(forms),
        "decimation": decimation.set_index("grain"),
        "decimation_summary": summary,
        "shapes": shape_comparison(shapes),
    }
    pictures = {
        "sheet": grain_sheet(grains),
        "steps": grain_steps(max(grains, key=lambda grain: len(grain.faces))),
        "zingg": figures.zingg_diagram({"this set": forms}, rhine_grains),
        "histograms": figures.form_histograms(forms, rhine_grains),
        "matrix": figures.correlation_matrix(correlations),
        "scans": figures.shapes_against_scans({"this set": shapes}, scan_ranges()),
        "changes": figures.decimation_changes(summary),
    }
    return Findings({name: _names_first(table) for name, table in tables.items()}, pictures)


def _names_first(table):
    """Return the table with its index as first column; its heading is empty if the index has no name."""
    return table.rename_axis(index=table.index.name or "").reset_index()
