"""Draw deposits over form and over spread of size, and compared with the law and process of Rettinger et al. (2022)."""

import pandas as pd
import xarray as xr

from simcore.campaign.deposit_findings import diagonal_fabrics, spread_fabrics
from simcore.campaign.job_log import log_to
from simcore.packing.file import read_packing
from simcore.report.figures.deposits import figures_of_rows
from simcore.report.figures.fabric import fabric_figure
from simcore.report.figures.packings import packing_figure
from simcore.report.figures.saving import save_figure

log_to(snakemake.log[0])
files, p = snakemake.input, snakemake.params
packings = pd.read_csv(files.packings, keep_default_na=False, na_values=["", "nan"])
maxima, crossings = (pd.read_csv(path).dropna(how="all") for path in (files.maxima, files.crossings))
of_packings = [xr.load_dataset(path) for path in files.fabrics]
angles = {row.direction: row.angle for row in crossings.itertuples() if row.angle == row.angle}
figures = figures_of_rows(packings, maxima)
if of_forms := diagonal_fabrics(p.studies, of_packings):
    figures["histograms"] = fabric_figure(of_forms, ["contact_normal", "long_axis"], crossing=angles)
figures["picture"] = packing_figure(read_packing(files.pictured[0]))
if of_spreads := spread_fabrics(p.studies, of_packings):
    figures["histograms_over_sizes"] = fabric_figure(of_spreads, ["contact_normal", "long_axis"])
for name, figure in figures.items():
    save_figure(figure, snakemake.output[name], p.test_only)
