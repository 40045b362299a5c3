"""Compares packings: porosity, contacts, sizes and forms, and the settings in which their specifications differ.

Packings whose specifications differ only in the seed form a group. Groups are compared with the first one: by pairs of
equal seed where there are such pairs, because beds of one seed have the same random numbers, so that part of their
scatter cancels in the difference.
"""

import json
from typing import NamedTuple

import numpy as np
import pandas as pd

from simcore.evaluation.confidence import student_quantile
from simcore.evaluation.coordination import coordination_number
from simcore.evaluation.interval import median_size
from simcore.evaluation.porosity import bulk_porosity
from simcore.scene.identity import deciding_but_seed, differing_keys, shown_but_seed

QUANTITIES = ("n", "n_exact", "coordination")
CODE = "(version of the code)"
LEVEL = 0.95


class Comparison(NamedTuple):
    """The result of `compare`."""

    packings: pd.DataFrame  # one row per packing
    differences: pd.DataFrame  # one row per later group and quantity, against the first group
    settings: pd.DataFrame  # one row per key in which groups differ, one column per group


def compare(packings, cut=None) -> Comparison:
    """Compare packings. packings: dict from a label to a Dataset of read_packing; cut [m]: as in bulk_porosity.

    Tables of the result. packings: label, group (A, B, ...), seed, grains, n and n_exact (slices of equal-volume
    spheres, and of the grains themselves), coordination, each with *_std_error; D50 [m] by mass, mean FL and EL by
    number, bed_top [m], code: the version that made it.
    differences: group, quantity, difference, std_error, low and high: its interval at the level of 95 %, pairs: number
    of pairs of equal seed. It is 0, and the difference is that of the means, if the groups share no seed, or only one
    although one of them has several. The error is the scatter over pairs or over seeds where a group has several, and
    the interval is Student's (Welch's for means). Otherwise the error is the sampling error of the single packing, and
    the interval is normal. settings: empty without specifications. ValueError with fewer than two packings, or if a bed
    cannot be evaluated.
    """
    if len(packings) < 2:
        raise ValueError(f"compare: {len(packings)} packing is given; give at least two")
    specifications = {label: json.loads(packing.attrs.get("scene", "{}")) for label, packing in packings.items()}
    seeds = {label: int(packing.attrs.get("seed", -1)) for label, packing in packings.items()}
    groups = _groups(specifications, seeds)
    rows = []
    for label, packing in packings.items():
        try:
            values = _evaluate(packing, cut)
        except ValueError as error:
            raise ValueError(f"{label}: {error}") from None
        # The commit behind the digest of the code does not matter.
        code = str(packing.attrs.get("code_version", "")).split(" ")[0]
        rows.append({"label": label, "group": groups[label], "seed": seeds[label], **values, "code": code})
    table = pd.DataFrame(rows)
    members = table.groupby("group", sort=False)
    codes = members["code"].agg(lambda versions: ", ".join(versions.unique()))
    settings = _settings(
        {group: specifications[label] for group, label in members["label"].first().items()}, codes.to_dict()
    )
    return Comparison(table, _differences(table, list(codes.index)), settings)


def _evaluate(packing, cut):
    """Return the numbers of one packing, dict."""
    bulk, exact = bulk_porosity(packing, "spheres", cut), bulk_porosity(packing, "exact", cut)
    contacts = coordination_number(packing)
    length, middle, short = (packing[name].values for name in "LIS")
    return {
        "grains": packing.sizes["grain"],
        "n": float(bulk["n"]),
        "n_std_error": float(bulk["n_std_error"]),
        "n_exact": float(exact["n"]),
        "n_exact_std_error": float(exact["n_std_error"]),
        "coordination": float(contacts["coordination_number"]),
        "coordination_std_error": float(contacts["coordination_number_std_error"]),
        "D50": median_size(packing["D"].values, packing["volume"].values),
        "FL": float((short / middle).mean()),
        "EL": float((middle / length).mean()),
        "bed_top": float(bulk["bed_top"]),
    }


