"""Figures of deposits of ellipsoids: over eta and zeta, over the spread of sizes, and by process.

The processes are the deposit and that of Rettinger et al. (2022).
"""

from itertools import cycle

import numpy as np
from matplotlib.figure import Figure

from simcore.campaign.deposit_findings import LINES
from simcore.campaign.deposits import curve, means, plain_means
from simcore.grains.beta_sizes import BetaSizes

LABELS = {
    "solid_fraction": "solid fraction [-]",
    "coordination_number": "contacts per grain [-]",
    "P2_contact_normal": "$\\langle P_2\\rangle$ of contact normals [-]",
    "P2_long_axis": "$\\langle P_2\\rangle$ of long axes [-]",
}
LEAST_SPAN = {
    "solid_fraction": 0.02,
    "coordination_number": 1.0,
    "P2_contact_normal": 0.2,
    "P2_long_axis": 0.2,
}
# Line, marker and lightness differ, so that the families can be distinguished in grey.
STYLES = {
    "diagonal": {"label": "η = ζ", "color": "#20313b", "marker": "o", "ls": "-"},
    "prolate": {"label": "prolate (ζ = 1), over η", "color": "#b3541e", "marker": "s", "ls": "--"},
    "oblate": {"label": "oblate (η = 1), over ζ", "color": "#7f9aa0", "marker": "^", "ls": "-."},
}
SIZE_STYLES = [("#20313b", "o", "-"), ("#b3541e", "s", "--"), ("#7f9aa0", "^", "-.")]
BAR = "± std. error over seeds"


def figures_of_rows(rows, maxima):
    """Return the figures that need no packings, dict by name; rows: with their family; maxima: of deposit_findings."""
    return {
        "map": map_figure(rows),
        "forms": forms_figure(rows, maxima),
        "directions": directions_figure(rows),
        "sizes": sizes_figure(rows),
        "bridge": bridge_figure(rows),
        "size_distributions": size_distributions_figure(sorted(set(rows["spread"].dropna()) - {0.0})),
    }


def map_figure(rows):
    """Draw solid fraction and contacts per grain over eta and zeta, as numbers in cells of equal size.

    rows: of deposits.deposit_rows, with their family. Only ratios of the family `map` are shown; values of a form are
    means over its seeds.
    """
    table = plain_means(rows)
    in_map = rows[rows["family"] == "map"]
    etas, zetas = np.unique(in_map["eta"]), np.unique(in_map["zeta"])
    figure = Figure(figsize=(2.4 + 1.3 * max(len(etas), 2), 1.6 + 0.62 * max(len(zetas), 2)), layout="constrained")
    for axes, name in zip(figure.subplots(1, 2), ("solid_fraction", "coordination_number"), strict=True):
        values = np.full((len(zetas), len(etas)), np.nan)
        for row in table.itertuples():
            if row.eta in etas and row.zeta in zetas:
                values[np.searchsorted(zetas, row.zeta), np.searchsorted(etas, row.eta)] = getattr(row, name)
        image = axes.imshow(values, origin="lower", cmap="cividis", aspect="auto")
        middle = 0.5 * (np.nanmin(values) + np.nanmax(values)) if np.isfinite(values).any() else 0.0
        for (k, j), value in np.ndenumerate(values):
            if np.isfinite(value):
                text = f"{value:.3f}" if name == "solid_fraction" else f"{value:.1f}"
                color = "black" if value > middle else "white"
                axes.text(j, k, text, ha="center", va="center", fontsize="small", color=color)
        axes.set_xticks(range(len(etas)), [f"{eta:g}" for eta in etas])
        axes.set_yticks(range(len(zetas)), [f"{zeta:g}" for zeta in zetas])
        axes.set(xlabel="η = a/b [-]", ylabel="ζ = b/c [-]")
        figure.colorbar(image, ax=axes, label=LABELS[name])
    return figure


