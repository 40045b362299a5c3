"""Figure of the evaluation interval: a vertical cut through a bed beside its porosity over height."""

import numpy as np
from matplotlib.figure import Figure

from simcore.dem.state.bodies import rotation_matrix
from simcore.evaluation.rounding import rounded
from simcore.report.figures.packings import MM, draw_profile
from simcore.report.figures.rendering import collect_surfaces

SLATE, RUST, SAND = "#20313b", "#b3541e", "#e8dcc4"
BESIDE = 1.06  # where the arrows are, right of the largest porosity


def interval_figure(packing, profiles, bulk):
    """Draw a vertical cut through the middle of a bed, its porosity over height, and what is evaluated. Returns Figure.

    packing: Dataset of read_packing; profiles, bulk: as in profile_figure.
    """
    figure = Figure(figsize=(8.8, 5.2), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True, width_ratios=(1.0, 1.5))
    width = packing.attrs["domain_width"]
    low, middle, high = np.array([0.0, 0.5, 1.0] if packing.attrs["domain_shape"] == "periodic" else [-0.5, 0.0, 0.5])
    for outline in cut_outlines(packing, middle * width):
        left.fill(*(MM * outline.T), facecolor=SAND, edgecolor=SLATE, lw=0.7)
    left.set(xlim=(MM * low * width, MM * high * width), xlabel="distance across the bed [mm]", aspect="equal")
    left.set_ylabel("height above the floor z [mm]")
    left.set_title("cut through the bed", fontsize="medium")
    draw_profile(right, profiles, bulk)
    floor, surface, top = (MM * float(bulk[name]) for name in ("z_lower", "z_upper", "bed_top"))
    for axes in (left, right):
        axes.axhspan(floor, surface, color="0.92", zorder=0)
        axes.axhline(top, color="black", lw=0.8, ls=(0, (1, 3)))
    right.axvline(0.5, color="0.6", lw=0.9, ls="--", zorder=0)
    right.plot(0.5, top, "o", ms=9, mfc="none", mec=RUST, mew=1.6)
    value = rounded(float(bulk["n"]), float(bulk["n_std_error"]))
    _span(right, 0.0, floor, "left out at the floor")
    _span(right, floor, surface, f"evaluated: n = {value}", RUST)
    _span(right, surface, top, "left out at the surface")
    right.text(BESIDE + 0.04, 1.02 * top, "surface: half is solid", va="bottom", fontsize="small", color=RUST)
    right.set(xlim=(0, 1.85), ylim=(0, 1.12 * top), xticks=[0, 0.25, 0.5, 0.75, 1], ylabel="")
    right.set_xlabel("porosity n of a slice [-]", loc="left")
    handles, labels = right.get_legend_handles_labels()
    shown = [k for k, label in enumerate(labels) if label in profiles]
    right.legend(
        [handles[k] for k in shown], [labels[k] for k in shown], loc="lower left", bbox_to_anchor=(0.0, 1.0),
        ncols=2, frameon=False, fontsize="small",
    )  # fmt: skip
    return figure


def cut_outlines(packing, y):
    """Return the outlines of the grains that the vertical plane at `y` [m] cuts, list of (k, 2), x and z [m].

    packing: Dataset of read_packing. A grain that a side of a periodic box divides is there twice, at both sides.
    """
    surfaces, width = collect_surfaces(packing), packing.attrs["domain_width"]
    images = (-width, 0.0, width) if packing.attrs["domain_shape"] == "periodic" else (0.0,)
    rotations = rotation_matrix(surfaces.orientation)
    outlines = []
    for i, s in enumerate(surfaces.shape):
        vertices = surfaces.vertices[surfaces.vertex_start[s] :][: surfaces.vertex_count[s]]
        faces = surfaces.faces[surfaces.face_start[s] :][: surfaces.face_count[s]]
        points = (vertices * surfaces.scale[i]) @ rotations[i].T + surfaces.position[i]
        for shift in images:  # along y; those along x follow
            outline = plane_outline(points + [0.0, shift, 0.0], faces, y)
            if outline is not None:
                steps = [step for step in images if _is_inside(outline[:, 0] + step, images, width)]
                outlines += [outline + [step, 0.0] for step in steps]
    return outlines


def plane_outline(points, faces, y):
    """Return the outline (k, 2), x and z, of a convex body where the plane at `y` cuts it; None if it does not.

    points (n, 3) and faces (m, 3): its surface.
    """
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    distance = points[:, 1] - y
    a, b = edges[distance[edges[:, 0]] * distance[edges[:, 1]] < 0.0].T
    if not len(a):
        return None
    share = (distance[a] / (distance[a] - distance[b]))[:, None]
    crossing = (points[a] + share * (points[b] - points[a]))[:, [0, 2]]
    around = crossing - crossing.mean(axis=0)
    return crossing[np.argsort(np.arctan2(around[:, 1], around[:, 0]))]


def _is_inside(x, images, width):
    """Return whether an outline with these x reaches into the domain; without images it always does."""
    return len(images) == 1 or (x.max() > 0.0 and x.min() < width)


def _span(axes, low, high, text, color="black"):
    """Draw a double arrow between two heights [mm] beside the profile, with its length."""
    if high <= low:
        return
    style = {"arrowstyle": "<->", "color": color, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (BESIDE, low), (BESIDE, high), arrowprops=style)
    text = f"{text}\n{high - low:.0f} mm"
    axes.text(BESIDE + 0.04, 0.5 * (low + high), text, va="center", fontsize="small", color=color)
