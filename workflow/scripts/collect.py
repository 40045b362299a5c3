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
check_gathered(p.folder, p.test_only)
machine = describe_host()
# All rows are made before the first is written.
gathered, sources = [], {}
for study, plans in p.packings.items():
    for source, packings in plans.items():
        rows, evaluations, made = finished(p.evaluations, study, packings, p.porosity)
        tables = {}
        if rows:
            tables[table_of(study)] = rows_of(study, rows, evaluations, source)
            tables["trends"] = trends_of(study, rows, evaluations, source)
            earlier = sources.setdefault(table_of(study), [])
            check_source(p.folder, study, source, tables[table_of(study)], earlier)
            earlier.append(source)
        gathered.append((study, source, packings, made, tables))
for study, source, packings, made, tables in gathered:
    for name, table in tables.items():
        gather(p.folder, name, table)
    record(p.folder, table_of(study), study, source, packings, made, command=p.command, machine=machine)
