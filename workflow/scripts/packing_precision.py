"""Write the error in porosity of each setting against its CPU time, and the cheapest settings for a given error."""

import pandas as pd

from simcore.report.figures.saving import save_figure
from simcore.report.figures.work_precision import work_precision_figure
from simcore.verification.machine import describe_machine
from simcore.verification.packings import cheapest_settings, study_errors, work_precision_of_studies

p, output, machine = snakemake.params, snakemake.output, describe_machine()
errors = study_errors(list(map(pd.read_csv, snakemake.input.tables)), p.rows)
errors.assign(machine=machine).to_csv(output.errors, index=False)
cheapest_settings(errors).assign(machine=machine).to_csv(output.settings, index=False)
runs = work_precision_of_studies(errors, p.studies, p.titles, p.rows)
labels = {"porosity": "error of the\nporosity [-]"}
figure = work_precision_figure(
    runs, "CPU time of a packing", labels, "setting", micro=False, note=machine, name_all=True
)
save_figure(figure, [output.figure, output.vector])
