"""Tables and figures of the studies whose rows are committed, and a page of them; no packing is made."""

import logging
from pathlib import Path

import pandas as pd

from simcore.report.committed import findings
from simcore.report.figures.saving import save_figure
from simcore.report.sections import EARLIER, committed_page

logging.basicConfig(filename=snakemake.log[0], level=logging.INFO)
p = snakemake.params
if not p.folder:
    raise ValueError("this campaign is not gathered: `reference` names no folder; config/workstation.yaml has one")
tables, figures = findings(p.folder, p.seed, p.folds, list(p.titles))
biases, gathered = dict(p.biases), Path(p.folder) / "collected.csv"
if gathered.exists():
    known = pd.read_csv(gathered)
    tables["collected"] = known[known["study"].isin(p.titles)].drop(columns=["table", "code", "command", "machine"])
    # A bias is told of the settings of today, which rows in the tables need not have.
    packed = tables["collected"].groupby("study")["packings"].sum()
    biases |= {study: EARLIER for study, packings in packed.items() if packings == 0}
folder = Path(snakemake.output.folder)
folder.mkdir(parents=True)
for name, table in tables.items():
    table.to_csv(folder / f"{name}.csv", index=False)
for name, figure in figures.items():
    save_figure(figure, [folder / f"{name}{suffix}" for suffix in (".png", ".pdf")])
captions = Path(snakemake.scriptdir).parent / "report"
(folder / "report.html").write_text(committed_page(folder, p.titles, biases, captions), encoding="utf-8")
