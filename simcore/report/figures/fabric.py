"""Figures of the fabric: distributions of directions, and positions of the contacts on the grains."""

import numpy as np
from matplotlib.figure import Figure

TITLES = {"contact_normal": "normals of contacts", "long_axis": "long axes", "short_axis": "short axes"}
# Dark to light, each with its own line, so that they can be distinguished in grey.
STYLES = [
    ("#20313b", "-"),
    ("#b3541e", "--"),
    ("#5f7f86", "-."),
    ("#c9963f", (0, (1, 1))),
    ("#8f9d9f", (0, (5, 1, 1, 1))),
]
BAND = "± standard error"


def fabric_figure(fabrics, directions=None, crossing=None):
    """Draw the density per solid angle against the angle to the vertical, one panel per kind of direction.

    fabrics: dict from a label to a Dataset of simcore.evaluation.fabric, five at most; directions: values of its
    coordinate `direction`; None: all with finite values. Steps are the bins, the band is their standard error, and the
    smooth line is the series of Legendre moments up to sixth order. crossing: dict from a direction to an angle [rad]
    to mark, such as crossing_angle.
    """
    _check(fabrics, "fabric_figure")
    if directions is None:
        directions = [
            name
            for name in TITLES
            if any(np.isfinite(fabric["density"].sel(direction=name)).any() for fabric in fabrics.values())
        ]
    figure = Figure(figsize=(1.0 + 3.5 * len(directions), 3.9), layout="constrained")
    panels = figure.subplots(1, len(directions), sharey=True, squeeze=False)[0]
    for axes, name in zip(panels, directions, strict=True):
        axes.axhline(1.0, color="0.45", lw=0.9, zorder=1, label="isotropic")
        for (label, fabric), (color, line) in zip(fabrics.items(), STYLES, strict=False):
            _draw_density(axes, fabric.sel(direction=name), label, color, line)
        if crossing and name in crossing:
            angle = np.degrees(crossing[name])
            axes.axvline(angle, color="black", lw=0.8, ls=":", label="crossing")
            axes.annotate(f"{angle:.1f}°", (angle, 0.02), (3, 0), "data", textcoords="offset points", fontsize="small")
        axes.set(
            xlim=(0, 90), xticks=range(0, 91, 15), title=TITLES[name], xlabel="angle against the vertical [°]",
        )  # fmt: skip
        axes.title.set_fontsize("medium")
    panels[0].set_ylim(bottom=0)
    panels[0].set_ylabel("density per solid angle / isotropic [-]")
    _legend(figure, panels)
    return figure


def contact_radius_figure(fabrics):
    """Draw the distances of contacts from the grains' centres, one panel per fabric.

    fabrics: dict from a label to a Dataset, five at most. Steps with a band: density of contacts over their distance
    from the centre, in radii of a sphere of the grain's volume. Filled outline: the same for the surface of the grains,
    which contacts would follow if they were spread evenly over it.
    """
    _check(fabrics, "contact_radius_figure")
    figure = Figure(figsize=(1.0 + 3.0 * len(fabrics), 3.6), layout="constrained")
    panels = figure.subplots(1, len(fabrics), squeeze=False)[0]
    for axes, (label, fabric) in zip(panels, fabrics.items(), strict=True):
        rho = fabric["radius"].values
        edges = np.append(rho, 2.0 * rho[-1] - rho[-2]) - 0.5 * (rho[1] - rho[0])
        surface, contacts = fabric["surface_radius_density"].values, fabric["contact_radius_density"].values
        axes.stairs(surface, edges, fill=True, color="0.85", label="surface of the grains")
        _band(axes, contacts, fabric["contact_radius_density_std_error"].values, edges, STYLES[0][0])
        axes.stairs(contacts, edges, color=STYLES[0][0], lw=1.3, label=f"contacts ({BAND})")
        some = np.flatnonzero((surface > 0.0) | (contacts > 0.0))
        axes.set(xlim=(edges[some[0]] - 0.1, edges[some[-1] + 1] + 0.1), xlabel="distance from the centre / radius [-]")
        axes.set_ylim(bottom=0)
        axes.set_title(label, fontsize="medium")
    panels[0].set_ylabel("density [-]")
    _legend(figure, panels[:1])
    return figure


def _draw_density(axes, fabric, label, color, line):
    """Draw the steps with their band and the smooth series for one kind of direction of one fabric."""
    density = fabric["density"].values
    if not np.isfinite(density).any():
        return
    edges = np.degrees(np.append(fabric["angle_bounds"].values[:, 0], 0.5 * np.pi))
    _band(axes, density, fabric["density_std_error"].values, edges, color)
    axes.stairs(density, edges, color=color, lw=0.7, alpha=0.8)
    order = fabric["order"].values
    series = np.zeros(order.max() + 1)
    series[0], series[order] = 1.0, (2 * order + 1) * fabric["legendre"].values
    theta = np.linspace(0.0, 0.5 * np.pi, 181)
    smooth = np.polynomial.legendre.legval(np.cos(theta), series)
    axes.plot(np.degrees(theta), smooth, ls=line, color=color, lw=1.5, label=f"{label} ({BAND})")


def _band(axes, values, errors, edges, color):
    """Draw the standard error around steps; without width where it is not a number."""
    low, high = (np.append(values + sign * np.nan_to_num(errors), np.nan) for sign in (-1.0, 1.0))
    low[-1], high[-1] = low[-2], high[-2]
    axes.fill_between(edges, low, high, step="post", color=color, alpha=0.22, lw=0)


def _legend(figure, panels):
    """Add a legend below the panels with every label once."""
    entries = {}
    for axes in panels:
        handles, labels = axes.get_legend_handles_labels()
        for label, handle in zip(labels, handles, strict=True):
            entries.setdefault(label, handle)
    figure.legend(entries.values(), entries, loc="outside lower center", ncols=3, frameon=False, fontsize="small")


def _check(fabrics, name):
    if not 0 < len(fabrics) <= len(STYLES):
        raise ValueError(
            f"{name}: {len(fabrics)} fabrics were given, but it can draw 1 to {len(STYLES)}; change their number"
        )
