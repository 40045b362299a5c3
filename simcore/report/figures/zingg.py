"""Zingg diagrams (elongation over flatness) with fields, porosities and sets of forms."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Ellipse
from scipy.spatial import Delaunay

from simcore.grains.form import axes_from_form

FLATNESS, ELONGATION = "flatness FL = S/I [-]", "elongation EL = I/L [-]"
POROSITY = "porosity n [-]"
# Dark is dense; lightness grows steadily, so that the scale can be read in grey.
SHADES = "cividis"
FIELDS = ((0.02, 0.98, "oblate"), (0.98, 0.98, "equant"), (0.02, 0.02, "bladed"), (0.98, 0.02, "prolate"))


def draw_fields(axes, lowest=0.2):
    """Draw the four fields of Zingg, divided at 2/3, with names in the corners; the axes begin at `lowest`."""
    axes.axvline(2 / 3, color="0.6", lw=0.8, zorder=0)
    axes.axhline(2 / 3, color="0.6", lw=0.8, zorder=0)
    for x, y, name in FIELDS:
        side, base = ("left" if x < 0.5 else "right"), ("bottom" if y < 0.5 else "top")
        axes.text(x, y, name, ha=side, va=base, color="0.2", style="italic", transform=axes.transAxes)
    axes.set(xlim=(lowest, 1.02), ylim=(lowest, 1.02), xlabel=FLATNESS, ylabel=ELONGATION)
    axes.set_aspect("equal")


def porosity_zingg_figure(packings, models=None):
    """Draw the porosity of packings of one form in the Zingg diagram, one panel per case, with one colour scale.

    packings: columns case, FL, EL, n; models: dict from a case to its PorosityModel, whose lines of equal porosity are
    drawn among the forms to which it was fitted.
    """
    cases = list(packings.groupby("case", sort=False))
    figure = Figure(figsize=(1.1 + 3.9 * len(cases), 4.2), layout="constrained")
    grid = figure.subplots(1, len(cases), squeeze=False)[0]
    low, high = packings["n"].min(), packings["n"].max()
    lowest = min(0.2, 0.95 * packings[["FL", "EL"]].min().min())
    for axes, (case, rows) in zip(grid, cases, strict=True):
        draw_fields(axes, lowest)
        if models and case in models:
            _draw_model(axes, models[case], rows)
        image = axes.scatter(
            rows["FL"], rows["EL"], c=rows["n"], cmap=SHADES, vmin=low, vmax=high, s=42, ec="black", lw=0.5, zorder=3
        )
        axes.set_title(f"sieve curve {case}, {len(rows)} forms", fontsize="medium")
    figure.colorbar(image, ax=grid, label=POROSITY, shrink=0.85)
    return figure


def form_sets_figure(mixtures, gravel=None):
    """Draw form mixtures in the Zingg diagram, each as an ellipse of one standard deviation around its mean.

    mixtures: columns mu_FL, sigma_FL, mu_EL, sigma_EL over the grains of each packing, and n, the porosity, which gives
    the colour; with a column case, one panel per case. gravel: a row of table2_form_statistics of Rettinger et al.
    (2022), drawn in black, or None.
    """
    cases = list(mixtures.groupby("case", sort=False)) if "case" in mixtures else [("", mixtures)]
    figure = Figure(figsize=(1.1 + 3.9 * len(cases), 4.2), layout="constrained")
    grid = figure.subplots(1, len(cases), squeeze=False)[0]
    low, high = mixtures["n"].min(), mixtures["n"].max()
    for axes, (case, rows) in zip(grid, cases, strict=True):
        draw_fields(axes, 0.1)
        image = axes.scatter(
            rows["mu_FL"], rows["mu_EL"], c=rows["n"], cmap=SHADES, vmin=low, vmax=high, s=30, ec="black", lw=0.5,
            zorder=3, label="mean of a mixture",
        )  # fmt: skip
        for _, row in rows.iterrows():
            _draw_set(axes, row, ec=image.cmap(image.norm(row["n"])), lw=0.9, alpha=0.7, zorder=2)
        if gravel is not None:
            axes.scatter(gravel["mu_FL"], gravel["mu_EL"], marker="D", s=42, c="black", zorder=4, label="Rhine gravel")
            _draw_set(axes, gravel, ec="black", lw=1.8, zorder=4)
        if case:
            axes.set_title(f"sieve curve {case}, {len(rows)} mixtures", fontsize="medium")
    figure.colorbar(image, ax=grid, label=POROSITY, shrink=0.85)
    handles, _ = grid[0].get_legend_handles_labels()
    handles.append(Line2D([], [], ls="none", marker="o", ms=12, mfc="none", mec="0.3", label="one standard deviation"))
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False, fontsize="small")
    return figure


def _draw_set(axes, row, **style):
    """Draw the ellipse of one standard deviation around the mean of a distribution of form."""
    size = (2 * row["sigma_FL"], 2 * row["sigma_EL"])
    axes.add_patch(Ellipse((row["mu_FL"], row["mu_EL"]), *size, fill=False, **style))


def _draw_model(axes, model, rows):
    """Draw lines of equal porosity of the model among the forms of `rows`, not outside them."""
    forms = rows[["FL", "EL"]].to_numpy()
    if np.linalg.matrix_rank(forms - forms.mean(axis=0), tol=1e-6) < 2:
        return  # forms on a line enclose no area
    flatness, elongation = (np.linspace(low, high, 80) for low, high in zip(forms.min(0), forms.max(0), strict=True))
    x, y = np.meshgrid(flatness, elongation)
    n = model.predict_form(*axes_from_form(1.0, x.ravel(), y.ravel()))
    between = Delaunay(forms).find_simplex(np.column_stack([x.ravel(), y.ravel()])) >= 0
    lines = axes.contour(
        x, y, np.where(between, n, np.nan).reshape(x.shape), 6, colors="0.45", linewidths=0.8, zorder=1
    )
    axes.clabel(lines, fmt="%.3g", fontsize="x-small")
