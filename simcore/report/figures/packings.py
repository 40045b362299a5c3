"""Figures of packings: porosity over height, and pictures of the grains."""

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure

from simcore.evaluation.axis_statistics import grain_axes
from simcore.evaluation.rounding import rounded
from simcore.report.figures.rendering import project, render

MM = 1e3
ONE_CLASS = 1.5  # sizes within this ratio are those of one sieve class, and their colours would show nothing
ONE_FORM = 0.05  # the same for L/S, as a difference
# From dark slate to sand; lightness grows steadily, so that the scale can be read in grey.
STONES = LinearSegmentedColormap.from_list("stones", ["#2f4858", "#5f7f86", "#a9a68c", "#e0bf86", "#f7ead0"])


def profile_figure(profiles, bulk, title=""):
    """Draw porosity over height with the evaluated interval.

    profiles: dict from a label to a DataArray n(z) [z in m], at most four; bulk: Dataset as from bulk_porosity.
    """
    figure = Figure(figsize=(5.2, 4.0), layout="constrained")
    axes = figure.subplots()
    draw_profile(axes, profiles, bulk)
    axes.set_title(title)
    figure.legend(loc="outside right upper", frameon=False, fontsize="small")
    return figure


def draw_profile(axes, profiles, bulk=None):
    """Draw porosity over height, and the evaluated interval unless bulk is None; arguments as in profile_figure."""
    if bulk is not None:
        low, high = float(bulk["z_lower"]), float(bulk["z_upper"])
        axes.axhspan(low * MM, high * MM, color="0.92", zorder=0, label="evaluated interval")
    styles = [("black", "-", 1.4), ("#2f6f8f", "--", 1.2), ("0.5", "-.", 1.2), ("0.3", ":", 1.4)]
    for (label, profile), (color, style, width) in zip(profiles.items(), styles, strict=False):
        axes.plot(profile, profile["z"] * MM, style, color=color, lw=width, label=label)
    if bulk is not None:
        n, error = float(bulk["n"]), float(bulk["n_std_error"])
        axes.plot([n, n], [low * MM, high * MM], color="#b3541e", lw=2.2, label=f"bulk n = {rounded(n, error)}")
        axes.axhline(float(bulk["bed_top"]) * MM, color="black", lw=0.8, ls=(0, (1, 3)), label="surface of the bed")
    axes.set(xlim=(0, 1), ylim=(0, None), xlabel="porosity n [-]", ylabel="height above the floor z [mm]")


def packing_figure(packing, azimuth=-60.0, elevation=22.0, title="", pixels=900):
    """Draw the packing with a scale bar; elevation 90 is from above.

    The colour shows the sieve size of the grains; L/S if they are of one sieve class and differ in form; or the angle
    of their longest axes if they are also of one form.
    """
    figure = Figure(layout="constrained")
    axes = figure.subplots()
    measure, label, norm = _colours([packing])
    draw_packing(axes, packing, norm, azimuth, elevation, pixels, measure)
    width, height = np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())
    figure.set_size_inches(4.4 * width / max(width, height) + 1.0, 4.4 * height / max(width, height) + 0.4)
    axes.set_title(title)
    bar = figure.colorbar(ScalarMappable(norm, STONES), ax=axes, shrink=0.6, pad=0.02)
    bar.set_label(label)
    return figure


