"""Write tables, figures and a page of the studies with committed rows; no packing is made."""

import logging
from pathlib import Path

from simcore.campaign.gathering import check_gathered
from simcore.report.committed import findings, gathered_packings, notes_of_rows
from simcore.report.findings import Findings
from simcore.report.sections import committed_page

logging.basicConfig(filename=snakemake.log[0], level=logging.INFO)
p, folder = snakemake.params, Path(snakemake.output.folder)
check_gathered(p.folder, False, "config/workstation.yaml")
tables, figures = findings(p.folder, p.seed, p.folds, list(p.titles))
gathered = gathered_packings(p.folder, list(p.titles))
Findings(tables | gathered, figures).write_into(folder)
captions = Path(snakemake.scriptdir).parent / "report"
page = committed_page(folder, p.titles, notes_of_rows(p.biases, gathered), captions)
(folder / "report.html").write_text(page, encoding="utf-8")
