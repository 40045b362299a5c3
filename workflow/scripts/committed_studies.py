"""Tables and figures of the studies whose rows are committed; no packing is made."""

import logging
from pathlib import Path

from simcore.committed import findings
from simcore.figures.saving import save_figure

logging.basicConfig(filename=snakemake.log[0], level=logging.INFO)
p = snakemake.params
if not p.folder:
    raise ValueError("this campaign is not gathered: `reference` names no folder; config/workstation.yaml has one")
tables, figures = findings(p.folder, p.seed, p.folds)
folder = Path(snakemake.output.folder)
folder.mkdir(parents=True)
for name, table in tables.items():
    table.to_csv(folder / f"{name}.csv", index=False)
for name, figure in figures.items():
    save_figure(figure, [folder / f"{name}{suffix}" for suffix in (".png", ".pdf")])
