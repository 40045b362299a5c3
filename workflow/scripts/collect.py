"""Rows of the packings that are finished, into the committed tables, and what stands behind them."""

import logging
from pathlib import Path

import xarray as xr

from simcore.collection import gather, record, rows_of, source_name, table_of, was_packed_so
from simcore.verification.machine import describe_machine

logging.basicConfig(filename=snakemake.log[0], level=logging.INFO, format="%(message)s")
p = snakemake.params
if not p.folder:
    raise ValueError("this campaign is not gathered: `reference` names no folder; config/workstation.yaml has one")
if p.test_only:
    raise ValueError("this campaign is a test only (`test_only`): its rows are not gathered")
source, machine, entries = source_name(p.source), describe_machine(), []
for study, packings in p.packings.items():
    rows, found, hours_left = [], [], 0.0
    for packing in packings:
        path = Path(p.evaluations) / study / f"{packing['row']['packing']}.nc"
        evaluation = xr.load_dataset(path) if path.exists() else None
        if evaluation is not None and was_packed_so(packing["specification"], evaluation):
            rows.append(packing["row"])
            found.append(evaluation)
        else:
            hours_left += packing["cpu_h"]
            if evaluation is not None:
                logging.info("%s left out: it was packed by other settings than the campaign's", path)
    if rows:
        gather(p.folder, table_of(study), rows_of(study, rows, found, source))
    entries.append(
        {
            "table": f"{table_of(study)}.csv",
            "study": study,
            "source": source,
            "packings": len(rows),
            "planned": len(packings),
            "cpu_h": round(sum(float(each.attrs["cpu_seconds"]) for each in found) / 3600.0, 2),
            "cpu_h_left_estimated": round(hours_left, 2),
            "command": p.command,
            "code": " ".join(sorted({each.attrs["code_version"] for each in found})),
            "machine": machine,
        }
    )
    print(f"{study}: {len(rows)} of {len(packings)} packings, about {hours_left:.1f} CPU hours left", flush=True)
record(p.folder, entries)
