"""Figure of a measured sieve curve."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from simcore.grains.sieve_statistics import percentile

MARKED = (16, 50, 84)


def sieve_figure(table, name):
    """Draw the share of the mass that passes each sieve of a SieveTable over its opening, and the mass per class.

    name: of the curve, for the title. D16, D50 and D84 are marked where the sieves determine them.
    """
    figure = Figure(figsize=(6.0, 4.0), layout="constrained")
    axes = figure.subplots()
    openings = table.openings * 1e3
    axes.stairs(100 * np.diff(table.passing), openings, fill=True, color="#c9d6d9", label="between two sieves")
    axes.plot(openings, 100 * table.passing, "o-", color="#20313b", ms=4, lw=1.4, label="passing")
    for percent in MARKED:
        size = percentile(table, percent / 100) * 1e3
        if np.isfinite(size):
            axes.plot([size, size], [0, percent], color="#b3541e", lw=0.9)
            axes.annotate(f"D{percent}\n{size:.3g} mm", (size, percent), (4, -4), textcoords="offset points",
                          ha="left", va="top", fontsize="x-small", color="#b3541e")  # fmt: skip
    axes.set_xscale("log")
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_xticks(openings, [f"{value:.3g}" for value in openings], rotation=60)
    axes.set_ylim(0, 102)
    axes.set_xlabel("sieve opening [mm]")
    axes.set_ylabel("share of the mass [%]")
    axes.set_title(name, fontsize="medium")
    axes.legend(frameon=False, fontsize="small", loc="upper left")
    return figure
