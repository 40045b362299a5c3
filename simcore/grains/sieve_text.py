"""Describes a sieve curve and its statistics as text for people, or as JSON."""

import json
from dataclasses import asdict

import numpy as np

from simcore.grains.sieve_statistics import to_phi
from simcore.grains.text_columns import text_columns


def describe_sieve(path, table, statistics):
    """Return the text on a SieveTable and its SieveStatistics. path: file, for the heading."""
    mass = "" if table.mass is None else f", {table.mass:.4g} kg"
    lines = [
        f"Sieve curve of {path}: {len(table.openings)} sieves from {table.openings[0] * 1e3:g} to "
        f"{table.openings[-1] * 1e3:g} mm{mass}",
        "",
        *text_columns([["sieve [mm]", "passing [%]"], *_rows(table)], "r"),
        "",
        *text_columns([["", "size [mm]", "phi"], *_percentile_rows(statistics)], "r"),
        "",
        *text_columns(_moment_rows(statistics), "r"),
        "",
        f"Folk and Ward: {_words(statistics.folk_ward.words)}",
        f"Moments:       {_words(statistics.phi_moments.words)}",
        f"Cu = D60/D10 = {_number(statistics.uniformity)}, Cc = D30²/(D10 D60) = {_number(statistics.curvature)}",
    ]
    return "\n".join([*lines, *(f"Note: {notice}" for notice in statistics.notices)])


def sieve_json(path, table, statistics, notices=()):
    """Return the same as JSON text; sizes in mm, a number that is not determined is null."""
    content = {
        "file": str(path),
        "mass_kg": table.mass,
        "openings_mm": [_plain(D * 1e3) for D in table.openings],
        "passing": [_plain(share) for share in table.passing],
        "percentiles_mm": {f"D{percent}": _plain(D * 1e3) for percent, D in statistics.percentiles.items()},
        "folk_ward_phi": _with_plain_numbers(statistics.folk_ward),
        "folk_ward_geometric": _with_plain_numbers(statistics.folk_ward.geometric()),
        "moments_phi": _with_plain_numbers(statistics.phi_moments),
        "moments_geometric": _with_plain_numbers(statistics.phi_moments.geometric()),
        "moments_mm": _with_plain_numbers(statistics.mm_moments),
        "Cu": _plain(statistics.uniformity),
        "Cc": _plain(statistics.curvature),
        "notices": [*notices, *statistics.notices],
    }
    return json.dumps(content, indent=1, allow_nan=False)


def _rows(table):
    rows = [[f"{D * 1e3:g}", f"{100 * share:.2f}"] for D, share in zip(table.openings, table.passing, strict=True)]
    return rows[::-1]


def _percentile_rows(statistics):
    return [
        [f"D{percent}", _number(D * 1e3), _number(float(to_phi(D)), 3)] for percent, D in statistics.percentiles.items()
    ]


def _moment_rows(statistics):
    """Return the rows of the table of moments. A geometric mean is in mm, and geometric sorting is a factor."""
    in_phi = (statistics.folk_ward, statistics.phi_moments)
    kinds = [scale for moments in in_phi for scale in (moments, moments.geometric())] + [statistics.mm_moments]
    rows = [
        ["", "Folk and Ward", "Folk and Ward", "moments", "moments", "moments"],
        ["", "phi", "geometric", "phi", "geometric", "mm"],
    ]
    for name in ("mean", "sorting", "skewness", "kurtosis"):
        rows.append([name, *(_number(getattr(kind, name), 3) for kind in kinds)])
    return rows


def _words(words):
    return ", ".join(filter(None, words)) or "not determined"


def _number(value, decimals=None):
    if np.isnan(value):
        return "-"
    return f"{value:.4g}" if decimals is None else f"{value:.{decimals}f}"


def _plain(value):
    return float(value) if np.isfinite(value) else None


def _with_plain_numbers(moments):
    values = asdict(moments)
    return {key: list(value) if key == "words" else _plain(value) for key, value in values.items()}
