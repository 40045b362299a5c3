"""Write the specification of one packing whose result is known."""

from pathlib import Path

import yaml

from simcore.campaign.job_log import log_to

log_to(snakemake.log[0])
text = yaml.safe_dump(snakemake.params.specification, sort_keys=False, allow_unicode=True)
Path(snakemake.output.specification).write_text(text, encoding="utf-8")
