"""Formats a comparison of packings as tables for reading."""

import numpy as np
from tabulate import tabulate

from simcore.evaluation.comparison import LEVEL, error_over_seeds
from simcore.evaluation.rounding import heights_in_mm, with_decimals

NAMES = {
    "n": "porosity n",
    "n_exact": "porosity, the grains themselves sliced",
    "coordination": "contacts per grain",
}
SHORT = {"n": "n", "n_exact": "n, grains sliced", "coordination": "contacts"}
_OF_PACKINGS = (
    "± is the standard error within the packing. contacts, FL and EL are means over all grains, also those at the "
    "surface."
)
_OF_MEANS = "± is the standard error over the packings of a group, or within it where it is one packing."
DECIMALS = {"n": 4, "n_exact": 4, "coordination": 2}


def comparison_text(comparison) -> str:
    """Return the tables of a simcore.evaluation.comparison.Comparison."""
    rows = [
        {
            "packing": row.label,
            "group": row.group,
            "seed": row.seed if row.seed >= 0 else "-",
            "grains": row.grains,
            SHORT["n"]: _pair(row.n, row.n_std_error, 4),
            SHORT["n_exact"]: _pair(row.n_exact, row.n_exact_std_error, 4),
            SHORT["coordination"]: _pair(row.coordination, row.coordination_std_error, 2),
            "D50 [mm]": f"{1e3 * row.D50:.2f}",
            "FL": f"{row.FL:.3f}",
            "EL": f"{row.EL:.3f}",
            "bed [mm]": heights_in_mm(row.bed_top)[0],
        }
        for row in comparison.packings.itertuples()
    ]
    several = len(set(comparison.packings.group)) > 1
    parts = [_table(rows), _OF_PACKINGS, *_codes(comparison.packings)]
    if not several:
        parts.append("All packings have the same settings but for the seed: there is one group.")
        parts += _scatter(comparison.packings)
        return "\n".join(parts)
    rows = [
        {
            "difference": f"{row.group} − {comparison.packings.group.iloc[0]}",
            "of": NAMES[row.quantity],
            "is": _pair(row.difference, row.std_error, DECIMALS[row.quantity], "+"),
            f"{100 * LEVEL:.0f} % interval": _interval(row.low, row.high, DECIMALS[row.quantity]),
            "from": _source(row.pairs),
        }
        for row in comparison.differences.itertuples()
    ]
    parts += ["", _table(_means(comparison.packings)), _OF_MEANS]
    parts += ["", _table(rows), "", *_settings(comparison.settings)]
    return "\n".join(parts)


def _codes(packings):
    """Return a line for each group whose packings were made by several versions of the code."""
    codes = packings.groupby("group", sort=False)["code"].unique()
    return [
        f"Group {group} has packings of several versions of the code: {', '.join(map(str, versions))}."
        for group, versions in codes.items()
        if len(versions) > 1
    ]


def _scatter(packings):
    """Return lines on the means over the seeds of one group."""
    lines = [""]
    for quantity, name in NAMES.items():
        values = packings[quantity]
        error, _ = error_over_seeds(packings, quantity)
        lines.append(f"mean {name}: {_pair(values.mean(), error, DECIMALS[quantity])} (over {len(values)} seeds)")
    return lines


def _means(packings):
    """Return the rows of the table of the means of each group."""
    rows = []
    for group, members in packings.groupby("group", sort=False):
        row = {"group": group, "packings": len(members)}
        for quantity in NAMES:
            values = members[quantity]
            error, _ = error_over_seeds(members, quantity)
            row[f"mean {SHORT[quantity]}"] = _pair(values.mean(), error, DECIMALS[quantity])
        rows.append(row)
    return rows


def _settings(settings):
    if settings.empty:
        return ["The files have no specification, or the same one, so that no differing setting can be listed."]
    rows = [{"setting": key, **row.to_dict()} for key, row in settings.iterrows()]
    return [_table(rows), "Quantities are in SI units."]


def _source(pairs):
    if pairs == 0:
        return "means of the groups, which share no two seeds"
    return f"{pairs} pairs of equal seed" if pairs > 1 else "1 pair of equal seed, errors within the packings"


def _interval(low, high, decimals):
    if np.isnan(low):
        return "-"
    return " to ".join(with_decimals(limit, decimals, "+") for limit in (low, high))


def _pair(value, error, decimals, sign=""):
    text = with_decimals(value, decimals, sign)
    return text if np.isnan(error) else f"{text} ± {error:.{decimals}f}"


def _table(rows):
    return tabulate(rows, headers="keys", tablefmt="simple", disable_numparse=True)
