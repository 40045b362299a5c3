"""Write rows of the finished packings to the committed tables, with their provenance."""

from simcore.campaign.gathering import (
    check_gathered,
    check_source,
    finished,
    gather,
    record,
    rows_of,
    table_of,
    trends_of,
)
from simcore.campaign.job_log import log_to
from simcore.provenance.machine import describe_host

log_to(snakemake.log[0])
p = snakemake.params
check_gathered(p.folder, p.test_only, "config/workstation.yaml")
machine = describe_host()
for study, plans in p.packings.items():
    for source, packings in plans.items():
        rows, evaluations, made = finished(p.evaluations, study, packings)
        if rows:
            check_source(p.folder, study, source)
            gather(p.folder, table_of(study), rows_of(study, rows, evaluations, source))
            gather(p.folder, "trends", trends_of(study, rows, evaluations, source))
        record(p.folder, table_of(study), study, source, packings, made, command=p.command, machine=machine)
