"""What each change does to porosity: its difference to the first setting of its study, paired by seed."""

import pandas as pd

from simcore.campaign.study_tables import mark
from simcore.verification.packings import name_changes, porosity_errors

p = snakemake.params
parts = []
for path, varied in zip(snakemake.input.tables, p.varied, strict=True):
    packings = pd.read_csv(path)
    packings["change"] = name_changes(packings, varied)
    # Each form has a reference of its own.
    groups = packings.groupby("grain", sort=False) if "grain" in packings else [("", packings)]
    parts += [porosity_errors(rows, ["change"]).assign(grain=grain) for grain, rows in groups]
mark(pd.concat(parts, ignore_index=True), p.test_only).to_csv(snakemake.output.table, index=False)
