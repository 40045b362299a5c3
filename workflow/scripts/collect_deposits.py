"""Write rows of the finished deposits to the committed tables, with their provenance."""

from pathlib import Path

from simcore.campaign.deposit_findings import crossings
from simcore.campaign.deposits import SOURCE, TABLE, deposit_rows, family
from simcore.campaign.gathering import check_gathered, finished, gather, record
from simcore.campaign.job_log import log_to
from simcore.provenance.machine import describe_host
from simcore.writing import whole_file

log_to(snakemake.log[0])
p = snakemake.params
check_gathered(p.folder, p.test_only)
machine = describe_host()
diagonal, missing = [], 0
for study, packings in p.packings.items():
    rows, fabrics, made = finished(p.fabrics, study, packings)
    if rows:
        gather(p.folder, TABLE, deposit_rows(study, rows, fabrics, packings[0]["row"]).round(6))
    record(p.folder, TABLE, study, SOURCE, packings, made, command=p.command, machine=machine)
    if family(study) == "diagonal":
        diagonal += [(study, fabric) for fabric in fabrics]
        missing += len(packings) - len(fabrics)
# The crossing angles follow from all fabrics of the diagonal, of which the rows have only a part.
if diagonal and not missing:
    with whole_file(Path(p.folder) / "deposit_crossings.csv") as part:
        crossings(*zip(*diagonal, strict=True)).to_csv(part, index=False)
