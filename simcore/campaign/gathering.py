"""Rows of finished packings, gathered into the committed tables of a campaign while it still runs.

A table in the reference folder holds one row a packing. Packings that are not finished yet are left out; rows that
stand there already stay, unless the same packing is gathered again. gathered.csv there names each packing that has a
row, with a digest of its settings, so that a campaign goes on where its rows end when its packings are gone;
collected.csv sums it up. trends.csv holds what a packing's porosity does not tell: order over its height.
"""

import json
import logging
from pathlib import Path

import pandas as pd
import xarray as xr

from simcore.campaign.cost_table import r22_hours
from simcore.campaign.study_tables import tabulate
from simcore.campaign.trend_tables import tabulate_trends
from simcore.reference.columns import COMMITTED_NAMES
from simcore.scene.identity import result_digest, same_result

log = logging.getLogger(__name__)

RESULT = ["n", "n_error", "grains", "cpu_s"]
# Of each table the columns that say which packing it is, and what else is known of it.
COLUMNS = {
    "single_form": (["source", "case", "grain", "representation", "seed"], ["L", "I", "S"]),
    "form_mixture": (
        ["case", "mu_FL_nominal", "sigma_FL_nominal", "mu_EL_nominal", "sigma_EL_nominal", "seed"],
        ["mu_EQ", "sigma_EQ", "mu_EL", "sigma_EL"],
    ),
    "validation": (["case", "run"], []),
    "application": (["case", "choice", "seed"], ["mu_EQ", "sigma_EQ", "mu_EL", "sigma_EL"]),
    "deposits": (["study", "packing"], []),
    "accuracy": (["accuracy", "case", "seed"], []),
    "difference_long_stones": (["source", "case", "faces", "seed"], []),
    "trends": (["source", "study", "packing", "quantity"], []),
}
# Where the seed stands after what is known of the form, or a column is left out.
ORDER = {
    "accuracy": [*COLUMNS["accuracy"][0], "grains", "n", "cpu_s"],
    "form_mixture": [*COLUMNS["form_mixture"][0][:-1], *COLUMNS["form_mixture"][1], "seed", *RESULT],
}
LEDGER = ["study", "source", "packing", "settings", "cpu_s", "grain_steps", "code"]
# Studies whose name begins so go into one table; any other study has its own.
TABLES = {"single_form": "single_form", "equivalent_ellipsoids": "single_form", "form_mixtures": "form_mixture"}
DECIMALS = {"n": 6, "n_error": 6, "cpu_s": 1} | dict.fromkeys("LIS", 7)
DECIMALS |= dict.fromkeys(["mu_EQ", "sigma_EQ", "mu_EL", "sigma_EL"], 6)


def table_of(study):
    """Name of the table that the packings of a study go into."""
    return next((table for start, table in TABLES.items() if study.startswith(start)), study)


def check_gathered(folder, test_only, example):
    """ValueError unless this campaign's rows are to be gathered. example: a configuration that names a folder."""
    if not folder:
        raise ValueError(f"this campaign is not gathered: `reference` names no folder; {example} has one")
    if test_only:
        raise ValueError("this campaign is a test only (`test_only`): its rows are not gathered")


def finished(folder, study, packings):
    """What is there of a study: (rows, their Datasets, a table for `record`: packing and the other columns of LEDGER).

    folder: of the Datasets, `study`/`packing`.nc each, with the scene in its attributes. packings: dicts with row,
    specification and cpu_h. A Dataset of other settings than the specification's is left out, and that is logged.
    """
    rows, found, made = [], [], []
    for packing in packings:
        name = packing["row"]["packing"]
        path = Path(folder) / study / f"{name}.nc"
        if not path.exists():
            continue
        dataset = xr.load_dataset(path)
        if not same_result(packing["specification"], json.loads(dataset.attrs["scene"])):
            log.info("%s left out: it was packed by other settings than the campaign's", path)
            continue
        rows.append(packing["row"])
        found.append(dataset)
        attrs = dataset.attrs
        made.append(
            {
                "packing": name,
                "settings": result_digest(packing["specification"]),
                "cpu_s": round(float(attrs["cpu_seconds"]), 1),
                "grain_steps": int(attrs["n_grains"]) * int(attrs["steps"]),
                "code": attrs["code_version"],
            }
        )
    return rows, found, pd.DataFrame(made, columns=LEDGER[2:])


def not_gathered(folder, study, source, packings):
    """Of packings, as of `finished`, those that have no row in the tables of `folder` yet."""
    there = _ledger(folder)
    there = there[(there.study == study) & (there.source == source)]
    there = set(zip(there.packing, there.settings, strict=True))
    return [each for each in packings if (each["row"]["packing"], result_digest(each["specification"])) not in there]


def _ledger(folder):
    path = Path(folder) / "gathered.csv"
    if not path.exists():
        return pd.DataFrame(columns=LEDGER)
    return pd.read_csv(path, dtype={"packing": str, "settings": str}).reindex(columns=LEDGER)  # older ones lack columns


