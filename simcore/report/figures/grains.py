"""Figures about grains: Zingg diagram, histograms, correlations of the form factors, shapes against scans."""

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from scipy.stats import norm

from simcore.report.figures.zingg import SHADES, draw_fields

_OPENINGS = [1, 1.4, 2, 2.8, 4, 5.6, 8, 11.2, 16, 22.4, 31.5, 45, 63, 90, 125, 180, 250, 355, 500, 710]  # [mm]
MOST_CLASSES = 8
# Markers and greys that can be distinguished in print without colour.
_STYLES = [("o", "0.15"), ("^", "0.55"), ("s", "white"), ("x", "0.35")]


def zingg_diagram(tables, r22=None):
    """Draw EL against FL in Zingg's diagram; tables: dict from label to form_table. Returns Figure.

    With one table the colour of a grain shows its sieve class, from dark for the finest to light for the coarsest; with
    several, markers and greys show the table. r22: a row of table2_form_statistics of Rettinger et al. (2022), whose
    mean and standard deviation are drawn as a cross.
    """
    figure = Figure(figsize=(5.6, 4.9) if len(tables) == 1 else (4.8, 4.9), layout="constrained")
    axes = figure.subplots()
    draw_fields(axes, lowest_of(*tables.values()))
    for (label, table), (marker, colour) in zip(tables.items(), _STYLES, strict=False):
        label = f"{label} (n = {len(table)})"
        if len(tables) > 1:
            _scatter(axes, table.FL, table.EL, marker, colour, label)
            continue
        bounds = sieve_class_bounds(table.D_mm)
        shades = colormaps[SHADES].resampled(len(bounds) - 1)
        points = axes.scatter(
            table.FL, table.EL, c=table.D_mm, cmap=shades, norm=BoundaryNorm(bounds, len(bounds) - 1), s=34, ec="black",
            lw=0.5, zorder=3, label=label,
        )  # fmt: skip
        bar = figure.colorbar(points, ax=axes, shrink=0.8, spacing="uniform")
        bar.set_ticks(bounds, labels=[f"{bound:g}" for bound in bounds])
        bar.set_label("sieve size D [mm]")
    if r22 is not None:
        axes.errorbar(
            r22.mu_FL, r22.mu_EL, r22.sigma_EL, r22.sigma_FL, fmt="D", color="#b3541e", mfc="white", ms=6,
            lw=1.4, capsize=3, zorder=4, label=f"{r22.n_samples:.0f} grains of Rettinger et al.: mean ± std.",
        )  # fmt: skip
    figure.legend(frameon=False, fontsize="small", loc="outside upper center", ncols=2)
    return figure


def lowest_of(*tables):
    """Return where the axes of flatness and elongation begin: at 0.2, or below all grains of the tables."""
    least = min(table[["FL", "EL"]].min().min() for table in tables)
    return min(0.2, 0.05 * np.floor(0.95 * least / 0.05))


