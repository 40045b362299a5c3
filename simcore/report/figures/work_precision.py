"""Figures of error against CPU time."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from simcore.verification.work_precision import settings_table

MAX_COLUMNS = 4
FEW_DECADES = 40.0  # maximum ratio of the ends of an axis for labels at 1, 2 and 5 instead of 1
# Lightness, line and marker distinguish the methods, also in grey.
STYLES = [
    ("black", "-", "o"),
    ("0.45", "--", "s"),
    ("0.62", "-.", "^"),
    ("#b3541e", ":", "D"),
    ("#2f6f8f", (0, (5, 1, 1, 1, 1, 1)), "v"),
    ("0.3", (0, (1, 1)), "P"),
    ("#7f9aa0", (0, (8, 2)), "X"),
]


def work_precision_figure(runs, cost_label, error_labels, setting_label, micro=True, note="", name_all=False):
    """Draw error against CPU time on logarithmic axes: a row of panels per quantity, a column per case.

    runs: table of simcore.verification.work_precision. cost_label: label of the CPU time; its unit, µs or s (micro
    False), is added. error_labels: dict from quantity to the label of its axis, with unit. setting_label: meaning of
    the numbers at the first, last and default points of a line. note: text in small print, such as the machine.
    name_all: write the setting at every point, not only the first, last and default, and draw no lines. Methods have
    the same style in all panels. Rings show the Pareto front, a star the default, and the dotted line above a shade the
    error of the reference itself. ValueError for more methods than styles.
    """
    table = settings_table(runs)
    quantities, cases = list(dict.fromkeys(table["quantity"])), list(dict.fromkeys(table["case"]))
    methods = dict(zip(dict.fromkeys(table["method"]), STYLES, strict=False))
    if len(methods) < table["method"].nunique():
        raise ValueError(
            f"work_precision_figure: {table['method'].nunique()} methods, but only {len(STYLES)} styles; draw fewer"
        )
    unit = 1e6 if micro else 1.0
    if len(quantities) == 1 and len(cases) > MAX_COLUMNS:
        explained = {"setting_label": setting_label, "note": note, "name_all": name_all}
        return _panels_in_rows(table, cases, methods, unit, cost_label, error_labels, **explained)
    figure = Figure(figsize=(1.2 + 3.7 * len(cases), 1.3 + 2.7 * len(quantities)), layout="constrained")
    grid = figure.subplots(len(quantities), len(cases), squeeze=False, sharex="col", sharey="row")
    handles = {}
    for i, quantity in enumerate(quantities):
        for j, case in enumerate(cases):
            axes = grid[i, j]
            points = table[(table["quantity"] == quantity) & (table["case"] == case)]
            _draw_panel(axes, points, methods, unit, handles, name_all)
            if i == 0:
                axes.set_title(case, fontsize="medium")
            if i == len(quantities) - 1:
                axes.set_xlabel(f"{cost_label} [{'µs' if micro else 's'}]")
        grid[i, 0].set_ylabel(error_labels[quantity])
    _tick(grid)
    _explain(figure, handles, setting_label, note)
    return figure


def _panels_in_rows(table, cases, methods, unit, cost_label, error_labels, *, setting_label, note, name_all):
    """Draw the panels of one quantity, MAX_COLUMNS in a row."""
    rows = -(-len(cases) // MAX_COLUMNS)
    figure = Figure(figsize=(1.2 + 3.7 * MAX_COLUMNS, 1.3 + 3.1 * rows), layout="constrained")
    grid = figure.subplots(rows, MAX_COLUMNS, squeeze=False, sharey=True)
    handles = {}
    for axes, case in zip(grid.flat, cases, strict=False):
        _draw_panel(axes, table[table["case"] == case], methods, unit, handles, name_all)
        axes.set_title(case, fontsize="medium")
        axes.set_xlabel(f"{cost_label} [{'µs' if unit > 1.0 else 's'}]")
    for axes in grid.flat[len(cases) :]:
        axes.set_visible(False)
    for row in grid:
        row[0].set_ylabel(next(iter(error_labels.values())))
    _tick(grid)
    _explain(figure, handles, setting_label, note)
    return figure


def _tick(grid):
    """Set the ticks of the logarithmic axes of drawn panels: axes of few decades are labelled at 1, 2 and 5 only."""
    for axes in grid.flat:
        for axis, (low, high) in (axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim()):
            axis.set_minor_formatter(NullFormatter())
            if high < FEW_DECADES * low:
                axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
                axis.set_major_formatter(FuncFormatter(lambda number, _: f"{number:g}"))


def _explain(figure, handles, setting_label, note):
    figure.legend(
        handles.values(), handles.keys(), loc="outside lower center", ncols=3, frameon=False, fontsize="small",
        title=f"numbers at the points: {setting_label}" + (f"\n{note}" if note else ""), title_fontsize="x-small",
    )  # fmt: skip


def _draw_panel(axes, points, methods, unit, handles, name_all):
    axes.set(xscale="log", yscale="log")
    axes.grid(color="0.92", lw=0.6)
    axes.set_axisbelow(True)
    reference_error = points["reference_error"].max()
    if reference_error > 0.0:
        handles["error of the reference"] = axes.axhline(reference_error, color="0.5", lw=1.0, ls=":", zorder=1)
        axes.axhspan(0.0, reference_error, color="0.94", zorder=0)
    for method, rows in points.groupby("method", sort=False):
        color, line, marker = methods[method]
        x, y = unit * rows["cpu_s"], rows["error"]
        spread = [x - unit * rows["cpu_least"], unit * rows["cpu_most"] - x]
        bars = axes.errorbar(
            x, y, rows.get("error_std"), spread,
            color=color, ls="none" if name_all else line, lw=1.2, marker=marker, ms=4, elinewidth=0.6, mec="white",
            mew=0.4, zorder=3,
        )  # fmt: skip
        handles.setdefault(method, bars)
        marked = dict.fromkeys(range(len(rows)), "left") if name_all else {0: "left", len(rows) - 1: "right"}
        marked |= {k: "left" for k in np.flatnonzero(rows["default"])}
        for k, side in marked.items():
            setting = rows["setting"].iloc[k]
            axes.annotate(
                f"{setting:g}" if isinstance(setting, (int, float, np.number)) else str(setting),
                (x.iloc[k], y.iloc[k]), (4 if side == "left" else -2, 4), textcoords="offset points",
                fontsize="xx-small", color=color, zorder=4,
            )  # fmt: skip
    front = points[points["on_front"]].sort_values("cpu_s")
    (handles["Pareto front"],) = axes.plot(
        unit * front["cpu_s"], front["error"], "o", mfc="none", mec="black", ms=9, mew=0.8, zorder=5
    )
    chosen = points[points["default"]]
    if len(chosen):
        (handles["default"],) = axes.plot(
            unit * chosen["cpu_s"], chosen["error"], "*", color="black", mec="white", ms=13, mew=0.8, zorder=6
        )


def rest_figure(table, allowed_unbalanced=0.02):
    """Draw remaining motion and unbalanced force of beds at rest over steps per contact time, a column per shape.

    table: of simcore.verification.rest. allowed_unbalanced: limit of the unbalanced force in a packing's convergence,
    drawn as a line. Beds that flew apart are shown as triangles at the upper edge.
    """
    quantities = {
        "kinetic_energy": "largest kinetic energy\n/ (weight × grain size) [-]",
        "unbalanced_force": "unbalanced force\n/ mean contact force [-]",
    }
    shapes = list(dict.fromkeys(table["shape"]))
    figure = Figure(figsize=(1.2 + 3.4 * len(shapes), 6.0), layout="constrained")
    grid = figure.subplots(2, len(shapes), squeeze=False, sharex=True, sharey="row")
    for row, (quantity, label) in zip(grid, quantities.items(), strict=True):
        row[0].set_ylabel(label)
        for axes, shape in zip(row, shapes, strict=True):
            axes.set(xscale="log", yscale="log")
            axes.grid(color="0.92", lw=0.6)
            rows_of = table[table["shape"] == shape].groupby("dashpot", sort=False)
            for (dashpot, rows), (color, line, marker) in zip(rows_of, STYLES, strict=False):
                axes.plot(
                    rows["steps"], rows[quantity].where(np.isfinite(rows[quantity])),
                    color=color, ls=line, marker=marker, ms=5, lw=1.2, label=dashpot,
                )  # fmt: skip
                lost = rows["steps"][~np.isfinite(rows["kinetic_energy"])]
                top = axes.get_xaxis_transform()
                axes.plot(lost, np.full(len(lost), 0.96), "^", color=color, ms=7, mfc="white", transform=top)
            if quantity == "unbalanced_force":
                axes.axhline(allowed_unbalanced, color="0.5", lw=1.0, ls=":", label="limit for a packing")
            steps = sorted(set(table["steps"]))
            axes.set_xticks(steps, [f"{n:g}" for n in steps])
            axes.minorticks_off()
    for axes, shape in zip(grid[0], shapes, strict=True):
        axes.set_title({"sphere": "spheres", "polyhedron": "pebbles"}.get(shape, shape), fontsize="medium")
    for axes in grid[-1]:
        axes.set_xlabel("steps per contact time [-]")
    figure.legend(*grid[1, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False)
    return figure
