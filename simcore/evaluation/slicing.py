"""Solid volume between horizontal planes: closed forms for spheres, ellipsoids and convex polyhedra.

An ellipsoid is an affine image of the unit ball, so it has the ball's share of volume between two planes, which depends
only on its half height. The volume of a polyhedron below a plane is a sum over its faces of piecewise cubic functions
of the plane's height (divergence theorem with the field (0, 0, zeta - z), whose flux through the cut itself is zero).
"""

from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from simcore.compilation import kernel, leaf
from simcore.grains.form import equal_volume_diameter

METHODS = ("spheres", "exact")


class Geometry(NamedTuple):
    """Positions of n grains, and the concatenated corners and triangles of their shapes."""

    position: np.ndarray  # (n, 3) [m]
    orientation: np.ndarray  # (n, 4), quaternions w, x, y, z
    scale: np.ndarray  # (n, 3) [m], along the axes of the shape
    shape: np.ndarray  # (n,), index of the shape
    vertex_start: np.ndarray  # of each shape
    vertex_count: np.ndarray
    vertices: np.ndarray  # (m, 3), in units of the scale
    face_start: np.ndarray  # of each shape
    face_count: np.ndarray
    faces: np.ndarray  # (k, 3), vertices of the shape


def slab_volumes(packing, edges, method="spheres", per_grain=False):
    """Return the solid volume between successive horizontal planes, (k,) or, per grain, (n, k) [m³].

    packing: Dataset of read_packing; edges: (k + 1,), increasing heights of the planes [m], ValueError otherwise;
    method: "spheres" slices the volume-equivalent spheres (Rettinger et al. 2022), "exact" the grains themselves. The
    overlap of two grains counts twice, as in Rettinger et al.; its volume grows with the square of its depth.
    """
    edges = np.ascontiguousarray(edges, dtype=np.float64)
    if edges.ndim != 1 or len(edges) < 2 or not np.all(np.diff(edges) > 0.0):
        raise ValueError("slab_volumes: edges must be at least two increasing heights [m]; sort them")
    heights = packing["position"].values[:, 2]
    volumes = packing["volume"].values
    rows = np.arange(len(volumes)) if per_grain else np.zeros(len(volumes), np.int64)
    out = np.zeros((len(volumes) if per_grain else 1, len(edges) - 1))
    polyhedral = _polyhedral(packing, method)
    ellipsoidal = np.flatnonzero(~polyhedral)
    half_heights = _half_heights(packing, method)
    _add_balls(out, rows, ellipsoidal, heights, half_heights, volumes, edges)
    if polyhedral.any():
        _add_polyhedra(out, rows, np.flatnonzero(polyhedral), _geometry(packing), edges)
    return out if per_grain else out[0]


def vertical_extent(packing, method="spheres"):
    """Return the lowest and highest point of each grain, two arrays (n,) [m]; method as in slab_volumes."""
    z = packing["position"].values[:, 2]
    half = _half_heights(packing, method)
    low, high = z - half, z + half
    polyhedral = np.flatnonzero(_polyhedral(packing, method))
    if len(polyhedral):
        _polyhedral_extent(low, high, polyhedral, _geometry(packing))
    return low, high


def vertical_axes(orientation):
    """Return the vertical in the frame of each body, the third row of its rotation matrix, (n, 3).

    orientation: quaternions (n, 4) as w, x, y, z.
    """
    return Rotation.from_quat(orientation, scalar_first=True).as_matrix()[:, 2]


def _polyhedral(packing, method):
    """Return whether each grain is sliced as a polyhedron, (n,) bool."""
    if method not in METHODS:
        raise ValueError(f"porosity method {method!r} is unknown; choose one of {', '.join(METHODS)}")
    kinds = packing["shape_kind"].values.astype(str)[packing["shape"].values]
    return (kinds == "convex") & (method == "exact")


def _half_heights(packing, method):
    """Return the half height of the sphere or ellipsoid that represents each grain, (n,) [m]."""
    if method == "spheres":
        return 0.5 * equal_volume_diameter(packing["volume"].values)
    return np.linalg.norm(vertical_axes(packing["orientation"].values) * packing["scale"].values, axis=1)


def _geometry(packing):
    """Return the Geometry of all grains; shapes other than polyhedra have no vertices and faces."""
    return Geometry(
        packing["position"].values,
        packing["orientation"].values,
        packing["scale"].values,
        packing["shape"].values.astype(np.int64),
        packing["shape_vertex_start"].values.astype(np.int64),
        packing["shape_vertex_count"].values.astype(np.int64),
        packing["shape_vertices"].values,
        packing["shape_face_start"].values.astype(np.int64),
        packing["shape_face_count"].values.astype(np.int64),
        packing["shape_faces"].values.astype(np.int64),
    )


