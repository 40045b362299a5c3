"""How far porosities are known to be off for the settings and the size of their beds, as measured on other beds."""

from pathlib import Path

import numpy as np
import pandas as pd

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
GRAINS, ELLIPSOIDS = "grains", "ellipsoids"  # of which SETTINGS are told
SETTINGS, SIZE, SHAKING, INSERTIONS = "settings", "size of the bed", "time of shaking", "insertion"
INSERTED = {"bed": "just above the bed", "r22": "at the heights of Rettinger et al."}  # by generation.fill
REFERENCE, REFERENCE_BED = "r22", (63.0, 1200)  # the accuracy, and width [mm] and grains, that others stand beside
LEAST_PAIRS = 3  # of fewer no standard error is told
CONTACT_TIME, REGION, GATE = "numerics.contact_time", "numerics.polyhedron_contact", "convergence.max_unbalanced_force"


def measured_biases(folder):
    """One row a difference that was measured, columns COLUMNS; tables that `folder` does not hold are left out.

    folder: accuracy.csv, beds of each accuracy that share their seeds; accuracy_heights.csv, others that were born at
    the study's heights; difference_ellipsoid_steps.csv (config/differences.yaml), ellipsoids as campaigns have them,
    born so, and with stiffer contacts; bed_size.csv, single forms in beds of several sizes
    (benchmarks/studies/bed_size.py); work_precision/packings.csv, of which the time of shaking is taken;
    difference_process.csv (config/differences.yaml), of which where grains are inserted.

    of: SETTINGS (all that an accuracy stands for, the time step among it, beside `r22`, or stiffer contacts), SIZE
    (beside 1200 grains in a box of 63 mm), SHAKING (beside the longest) or INSERTIONS (beside the study's). difference:
    mean over the pairs of beds, with its standard error. Of SETTINGS, inserted: where, and kind: GRAINS or ELLIPSOIDS.
    """
    folder = Path(folder)
    parts = [
        function(pd.read_csv(folder / name)).assign(source=name)
        for name, function in (
            ("accuracy.csv", _of_settings),
            ("accuracy_heights.csv", _of_settings_at_heights),
            ("difference_ellipsoid_steps.csv", _of_ellipsoids),
            ("bed_size.csv", _of_size),
            ("work_precision/packings.csv", _of_shaking),
            ("difference_process.csv", _of_insertions),
        )
        if (folder / name).exists()
    ]
    found = pd.concat(parts, ignore_index=True) if parts else pd.DataFrame(columns=COLUMNS)
    return found.reindex(columns=COLUMNS).fillna({"inserted": "", "kind": ""})


def _of_settings(rows, inserted="bed"):
    n = rows.pivot(index=["case", "seed"], columns="accuracy", values="n")
    found = [_mean(name, n[name] - n[REFERENCE]) for name in n if name != REFERENCE and REFERENCE in n]
    bed = f"{rows['grains'].iloc[0]} grains of all forms, inserted {INSERTED[inserted]}"
    return pd.DataFrame(found).assign(of=SETTINGS, against=REFERENCE, bed=bed, inserted=INSERTED[inserted], kind=GRAINS)


def _of_settings_at_heights(rows):
    settings = zip(rows["accuracy"], rows["polyhedron_contact"], rows["contact_time_s"], strict=True)
    names = [_name_settings(*each) for each in settings]
    return _of_settings(rows.assign(accuracy=names), "r22")


def _of_ellipsoids(rows):
    """Contacts as soft as campaigns have them beside the stiffest, at the steps of `standard`."""
    numerics = _settings_of("standard")["numerics"]
    alike = rows[(rows["dashpot"] == numerics["dashpot"])]
    alike = alike[alike["steps_per_contact_time"] == numerics["steps_per_contact_time"]]
    n = alike.pivot(index=["case", "grain", "seed"], columns="contact_time_s", values="n")
    stiff = n.columns.min()
    found = [_mean(_name_settings("standard", "point", time), n[time] - n[stiff]) for time in n if time != stiff]
    forms = rows["grain"].nunique()
    return pd.DataFrame(found).assign(
        of=SETTINGS,
        against=f"a contact time of {1e3 * stiff:g} ms",
        bed=f"{rows['grains'].iloc[0]} ellipsoids of one of {forms} forms, inserted {INSERTED['r22']}",
        inserted=INSERTED["r22"],
        kind=ELLIPSOIDS,
    )


def _of_size(rows):
    n = rows.pivot_table(index=["case", "grain"], columns=["width_mm", "grains"], values="n")
    found = [
        _mean(describe_bed(*size), n[size] - n[REFERENCE_BED])
        for size in n
        if size != REFERENCE_BED and (n[size] - n[REFERENCE_BED]).count() >= LEAST_PAIRS
    ]
    return pd.DataFrame(found).assign(of=SIZE, against=describe_bed(*REFERENCE_BED), bed="single forms")


def _of_shaking(rows):
    rows = rows[rows["study"] == "precision_shaking"]
    seconds = rows["setting"].astype(float)
    longest = seconds.max()
    found = rows.assign(setting=[f"{value:g} s" for value in seconds], beds=rows["seeds"])[seconds < longest]
    return found.assign(of=SHAKING, against=f"{longest:g} s", bed="600 grains of all forms, draft")


