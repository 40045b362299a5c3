"""Pictures of single grains: a sheet of grains with their form, and one grain from its mesh to its ellipsoid."""

import numpy as np
import xarray as xr
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from simcore.grains.form import ellipsoid_sphericity
from simcore.grains.mesh import decimate
from simcore.report.figures.rendering import camera_axes, project, render

MM = 1e3
SLATE, RUST, SAND = "#20313b", "#b3541e", "#d8c39a"
# Quaternions that turn a grain, whose S, I and L are along x, y and z. In a picture from above the first shows L to the
# right and I upwards, the second I to the right and S upwards.
FROM_ABOVE, ALONG_L = np.array([[0.0, 1.0, 0.0, 1.0], [0.0, 1.0, 1.0, 0.0]]) / np.sqrt(2.0)
ABOVE = {"azimuth": -90.0, "elevation": 90.0}
ASLANT = {"azimuth": -55.0, "elevation": 24.0}
COLUMNS, ROWS = 4, 3  # at most, of the sheet: classes of flatness and of elongation
MOST_LINES = 5000  # triangles; the lines of a finer mesh would hide it


def grain_sheet(grains):
    """Draw grains of different form from two sides, scaled to one sieve size, each with its FL and EL. Returns Figure.

    grains: list of Grain. They are divided into ROWS classes of elongation with equally many grains, and each of these
    into COLUMNS classes of flatness; the sheet shows the middle grain of each. With few grains there are fewer classes.
    """
    columns = min(COLUMNS, len(grains))
    rows = min(ROWS, len(grains) // columns)
    sheet = _of_each_class(grains, columns, rows)
    size = max(grain.sieve_size for grain in sheet)
    scaled = [grain.scaled(size / grain.sieve_size) for grain in sheet]
    length, breadth = max(grain.L for grain in scaled), max(grain.I for grain in scaled)
    width, height = 1.1 * (length + breadth), 1.75 * breadth
    places = [(width * (k % columns), -height * (k // columns)) for k in range(columns * rows)]
    inches = 9.0 * columns / COLUMNS
    figure = Figure(figsize=(inches, inches * rows * height / (columns * width) + 0.4), layout="constrained")
    axes = figure.subplots()
    bodies = [(grain, FROM_ABOVE, place) for grain, place in zip(scaled, places, strict=True)]
    beside = 0.5 * length + 0.62 * breadth
    bodies += [(grain, ALONG_L, (x + beside, y)) for grain, (x, y) in zip(scaled, places, strict=True)]
    _draw(axes, bodies, ABOVE, 1300)
    for grain, (x, y) in zip(scaled, places, strict=True):
        text = f"{grain.name}: EL = {grain.elongation:.2f}, FL = {grain.flatness:.2f}"
        place = MM * (x + 0.5 * beside), MM * (y - 0.66 * breadth)
        axes.text(*place, text, ha="center", va="top", fontsize="small")
    for x, text in ((0.0, "from above"), (beside, "along L")):
        axes.text(MM * x, MM * 0.72 * breadth, text, ha="center", fontsize="small", style="italic")
    axes.set(
        xlim=(-0.55 * MM * length, MM * (width * (columns - 1) + beside + 0.6 * breadth)),
        ylim=(-MM * height * (rows - 0.42), 0.9 * MM * breadth),
        xlabel="flat (small FL = S/I)  $\\longrightarrow$  not flat",
        ylabel="elongated (small EL = I/L)  $\\longrightarrow$  not elongated",
        xticks=[], yticks=[],
    )  # fmt: skip
    axes.spines[:].set_visible(False)
    return figure


def grain_steps(grain, faces=(300, 100)):
    """Draw a grain's mesh, its hulls with at most `faces` triangles, and its mass-equivalent ellipsoid. Returns Figure.

    grain: Grain, with more triangles than each of `faces` if they are to differ. All are drawn at one scale; lines are
    the edges of the triangles. Below each are its volume, relative to the mesh, FL, EL and sphericity.
    """
    hulls = [grain, *(decimate(grain, number) for number in faces)]
    titles = [f"mesh of the grain,\n{len(grain.faces)} triangles"]
    titles += [f"hull with at most\n{number} triangles" for number in faces]
    figure = Figure(figsize=(2.7 * (len(hulls) + 1), 2.5), layout="constrained")
    panels = figure.subplots(1, len(hulls) + 1)
    for axes, hull, title in zip(panels, hulls, titles, strict=False):
        _draw(axes, [(hull, FROM_ABOVE, (0.0, 0.0))], ASLANT, 500)
        if len(hull.faces) <= MOST_LINES:
            axes.add_collection(LineCollection(_visible_edges(hull), colors=SLATE, linewidths=0.35, zorder=3))
        _label(axes, title, hull.volume / grain.volume, hull, hull.sphericity)
    _draw(panels[-1], [(grain, FROM_ABOVE, (0.0, 0.0))], ASLANT, 500, ellipsoids=True)
    _draw_axes(panels[-1], grain)
    volume = np.pi / 6.0 * grain.L * grain.I * grain.S
    sphericity = ellipsoid_sphericity(grain.L, grain.I, grain.S)
    _label(panels[-1], "mass-equivalent ellipsoid\nwith the axes L, I, S", volume / grain.volume, grain, sphericity)
    outline = MM * project(_to_world(grain.vertices), **ASLANT)
    low, high = 1.08 * outline.min(axis=0), 1.08 * outline.max(axis=0)
    for axes in panels:
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
        axes.set_axis_off()
    return figure


def _of_each_class(grains, columns, rows):
    """Return the middle grain of each class, from not elongated to elongated, and in each row from flat to not flat."""
    by_elongation = sorted(grains, key=lambda grain: -grain.elongation)
    sheet = []
    for part in np.array_split(np.arange(len(grains)), rows):
        by_flatness = sorted((by_elongation[k] for k in part), key=lambda grain: grain.flatness)
        sheet += [by_flatness[k[len(k) // 2]] for k in np.array_split(np.arange(len(by_flatness)), columns)]
    return sheet


def _draw(axes, bodies, view, pixels, ellipsoids=False):
    """Draw bodies, (grain, quaternion, place in the picture [m]) each, into axes in mm; or their ellipsoids."""
    image, extent = render(
        as_packing(bodies, view, ellipsoids), np.tile(to_rgb(SAND), (len(bodies), 1)), **view, pixels=pixels
    )
    axes.imshow(image, extent=[MM * edge for edge in extent], zorder=2, interpolation="antialiased")
    axes.set_aspect("equal")


def as_packing(bodies, view, ellipsoids=False):
    """Return bodies in the layout of a packing's file, as far as a picture needs it, Dataset.

    bodies: list of (Grain, quaternion (4,), place in the picture (2,) [m]); view: azimuth and elevation of the camera.
    ellipsoids: whether each grain is replaced by its mass-equivalent ellipsoid.
    """
    grains, orientations, places = zip(*bodies, strict=True)
    right, up, _ = camera_axes(**view)
    counts = {
        "vertex": np.array([len(grain.vertices) for grain in grains]),
        "face": np.array([len(grain.faces) for grain in grains]),
    }
    half_axes = 0.5 * np.array([[grain.S, grain.I, grain.L] for grain in grains])
    data = {
        "position": (("grain", "xyz"), np.array([x * right + y * up for x, y in places])),
        "orientation": (("grain", "wxyz"), np.array(orientations)),
        "scale": (("grain", "xyz"), half_axes if ellipsoids else np.ones((len(grains), 3))),
        "shape": ("grain", np.arange(len(grains))),
        "shape_kind": ("shape", np.full(len(grains), "sphere" if ellipsoids else "convex")),
        "shape_vertices": (("vertex", "xyz"), np.concatenate([grain.vertices for grain in grains])),
        "shape_faces": (("face", "corner"), np.concatenate([grain.faces for grain in grains])),
    }
    for name, count in counts.items():
        data |= {f"shape_{name}_start": ("shape", np.cumsum(count) - count), f"shape_{name}_count": ("shape", count)}
    return xr.Dataset(data)


def _to_world(points):
    """Return points (n, 3) of a grain's frame, turned by FROM_ABOVE."""
    return np.asarray(points) @ np.array([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]])


def _visible_edges(grain):
    """Return the edges of the triangles that are turned to the camera, (k, 2, 2) in the picture [mm]."""
    corners = _to_world(grain.vertices)[grain.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    visible = grain.faces[normals @ camera_axes(**ASLANT)[2] > 0.0]
    edges = np.unique(np.sort(visible[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    return MM * project(_to_world(grain.vertices), **ASLANT)[edges]


def _draw_axes(axes, grain):
    """Draw the three axes of the ellipsoid as lines through it, with their symbols."""
    for k, (name, length) in enumerate((("S", grain.S), ("I", grain.I), ("L", grain.L))):
        ends = np.zeros((2, 3))
        ends[:, k] = [-0.5 * length, 0.5 * length]
        x, y = (MM * project(_to_world(ends), **ASLANT)).T
        axes.plot(x, y, color=RUST, lw=1.4, marker="o", ms=3, zorder=4)
        end = np.argmax(y if name == "S" else x)
        axes.annotate(
            name, (x[end], y[end]), (0, 5), textcoords="offset points", ha="center", color=RUST, weight="bold", zorder=5
        )


def _label(axes, title, volume, form, sphericity):
    axes.set_title(title, fontsize="medium")
    text = (
        f"volume {100 * volume:.1f} %, FL {form.flatness:.3f},\nEL {form.elongation:.3f}, sphericity {sphericity:.3f}"
    )
    axes.text(0.5, -0.02, text, ha="center", va="top", fontsize="small", transform=axes.transAxes)
