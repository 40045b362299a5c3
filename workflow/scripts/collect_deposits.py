"""Rows of the deposits that are finished, into the committed table, and what stands behind it."""

import logging

import pandas as pd

from simcore.collection import check_gathered, finished, gather, record
from simcore.deposits import deposit_rows
from simcore.verification.machine import describe_machine

TABLE = "deposits"
logging.basicConfig(filename=snakemake.log[0], level=logging.INFO, format="%(message)s")
p = snakemake.params
check_gathered(p.folder, p.test_only, "config/deposits.yaml")
machine, parts, entries = describe_machine(), [], []
for study, packings in p.packings.items():
    rows, fabrics, behind = finished(p.fabrics, study, packings)
    if rows:
        parts.append(deposit_rows(study, rows, fabrics, packings[0]["row"]))
    of_study = {"table": f"{TABLE}.csv", "study": study, "source": "ellipsoids"}
    entries.append({**of_study, **behind, "command": p.command, "machine": machine})
if parts:
    gather(p.folder, TABLE, pd.concat(parts, ignore_index=True).round(6))
record(p.folder, entries)
