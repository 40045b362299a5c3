"""Write tables, figures and a page of the studies with committed rows; no packing is made."""

from pathlib import Path

from simcore.campaign.job_log import log_to
from simcore.report.committed import findings, gathered_packings, notes_of_rows
from simcore.report.findings import Findings
from simcore.report.making import describe_making
from simcore.report.sections import committed_page

log_to(snakemake.log[0])
p, folder = snakemake.params, Path(snakemake.output.folder)
tables, figures = findings(p.folder, p.seed, p.folds, list(p.titles))
gathered = gathered_packings(p.folder, list(p.titles))
Findings(tables | gathered, figures).write_into(folder)
captions = Path(snakemake.scriptdir).parent / "report"
biases = notes_of_rows(p.biases, gathered)
page = committed_page(folder, p.titles, biases, captions, p.questions, describe_making())
(folder / "report.html").write_text(page, encoding="utf-8")
