"""Gather rows of finished packings into the committed tables of a campaign, also while it still runs.

A table in the reference folder has one row per packing. Unfinished packings are left out. Existing rows remain, unless
the same packing is gathered again. gathered.csv lists each packing that has a row, with a digest of its settings, so
that a campaign continues after its last row even if the packings' files are gone. collected.csv is its summary.
trends.csv has the trends of size, form and orientation over the height of each packing.
"""

import logging
from pathlib import Path

import pandas as pd
import xarray as xr

from simcore.campaign.composition_columns import composition_columns
from simcore.campaign.cost_table import r22_hours
from simcore.campaign.evaluations import grain_set_of, how_it_differs
from simcore.campaign.study_tables import tabulate
from simcore.campaign.trend_tables import tabulate_trends
from simcore.reference.columns import COMMITTED_NAMES
from simcore.reference.named_tables import NAMES, read_named_table
from simcore.scene.identity import result_digest
from simcore.writing import whole_file

log = logging.getLogger(__name__)

RESULT = ["n", "n_error", "grains", "cpu_s"]
OF_SETS = ["case", "mu_FL_nominal", "sigma_FL_nominal", "mu_EL_nominal", "sigma_EL_nominal", "seed"]
OF_LONG_GRAINS = ["source", *OF_SETS]
# For each table: the columns that identify a packing, and further columns that describe it.
COLUMNS = {
    "single_form": (["source", "case", "grain", "representation", "seed"], ["L", "I", "S"]),
    "form_mixture": (OF_SETS, ["mu_EQ", "sigma_EQ", "mu_EL", "sigma_EL"]),
    "validation": (["case", "run"], []),
    "mesh_resolution": (["case", "faces", "seed"], []),
    "application": (["case", "choice", "seed"], ["mu_EQ", "sigma_EQ", "mu_EL", "sigma_EL"]),
    "deposits": (["study", "packing"], []),
    "accuracy": (["accuracy", "case", "seed"], []),
    "difference_long_stones": (["source", "case", "faces", "seed"], []),
    "difference_long_sources": (["source", "case", "faces", "seed"], []),
    "difference_long_grains": (OF_LONG_GRAINS, []),
    "difference_long_wide": (OF_LONG_GRAINS, []),
    "size_and_form": (["case", "grain", "representation", "width_m", "mass_kg", "seed"], []),
    "form_by_size": (["study", "case", "seed"], []),
    "mixtures_wide": (OF_SETS, []),
    "base_time": (["case", "grain", "representation", "mass_kg", "seed"], []),
    "base_rate": (["case", "grain", "representation", "spacing", "mass_kg", "seed"], []),
    "base_size": (["case", "grain", "representation", "width_m", "mass_kg", "seed"], []),
    "base_process": (
        ["case", "grain", "representation", "width_m", "mass_kg", "shaking_s", "batch_solid_fraction", "seed"],
        [],
    ),
    "base_forms": (
        ["case", "grain", "mu_FL_nominal", "sigma_FL_nominal", "mu_EL_nominal", "sigma_EL_nominal", "seed"],
        [],
    ),
    "lattice_beds": (["case", "grain", "representation", "width_m", "mass_kg", "seed"], []),
    "trends": (["source", "study", "packing", "quantity"], []),
}
# Order of the columns in tables where the seed follows the columns of the form, or where a column is left out.
ORDER = {
    "accuracy": [*COLUMNS["accuracy"][0], "grains", "n", "cpu_s"],
    "form_mixture": [*COLUMNS["form_mixture"][0][:-1], *COLUMNS["form_mixture"][1], "seed", *RESULT],
}
LEDGER = ["study", "source", "packing", "settings", "grain_set", "cpu_s", "grain_steps", "code", "evaluation"]
# Tables whose rows also have the columns of simcore.campaign.composition_columns.
COMPOSED = {
    "size_and_form", "lattice_beds", "form_by_size", "mixtures_wide",
    "base_time", "base_rate", "base_size", "base_process", "base_forms",
}  # fmt: skip
# Studies whose name begins with a key share that table; any other study has its own table.
TABLES = {"single_form": "single_form", "equivalent_ellipsoids": "single_form", "form_mixtures": "form_mixture"}
TABLES |= {"flat_coarse_grains": "form_by_size", "flat_fine_grains": "form_by_size", "base_forms": "base_forms"}
# Studies whose means are compared with a table of Rettinger et al. (2022), or shown alone if there is none.
PLAIN_STUDIES = (
    "mesh_resolution",
    "shaking_cylinder",
    "validation",
    "domain_size",
    "shaking_periodic",
    "near_spheres",
    "application",
)
# Tables of packings that the report shows from committed rows.
SHOWN_TABLES = ("single_form", "form_mixture", *PLAIN_STUDIES)
DECIMALS = {"n": 6, "n_error": 6, "cpu_s": 1} | dict.fromkeys("LIS", 7)
DECIMALS |= dict.fromkeys(["mu_EQ", "sigma_EQ", "mu_EL", "sigma_EL"], 6)


