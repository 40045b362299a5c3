"""Picture of a packing: the surfaces of all grains in an orthographic depth buffer, shaded by slope and depth."""

import numpy as np
import trimesh
from scipy.ndimage import gaussian_filter

from simcore.compilation import kernel
from simcore.evaluation.slicing import Geometry, world_vertices

LIGHT = np.array([-0.45, 0.55, 0.70])  # direction to the light in camera axes: from the upper left
AMBIENT = 0.35
OVERSAMPLING = 2  # the picture is drawn at this multiple of the resolution and averaged


def render(packing, colors, azimuth=-60.0, elevation=22.0, pixels=900):
    """Draw an orthographic picture of all grains; returns the image (rows, columns, 4) in [0, 1], and its extent.

    The image is transparent where there are no grains. packing: Dataset as in simcore.packing.file; colors (n, 3): RGB
    of each grain; azimuth, elevation [degree] of the camera, elevation 90 is from above; pixels: number of pixels of
    the longer side. extent: (left, right, bottom, top) [m] in the coordinates of `project`.
    """
    grain, depth, normal, extent = _depth_buffer(packing, camera_axes(azimuth, elevation), pixels * OVERSAMPLING)
    covered = grain >= 0
    size = max(extent[1] - extent[0], extent[3] - extent[2])
    slope = np.clip(normal @ (LIGHT / np.linalg.norm(LIGHT)), 0.0, 1.0)
    shade = (AMBIENT + (1.0 - AMBIENT) * slope) * _crevices(depth, covered, size) * _outlines(grain)
    image = np.zeros((*grain.shape, 4))
    image[covered, :3] = np.clip(np.asarray(colors)[grain[covered]] * shade[covered, None], 0.0, 1.0)
    image[covered, 3] = 1.0
    return _crop(_average(image), extent)


def camera_axes(azimuth, elevation):
    """Return the camera's right, up and backward direction in world axes as rows, (3, 3); angles [degree]."""
    a, e = np.radians([azimuth, elevation])
    back = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    return np.stack([right, np.cross(back, right), back])


def project(points, azimuth, elevation):
    """Return the picture coordinates (n, 2) [m] of world points (n, 3) [m]."""
    return np.asarray(points) @ camera_axes(azimuth, elevation)[:2].T


def _depth_buffer(packing, camera, pixels):
    """Return grain index (-1: none), depth [m] and normal (camera axes) for each pixel, and the picture's extent."""
    surfaces = collect_surfaces(packing)
    farthest = np.maximum.reduceat(np.linalg.norm(surfaces.vertices, axis=1), surfaces.vertex_start)  # of each shape
    reach = (packing["scale"].values.max(axis=1) * farthest[surfaces.shape])[:, None]
    centres = packing["position"].values @ camera[:2].T
    low, high = (centres - reach).min(axis=0), (centres + reach).max(axis=0)
    pixel = (high - low).max() / pixels
    columns, rows = np.ceil((high - low) / pixel).astype(int) // OVERSAMPLING * OVERSAMPLING + OVERSAMPLING
    grain = np.full((rows, columns), -1, np.int64)
    depth = np.full((rows, columns), -np.inf)
    normal = np.zeros((rows, columns, 3))
    _draw(grain, depth, normal, low, pixel, camera, surfaces)
    return grain[::-1], depth[::-1], normal[::-1], (low[0], low[0] + columns * pixel, low[1], low[1] + rows * pixel)


def collect_surfaces(packing):
    """Return the Geometry of a packing, Dataset of read_packing, with a fine mesh instead of the unit sphere."""
    sphere = trimesh.creation.icosphere(subdivisions=4)
    vertices, faces = [], []
    for s, kind in enumerate(packing["shape_kind"].values.astype(str)):
        convex = kind == "convex"
        vertices.append(_part(packing, "vertex", "shape_vertices", s) if convex else sphere.vertices)
        faces.append(_part(packing, "face", "shape_faces", s) if convex else sphere.faces)
    counts = [np.array([len(part) for part in parts]) for parts in (vertices, faces)]
    starts = [np.cumsum(count) - count for count in counts]
    return Geometry(
        packing["position"].values,
        packing["orientation"].values,
        packing["scale"].values,
        packing["shape"].values.astype(np.int64),
        starts[0],
        counts[0],
        np.concatenate(vertices),
        starts[1],
        counts[1],
        np.concatenate(faces).astype(np.int64),
    )