def packings_figure(packings, azimuth=-90.0, elevation=90.0, pixels=600):
    """Draw several packings side by side in one scale, of colour and of length.

    packings: list of (label, Dataset). Colours are those of `packing_figure`.
    """
    columns = min(len(packings), 2)
    rows = -(-len(packings) // columns)
    figure = Figure(figsize=(1.0 + 3.2 * columns, 3.3 * rows), layout="constrained")
    grid = figure.subplots(rows, columns, squeeze=False)
    measure, colour_label, norm = _colours([packing for _, packing in packings])
    for axes in grid.flat:
        axes.set_axis_off()
    for axes, (label, packing) in zip(grid.flat, packings, strict=False):
        draw_packing(axes, packing, norm, azimuth, elevation, pixels, measure)
        axes.set_title(label, fontsize="medium")
    _share_span(grid.flat[: len(packings)])
    bar = figure.colorbar(ScalarMappable(norm, STONES), ax=grid, shrink=0.6, pad=0.02)
    bar.set_label(colour_label)
    return figure


def _share_span(panels):
    """Give all panels the same width and height in mm, so that a grain has the same size in each."""
    limits = [(axes.get_xlim(), axes.get_ylim()) for axes in panels]
    width, height = (max(np.ptp(limit[k]) for limit in limits) for k in (0, 1))
    for axes, (x, y) in zip(panels, limits, strict=True):
        axes.set_xlim(np.mean(x) - 0.5 * width, np.mean(x) + 0.5 * width)
        axes.set_ylim(y[0], y[0] + height)


def _sizes(packing):
    return MM * packing["D"].values


def _elongations(packing):
    return packing["L"].values / packing["S"].values


def _angles(packing):
    """Return the angles of the longest axes against the vertical (n,) [degree]; nan for a grain that has none."""
    directions, grains = grain_axes(packing)["long_axis"]
    angles = np.full(packing.sizes["grain"], np.nan)
    angles[grains] = np.degrees(np.arccos(np.clip(np.abs(directions[:, 2]), 0.0, 1.0)))
    return angles


def _colours(packings):
    """Return what the colours of the grains show, a function of a packing, its label, and its scale."""
    sizes, ratios = (np.concatenate([of(packing) for packing in packings]) for of in (_sizes, _elongations))
    if sizes.max() <= ONE_CLASS * sizes.min():
        if np.ptp(ratios) > ONE_FORM:
            return _elongations, "longest over shortest axis L/S [-]", size_norm(ratios)
        if np.isfinite(np.concatenate([_angles(packing) for packing in packings])).all():
            return _angles, "angle of the longest axis\nagainst the vertical [°]", Normalize(0.0, 90.0)
    return _sizes, "sieve size D [mm]", size_norm(sizes)


def draw_packing(axes, packing, norm, azimuth, elevation, pixels, measure=_sizes):
    """Draw a packing, the outline of its floor and a scale bar into `axes`, [mm]; measure: what the colour shows."""
    image, extent = render(packing, STONES(norm(measure(packing)))[:, :3], azimuth, elevation, pixels)
    floor = MM * project(_floor_outline(packing), azimuth, elevation)
    axes.plot(*floor.T, color="0.6", lw=0.8, zorder=1)
    axes.imshow(image, extent=[MM * edge for edge in extent], zorder=2, interpolation="antialiased")
    low = np.minimum(floor.min(axis=0), MM * np.array([extent[0], extent[2]]))
    high = np.maximum(floor.max(axis=0), MM * np.array([extent[1], extent[3]]))
    length = _round_length(0.25 * (high - low)[0])
    y = low[1] - 0.04 * (high - low)[1]
    axes.plot([low[0], low[0] + length], [y, y], color="black", lw=2.5, solid_capstyle="butt")
    axes.annotate(
        f"{length:g} mm", (low[0] + 0.5 * length, y), (0, -4), textcoords="offset points", ha="center", va="top"
    )
    margin = 0.03 * (high - low).max()
    axes.set(xlim=(low[0] - margin, high[0] + margin), ylim=(y - 4 * margin, high[1] + margin), aspect="equal")
    axes.set_axis_off()


def size_norm(sizes):
    """Return the colour scale over sizes; it is widened around a single size, which is then in the middle."""
    low, high = float(np.min(sizes)), float(np.max(sizes))
    spread = max(0.5 * (high - low), 0.05 * high)
    return Normalize(0.5 * (low + high) - spread, 0.5 * (low + high) + spread)


def _floor_outline(packing):
    """Return a closed line around the floor, (n, 3) [m]."""
    width = packing.attrs["domain_width"]
    if packing.attrs["domain_shape"] == "periodic":
        corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]) * width
    else:
        angle = np.linspace(0, 2 * np.pi, 181)
        corners = 0.5 * width * np.column_stack([np.cos(angle), np.sin(angle)])
    return np.column_stack([corners, np.zeros(len(corners))])


def _round_length(length):
    """Return the largest of 1, 2, 5 times a power of ten that is at most `length`."""
    power = 10.0 ** np.floor(np.log10(length))
    return max(step * power for step in (1, 2, 5) if step * power <= length)