def table_of(study):
    """Return the name of the table for the packings of a study."""
    return next((table for start, table in TABLES.items() if study.startswith(start)), study)


def check_gathered(folder, test_only):
    """Raise ValueError if this campaign's rows must not be gathered."""
    if not folder:
        raise ValueError(
            "the rows of this campaign cannot be gathered: give a folder for them in its configuration, such as "
            "`reference: my_rows`"
        )
    if test_only:
        raise ValueError("the rows of this campaign are not gathered, since `test_only` is set")


def finished(folder, study, packings, porosity=None):
    """Return the finished packings of a study: rows, their Datasets, and a table for `record` with columns of LEDGER.

    folder: of the Datasets, one `study`/`packing`.nc each, with the scene in its attributes. packings: dicts with row,
    specification and cpu_h. porosity: as for how_it_differs. A Dataset whose settings, grains or evaluation differ is
    left out, which is logged.
    """
    rows, datasets, made = [], [], []
    for packing in packings:
        name = packing["row"]["packing"]
        path = Path(folder) / study / f"{name}.nc"
        if not path.exists():
            continue
        dataset = xr.load_dataset(path)
        if differs := how_it_differs(dataset, packing["specification"], porosity):
            log.info("%s is left out: it %s than the campaign has; make it again", path, differs)
            continue
        rows.append(packing["row"])
        datasets.append(dataset)
        attrs = dataset.attrs
        made.append(
            {
                "packing": name,
                "settings": result_digest(packing["specification"]),
                "grain_set": grain_set_of(packing["specification"]),
                "cpu_s": round(float(attrs["cpu_seconds"]), 1),
                "grain_steps": int(attrs["n_grains"]) * int(attrs["steps"]),
                "code": attrs["code_version"],
                # Evaluations of earlier versions do not name their code.
                "evaluation": attrs.get("evaluation_code", ""),
            }
        )
    return rows, datasets, pd.DataFrame(made, columns=LEDGER[2:])


def not_gathered(folder, study, source, packings):
    """Return those packings (dicts as for `finished`) that have no row in the tables of `folder` yet."""
    ledger = _ledger(folder)
    ledger = ledger[(ledger.study == study) & (ledger.source == source)]
    # Rows of earlier versions do not state their set of grains.
    sets = ledger.grain_set.astype(object).fillna("")
    gathered = dict(zip(zip(ledger.packing, ledger.settings, strict=True), sets, strict=True))

    def is_gathered(packing):
        key = packing["row"]["packing"], result_digest(packing["specification"])
        return key in gathered and gathered[key] in ("", grain_set_of(packing["specification"]))

    return [packing for packing in packings if not is_gathered(packing)]


def _ledger(folder):
    path = Path(folder) / "gathered.csv"
    if not path.exists():
        return pd.DataFrame(columns=LEDGER)
    # Files of earlier versions lack columns.
    return read_named_table(path, text=("settings", "grain_set", "code", "evaluation")).reindex(columns=LEDGER)


