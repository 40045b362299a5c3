"""Formats the state of a campaign's packings: as text, and as a table that rich draws in a terminal."""

from collections import Counter

import numpy as np
from tabulate import tabulate

from simcore.campaign.watching import DONE, FAILED, INTERRUPTED, RUNNING, SILENT, STATES, WAITING
from simcore.packing.outlook import duration_text

HEADERS = ("packing", "state", "done", "steps/s", "left", "note")
COLORS = {RUNNING: "cyan", SILENT: "yellow", FAILED: "red", INTERRUPTED: "yellow", WAITING: "dim", DONE: "green"}
LONGEST_NOTE = 60  # letters


def summary(watched) -> str:
    """Return a sentence with the number of packings in each state."""
    counts = Counter(one.state for one in watched)
    parts = [f"{counts[state]} {state}" for state in STATES[::-1] if counts[state]]
    left = [one.left for one in watched if one.state == RUNNING and np.isfinite(one.left)]
    end = f"; the running ones need about {duration_text(max(left))}" if left else ""
    number = "1 packing" if len(watched) == 1 else f"{len(watched)} packings"
    return f"{number}: {', '.join(parts)}{end}"


def watched_text(watched) -> str:
    """Return the summary and a table of all packings, list of Watched."""
    table = tabulate([_cells(one, None) for one in watched], HEADERS, tablefmt="simple", disable_numparse=True)
    return f"{summary(watched)}\n\n{table}"


def watched_table(watched, rows, table_module):
    """Return a rich Table of the first `rows` packings; table_module: the module rich.table."""
    table = table_module.Table(title=summary(watched), title_justify="left", expand=True)
    for header, width in zip(HEADERS, (12, 18, 5, 7, 7, None), strict=True):
        table.add_column(header, no_wrap=True, overflow="ellipsis", min_width=width)
    for one in watched[:rows]:
        table.add_row(*_cells(one, LONGEST_NOTE), style=COLORS[one.state])
    if len(watched) > rows:
        table.add_row(f"and {len(watched) - rows} more", *[""] * (len(HEADERS) - 1))
    return table


def _cells(one, longest):
    state = f"{one.state}, {one.phase}" if one.phase and one.state != DONE else one.state
    share = f"{100.0 * one.share:.0f} %" if np.isfinite(one.share) else "-"
    rate = f"{one.rate:.0f}" if np.isfinite(one.rate) and one.state in (RUNNING, SILENT) else "-"
    left = duration_text(one.left) if one.state != DONE else "-"
    note = one.note if longest is None or len(one.note) <= longest else f"{one.note[: longest - 1]}…"
    return [one.name, state, share, rate, left, note]
