"""Maps of what is stable: one panel for each pair of settings, one cell for each scene that was tried."""

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

# Lightness falls from stable to wrong, and each but the first bears a letter: so it reads in grey and without colour.
OUTCOMES = {
    "stable": ("#f4efe2", "", "stable and right"),
    "soft": ("#d9c88f", "~", "right, but grains overlap by more than a twentieth of the smaller one"),
    "refused": ("#8fa9b1", "r", "refused before the run"),
    "stopped": ("#56757f", "s", "stopped with an error"),
    "wrong": ("#7a1f12", "W", "silently wrong"),
}
LABELS = {
    "contact time": "contact time $T_c$ [s]",
    "steps": "steps per contact time [-]",
    "restitution": "restitution [-]",
    "size ratio": "size ratio [-]",
    "weight": "mass carried over own mass [-]",
    "impact": "speed of impact [m/s]",
}


def stability_figure(cells):
    """One panel for each map of `cells`, with the number of cells of each outcome in the legend.

    cells: columns map, as the maps of benchmarks/studies/stability.py are called, x, y, outcome. ValueError for an
    outcome that is none of OUTCOMES.
    """
    unknown = set(cells["outcome"]) - set(OUTCOMES)
    if unknown:
        raise ValueError(f"stability_figure: outcome {sorted(unknown)[0]!r} is none of {', '.join(OUTCOMES)}")
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
        codes = np.full(table.shape, np.nan)  # of a cell that was not tried
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