def _of_insertions(rows):
    alike = [name for name in rows if name not in ("fill", "n", "n_error", "cpu_s")]
    # What was left to a case's own value is empty in the table; no number is a group of its own there.
    n = rows.assign(**rows[alike].map(str)).pivot_table(index=alike, columns="fill", values="n")
    n = n.reindex(columns=list(INSERTED))
    found = pd.DataFrame([_mean(INSERTED["bed"], n["bed"] - n["r22"])])
    found = found[found["beds"] >= LEAST_PAIRS]
    return found.assign(of=INSERTIONS, against=INSERTED["r22"], bed=f"{rows['grains'].iloc[0]} grains of all forms")


def _mean(setting, differences):
    differences = differences.dropna()
    return {
        "setting": setting,
        "beds": len(differences),
        "difference": differences.mean(),
        "difference_std_error": differences.sem(),
    }


def describe_bed(width_mm, grains):
    """Size of a bed in words, as the table of biases has it."""
    return f"{grains:g} grains in {width_mm:g} mm"


def describe_settings(specification):
    """Name of a packing's settings in the table of biases; None where they differ from its accuracy in more than that.

    That is the contact time, and the deepest point in place of the patch, whose gate of rest may be wider. What is
    compared is what an accuracy sets, faces apart: ellipsoids have none, and grains may come decimated.
    """
    if specification["accuracy"] is None:
        return None
    of_accuracy = _settings_of(specification["accuracy"])
    groups = ("shaking", "numerics", "convergence")
    other = differing_keys(*({group: spec[group] for group in groups} for spec in (of_accuracy, specification)))
    other = set(other) - {"numerics.progress_interval"}
    if other - {CONTACT_TIME} - ({REGION, GATE} if REGION in other else set()):
        return None
    if specification["numerics"]["polyhedron_contact"] == "inflated":
        return None
    numerics = specification["numerics"]
    return _name_settings(specification["accuracy"], numerics["polyhedron_contact"], numerics["contact_time"])


def _settings_of(accuracy):
    bare = {"name": "any", "domain": {"width": "1 m", "height": "1 m"}, "sizes": {"case": "U1"}}
    return resolve({**bare, "amount": {"grains": 1}, "accuracy": accuracy})


def _name_settings(accuracy, region, contact_time):
    """An accuracy, and what of the two is not its own."""
    its = _settings_of(accuracy)["numerics"]
    at_point = region != its["polyhedron_contact"]
    words = ["at the deepest point"] if at_point else []
    if not np.isclose(contact_time, its["contact_time"], rtol=1e-9, atol=0.0):
        words.append(f"contact time {1e3 * contact_time:g} ms")
    joined = " and ".join(words)
    return f"{accuracy} {'' if at_point else 'with '}{joined}" if words else accuracy


def bias_note(specifications, biases):
    """A sentence on the bias of the porosities of a study, for its page.

    specifications: of its packings, resolved; biases: as of measured_biases. What its packings do not share, or was not
    measured for them, is said to be so.
    """
    found = {
        SETTINGS: [describe_settings(spec) for spec in specifications],
        SIZE: [_bed_of(spec) for spec in specifications],
        SHAKING: [f"{spec['shaking']['duration']:g} s" for spec in specifications],
        INSERTIONS: [_insertions_of(spec["generation"]) for spec in specifications],
    }
    # Settings do to grains that fall far what they need not do to those that are inserted just above the bed.
    inserted = set(found[INSERTIONS]) if len(set(found[INSERTIONS])) == 1 else ()
    known = biases[(biases["of"] != SETTINGS) | biases["inserted"].isin(inserted)]
    # Ellipsoids have no faces, whose error makes up for others; where nothing is known of them, it is told of grains.
    smooth = all(spec["shapes"]["kind"] in ("ellipsoid", "sphere") for spec in specifications)
    of_kind = known["setting"].isin(known["setting"][known["kind"] == ELLIPSOIDS]) & smooth
    wanted = np.where(of_kind, ELLIPSOIDS, GRAINS)
    known = known[(known["of"] != SETTINGS) | (known["kind"] == wanted)]
    parts = [f"{of}: {_phrase(values, known[known['of'] == of])}" for of, values in found.items()]
    return f"Bias, as measured on other beds, of the {'; of the '.join(parts)}."


def _bed_of(spec):
    if spec["domain"]["type"] != "periodic" or not spec["amount"]["grains"]:
        return None
    return describe_bed(round(1e3 * spec["domain"]["width"], 3), spec["amount"]["grains"])


def _insertions_of(generation):
    return INSERTED.get(generation["fill"]) if generation["placement"] == "lattice" else None


def _phrase(values, biases):
    """What is known of one kind of bias; values: what each packing of a study has of it, None where it has no name."""
    named = {value for value in values if value is not None}
    if len(named) == 1 and None in values:
        count = sum(value is not None for value in values)
        rest = len(values) - count
        return f"of {count} packings {_phrase(named, biases)}, of the other {rest} not measured"
    if len(named) > 1:
        return "not the same throughout"
    value = next(iter(values))
    row = biases[biases["setting"] == value]
    if len(row):
        row = row.iloc[0]
        return f"{_number(row)} ({value}, beside {row['against']}; {row['bed']})"
    if value in set(biases["against"]):
        others = ", ".join(f"{_number(row)} for {row['setting']}" for _, row in biases.iterrows())
        return f"{value}, beside which others came out {others}"
    return "not measured" + (f" for {value}" if value else "")


def _number(row):
    error = row["difference_std_error"]
    return f"{row['difference']:+.4f}" + (f" ± {error:.4f}" if np.isfinite(error) else "")
