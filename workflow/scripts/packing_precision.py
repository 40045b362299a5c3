"""Write the packings, the error in porosity of each setting against its CPU time, and the cheapest settings."""

import pandas as pd

from simcore.campaign.job_log import log_to
from simcore.reference.named_tables import read_named_table
from simcore.report.figures.saving import save_figure
from simcore.report.figures.work_precision import work_precision_figure
from simcore.verification.machine import describe_machine
from simcore.verification.packings import cheapest_settings, study_errors, work_precision_of_studies

log_to(snakemake.log[0])
p, output, machine = snakemake.params, snakemake.output, describe_machine()
tables = list(map(read_named_table, snakemake.input.tables))
columns = ["study", "packing", "seed", "grains", "n", "n_std_error", "cpu_s"]
pd.concat([table.assign(study=study) for study, table in zip(p.studies, tables, strict=True)])[columns].round(
    {"n": 6, "n_std_error": 6}
).to_csv(output.rows, index=False)
errors = study_errors(tables, p.rows)
errors.assign(machine=machine).to_csv(output.errors, index=False)
cheapest_settings(errors).assign(machine=machine).to_csv(output.settings, index=False)
runs = work_precision_of_studies(errors, p.studies, p.titles, p.rows)
labels = {"porosity": "error of the\nporosity [-]"}
figure = work_precision_figure(
    runs, "CPU time of a packing", labels, "setting", micro=False, note=machine, name_all=True
)
save_figure(figure, [output.figure, output.vector])
