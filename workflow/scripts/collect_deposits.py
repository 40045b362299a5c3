"""Rows of the deposits that are finished, into the committed table, and what stands behind it."""

import logging
from pathlib import Path

import pandas as pd
import xarray as xr

from simcore.collection import gather, record, was_packed_so
from simcore.deposits import deposit_rows
from simcore.verification.machine import describe_machine

TABLE = "deposits"
logging.basicConfig(filename=snakemake.log[0], level=logging.INFO, format="%(message)s")
p = snakemake.params
if not p.folder:
    raise ValueError("this campaign is not gathered: `reference` names no folder; config/deposits.yaml has one")
if p.test_only:
    raise ValueError("this campaign is a test only (`test_only`): its rows are not gathered")
parts, entries = [], []
for study, packings in p.packings.items():
    rows, found, hours_left = [], [], 0.0
    for packing in packings:
        path = Path(p.fabrics) / study / f"{packing['row']['packing']}.nc"
        fabric = xr.load_dataset(path) if path.exists() else None
        if fabric is not None and was_packed_so(packing["specification"], fabric):
            rows.append(packing["row"])
            found.append(fabric)
        else:
            hours_left += packing["cpu_h"]
            if fabric is not None:
                logging.info("%s left out: it was packed by other settings than the campaign's", path)
    if rows:
        parts.append(deposit_rows(study, rows, found, packings[0]["row"]))
    entries.append(
        {
            "table": f"{TABLE}.csv",
            "study": study,
            "source": "ellipsoids",
            "packings": len(rows),
            "planned": len(packings),
            "cpu_h": round(sum(float(each.attrs["cpu_seconds"]) for each in found) / 3600.0, 2),
            "cpu_h_left_estimated": round(hours_left, 2),
            "command": p.command,
            "code": " ".join(sorted({each.attrs["code_version"] for each in found})),
            "machine": describe_machine(),
        }
    )
    print(f"{study}: {len(rows)} of {len(packings)} packings, about {hours_left:.1f} CPU hours left", flush=True)
if parts:
    gather(p.folder, TABLE, pd.concat(parts, ignore_index=True).round(6))
record(p.folder, entries)