def rows_of(study, rows, evaluations, source):
    """Return one row per evaluated packing of a study, with the columns of its table; arguments as for tabulate.

    L, I, S: means over the grains [m]. n_error: the packing's sampling error. cpu_s: CPU time [s].
    """
    table = tabulate(study, rows, evaluations).assign(source=source)
    table = table.drop(columns=[name for name in ("mu_EQ", "mu_EL") if name in table])
    table = table.rename(columns=COMMITTED_NAMES).assign(run=table["seed"])
    name = table_of(study)
    if name not in COLUMNS:
        varied = [column for column in rows[0]["varied"] if column not in ("seed", "case")]
        varied = [COMMITTED_NAMES.get(column, column) for column in varied]
        grain = ["grain"] if "grain" in table else []
        return table[["case", *dict.fromkeys([*varied, *grain]), "seed", *RESULT]]
    if name in COMPOSED:
        composed = pd.DataFrame([composition_columns(data) for data in evaluations])
        # Beds of all forms have no grain; a table that lacks the column takes no rows of single forms later.
        return pd.concat([table.reindex(columns=_order(name)).reset_index(drop=True), composed], axis=1)
    return table[_order(name)]


def check_source(folder, study, source, rows, other_sources=()):
    """Raise ValueError if the rows of a study would replace those of other grains, of which the table has no column.

    rows: as from `rows_of`. other_sources: of rows that `collect` writes into the same table at the same time.
    """
    name = table_of(study)
    if {"source", "grain_source"} & set(rows):
        return
    ledger = _ledger(folder)
    others = sorted({*ledger.source[ledger.study.map(table_of) == name].dropna(), *other_sources} - {source})
    if others:
        raise ValueError(
            f"{Path(folder) / name}.csv has rows of grains from {', '.join(others)}, and no column for the source of "
            f"grains; set `reference` to another folder for those from {source}"
        )


def _order(name):
    return ORDER.get(name, [*COLUMNS[name][0], *COLUMNS[name][1], *RESULT])


def trends_of(study, rows, evaluations, source):
    """Return rows of trends.csv; arguments as for `rows_of`. A quantity equal for all grains has no row."""
    table = tabulate_trends(study, rows, evaluations).assign(source=source)
    table = table[table["spearman_r"].notna()].drop(columns="p_value")
    numbers = table.select_dtypes("float").columns
    table[numbers] = table[numbers].map(lambda value: float(f"{value:.4g}"))
    return table[["source", *table.columns.drop("source")]]


def gather(folder, name, rows):
    """Merge rows into the table `name`.csv in `folder`, sorted; return the new number of rows.

    A new row replaces an existing one of the same packing. ValueError if the existing table has other columns, or if
    the columns of the table do not distinguish the new rows.
    """
    path = Path(folder) / f"{name}.csv"
    rows = rows.round({column: places for column, places in DECIMALS.items() if column in rows})
    keys = COLUMNS[name][0] if name in COLUMNS else [column for column in rows if column not in RESULT]
    if (alike := rows[_as_text(rows[keys]).duplicated()]).size:
        row = ", ".join(f"{key} {value}" for key, value in alike[keys].iloc[0].items())
        raise ValueError(
            f"{path}: two packings have the same row, {row}, because the table has no column for the setting in which "
            "they differ; pack one of them in a study with another name"
        )
    if path.exists():
        existing = read_named_table(path)
        if list(existing) != list(rows):
            raise ValueError(f"{path}: has the columns {', '.join(existing)} and not {', '.join(rows)}; move it")
        rows = pd.concat([existing, rows], ignore_index=True)
    rows = rows[~_as_text(rows[keys]).duplicated(keep="last")].sort_values(keys, key=_sortable)
    _write(rows, path)
    return len(rows)


def _as_text(keys):
    """Return keys as they are compared: 300 of a file equals "300" of a specification, and empty equals empty."""
    return pd.DataFrame({key: [_text(value, key in NAMES) for value in keys[key]] for key in keys}, index=keys.index)


