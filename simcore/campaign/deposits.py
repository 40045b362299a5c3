"""Tables of deposits of ellipsoids: one row per packing, means over seeds, and the effect of changes of settings.

The form of an ellipsoid is eta = a/b and zeta = b/c of its semi-axes a >= b >= c; L/S is eta times zeta. Studies whose
name begins with PREFIX belong together. The next word of the name is the family: `map`, `diagonal`, `prolate` and
`oblate` differ only in form (a further word, as in `map_long`, marks a box of another size), `sizes` in the spread of
size S, and `forms` in the spread of form; `bridge` has forms deposited with the law and the process of Rettinger et al.
(2022), and `change` has experiments.
"""

import json

import numpy as np
import pandas as pd

PREFIX = "deposit_"
FAMILIES = ("map", "diagonal", "prolate", "oblate", "sizes", "forms", "bridge", "change")
PLAIN = ("map", "diagonal", "prolate", "oblate")
# Columns that are averaged over seeds and compared between settings.
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
AS_OTHERS = "none"


def figures_of_fabrics(studies, specifications):
    """Return the names of the figures of fabrics that these deposits allow, a list of str.

    studies: name of the study of each deposit; specifications: resolved specification of each deposit.
    """
    pairs = list(zip(studies, specifications, strict=True))
    figures = {"histograms": is_plain_diagonal, "histograms_over_sizes": is_plain_spread}
    return [name for name, fits in figures.items() if any(fits(study, specification) for study, specification in pairs)]


def is_plain_diagonal(study, specification):
    """Return whether the grains of a deposit have one form with eta = zeta."""
    return family(study) == "diagonal" and not isinstance(specification["shapes"]["eta"], dict)


def is_plain_spread(study, specification):
    """Return whether a deposit of the family `sizes` has grains of one form and a spread of size."""
    ratios = (specification["shapes"]["eta"], specification["shapes"]["zeta"])
    plain = specification["sizes"]["beta"] is not None and not any(isinstance(ratio, dict) for ratio in ratios)
    return family(study) == "sizes" and plain


def family(study):
    """Return the family, one of FAMILIES, from a study's name; ValueError for another name."""
    word = study.removeprefix(PREFIX).split("_")[0]
    if not study.startswith(PREFIX) or word not in FAMILIES:
        allowed = ", ".join(PREFIX + name for name in FAMILIES)
        raise ValueError(f"studies.{study}: the name has no known family; names of deposits begin with {allowed}")
    return word


def deposit_row(study, row, fabric, base):
    """Return the row of one packing as a dict. fabric: Dataset of simcore.evaluation.deposit.

    row: {packing, varied} as in simcore.campaign.studies. base: the row of the study's first packing. The column
    `change` of an experiment names the difference between the two.
    """
    scene = json.loads(fabric.attrs["scene"])
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
        "grains": fabric.attrs["n_grains"],
        "bulk_grains": int(fabric["grains"]),
    }
    for name in ("solid_fraction", "coordination_number", "coordination_number_without_rattlers", "rattler_fraction"):
        values[name] = float(fabric[name])
    for kind in ("contact_normal", "long_axis", "short_axis"):
        values[f"P2_{kind}"] = float(fabric["legendre"].sel(direction=kind, order=2))
    for kind in ("contact_normal", "long_axis"):
        for fold in fabric["fold"].values:
            values[f"azimuth_p{fold}_{kind}"] = float(fabric["azimuth_p_value"].sel(direction=kind, fold=fold))
    return values | {
        "bulk_height_in_long_axes": _bulk_height(fabric, scene, eta, zeta),
        "mean_overlap": float(fabric["mean_overlap"]),
        "steps": int(fabric.attrs["steps"]),
        "time_s": float(fabric.attrs["time"]),
        "last_insertion_s": float(fabric.attrs["last_insertion"]),
        "cpu_s": float(fabric.attrs["cpu_seconds"]),
        "change": _change(row, base) if family(study) == "change" else "",
    }


def deposit_rows(study, rows, deposits, base):
    """Return a DataFrame of the deposit_row of each packing; rows and deposits have the same order."""
    return pd.DataFrame([deposit_row(study, row, fabric, base) for row, fabric in zip(rows, deposits, strict=True)])


