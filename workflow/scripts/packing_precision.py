"""Error in porosity of each setting of a packing against its CPU time, and the cheapest settings for a wished error."""

import pandas as pd

from simcore.report.figures.saving import save_figure
from simcore.report.figures.work_precision import work_precision_figure
from simcore.verification.machine import describe_machine
from simcore.verification.packings import base_setting, cheapest_settings, porosity_errors, work_precision_runs

p = snakemake.params
errors = pd.concat(
    [
        porosity_errors(pd.read_csv(path), rows[0]["varied"])
        for path, rows in zip(snakemake.input.tables, p.rows, strict=True)
    ],
    ignore_index=True,
)
machine = describe_machine()
errors.assign(machine=machine).to_csv(snakemake.output.errors, index=False)
cheapest_settings(errors).assign(machine=machine).to_csv(snakemake.output.settings, index=False)
defaults = {study: base_setting(rows) for study, rows in zip(p.studies, p.rows, strict=True)}
runs = work_precision_runs(errors, p.titles, defaults)
figure = work_precision_figure(
    runs,
    "CPU time of a packing",
    {"porosity": "error of the\nporosity [-]"},
    "setting",
    micro=False,
    note=machine,
    name_all=True,
)
for path in (snakemake.output.figure, snakemake.output.vector):
    save_figure(figure, path)
