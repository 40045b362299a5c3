"""Stability maps: one panel per pair of settings, one cell per scene that was simulated."""

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

# Lightness falls from stable to wrong, and all outcomes but the first have a letter, so that maps can be read in grey.
OUTCOMES = {
    "stable": ("#f4efe2", "", "stable and correct"),
    "vibrating": ("#e2d3ae", "v", "at rest on average, but forces alternate from step to step"),
    "soft": ("#c9b46c", "~", "correct, but grains overlap by more than a twentieth of the thinner one"),
    "refused": ("#7f9aa2", "r", "refused before the run"),
    "stopped": ("#56757f", "s", "stopped with an error"),
    "wrong": ("#7a1f12", "W", "silently wrong"),
}
LABELS = {
    "contact time": "contact time $T_c$ [s]",
    "steps": "steps per contact time [-]",
    "restitution": "restitution [-]",
    "size ratio": "size ratio [-]",
    "weight": "mass carried, relative to own mass [-]",
    "impact": "impact speed [m/s]",
    "size ratio of pebbles": "largest over smallest size of the pebbles [-]",
    "flatness": "flatness $S/I$ [-]",
    "elongation": "elongation $I/L$ [-]",
}


def stability_figure(cells):
    """Draw one panel per map of `cells`, with the number of cells of each outcome in the legend.

    cells: columns map (the names of benchmarks/studies/stability.py), x, y, outcome. ValueError for an outcome that is
    not in OUTCOMES.
    """
    unknown = set(cells["outcome"]) - set(OUTCOMES)
    if unknown:
        raise ValueError(f"stability_figure: outcome {sorted(unknown)[0]!r} is not one of {', '.join(OUTCOMES)}")
    maps = list(cells.groupby("map", sort=False))
    columns = min(len(maps), 3)
    rows = -(-len(maps) // columns)
    figure = Figure(figsize=(3.6 * columns, 3.5 * rows + 0.9), layout="constrained")
    grid = figure.subplots(rows, columns, squeeze=False).ravel()
    colors = ListedColormap([color for color, _, _ in OUTCOMES.values()])
    norm = BoundaryNorm(np.arange(len(OUTCOMES) + 1) - 0.5, colors.N)
    order = list(OUTCOMES)
    for axes, (name, rows_of_map) in zip(grid, maps, strict=False):
        table = rows_of_map.pivot(index="y", columns="x", values="outcome")
        codes = np.full(table.shape, np.nan)  # nan: a cell that was not simulated
        for code, outcome in enumerate(order):
            codes[table == outcome] = code
        axes.pcolormesh(
            np.arange(codes.shape[1] + 1) - 0.5, np.arange(codes.shape[0] + 1) - 0.5, codes,
            cmap=colors, norm=norm, edgecolors="white", linewidth=1.2,
        )  # fmt: skip
        for (row, column), code in np.ndenumerate(codes):
            if np.isfinite(code):
                light = code >= order.index("stopped")
                axes.text(
                    column, row, OUTCOMES[order[int(code)]][1], ha="center", va="center", fontsize="small",
                    color="white" if light else "black",
                )  # fmt: skip
        axes.set_xticks(range(codes.shape[1]), [f"{x:g}" for x in table.columns], rotation=45, ha="right")
        axes.set_yticks(range(codes.shape[0]), [f"{y:g}" for y in table.index])
        first, second = name.split(" and ")
        across, up = (second, first) if first == "steps" else (first, second)
        axes.set(xlabel=LABELS[across], ylabel=LABELS[up])
    for axes in grid[len(maps) :]:
        axes.set_axis_off()
    counts = cells["outcome"].value_counts()
    handles = [
        Patch(fc=color, ec="0.4", lw=0.5, label=f"{letter + ': ' if letter else ''}{text} ({counts.get(outcome, 0)})")
        for outcome, (color, letter, text) in OUTCOMES.items()
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=2, frameon=False, fontsize="small")
    return figure
