"""Figure of packings with known outcomes: measured values relative to the expected bands."""

import numpy as np
from matplotlib.figure import Figure


def outside_figure(table):
    """Draw the place of each measured value in its band, one line per case; -1 and 1 are the ends of the band.

    table: of simcore.verification.outside.table. Bars are one standard error over seeds; values outside are orange.
    """
    middle, half = 0.5 * (table["low"] + table["high"]), 0.5 * (table["high"] - table["low"])
    place, error = (table["measured"] - middle) / half, table["std_error"] / half
    rows = np.arange(len(table))[::-1]
    figure = Figure(figsize=(7.0, 1.2 + 0.28 * len(table)), layout="constrained")
    axes = figure.subplots()
    axes.axvspan(-1.0, 1.0, color="0.9", zorder=0)
    axes.axvline(0.0, color="0.6", lw=0.8, zorder=1)
    for inside, colour, marker in ((True, "#20313b", "o"), (False, "#b3541e", "D")):
        chosen = (table["inside"] == inside).to_numpy()
        axes.errorbar(
            place[chosen], rows[chosen], xerr=error[chosen], fmt=marker, ms=5, capsize=2, color=colour, zorder=2
        )
    names = [f"{row['name'].replace('_', ' ')}: {row['measured']:.4g}" for _, row in table.iterrows()]
    axes.set_yticks(rows, names, fontsize="small")
    axes.set_xlabel("position in the expected band [-]\n(-1: lower end, 1: upper end; bars: standard error over seeds)")
    return figure