@leaf
def _ball_fraction(low, high):
    """Return the share of the unit ball's volume between the planes low <= high, both in [-1, 1]."""
    return 0.25 * (high - low) * (3.0 - (low * low + low * high + high * high))


@kernel
def _add_balls(out, rows, grains, heights, half_heights, volumes, edges):
    """Add to out[row, slab] the volume of each sphere or ellipsoid there."""
    for g in grains:
        z, half = heights[g], half_heights[g]
        lowest_slab = max(np.searchsorted(edges, z - half) - 1, 0)
        for k in range(lowest_slab, len(edges) - 1):
            if edges[k] >= z + half:
                break
            low = min(max((edges[k] - z) / half, -1.0), 1.0)
            high = min(max((edges[k + 1] - z) / half, -1.0), 1.0)
            out[rows[g], k] += volumes[g] * _ball_fraction(low, high)


@kernel
def world_vertices(points, g, geometry):
    """Fill points[:count] with the grain's vertices, rotated and scaled, relative to its centre [m]; return count."""
    s, scale, vertices = geometry.shape[g], geometry.scale, geometry.vertices
    start, count = geometry.vertex_start[s], geometry.vertex_count[s]
    w, x, y, z = geometry.orientation[g]
    for i in range(count):
        a = scale[g, 0] * vertices[start + i, 0]
        b = scale[g, 1] * vertices[start + i, 1]
        c = scale[g, 2] * vertices[start + i, 2]
        points[i, 0] = (1 - 2 * (y * y + z * z)) * a + 2 * (x * y - w * z) * b + 2 * (x * z + w * y) * c
        points[i, 1] = 2 * (x * y + w * z) * a + (1 - 2 * (x * x + z * z)) * b + 2 * (y * z - w * x) * c
        points[i, 2] = 2 * (x * z - w * y) * a + 2 * (y * z + w * x) * b + (1 - 2 * (x * x + y * y)) * c
    return count


@leaf
def _volume_over_face(z, a, b, c):
    """Return the volume between the plane at z and the part of a face below it, per projected area of the face.

    The area is projected onto the horizontal. a <= b <= c: heights of the face's corners.
    """
    if z <= a:
        return 0.0
    if z < b:
        return (z - a) ** 3 / (3.0 * (b - a) * (c - a))
    mean = (a + b + c) / 3.0
    if z < c:
        return (z - mean) + (c - z) ** 3 / (3.0 * (c - a) * (c - b))
    return z - mean


@kernel
def _add_polyhedra(out, rows, grains, geometry, edges):
    """Add to out[row, slab] the volume of each convex polyhedron there."""
    position, faces = geometry.position, geometry.faces
    points = np.empty((np.max(geometry.vertex_count), 3))
    below = np.empty(len(edges))
    for g in grains:
        s = geometry.shape[g]
        count = world_vertices(points, g, geometry)
        low, high = points[:count, 2].min(), points[:count, 2].max()
        lowest_edge = max(np.searchsorted(edges, position[g, 2] + low) - 1, 0)
        highest_edge = min(np.searchsorted(edges, position[g, 2] + high), len(edges) - 1)
        below[lowest_edge : highest_edge + 1] = 0.0
        for f in range(geometry.face_start[s], geometry.face_start[s] + geometry.face_count[s]):
            p, q, r = points[faces[f, 0]], points[faces[f, 1]], points[faces[f, 2]]
            area = 0.5 * ((q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1]))
            a, c = min(p[2], q[2], r[2]), max(p[2], q[2], r[2])
            b = max(min(p[2], q[2]), min(max(p[2], q[2]), r[2]))
            for k in range(lowest_edge, highest_edge + 1):
                z = min(edges[k] - position[g, 2], high)
                below[k] -= area * _volume_over_face(z, a, b, c)
        for k in range(lowest_edge, highest_edge):
            out[rows[g], k] += below[k + 1] - below[k]


@kernel
def _polyhedral_extent(low, high, grains, geometry):
    """Set low[g], high[g] to the lowest and highest vertex of each polyhedron [m]."""
    position = geometry.position
    points = np.empty((np.max(geometry.vertex_count), 3))
    for g in grains:
        count = world_vertices(points, g, geometry)
        low[g] = position[g, 2] + points[:count, 2].min()
        high[g] = position[g, 2] + points[:count, 2].max()
