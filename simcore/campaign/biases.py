"""Bias of the porosity caused by the settings and the size of a bed, as measured on other packings."""

import functools
from pathlib import Path

import numpy as np
import pandas as pd

from simcore.evaluation.rounding import rounded
from simcore.scene.identity import differing_keys
from simcore.scene.specification import resolve

COLUMNS = [
    "of",
    "setting",
    "against",
    "bed",
    "inserted",
    "kind",
    "beds",
    "difference",
    "difference_std_error",
    "source",
]
GRAINS, ELLIPSOIDS = "grains", "ellipsoids"  # kinds of packings for which the bias of SETTINGS is measured
SETTINGS, SIZE, SHAKING, INSERTIONS = "settings", "size of the bed", "time of shaking", "insertion"
INSERTED = {"bed": "just above the bed", "r22": "at the heights of Rettinger et al."}  # by generation.fill
REFERENCE, REFERENCE_BED = "r22", (63.0, 1200)  # preset, and (width [mm], grains), with which others are compared
WIDE_REFERENCE = "a contact time of 0.2 ms and 2 s of shaking"  # settings of wide_quota in config/wide.yaml
LEAST_PAIRS = 3  # with fewer pairs no bias is given for the size of the bed and the insertion
CONTACT_TIME, REGION, GATE = "numerics.contact_time", "numerics.polyhedron_contact", "convergence.max_unbalanced_force"


def measured_biases(folder):
    """Return a DataFrame with one row per measured difference in porosity and the columns COLUMNS.

    folder: its tables are read if they exist. accuracy.csv has packings with each preset, paired by seed, and
    accuracy_changed.csv the same beds with other settings; accuracy_heights.csv the same with insertion at the heights
    of Rettinger et al. (2022); difference_ellipsoid_steps.csv (config/differences.yaml) ellipsoids inserted at those
    heights, with the contacts of campaigns and with stiffer ones; bed_size.csv (benchmarks/studies/bed_size.py) single
    forms in beds of several sizes; wide_both.csv and wide_quota.csv (config/wide.yaml) beds of a wide sieve curve with
    the settings of the preset `wide`, and with stiffer contacts and longer shaking. The time of shaking is taken from
    work_precision/packings.csv, and the insertion from difference_process.csv (config/differences.yaml).

    Column of: SETTINGS (all settings of a preset, with the time step, compared with `r22` or with stiffer contacts),
    SIZE (compared with 1200 grains in a box of 63 mm), SHAKING (compared with the longest) or INSERTIONS (compared with
    those of Rettinger et al.). difference: mean over the pairs of packings, with its standard error. For SETTINGS also
    inserted: where, and kind: GRAINS or ELLIPSOIDS.
    """
    folder = Path(folder)
    changed = folder / "accuracy_changed.csv"
    of_changed = [_with_names(pd.read_csv(changed))] if changed.exists() else []
    parts = [
        function(pd.read_csv(folder / name)).assign(source=name)
        for name, function in (
            ("accuracy.csv", lambda rows: _of_settings(pd.concat([rows, *of_changed]))),
            ("accuracy_heights.csv", _of_settings_at_heights),
            ("difference_ellipsoid_steps.csv", _of_ellipsoids),
            ("wide_both.csv", lambda rows: _of_wide(rows, folder)),
            ("bed_size.csv", _of_size),
            ("work_precision/packings.csv", _of_shaking),
            ("difference_process.csv", _of_insertions),
        )
        if (folder / name).exists()
    ]
    table = pd.concat(parts, ignore_index=True) if parts else pd.DataFrame(columns=COLUMNS)
    return table.reindex(columns=COLUMNS).fillna({"inserted": "", "kind": ""})


def _of_settings(rows, inserted="bed"):
    n = rows.pivot(index=["case", "seed"], columns="accuracy", values="n")
    differences = [_mean(name, n[name] - n[REFERENCE]) for name in n if name != REFERENCE and REFERENCE in n]
    bed = f"{rows['grains'].iloc[0]} grains of all forms, inserted {INSERTED[inserted]}"
    return pd.DataFrame(differences).assign(
        of=SETTINGS, against=REFERENCE, bed=bed, inserted=INSERTED[inserted], kind=GRAINS
    )


def _of_settings_at_heights(rows):
    return _of_settings(_with_names(rows), "r22")


