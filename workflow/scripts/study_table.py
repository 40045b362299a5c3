"""The packings of a study, their features of form, and means over the seeds beside the source study's values."""

import xarray as xr

from simcore.reference import add_reference
from simcore.study_tables import mark, summarise, tabulate, tabulate_features

rows, study = snakemake.params.rows, snakemake.wildcards.study
evaluations = [xr.load_dataset(path) for path in snakemake.input.evaluations]
packings = tabulate(study, rows, evaluations)
tables = {
    "packings": packings,
    "features": tabulate_features(packings, evaluations),
    "table": add_reference(summarise(packings, rows[0]["varied"]), study),
}
for name, table in tables.items():
    mark(table, snakemake.params.test_only).to_csv(snakemake.output[name], index=False)