def rows_of(study, rows, evaluations, source):
    """One row for each evaluated packing of a study, with the columns of its table; arguments as of tabulate.

    L, I, S: means over the grains [m]; n_error: the packing's sampling error; cpu_s [s].
    """
    table = tabulate(study, rows, evaluations).assign(source=source)
    table = table.drop(columns=[name for name in ("mu_EQ", "mu_EL") if name in table])
    table = table.rename(columns=COMMITTED_NAMES).assign(run=table["seed"])
    name = table_of(study)
    if name not in COLUMNS:
        varied = [column for column in rows[0]["varied"] if column not in ("seed", "case")]
        varied = [COMMITTED_NAMES.get(column, column) for column in varied]
        return table[["case", *dict.fromkeys(varied), *(["grain"] if "grain" in table else []), "seed", *RESULT]]
    return table[_order(name)]


def _order(name):
    return ORDER.get(name, [*COLUMNS[name][0], *COLUMNS[name][1], *RESULT])


def trends_of(study, rows, evaluations, source):
    """Rows of trends.csv; arguments as of `rows_of`. A quantity that all grains of a packing share has none."""
    table = tabulate_trends(study, rows, evaluations).assign(source=source)
    table = table[table["spearman_r"].notna()].drop(columns="p_value")
    numbers = table.select_dtypes("float").columns
    table[numbers] = table[numbers].map(lambda value: float(f"{value:.4g}"))
    return table[["source", *table.columns.drop("source")]]


def gather(folder, name, rows):
    """Lay rows over the table `name`.csv in `folder`, sorted; returns how many it holds now.

    ValueError if the table there has other columns.
    """
    path = Path(folder) / f"{name}.csv"
    rows = rows.round({column: places for column, places in DECIMALS.items() if column in rows})
    keys = COLUMNS[name][0] if name in COLUMNS else [column for column in rows if column not in RESULT]
    if path.exists():
        there = pd.read_csv(path)
        if list(there) != list(rows):
            raise ValueError(f"{path}: has the columns {', '.join(there)}, not {', '.join(rows)}; move it away")
        rows = pd.concat([there, rows], ignore_index=True)
    # Numbers of a file and of a specification are one, 300 and "300", and so is what neither states.
    spelled = rows[keys].map(lambda value: "" if pd.isna(value) else str(value))
    rows = rows[~spelled.duplicated(keep="last")].sort_values(keys, key=_sortable)
    _write(rows, path)
    return len(rows)


def _sortable(column):
    return column if pd.api.types.is_numeric_dtype(column) else column.astype(str)


def record(folder, table, study, source, packings, made, command, machine):
    """Lay what was `made` over gathered.csv in `folder`, and the study's sum over collected.csv.

    table: name of the one that the rows went into. packings and made: as of `finished`, which does not know those
    whose files are gone. command, of the campaign, and machine: where packings are of several, all stand there. What
    another campaign says of the study stays where this one has no packing of it. r22_cpu_h there: core-hours of the
    source study's program for as many grain-steps, of packings that state theirs.
    """
    key = {"study": study, "source": source}
    ledger = _ledger(folder)
    if len(made):
        ledger = pd.concat([ledger, made.assign(**key)], ignore_index=True) if len(ledger) else made.assign(**key)
    ledger = ledger.drop_duplicates([*key, "packing"], keep="last").sort_values([*key, "packing"])
    _write(ledger[LEDGER].astype({"grain_steps": "Int64"}), Path(folder) / "gathered.csv")
    left = not_gathered(folder, study, source, packings)
    hours_left = sum(packing["cpu_h"] for packing in left)
    names = {packing["row"]["packing"] for packing in packings} - {packing["row"]["packing"] for packing in left}
    done = ledger[(ledger.study == study) & (ledger.source == source) & ledger.packing.isin(names)]
    print(f"{study}: {len(done)} of {len(packings)} packings, about {hours_left:.1f} CPU hours left", flush=True)
    steps = done.grain_steps.sum(min_count=1)
    entry = {
        "table": f"{table}.csv",
        **key,
        "packings": len(done),
        "planned": len(packings),
        "cpu_h": round(done.cpu_s.sum() / 3600.0, 2),
        "r22_cpu_h": round(r22_hours(steps), 2) if pd.notna(steps) else "",
        "cpu_h_left_estimated": round(hours_left, 2),
        "code": " ".join(sorted(set(done.code))),
    }
    path, keys = Path(folder) / "collected.csv", ["table", "study", "source"]
    behind = {"command": command, "machine": machine}
    summary = pd.read_csv(path, keep_default_na=False) if path.exists() else pd.DataFrame(columns=[*keys, *behind])
    known = summary[(summary[keys] == [entry[name] for name in keys]).all(axis=1)]
    texts = {name: [part for before in known[name] for part in before.split("; ") if part] for name in behind}
    of_others = texts["command"] if len(known) else list(summary.command[summary.study == study])
    if not len(done) and of_others and command not in texts["command"]:
        return
    # A campaign that plans a study is told before it has a packing of it, a machine is not.
    if len(made) or not len(done):
        texts["command"].append(command)
    if len(made):
        texts["machine"].append(machine)
    entry |= {name: "; ".join(dict.fromkeys(texts[name])) for name in behind}
    summary = pd.concat([summary, pd.DataFrame([entry])], ignore_index=True) if len(summary) else pd.DataFrame([entry])
    _write(summary.drop_duplicates(keys, keep="last").sort_values(keys)[list(entry)], path)


def _write(table, path):
    path.parent.mkdir(parents=True, exist_ok=True)
    table.to_csv(path, index=False, lineterminator="\n")
