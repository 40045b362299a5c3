"""Deposits of ellipsoids as a table: one row a packing, means over seeds, and what each change of settings does.

A form is eta = a/b and zeta = b/c of the semi-axes a >= b >= c; L/S is eta times zeta. Studies whose name begins with
PREFIX belong together; what stands after it says how they are read: `map`, `diagonal`, `prolate` and `oblate` differ
in form alone (a further word, as in `map_long`, is a box of another size), `sizes` in the spread of size S, `forms` in
the spread of form, `bridge` holds forms deposited by the first study's law and process, `change` experiments.
"""

import json

import numpy as np
import pandas as pd

PREFIX = "deposit_"
FAMILIES = ("map", "diagonal", "prolate", "oblate", "sizes", "forms", "bridge", "change")
PLAIN = ("map", "diagonal", "prolate", "oblate")
# What is averaged over seeds, and compared between settings.
RESULTS = (
    "solid_fraction",
    "coordination_number",
    "coordination_number_without_rattlers",
    "rattler_fraction",
    "P2_contact_normal",
    "P2_long_axis",
    "P2_short_axis",
)
FORM = ("eta", "zeta", "std_eta", "std_zeta", "spread")
TABLE, SOURCE = "deposits", "ellipsoids"  # in simcore.campaign.gathering
KEYS = ["study", "packing"]  # which packing a row is of
AS_OTHERS = "none"


def family(study):
    """What a study's name says after PREFIX, of FAMILIES; ValueError for another name."""
    word = study.removeprefix(PREFIX).split("_")[0]
    if not study.startswith(PREFIX) or word not in FAMILIES:
        known = ", ".join(PREFIX + name for name in FAMILIES)
        raise ValueError(f"studies.{study}: what it shows is not known; names of deposits begin with {known}")
    return word


def deposit_row(study, row, found, base):
    """One packing's row, dict. found: of simcore.evaluation.deposit.

    row: {packing, varied} as simcore.campaign.studies has it, base: of the study's first packing. An experiment's
    column `change` says what differs between the two.
    """
    scene = json.loads(found.attrs["scene"])
    eta, std_eta = _ratio(scene["shapes"]["eta"])
    zeta, std_zeta = _ratio(scene["shapes"]["zeta"])
    values = {
        "study": study,
        "packing": row["packing"],
        "eta": eta,
        "zeta": zeta,
        "std_eta": std_eta,
        "std_zeta": std_zeta,
        "spread": (scene["sizes"]["beta"] or {"spread": np.nan})["spread"],
        "law": scene["material"]["law"],
        "shaking_s": scene["shaking"]["duration"],
        "seed": scene["seed"],
        "grains": found.attrs["n_grains"],
        "bulk_grains": int(found["grains"]),
    }
    for name in ("solid_fraction", "coordination_number", "coordination_number_without_rattlers", "rattler_fraction"):
        values[name] = float(found[name])
    for kind in ("contact_normal", "long_axis", "short_axis"):
        values[f"P2_{kind}"] = float(found["legendre"].sel(direction=kind, order=2))
    for kind in ("contact_normal", "long_axis"):
        for fold in found["fold"].values:
            values[f"azimuth_p{fold}_{kind}"] = float(found["azimuth_p_value"].sel(direction=kind, fold=fold))
    return values | {
        "bulk_height_in_long_axes": _bulk_height(found, scene, eta, zeta),
        "mean_overlap": float(found["mean_overlap"]),
        "steps": int(found.attrs["steps"]),
        "time_s": float(found.attrs["time"]),
        "last_insertion_s": float(found.attrs["last_insertion"]),
        "cpu_s": float(found.attrs["cpu_seconds"]),
        "change": _change(row, base) if family(study) == "change" else "",
    }


def deposit_rows(study, rows, deposits, base):
    """DataFrame of the deposit_row of each; rows and deposits in one order."""
    return pd.DataFrame([deposit_row(study, row, found, base) for row, found in zip(rows, deposits, strict=True)])


def tabulate_deposits(studies, rows, fabrics):
    """DataFrame of all deposits with their family, study by study; one row a packing.

    studies, rows, fabrics: of each packing the name of its study, its row as of simcore.campaign.studies and its
    Dataset of simcore.evaluation.deposit, in one order.
    """
    parts = []
    for study in dict.fromkeys(studies):
        own = [k for k, name in enumerate(studies) if name == study]
        parts.append(deposit_rows(study, [rows[k] for k in own], [fabrics[k] for k in own], rows[own[0]]))
    return add_family(pd.concat(parts, ignore_index=True))