def _text(value, is_name):
    if pd.isna(value):
        return ""
    text = str(value)
    return text if is_name or not text[:-2].isdigit() else text.removesuffix(".0")


def _sortable(column):
    """Return a column as a key for sorting: numbers by size, and before words, such as 50, 300 and "original"."""
    if pd.api.types.is_numeric_dtype(column):
        return column
    numbers, words = pd.to_numeric(column, errors="coerce"), column.astype(str)
    return words.where(numbers.isna(), numbers.rank(method="dense").map("{:012.0f}".format))


def record(folder, table, study, source, packings, made, command, machine):
    """Merge the table `made` into gathered.csv in `folder`, and the summary of the study into collected.csv.

    table: name of the table with the rows. packings and made: as from `finished`; `made` lacks packings whose files are
    gone. command (of the campaign) and machine: the summary lists all of them. The entry of another campaign remains if
    this one has no packing of the study. cpu_h_estimated in the summary: by the cost model, of the packings that are
    done. r22_cpu_h: core-hours of the program of Rettinger et al. for the same number of grain-steps, of the packings
    whose number is recorded.
    """
    key = {"study": study, "source": source}
    ledger = _ledger(folder)
    if len(made):
        ledger = pd.concat([ledger, made.assign(**key)], ignore_index=True) if len(ledger) else made.assign(**key)
    ledger = ledger.drop_duplicates([*key, "packing"], keep="last").sort_values([*key, "packing"])
    _write(ledger[LEDGER].astype({"grain_steps": "Int64"}), Path(folder) / "gathered.csv")
    remaining = not_gathered(folder, study, source, packings)
    hours_left = sum(packing["cpu_h"] for packing in remaining)
    estimates = {packing["row"]["packing"]: packing["cpu_h"] for packing in packings}
    names = set(estimates) - {packing["row"]["packing"] for packing in remaining}
    done = ledger[(ledger.study == study) & (ledger.source == source) & ledger.packing.isin(names)]
    print(f"{study}: {len(done)} of {len(packings)} packings, about {hours_left:.1f} CPU hours left", flush=True)
    steps = done.grain_steps.sum(min_count=1)
    entry = {
        "table": f"{table}.csv",
        **key,
        "packings": len(done),
        "planned": len(packings),
        "cpu_h": round(done.cpu_s.sum() / 3600.0, 2),
        "cpu_h_estimated": round(sum(estimates[name] for name in done.packing), 2),
        "r22_cpu_h": round(r22_hours(steps), 2) if pd.notna(steps) else "",
        "cpu_h_left_estimated": round(hours_left, 2),
        "code": " ".join(sorted(set(done.code))),
    }
    path, keys = Path(folder) / "collected.csv", ["table", "study", "source"]
    provenance = {"command": command, "machine": machine}
    texts_of = dict.fromkeys([*keys, "code", *provenance], str)
    summary = pd.DataFrame(columns=[*keys, *provenance])
    if path.exists():
        summary = pd.read_csv(path, dtype=texts_of, keep_default_na=False)
    entries = summary[(summary[keys] == [entry[name] for name in keys]).all(axis=1)]
    texts = {name: [part for text in entries[name] for part in text.split("; ") if part] for name in provenance}
    of_others = texts["command"] if len(entries) else list(summary.command[summary.study == study])
    if not len(done) and of_others and command not in texts["command"]:
        return
    # The command is listed as soon as a campaign plans the study, the machine only once it has made a packing.
    if len(made) or not len(done):
        texts["command"].append(command)
    if len(made):
        texts["machine"].append(machine)
    entry |= {name: "; ".join(dict.fromkeys(texts[name])) for name in provenance}
    summary = pd.concat([summary, pd.DataFrame([entry])], ignore_index=True) if len(summary) else pd.DataFrame([entry])
    _write(summary.drop_duplicates(keys, keep="last").sort_values(keys)[list(entry)], path)


def _write(table, path):
    path.parent.mkdir(parents=True, exist_ok=True)
    with whole_file(path) as part:  # a process that is killed leaves the former table
        table.to_csv(part, index=False, lineterminator="\n")
