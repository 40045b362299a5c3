"""Origin of the committed tables: version of the code, machine and CPU hours.

Tables of campaigns have them in collected.csv. results.yaml has them for the other tables that were measured.
"""

import functools
import re

import pandas as pd

from simcore.paths import REFERENCE

NOT_RECORDED = "not recorded"
MAX_COMMITS = 3  # of more commits only the number is on the page
HASH_DIGITS = 7


def is_published(path):
    """Return whether the table at this path has values that others published."""
    return path.startswith("r22/") or path == "beard_weyl_1973.csv"


def is_gathered(path):
    """Return whether campaigns gather the rows of the table at this path."""
    return path in set(_collected().table)


def origin(path, entry, rows):
    """Return sentences on commit, machine and CPU hours of the table at `path`; empty for published values.

    entry: its entry in results.yaml; rows: the table.
    """
    if is_published(path):
        return ""
    if "computed_from" in entry:
        return f"It is computed from {entry['computed_from']}."
    parts = _of_campaigns(path, rows) if is_gathered(path) else _of_measurement(path, entry, rows)
    commit, machine, hours = (text or NOT_RECORDED for text in parts)
    return f"Commit: {commit}. Machine: {machine}. CPU hours: {hours}."


@functools.cache
def _collected():
    rows = pd.read_csv(REFERENCE / "collected.csv").dropna(subset="command")
    return rows[rows.packings > 0]


def _of_campaigns(path, rows):
    """Return commits, machines and CPU hours of the packings of all studies in a table, as text."""
    studies = _collected()
    studies = studies[studies.table == path]
    hashes = re.findall(r"\((\w+)\+?\)", " ".join(studies.code.dropna()))
    commits = sorted({commit[:HASH_DIGITS] for commit in hashes})
    listed = ", ".join(f"`{commit}`" for commit in commits)
    if len(commits) > MAX_COMMITS:
        listed = f"{len(commits)} commits, in `collected.csv`"
    packings = int(studies.packings.sum())
    if packings < len(rows):
        listed += f" ({packings} of {len(rows)} rows; of the others it is {NOT_RECORDED})"
    machines = sorted({name for text in studies.machine.dropna() for name in text.split("; ")})
    hours = _total_hours(rows) if "cpu_s" in rows else float(studies.cpu_h.sum())
    return listed, "; ".join(machines), _hours(hours)


def _of_measurement(path, entry, rows):
    """Return commit, machine and CPU hours of a table that no campaign gathers, as text; empty if not recorded."""
    machine = entry.get("machine", "")
    if "machine" in rows:
        machine = "; ".join(sorted({re.sub(r", code \w+$", "", name) for name in rows.machine.dropna()}))
    hours = entry.get("hours", _default_hours(path))
    if hours == "cpu_s":
        hours = _total_hours(rows)
    return f"`{entry['commit']}`" if "commit" in entry else "", machine, _hours(hours)


def _total_hours(rows):
    return float(rows.cpu_s.sum()) / 3600.0


def _default_hours(path):
    """Return the CPU hours of a study of the default campaign, from its table of costs; None for other tables."""
    costs = pd.read_csv(REFERENCE / "default" / "cost.csv").set_index("study").cpu_h
    study = path.removeprefix("default/").removesuffix(".csv")
    return float(costs[study]) if path.startswith("default/") and study in costs else None


def _hours(hours):
    return "" if hours is None else f"{hours:.2g}"
