"""One figure on one packing: picture, porosity over height, sizes, and roses of the grains' axes."""

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure

from simcore.evaluation.axis_statistics import density_per_solid_angle, grain_axes
from simcore.evaluation.porosity import porosity_profile
from simcore.report.figures.packings import MM, STONES, draw_packing, draw_profile, size_norm

SLATE, RUST = "#20313b", "#b3541e"
AXES = {"long_axis": ("long axes", SLATE, "-"), "short_axis": ("short axes", RUST, "--")}
SECTORS = 12  # of half a turn
INCLINATIONS = 9  # bins of 10°


def bed_figure(packing, bulk=None, title="", pixels=900):
    """Draw a packing in one figure. packing: Dataset of read_packing; bulk: Dataset of bulk_porosity, or None.

    Left: the grains, coloured by sieve size. Middle: n(z) by slices of the grains themselves, with the evaluated
    interval and its porosity if there is a bulk. Right above: share of the mass that is finer than a sieve size. Right
    below: rose of the azimuths of the long axes, and density per solid angle of the long and short axes against their
    dip; the dotted circles are what axes without a preferred direction give.
    """
    figure = Figure(figsize=(13.0, 6.2), layout="constrained")
    left, middle, right = figure.subfigures(1, 3, width_ratios=(4.6, 3.2, 5.2))
    _draw_picture(left, packing, pixels)
    axes = middle.subplots()
    draw_profile(axes, {"n(z)": porosity_profile(packing, None, "exact")["porosity"]}, bulk)
    _legend_below(middle, [axes], 2)
    above, below = right.subfigures(2, 1)
    draw_sizes(above.subplots(), packing)
    azimuth, dip = below.subplots(1, 2, subplot_kw={"projection": "polar"})
    draw_azimuths(azimuth, packing)
    draw_dips(dip, packing)
    _legend_below(below, [azimuth, dip], 3)
    if title:
        figure.suptitle(title)
    return figure


def draw_sizes(axes, packing):
    """Draw the share of the mass of the grains that is finer than a sieve size, and the specified curve."""
    size, volume = packing["D"].values, packing["volume"].values
    order = np.argsort(size)
    passing = np.cumsum(volume[order]) / volume.sum()
    axes.step(MM * size[order], 100.0 * passing, where="post", color=SLATE, label="grains of the packing")
    if "mass_fraction_specified" in packing:
        shares = packing["mass_fraction_specified"].values
        first, last = np.flatnonzero(shares)[[0, -1]]  # a case has empty classes at its ends
        bounds = packing["sieve_bounds"].values[first : last + 1]
        share = np.append(0.0, np.cumsum(shares[first : last + 1]))
        axes.plot(
            MM * np.append(bounds[:, 0], bounds[-1, 1]), 100.0 * share, "--", color=RUST, marker="o", mfc="white",
            label="specified sieve curve",
        )  # fmt: skip
    low, high = axes.get_xlim()
    if size.max() > 2.0 * size.min():
        axes.set_xscale("log")
        low, high = MM * size.min() / 1.3, MM * size.max() * 1.3
        ticks = [step * 10.0**power for power in range(-3, 4) for step in (1, 2, 5)]
        ticks = [tick for tick in ticks if low <= tick <= high]
        axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
        axes.minorticks_off()
    axes.set(
        xlim=(low, high),
        ylim=(0, 102),
        xlabel="sieve size D [mm]",
        ylabel="finer mass [%]",
        title="sizes of the grains",
    )
    axes.grid(color="0.9")
    axes.legend(loc="upper left", frameon=False, fontsize="small")


def draw_azimuths(axes, packing):
    """Draw the rose of the horizontal directions of the long axes, whose two ends count equally, on polar axes."""
    directions, _ = grain_axes(packing)["long_axis"]
    axes.set_title("azimuths of long axes", fontsize="medium")
    inclined = np.hypot(*directions.T[:2]) > 1e-9
    if not inclined.any():
        _say_none(axes, "no long axis:\nL = I")
        return
    angle = np.arctan2(directions[inclined, 1], directions[inclined, 0]) % np.pi
    counts, edges = np.histogram(angle, SECTORS, (0.0, np.pi))
    height = counts / counts.mean()
    for turn in (0.0, np.pi):
        axes.bar(edges[:-1] + turn, height, np.diff(edges), align="edge", color="#a9a68c", edgecolor=SLATE, lw=0.6)
    _draw_isotropic(axes, 2.0 * np.pi)
    axes.set_xticks(np.radians([0, 90, 180, 270]), ["x", "y", "−x", "−y"])
    axes.set_yticks([])


def draw_dips(axes, packing):
    """Draw the density per solid angle of long and short axes against the angle to the horizontal, on polar axes."""
    edges = np.linspace(0.0, 0.5 * np.pi, INCLINATIONS + 1)
    axes.set_title("dip of the axes", fontsize="medium")
    axes.set_thetamin(0)
    axes.set_thetamax(90)
    drawn = False
    for name, (directions, _) in grain_axes(packing).items():
        if not len(directions):
            continue
        label, color, line = AXES[name]
        density, _ = density_per_solid_angle(directions, np.ones(len(directions)), edges)
        # `edges` are angles with the vertical; a dip is the angle with the horizontal.
        dip, radius = np.repeat(0.5 * np.pi - edges, 2)[1:-1], np.repeat(density, 2)
        axes.plot(dip, radius, color=color, ls=line, label=label)
        drawn = True
    if not drawn:
        _say_none(axes, "no axis: the grains\nare round")
        return
    _draw_isotropic(axes, 0.5 * np.pi)
    axes.set_ylim(bottom=0.0)
    axes.set_xticks(np.radians([0, 30, 60, 90]), ["0°", "30°", "60°", "90°"])
    axes.set_yticks([1.0], [""])


def _draw_picture(figure, packing, pixels):
    axes = figure.subplots()
    norm = size_norm(MM * packing["D"].values)
    draw_packing(axes, packing, norm, -60.0, 22.0, pixels)
    bar = figure.colorbar(ScalarMappable(norm, STONES), ax=axes, orientation="horizontal", shrink=0.7, pad=0.02)
    bar.set_label("sieve size D [mm]")


def _draw_isotropic(axes, end):
    angle = np.linspace(0.0, end, 181)
    axes.plot(angle, np.ones(181), color="black", lw=0.7, ls=":", label="no preferred direction")


def _legend_below(figure, panels, columns):
    """Add a legend with every label of the panels once, unless there is none."""
    entries = {}
    for axes in panels:
        entries |= dict(zip(*axes.get_legend_handles_labels()[::-1], strict=True))
    if entries:
        figure.legend(
            entries.values(), entries, loc="outside lower center", ncols=columns, frameon=False, fontsize="small"
        )


def _say_none(axes, text):
    axes.set_axis_off()
    axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", va="center")
