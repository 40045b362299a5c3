"""Write one page with every table and figure of the campaign."""

from pathlib import Path

from simcore.campaign.job_log import log_to
from simcore.report.campaign_page import campaign_page
from simcore.report.making import describe_making

log_to(snakemake.log[0])
p, output = snakemake.params, snakemake.output
captions = Path(snakemake.scriptdir).parent / "report"
whole, tables_alone = campaign_page(
    snakemake.input, p.titles, p.biases, captions, p.questions, p.test_only, describe_making()
)
Path(output.report).write_text(whole, encoding="utf-8")
Path(output.tables).write_text(tables_alone, encoding="utf-8")