def _groups(specifications, seeds):
    """Return the name of each packing's group, dict by label; a seed that is repeated in a group starts another."""
    members, names = {}, {}
    for label, specification in specifications.items():
        key = json.dumps(deciding_but_seed(specification), sort_keys=True) if specification else label
        repeated = 0
        while seeds[label] in members.setdefault((key, repeated), []):
            repeated += 1
        members[key, repeated].append(seeds[label])
        names[label] = (key, repeated)
    order = list(dict.fromkeys(names.values()))
    return {label: _letter(order.index(key)) for label, key in names.items()}


def _letter(number):
    """Return A, B, ..., Z, AA, AB, ..."""
    return (_letter(number // 26 - 1) if number >= 26 else "") + chr(ord("A") + number % 26)


def _differences(table, groups):
    rows = []
    reference = table[table.group == groups[0]].set_index("seed")
    for group in groups[1:]:
        other = table[table.group == group].set_index("seed")
        common = [seed for seed in reference.index if seed in other.index and seed >= 0]
        # The error of a single pair would be that within the packings, although several seeds show a scatter.
        common = [] if len(common) == 1 < max(len(reference), len(other)) else common
        for quantity in QUANTITIES:
            if common:
                a, b = reference.loc[common], other.loc[common]
                differences = (b[quantity] - a[quantity]).to_numpy()
                difference = differences.mean()
                if len(differences) > 1:
                    error, freedom = differences.std(ddof=1) / np.sqrt(len(differences)), len(differences) - 1.0
                else:
                    error, freedom = _combine(error_over_seeds(a, quantity), error_over_seeds(b, quantity))
            else:
                difference = other[quantity].mean() - reference[quantity].mean()
                error, freedom = _combine(error_over_seeds(reference, quantity), error_over_seeds(other, quantity))
            half = student_quantile(LEVEL, freedom) * error
            rows.append((group, quantity, difference, error, difference - half, difference + half, len(common)))
    return pd.DataFrame(rows, columns=["group", "quantity", "difference", "std_error", "low", "high", "pairs"])


def error_over_seeds(rows, quantity):
    """Return the standard error of the mean over the seeds of a group, or of its only packing, and its freedom."""
    if len(rows) > 1:
        return rows[quantity].std(ddof=1) / np.sqrt(len(rows)), len(rows) - 1.0
    return rows[f"{quantity}_std_error"].iloc[0], np.inf


def _combine(a, b):
    """Return the standard error of the difference of two independent means, and its degrees of freedom (Welch).

    a, b: standard error of each mean and its degrees of freedom.
    """
    (error_a, freedom_a), (error_b, freedom_b) = a, b
    spread = error_a**4 / freedom_a + error_b**4 / freedom_b
    return float(np.hypot(error_a, error_b)), (error_a**2 + error_b**2) ** 2 / spread if spread > 0.0 else np.inf


def _settings(specifications, codes):
    """Return the keys in which the groups' specifications differ, with their values; arguments: dicts by group."""
    groups = list(specifications)
    parts = {group: shown_but_seed(specification) for group, specification in specifications.items()}
    keys = sorted({key for group in groups[1:] for key in differing_keys(parts[groups[0]], parts[group])})
    rows = {key: [_value(parts[group], key) for group in groups] for key in keys}
    if len(set(codes.values())) > 1:
        rows[CODE] = [codes[group] for group in groups]
    return pd.DataFrame.from_dict(rows, orient="index", columns=groups).rename_axis("key")


def _value(specification, key):
    """Return the value of a key such as "sizes.case" as text, "-" where there is none."""
    value = specification
    for name in key.split("."):
        value = value.get(name) if isinstance(value, dict) else None
    return "-" if value is None else value if isinstance(value, str) else json.dumps(value)