def forms_figure(rows, maxima):
    """Draw solid fraction and contacts per grain along the diagonal and both families of spheroids, with their maxima.

    maxima: of deposit_findings.maxima; each maximum inside the range of forms is shown as a ring with its errors.
    """
    longest = rows[["eta", "zeta"]].max().max()
    figure, grid = _panels(("solid_fraction", "coordination_number"))
    for axes, name in zip(grid, ("solid_fraction", "coordination_number"), strict=True):
        _draw_lines(axes, rows, name)
        for top in maxima[(maxima["of"] == name) & (maxima["ratio"] < longest)].itertuples():
            axes.errorbar(
                top.ratio, top.value, top.value_error, top.ratio_error, fmt="o", ms=11, mfc="none", capsize=2, lw=0.9,
                color=STYLES[top.family]["color"], label="maximum of a curve fitted near it (± std. error)",
            )  # fmt: skip
    return _with_legend(figure, grid)


def directions_figure(rows):
    """Draw <P2> of contact normals and of long axes relative to the vertical, over form; isotropic is 0."""
    names = ("P2_contact_normal", "P2_long_axis")
    figure, grid = _panels(names)
    for axes, name in zip(grid, names, strict=True):
        axes.axhline(0.0, color="0.45", lw=0.9, zorder=1, label="isotropic")
        _draw_lines(axes, rows, name)
    return _with_legend(figure, grid)


def sizes_figure(rows):
    """Draw density, contacts and directions over the spread of sizes S, one line per form."""
    table = means(rows[rows["family"] == "sizes"])
    figure = Figure(figsize=(8.4, 6.2), layout="constrained")
    grid = figure.subplots(2, 2, sharex=True)
    for axes, name in zip(grid.flat, LABELS, strict=True):
        groups = table.groupby(["eta", "zeta"], sort=True)
        for ((eta, zeta), form), (color, marker, line) in zip(groups, cycle(SIZE_STYLES), strict=False):
            form = form.sort_values("spread")
            axes.errorbar(
                form["spread"], form[name], form[f"{name}_error"], color=color, marker=marker, ls=line, ms=5, capsize=2,
                lw=1.2, label=f"η = {eta:g}, ζ = {zeta:g} ({BAR})",
            )  # fmt: skip
        axes.set_ylabel(LABELS[name])
        # A minimum span keeps pure scatter from looking like an effect.
        low, high = axes.get_ylim()
        wider = max(0.5 * (LEAST_SPAN[name] - (high - low)), 0.0)
        axes.set_ylim(low - wider, high + wider)
        _grid(axes)
    for axes in grid[-1]:
        axes.set_xlabel("spread of sizes S [-]")
    return _with_legend(figure, list(grid.flat))


def size_distributions_figure(spreads, alpha=3.0, beta=3.0):
    """Draw the distributions of size of deposits by volume and by number, one line per spread of sizes S.

    spreads: at most three, above 0. Sizes are radii of spheres of the grains' volumes, divided by the middle of their
    range; alpha, beta: exponents of BetaSizes.
    """
    figure = Figure(figsize=(9.0, 4.0), layout="constrained")
    panels = figure.subplots(1, 2, sharex=True)
    for spread, (color, _, line) in zip(spreads, cycle(SIZE_STYLES), strict=False):
        sizes = BetaSizes(1.0, spread, alpha, beta)
        radius = np.linspace(1.0 - spread, 1.0 + spread, 401)
        volume = (radius - 1.0 + spread) ** alpha * (1.0 + spread - radius) ** beta
        means = (sizes.moment(4) / sizes.moment(3), sizes.moment(1))
        for axes, density, mean in zip(panels, (volume, volume / radius**3), means, strict=True):
            density = density / np.trapezoid(density, radius)
            axes.plot(radius, density, color=color, ls=line, lw=1.5, label=f"S = {spread:g}")
            axes.plot(mean, np.interp(mean, radius, density), "o", color=color, ms=6)
    for axes, name in zip(panels, ("volume", "number"), strict=True):
        axes.axvline(1.0, color="0.6", lw=0.8, zorder=0)
        axes.plot([], [], "o", color="0.4", ms=6, label="mean")
        axes.set(
            xlabel="radius / middle of its range [-]",
            ylabel=f"share of the {name} per relative radius [-]",
            ylim=(0, None),
        )
        axes.set_title(f"by {name} of the grains", fontsize="medium")
        _grid(axes)
    return _with_legend(figure, list(panels), columns=4)