def _with_names(rows):
    """Return rows with the name of their settings as `accuracy`.

    rows: columns accuracy (the preset), polyhedron_contact and contact_time_s, and faces if their number varies.
    """
    names = []
    for row in rows.itertuples():
        name = _name_settings(row.accuracy, row.polyhedron_contact, row.contact_time_s)
        if "faces" in rows and row.faces != _settings_of(row.accuracy)["faces"]:
            name = f"{row.accuracy} with {row.faces} faces{name.removeprefix(row.accuracy)}"
        names.append(name)
    return rows.assign(accuracy=names)


def _of_ellipsoids(rows):
    """Compare contacts as soft as in campaigns with the stiffest ones, at the steps of preset `standard`."""
    numerics = _settings_of("standard")["numerics"]
    selected = rows[(rows["dashpot"] == numerics["dashpot"])]
    selected = selected[selected["steps_per_contact_time"] == numerics["steps_per_contact_time"]]
    # Seeds of one form are not independent of each other: the error is that over forms.
    n = selected.pivot_table(index=["case", "grain"], columns="contact_time_s", values="n")
    stiff = n.columns.min()
    differences = [_mean(_name_settings("standard", "point", time), n[time] - n[stiff]) for time in n if time != stiff]
    forms = rows["grain"].nunique()
    return pd.DataFrame(differences).assign(
        beds=lambda table: table["beds"] * selected["seed"].nunique(),
        of=SETTINGS,
        against=f"a contact time of {1e3 * stiff:g} ms",
        bed=f"{rows['grains'].iloc[0]} ellipsoids of one of {forms} forms, inserted {INSERTED['r22']}",
        inserted=INSERTED["r22"],
        kind=ELLIPSOIDS,
    )


def _of_wide(rows, folder):
    """Compare the preset `wide` with the same beds at a shorter contact time and with longer shaking."""
    stiffer = pd.read_csv(folder / "wide_quota.csv")
    pairs = rows.merge(stiffer, on=["case", "width_m", "mass_kg", "seed"], suffixes=("", "_stiffer"))
    beds = ", ".join(f"{mass:g} kg of {case}" for case, mass in pairs.groupby(["case", "mass_kg"]).groups)
    return pd.DataFrame([_mean("wide", pairs["n"] - pairs["n_stiffer"])]).assign(
        of=SETTINGS,
        against=WIDE_REFERENCE,
        bed=f"{beds}, inserted {INSERTED['r22']}",
        inserted=INSERTED["r22"],
        kind=GRAINS,
    )


def _of_size(rows):
    n = rows.pivot_table(index=["case", "grain"], columns=["width_mm", "grains"], values="n")
    differences = [
        _mean(describe_bed(*size), n[size] - n[REFERENCE_BED])
        for size in n
        if size != REFERENCE_BED and (n[size] - n[REFERENCE_BED]).count() >= LEAST_PAIRS
    ]
    return pd.DataFrame(differences).assign(of=SIZE, against=describe_bed(*REFERENCE_BED), bed="single forms")


def _of_shaking(rows):
    rows = rows[rows["study"] == "precision_shaking"]
    seconds = rows["setting"].astype(float)
    longest = seconds.max()
    shorter = rows.assign(setting=[f"{value:g} s" for value in seconds], beds=rows["seeds"])[seconds < longest]
    return shorter.assign(of=SHAKING, against=f"{longest:g} s", bed="600 grains of all forms, draft")


def _of_insertions(rows):
    keys = [name for name in rows if name not in ("fill", "n", "n_error", "cpu_s")]
    # A setting with its default value is empty in the table; as text, empty is a group of its own.
    n = rows.assign(**rows[keys].map(str)).pivot_table(index=keys, columns="fill", values="n")
    n = n.reindex(columns=list(INSERTED))
    table = pd.DataFrame([_mean(INSERTED["bed"], n["bed"] - n["r22"])])
    table = table[table["beds"] >= LEAST_PAIRS]
    return table.assign(of=INSERTIONS, against=INSERTED["r22"], bed=f"{rows['grains'].iloc[0]} grains of all forms")


def _mean(setting, differences):
    differences = differences.dropna()
    return {
        "setting": setting,
        "beds": len(differences),
        "difference": differences.mean(),
        "difference_std_error": differences.sem(),
    }


def describe_bed(width_mm, grains):
    """Return the size of a bed in words, as in the table of biases."""
    return f"{grains:g} grains in {width_mm:g} mm"