def sieve_class_bounds(sizes):
    """Return the openings [mm] of the standard sieves that divide sizes (n,) [mm] into classes, ascending, two or more.

    They are from the series R 20/3 of ISO 565, those of Rettinger et al. (2022) among them. If it divides the sizes
    into more than MOST_CLASSES classes, only every second or third opening is used, and so on.
    """
    series = np.multiply.outer(1000.0 ** np.arange(-2, 3), _OPENINGS).ravel()
    first = np.searchsorted(series, np.min(sizes), side="right") - 1
    last = max(np.searchsorted(series, np.max(sizes), side="left"), first + 1)
    step = -(-(last - first) // MOST_CLASSES)
    return series[np.arange(first, last + step, step)]


def form_histograms(table, r22=None):
    """Draw histograms of FL and EL with the normal density of their mean and standard deviation. Returns Figure.

    r22: a row of table2_form_statistics of Rettinger et al. (2022), whose normal density is drawn for the same number
    of grains.
    """
    figure = Figure(figsize=(7, 3.4), layout="constrained")
    lowest = lowest_of(table)
    for axes, factor, name in zip(
        figure.subplots(1, 2, sharey=True), ("FL", "EL"), ("flatness", "elongation"), strict=True
    ):
        values, edges = table[factor], np.linspace(lowest, 1, 1 + round((1 - lowest) / 0.05))
        axes.hist(values, edges, color="0.85", edgecolor="0.4", lw=0.6, label="grains of this set")
        x = np.linspace(lowest, 1, 200)
        grains = len(values) * (edges[1] - edges[0])
        spread = values.std(ddof=1)
        if spread > 0.0:  # nan for one grain
            axes.plot(
                x, grains * norm.pdf(x, values.mean(), spread), "k", lw=1.2, label="normal distribution, this set"
            )
        if r22 is not None:
            density = norm.pdf(x, r22[f"mu_{factor}"], r22[f"sigma_{factor}"])
            axes.plot(x, grains * density, "--", color="#b3541e", lw=1.6, label="normal distribution, Rettinger et al.")
        title = f"mean {values.mean():.3f}" + (f", std {spread:.3f}" if np.isfinite(spread) else "")
        axes.set_title(title, fontsize="medium")
        axes.set(xlabel=f"{name} {factor} [-]", xlim=(lowest, 1))
    figure.axes[0].set_ylabel("number of grains [-]")
    handles = figure.axes[0].get_legend_handles_labels()
    figure.legend(*handles, loc="outside lower center", ncols=3, frameon=False, fontsize="small")
    return figure


def correlation_matrix(correlations):
    """Draw the correlations of the form factors as a matrix of colours with their numbers. Returns Figure."""
    names = list(correlations.columns)
    figure = Figure(figsize=(6.6, 5.6), layout="constrained")
    axes = figure.subplots()
    image = axes.imshow(correlations, cmap="RdBu", vmin=-1, vmax=1)
    for (row, column), value in np.ndenumerate(correlations.to_numpy()):
        colour = "white" if abs(value) > 0.6 else "black"
        text = f"{value:.2f}".replace("-", "−") if np.isfinite(value) else ""
        axes.text(column, row, text, ha="center", va="center", color=colour, fontsize=7)
    axes.set_xticks(range(len(names)), names, rotation=60)
    axes.set_yticks(range(len(names)), names)
    axes.set(xlabel="form factor", ylabel="form factor")
    figure.colorbar(image, ax=axes, label="Pearson's r [-]", shrink=0.85)
    return figure


def shapes_against_scans(tables, ranges):
    """Draw share in facets against sphericity with the range of scans, at equal maximum face counts. Returns Figure.

    tables: dict from label to shape_table; ranges: of scan_ranges. Left: sphericity; right: sphericity relative to that
    of the ellipsoid, which removes the influence of form.
    """
    figure = Figure(figsize=(8.4, 3.9), layout="constrained")
    share = ranges.loc["facet_share_300"]
    panels = [("sphericity_300", "sphericity [-]"), ("relative_sphericity", "sphericity relative to the ellipsoid [-]")]
    for axes, (measure, name) in zip(figure.subplots(1, 2, sharey=True), panels, strict=True):
        low, high = ranges.loc[measure, ["min", "max"]]
        box = Rectangle((low, share["min"]), high - low, share["max"] - share["min"], fc="0.92", ec="0.4", ls="--")
        axes.add_patch(box).set_label("range of 65 scanned grains")
        axes.errorbar(
            ranges.loc[measure, "mean"],
            share["mean"],
            share["std"],
            ranges.loc[measure, "std"],
            color="0.4",
            capsize=3,
            label="mean ± standard deviation of these grains",
        )
        for (label, table), (marker, colour) in zip(tables.items(), _STYLES, strict=False):
            _scatter(axes, table[measure], table.facet_share_300, marker, colour, label)
        axes.set_xlabel(name)
    figure.axes[0].set_ylabel("share of surface in the ten largest\nfacets, at most 300 faces [-]")
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=2, frameon=False)
    return figure


def decimation_changes(summary):
    """Draw the mean change of volume, FL, EL and sphericity over the face target; summary: of decimation_summary."""
    figure = Figure(figsize=(5, 3.4), layout="constrained")
    axes = figure.subplots()
    styles = {"volume": "o-", "flatness": "^--", "elongation": "s-.", "sphericity": "x:"}
    for name, style in styles.items():
        axes.plot(summary.index, summary[f"{name}_change_percent"], style, color="0.2", mfc="white", label=name)
    axes.axhline(0, color="0.6", lw=0.8, zorder=0)
    axes.set_xscale("log")
    axes.set_xticks(list(summary.index), [str(target) for target in summary.index])
    axes.minorticks_off()
    axes.set(xlabel="maximum number of faces [-]", ylabel="mean change [%]")
    axes.legend(frameon=False)
    return figure


def _scatter(axes, x, y, marker, colour, label):
    edge = {} if marker == "x" else {"edgecolors": "k", "linewidths": 0.5}
    axes.scatter(x, y, s=22, marker=marker, color=colour, label=label, **edge)