def bridge_figure(rows):
    """Draw porosity over L/S of deposits, and of the same forms by the process of Rettinger et al., shaken or not.

    Shades show the processes, markers the families of forms. Lines connect the forms of one family; the sphere belongs
    to all families.
    """
    figure = Figure(figsize=(6.4, 4.8), layout="constrained")
    axes = figure.subplots()
    of_bridge = means(rows[rows["family"] == "bridge"])
    forms = set(zip(of_bridge["eta"], of_bridge["zeta"], strict=True))
    deposits = plain_means(rows)
    deposits = deposits[[form in forms for form in zip(deposits["eta"], deposits["zeta"], strict=True)]]
    shaken = of_bridge["shaking_s"] > 0.0
    for table, process, shade in (
        (of_bridge[~shaken], "law of Rettinger et al.: static friction, not shaken", "white"),
        (of_bridge[shaken], "law and process of Rettinger et al.: shaken", "0.6"),
        (deposits, "deposit: Hertz, dynamic friction, not shaken", "#20313b"),
    ):
        for on, style in (
            (table["eta"] == table["zeta"], STYLES["diagonal"]),
            (table["zeta"] == 1.0, STYLES["prolate"]),
            (table["eta"] == 1.0, STYLES["oblate"]),
        ):
            line = table[on].sort_values(["eta", "zeta"])
            axes.errorbar(
                line["eta"] * line["zeta"], 1.0 - line["solid_fraction"], line["solid_fraction_error"],
                marker=style["marker"], ls=style["ls"], color="#20313b", mfc=shade, ms=6, mew=0.8, lw=0.7, capsize=2,
            )  # fmt: skip
        axes.plot([], [], ls="none", marker="D", mec="#20313b", mfc=shade, label=process)
    for style in STYLES.values():
        label = style["label"].split(",")[0]
        axes.plot([], [], color="#20313b", marker=style["marker"], mfc="none", ls=style["ls"], lw=0.7, label=label)
    axes.set(xlabel="L/S = η ζ [-]", ylabel="porosity n [-], ± std. error over seeds")
    _grid(axes)
    return _with_legend(figure, [axes])


def _panels(names):
    """Return a figure and its panels side by side, one for each of `names`, over the ratio of axes."""
    figure = Figure(figsize=(9.0, 4.2), layout="constrained")
    grid = figure.subplots(1, len(names))
    for axes, name in zip(grid, names, strict=True):
        axes.set(xlabel="ratio of neighbouring axes [-]", ylabel=LABELS[name])
        _grid(axes)
    return figure, list(grid)


def _draw_lines(axes, rows, name):
    """Draw the means over the seeds for the three families of forms."""
    for line_name in LINES:
        groups = curve(rows, line_name).groupby("ratio")[name]
        mean, error = groups.mean(), groups.std(ddof=1) / np.sqrt(groups.size())
        style = dict(STYLES[line_name])
        label = f"{style.pop('label')} ({BAR})"
        axes.errorbar(mean.index, mean, error, ms=4, lw=1.2, capsize=2, label=label, **style)


def _grid(axes):
    axes.grid(color="0.93", lw=0.6)
    axes.set_axisbelow(True)


def _with_legend(figure, panels, columns=2):
    """Add a legend below the panels with every label once, and return the figure."""
    entries = {}
    for axes in panels:
        handles, labels = axes.get_legend_handles_labels()
        for label, handle in zip(labels, handles, strict=True):
            entries.setdefault(label, handle)
    figure.legend(entries.values(), entries, loc="outside lower center", ncols=columns, frameon=False, fontsize="small")
    return figure
