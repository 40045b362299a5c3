"""Write rows of the finished deposits to the committed table, with their provenance."""

import logging

from simcore.campaign.deposits import SOURCE, TABLE, deposit_rows
from simcore.campaign.gathering import check_gathered, finished, gather, record
from simcore.provenance.machine import describe_host

logging.basicConfig(filename=snakemake.log[0], level=logging.INFO, format="%(message)s")
p = snakemake.params
check_gathered(p.folder, p.test_only, "config/deposits.yaml")
machine = describe_host()
for study, packings in p.packings.items():
    rows, fabrics, made = finished(p.fabrics, study, packings)
    if rows:
        gather(p.folder, TABLE, deposit_rows(study, rows, fabrics, packings[0]["row"]).round(6))
    record(p.folder, TABLE, study, SOURCE, packings, made, command=p.command, machine=machine)