def read_deposits(path):
    """Read the committed rows of deposits from a CSV file, with their family."""
    rows = pd.read_csv(path, keep_default_na=False, na_values=["", "nan"])  # "none" is a change
    return add_family(rows.assign(change=rows["change"].fillna("")))


def add_family(rows):
    """The rows with a first column family."""
    return rows.assign(family=rows["study"].map(family))[["family", *rows.columns]]


def means(rows):
    """Means over the seeds, DataFrame: one row for each family, form, spread, law, shaking and change.

    For each of RESULTS also *_error, the standard error over the seeds (nan of one), and packings, their number. cpu_s
    is their sum. Boxes of other sizes are not told apart but in experiments.
    """
    keys = ["family", *FORM, "law", "shaking_s", "change"]
    groups = rows.groupby(keys, sort=False, dropna=False)
    table = groups.size().rename("packings").to_frame()
    for name in RESULTS:
        table[name] = groups[name].mean()
        table[f"{name}_error"] = groups[name].std(ddof=1) / np.sqrt(table["packings"])
    for name in ("mean_overlap", "time_s", "steps", "grains"):
        table[name] = groups[name].mean()
    table["cpu_s"] = groups["cpu_s"].sum()
    return table.reset_index()


def plain_means(rows):
    """Means over all packings of one form that differ in form, seed and box alone, DataFrame as of means()."""
    plain = rows[rows["family"].isin(PLAIN)]
    return means(plain.assign(family="plain", change=""))


def curve(rows, name):
    """Rows of one family over its one ratio, DataFrame with the column `ratio`, ascending: diagonal, prolate, oblate.

    The sphere stands in all three, and forms on them that the map has, too.
    """
    plain = rows[rows["family"].isin(PLAIN)]
    on = {
        "diagonal": plain["eta"] == plain["zeta"],
        "prolate": plain["zeta"] == 1.0,
        "oblate": plain["eta"] == 1.0,
    }[name]
    ratio = "zeta" if name == "oblate" else "eta"
    return plain[on].assign(ratio=plain[ratio]).sort_values(["ratio", "seed"], ignore_index=True)


def experiment_differences(rows):
    """What each change does: means of the differences to the unchanged setting of its form, paired by seed, DataFrame.

    rows: of the family `change`. Columns study, eta, zeta, change, pairs, and for each of
    RESULTS the difference and its standard error (nan of one pair).
    """
    table = []
    for (study, eta, zeta), group in rows.groupby(["study", "eta", "zeta"], sort=False):
        base = group[group["change"] == AS_OTHERS].set_index("seed")
        for change in dict.fromkeys(group["change"]):
            if change == AS_OTHERS:
                continue
            other = group[group["change"] == change].set_index("seed")
            shared = other.index.intersection(base.index)
            found = {"study": study, "eta": eta, "zeta": zeta, "change": change}
            found["pairs"] = len(shared)
            for name in RESULTS:
                difference = other.loc[shared, name] - base.loc[shared, name]
                found[name] = difference.mean()
                found[f"{name}_error"] = difference.std(ddof=1) / np.sqrt(max(len(shared), 1))
            table.append(found)
    of_results = [name for result in RESULTS for name in (result, f"{result}_error")]
    return pd.DataFrame(table).reindex(columns=["study", "eta", "zeta", "change", "pairs", *of_results])


def _change(row, base):
    """What of a study's settings, but for form and seed, differs from those of its first packing, as text."""
    varied = {name: value for name, value in row["varied"].items() if name not in (*FORM, "seed")}
    changed = {name: value for name, value in varied.items() if value != base["varied"][name]}
    words = (f"{name} {value:g}" if isinstance(value, float) else f"{name} {value}" for name, value in changed.items())
    return ", ".join(words) or AS_OTHERS


def _ratio(value):
    """Mean and standard deviation of a ratio of a specification."""
    return (value["mean"], value["std"]) if isinstance(value, dict) else (float(value), 0.0)


def _bulk_height(found, scene, eta, zeta):
    """Height of the bulk in long axes of a grain of the mid-range radius; nan where sizes are of a sieve curve."""
    if scene["sizes"]["beta"] is None:
        return np.nan
    long_axis = 2.0 * scene["sizes"]["beta"]["radius"] * np.cbrt(eta**2 * zeta)
    return (float(found["z_upper"]) - float(found["z_lower"])) / long_axis