def tabulate_deposits(studies, rows, fabrics):
    """Return a DataFrame of all deposits with their family, study by study, one row per packing.

    studies, rows, fabrics: for each packing the name of its study, its row as from simcore.campaign.studies, and its
    Dataset from simcore.evaluation.deposit, in the same order.
    """
    parts = []
    for study in dict.fromkeys(studies):
        own = [k for k, name in enumerate(studies) if name == study]
        parts.append(deposit_rows(study, [rows[k] for k in own], [fabrics[k] for k in own], rows[own[0]]))
    return add_family(pd.concat(parts, ignore_index=True))


def read_deposits(path):
    """Read the committed rows of deposits from a CSV file, with their family."""
    rows = pd.read_csv(path, keep_default_na=False, na_values=["", "nan"])  # "none" is a value of `change`
    return add_family(rows.assign(change=rows["change"].fillna("")))


def add_family(rows):
    """Return the rows with the additional first column `family`."""
    return rows.assign(family=rows["study"].map(family))[["family", *rows.columns]]


def means(rows):
    """Return the means over the seeds: one row for each family, form, spread, law, shaking and change.

    The DataFrame also has *_error for each of RESULTS, the standard error over the seeds (nan for one seed), and
    packings, their number. cpu_s is the sum. Boxes of different sizes are only separated in experiments.
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
    """Return the means over the packings of each form in the PLAIN families, as a DataFrame like that of means()."""
    plain = rows[rows["family"].isin(PLAIN)]
    return means(plain.assign(family="plain", change=""))


def curve(rows, name):
    """Return the rows of the family diagonal, prolate or oblate, with the ascending column `ratio`.

    All three include the sphere, and also the forms of the map that belong to the family.
    """
    plain = rows[rows["family"].isin(PLAIN)]
    selected = {
        "diagonal": plain["eta"] == plain["zeta"],
        "prolate": plain["zeta"] == 1.0,
        "oblate": plain["eta"] == 1.0,
    }[name]
    ratio = "zeta" if name == "oblate" else "eta"
    return plain[selected].assign(ratio=plain[ratio]).sort_values(["ratio", "seed"], ignore_index=True)


def experiment_differences(rows):
    """Return the effect of each change: mean difference to the unchanged setting of the same form, paired by seed.

    rows: of the family `change`. The DataFrame has the columns study, eta, zeta, change, pairs, and for each of RESULTS
    the difference and its standard error (nan for one pair).
    """
    table = []
    for (study, eta, zeta), group in rows.groupby(["study", "eta", "zeta"], sort=False):
        base = group[group["change"] == AS_OTHERS].set_index("seed")
        for change in dict.fromkeys(group["change"]):
            if change == AS_OTHERS:
                continue
            other = group[group["change"] == change].set_index("seed")
            shared = other.index.intersection(base.index)
            entry = {"study": study, "eta": eta, "zeta": zeta, "change": change}
            entry["pairs"] = len(shared)
            for name in RESULTS:
                difference = other.loc[shared, name] - base.loc[shared, name]
                entry[name] = difference.mean()
                entry[f"{name}_error"] = difference.std(ddof=1) / np.sqrt(max(len(shared), 1))
            table.append(entry)
    of_results = [name for result in RESULTS for name in (result, f"{result}_error")]
    return pd.DataFrame(table).reindex(columns=["study", "eta", "zeta", "change", "pairs", *of_results])


def _change(row, base):
    """Return as text the settings, without form and seed, that differ from those of the study's first packing."""
    varied = {name: value for name, value in row["varied"].items() if name not in (*FORM, "seed")}
    changed = {name: value for name, value in varied.items() if value != base["varied"][name]}
    words = (f"{name} {value:g}" if isinstance(value, float) else f"{name} {value}" for name, value in changed.items())
    return ", ".join(words) or AS_OTHERS


def _ratio(value):
    """Return mean and standard deviation of a ratio of a specification."""
    return (value["mean"], value["std"]) if isinstance(value, dict) else (float(value), 0.0)


def _bulk_height(fabric, scene, eta, zeta):
    """Return the height of the bulk in long axes of a grain of the mid-range radius; nan for a sieve curve."""
    if scene["sizes"]["beta"] is None:
        return np.nan
    long_axis = 2.0 * scene["sizes"]["beta"]["radius"] * np.cbrt(eta**2 * zeta)
    return (float(fabric["z_upper"]) - float(fabric["z_lower"])) / long_axis
