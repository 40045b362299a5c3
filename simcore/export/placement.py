"""Places of grains in space: each grain once, or with its periodic images.

`leave`  each grain is whole and at one place; a grain at a side of the periodic box extends out of it
`copy`   a grain at a side of the box is also at the opposite side, whole, so that no part of the box is empty
`cut`    as `copy`, but all grains are cut at the sides, so that only their parts in the box remain
"""

from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

PERIODIC = ("cut", "copy", "leave")


class Places(NamedTuple):
    """Places of grains; a grain with periodic images has several."""

    grain: np.ndarray  # (m,) int64, index of the grain
    shift: np.ndarray  # (m, 3) [m], from the stored centre to this place; whole periods along x and y
    sides: float | None  # [m], grains are cut at x, y = 0 and at x, y = sides; None: they are whole


def places(packing, periodic="leave"):
    """Return the Places of all grains. packing: Dataset of read_packing.

    The domain of a cylinder has no images: its grains have one place each, and are never cut. ValueError if `periodic`
    is none of PERIODIC.
    """
    if periodic not in PERIODIC:
        raise ValueError(f"periodic: {periodic!r} is unknown; choose one of {', '.join(PERIODIC)}")
    n = packing.sizes["grain"]
    if periodic == "leave" or packing.attrs["domain_shape"] != "periodic":
        return Places(np.arange(n), np.zeros((n, 3)), None)
    width = float(packing.attrs["domain_width"])
    low, high = horizontal_extents(packing)
    # Image k of a grain is in the box if low + k width < width and high + k width > 0.
    first, last = np.floor(-high / width).astype(int) + 1, np.ceil(1.0 - low / width).astype(int) - 1
    grain, shift = [], []
    for g in range(n):
        for i in range(first[g, 0], last[g, 0] + 1):
            for j in range(first[g, 1], last[g, 1] + 1):
                grain.append(g)
                shift.append((i * width, j * width, 0.0))
    return Places(np.array(grain, np.int64), np.array(shift).reshape(-1, 3), width if periodic == "cut" else None)


def rotations(packing):
    """Return the matrices (n, 3, 3) that turn the axes of the base shapes into those of the world."""
    return Rotation.from_quat(packing["orientation"].values, scalar_first=True).as_matrix()


def is_polyhedron(packing):
    """Return whether each grain is a polyhedron, (n,) bool; the others are spheres and ellipsoids."""
    return packing["shape_kind"].values.astype(str)[packing["shape"].values] == "convex"


def shape_part(packing, name, shape):
    """Return the vertices (m, 3) or the faces (k, 3) of base shape number `shape`. name: "vertex" or "face"."""
    values = {"vertex": "shape_vertices", "face": "shape_faces"}[name]
    start, count = (int(packing[f"shape_{name}_{part}"].values[shape]) for part in ("start", "count"))
    return packing[values].values[start : start + count]


def horizontal_extents(packing):
    """Return the least and greatest x and y of each grain, two arrays (n, 2) [m]."""
    position, scale, shape = (packing[name].values for name in ("position", "scale", "shape"))
    to_world = rotations(packing)
    half = np.linalg.norm(to_world * scale[:, None, :], axis=2)[:, :2]  # of spheres and ellipsoids
    low, high = position[:, :2] - half, position[:, :2] + half
    for g in np.flatnonzero(is_polyhedron(packing)):
        points = (shape_part(packing, "vertex", shape[g]) * scale[g]) @ to_world[g].T + position[g]
        low[g], high[g] = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    return low, high