def describe_settings(specification):
    """Return the name of a packing's settings in the table of biases, or None if there is no name for them.

    There are names for a preset with its own settings, with another contact time, and with point contacts instead of
    patch contacts; the limit of the unbalanced force may then differ too. Only the settings of the preset are compared,
    and without the number of faces, since ellipsoids have none and grains may be decimated already.
    """
    if specification["accuracy"] is None:
        return None
    preset = _settings_of(specification["accuracy"])
    groups = ("shaking", "numerics", "convergence")
    other = differing_keys(*({group: spec[group] for group in groups} for spec in (preset, specification)))
    other = set(other) - {"numerics.progress_interval"}
    if other - {CONTACT_TIME} - ({REGION, GATE} if REGION in other else set()):
        return None
    if specification["numerics"]["polyhedron_contact"] == "inflated":
        return None
    numerics = specification["numerics"]
    return _name_settings(specification["accuracy"], numerics["polyhedron_contact"], numerics["contact_time"])


@functools.cache
def _settings_of(accuracy):
    bare = {"name": "any", "domain": {"width": "1 m", "height": "1 m"}, "sizes": {"case": "U1"}}
    return resolve({**bare, "amount": {"grains": 1}, "accuracy": accuracy})


def _name_settings(accuracy, region, contact_time):
    """Return the preset's name and those of the two settings that differ from it."""
    numerics = _settings_of(accuracy)["numerics"]
    at_point = region != numerics["polyhedron_contact"]
    words = ["at the deepest point"] if at_point else []
    if not np.isclose(contact_time, numerics["contact_time"], rtol=1e-9, atol=0.0):
        words.append(f"contact time {1e3 * contact_time:g} ms")
    joined = " and ".join(words)
    return f"{accuracy} {'' if at_point else 'with '}{joined}" if words else accuracy


def bias_effects(specifications, biases):
    """Return the measured effect of each kind of setting on the porosities of a study, list of (kind, text).

    specifications: of its packings, resolved. biases: from measured_biases. The text also states which settings are not
    the same in all packings, and which were not measured.
    """
    settings = {
        SETTINGS: [describe_settings(spec) for spec in specifications],
        SIZE: [_bed_of(spec) for spec in specifications],
        SHAKING: [f"{spec['shaking']['duration']:g} s" for spec in specifications],
        INSERTIONS: [_insertions_of(spec["generation"]) for spec in specifications],
    }
    # The bias of the settings depends on the height from which grains fall.
    inserted = set(settings[INSERTIONS]) if len(set(settings[INSERTIONS])) == 1 else ()
    measured = biases[(biases["of"] != SETTINGS) | biases["inserted"].isin(inserted)]
    # Ellipsoids have no faces, whose error compensates others; without a measurement, that of polyhedra is used.
    smooth = all(spec["shapes"]["kind"] in ("ellipsoid", "sphere") for spec in specifications)
    of_kind = measured["setting"].isin(measured["setting"][measured["kind"] == ELLIPSOIDS]) & smooth
    wanted = np.where(of_kind, ELLIPSOIDS, GRAINS)
    measured = measured[(measured["of"] != SETTINGS) | (measured["kind"] == wanted)]
    return [(of, _phrase(values, measured[measured["of"] == of])) for of, values in settings.items()]


def _bed_of(spec):
    if spec["domain"]["type"] != "periodic" or not spec["amount"]["grains"]:
        return None
    return describe_bed(round(1e3 * spec["domain"]["width"], 3), spec["amount"]["grains"])


def _insertions_of(generation):
    return INSERTED.get(generation["fill"]) if generation["placement"] == "lattice" else None


def _phrase(values, biases):
    """Return a phrase on one kind of bias. values: the name of each packing's setting; None if it has no name."""
    named = {value for value in values if value is not None}
    if len(named) == 1 and None in values:
        count = sum(value is not None for value in values)
        return f"for {count} of {len(values)} packings {_phrase(named, biases)}; for the rest not measured"
    if len(named) > 1:
        return "not the same in all packings"
    value = next(iter(values))
    row = biases[biases["setting"] == value]
    if len(row):
        row = row.iloc[0]
        return f"{_number(row)} ({value} instead of {row['against']}; {row['bed']})"
    if value in set(biases["against"]):
        compared = biases[biases["against"] == value]
        others = ", ".join(f"{_number(row)} for {row['setting']}" for _, row in compared.iterrows())
        return f"none for {value}, the reference; others differ from it by {others}"
    return "not measured" + (f" for {value}" if value else "")


def _number(row):
    return rounded(row["difference"], row["difference_std_error"], sign="+")
