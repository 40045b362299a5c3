"""Tables and figures of the deposits whose rows are committed; no packing is made."""

import pandas as pd

from simcore.campaign.deposit_findings import findings
from simcore.campaign.deposits import add_family
from simcore.report.figures.deposits import figures_of_rows
from simcore.report.figures.saving import save_figure

rows = add_family(pd.read_csv(snakemake.input.rows, keep_default_na=False, na_values=["", "nan"]))
rows["change"] = rows["change"].fillna("")
tables = findings(rows)
for name, table in tables.items():
    table.to_csv(snakemake.output[name], index=False)
for name, figure in figures_of_rows(rows, tables["maxima"]).items():
    save_figure(figure, snakemake.output[f"{name}_figure"])