def _part(packing, name, values, shape):
    """Return the vertices or the faces of one shape."""
    start, count = int(packing[f"shape_{name}_start"][shape]), int(packing[f"shape_{name}_count"][shape])
    return packing[values].values[start : start + count]


@kernel
def _draw(grain, depth, normal, low, pixel, camera, surfaces):
    """Draw the faces that are turned to the camera; each pixel shows the nearest one."""
    position, faces = surfaces.position, surfaces.faces
    points = np.empty((np.max(surfaces.vertex_count), 3))
    projected = np.empty((np.max(surfaces.vertex_count), 3))
    rows, columns = grain.shape
    for g in range(len(position)):
        s = surfaces.shape[g]
        for i in range(world_vertices(points, g, surfaces)):
            for a in range(3):
                projected[i, a] = 0.0
                for b in range(3):
                    projected[i, a] += camera[a, b] * (points[i, b] + position[g, b])
            projected[i, 0] = (projected[i, 0] - low[0]) / pixel
            projected[i, 1] = (projected[i, 1] - low[1]) / pixel
        for f in range(surfaces.face_start[s], surfaces.face_start[s] + surfaces.face_count[s]):
            p, q, r = projected[faces[f, 0]], projected[faces[f, 1]], projected[faces[f, 2]]
            area = (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1])
            if area <= 0.0:
                continue
            # Depth is in metres, the other two coordinates in pixels; the normal needs one unit.
            nx = ((q[1] - p[1]) * (r[2] - p[2]) - (r[1] - p[1]) * (q[2] - p[2])) / pixel
            ny = ((q[2] - p[2]) * (r[0] - p[0]) - (r[2] - p[2]) * (q[0] - p[0])) / pixel
            norm = np.sqrt(nx * nx + ny * ny + area * area)
            for j in range(max(int(min(p[1], q[1], r[1])), 0), min(int(max(p[1], q[1], r[1])) + 1, rows)):
                for i in range(max(int(min(p[0], q[0], r[0])), 0), min(int(max(p[0], q[0], r[0])) + 1, columns)):
                    x, y = i + 0.5, j + 0.5
                    u = ((q[0] - x) * (r[1] - y) - (r[0] - x) * (q[1] - y)) / area
                    v = ((r[0] - x) * (p[1] - y) - (p[0] - x) * (r[1] - y)) / area
                    w = 1.0 - u - v
                    if u < 0.0 or v < 0.0 or w < 0.0:
                        continue
                    d = u * p[2] + v * q[2] + w * r[2]
                    if d > depth[j, i]:
                        depth[j, i], grain[j, i] = d, g
                        normal[j, i, 0], normal[j, i, 1], normal[j, i, 2] = nx / norm, ny / norm, area / norm


def _crevices(depth, covered, size):
    """Return the darkening of places that are deeper than their surroundings, (rows, columns) in (0.4, 1]."""
    width = 0.012 * max(depth.shape)
    weight = gaussian_filter(covered.astype(float), width)
    around = gaussian_filter(np.where(covered, depth, 0.0), width) / np.maximum(weight, 1e-9)
    hollow = np.where(covered, np.clip(around - depth, 0.0, None), 0.0) / size
    return 0.4 + 0.6 * np.exp(-40.0 * hollow)


def _outlines(grain):
    """Return the darkening of pixels at the outline of a grain, (rows, columns)."""
    edge = np.zeros(grain.shape, bool)
    edge[:-1] |= grain[:-1] != grain[1:]
    edge[:, :-1] |= grain[:, :-1] != grain[:, 1:]
    return np.where(edge, 0.45, 1.0)


def _average(image):
    """Return the image at the final resolution; colours are averaged with their opacity as weight."""
    rows, columns, _ = image.shape
    k = OVERSAMPLING
    blocks = image.reshape(rows // k, k, columns // k, k, 4)
    opacity = blocks[..., 3].mean(axis=(1, 3))
    color = blocks[..., :3].sum(axis=(1, 3)) / np.maximum(opacity * k * k, 1e-9)[..., None]
    return np.concatenate([np.clip(color, 0, 1), opacity[..., None]], axis=2)


def _crop(image, extent):
    """Return the part of the image that is not transparent, and its extent."""
    rows, columns = (np.flatnonzero(image[..., 3].any(axis=axis)) for axis in (1, 0))
    pixel = (extent[1] - extent[0]) / image.shape[1]
    left, top = extent[0] + columns[0] * pixel, extent[3] - rows[0] * pixel
    cropped = image[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    return cropped, (left, left + cropped.shape[1] * pixel, top - cropped.shape[0] * pixel, top)
