"""Deposits as tables: one row a packing, means over seeds, maxima, symmetry, crossing angles, what changes do."""

import pandas as pd
import xarray as xr

from simcore.campaign.deposit_findings import crossings, findings
from simcore.campaign.deposits import add_family, deposit_rows
from simcore.campaign.study_tables import mark

p = snakemake.params
fabrics = [xr.load_dataset(path) for path in snakemake.input.fabrics]
parts = []
for study in dict.fromkeys(p.studies):
    some = [k for k, name in enumerate(p.studies) if name == study]
    rows = [p.rows[k] for k in some]
    parts.append(deposit_rows(study, rows, [fabrics[k] for k in some], rows[0]))
packings = add_family(pd.concat(parts, ignore_index=True))
tables = {"packings": packings, "crossings": crossings(p.studies, fabrics)} | findings(packings)
for name, table in tables.items():
    mark(table, p.test_only).to_csv(snakemake.output[name], index=False)
