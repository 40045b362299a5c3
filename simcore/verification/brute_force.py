"""Signed distance by trying everything: the reference that `query` is measured against, and used for nothing else.

Support functions are maxima over all vertices, and no polytope grows. Of two hulls every direction is tried that can
matter; with an ellipsoid some hundred directions are, and the best of them are climbed. What is compared is always
what a direction shows, a bound by itself: −f(n) bounds the depth from above, f(n) a gap from below.
"""

import numpy as np

from simcore.compilation import kernel, leaf, routine
from simcore.dem.contact.search.ellipsoid_climb import climb_normal, support_height
from simcore.dem.contact.search.pair_frame import to_world
from simcore.dem.contact.search.polyhedron_ellipsoid_climb import climb_feature
from simcore.dem.shapes.hulls import CONVEX, ELLIPSOID, SPHERE

SPIRAL = 64
CLIMBED = 16


@routine
def support_value(shapes, solids, i, nx, ny, nz):
    """h(n) of solid i about its centre."""
    if solids.kind[i] != CONVEX:
        return support_height(solids.form_matrix, i, nx, ny, nz)
    r, s = solids.rotation, solids.scale
    dx = s[i, 0] * (r[i, 0, 0] * nx + r[i, 1, 0] * ny + r[i, 2, 0] * nz)
    dy = s[i, 1] * (r[i, 0, 1] * nx + r[i, 1, 1] * ny + r[i, 2, 1] * nz)
    dz = s[i, 2] * (r[i, 0, 2] * nx + r[i, 1, 2] * ny + r[i, 2, 2] * nz)
    best = -np.inf
    for v in range(shapes.vertex_start[solids.shape[i]], shapes.vertex_start[solids.shape[i] + 1]):
        best = max(best, shapes.vertices[v, 0] * dx + shapes.vertices[v, 1] * dy + shapes.vertices[v, 2] * dz)
    return best


@leaf
def shown(shapes, solids, i, j, rx, ry, rz, nx, ny, nz):
    """f(n) = n·r − h_i(n) − h_j(−n)"""
    gap = nx * rx + ny * ry + nz * rz
    return gap - support_value(shapes, solids, i, nx, ny, nz) - support_value(shapes, solids, j, -nx, -ny, -nz)


@kernel
def shown_along(shapes, solids, offset, normal):
    """f (n,) of pairs of solids 2k and 2k + 1 along their normals (n, 3)."""
    value = np.empty(len(offset))
    for k in range(len(offset)):
        value[k] = shown(
            shapes, solids, 2 * k, 2 * k + 1, offset[k, 0], offset[k, 1], offset[k, 2],
            normal[k, 0], normal[k, 1], normal[k, 2],
        )  # fmt: skip
    return value


@kernel
def _corners(shapes, solids, i):
    """Vertices (n, 3) of hull i in world axes about its centre; the sphere's is its centre."""
    first, last = shapes.vertex_start[solids.shape[i]], shapes.vertex_start[solids.shape[i] + 1]
    corners = np.empty((last - first, 3))
    for k in range(last - first):
        x, y, z = to_world(
            solids.rotation, i,
            solids.scale[i, 0] * shapes.vertices[first + k, 0],
            solids.scale[i, 1] * shapes.vertices[first + k, 1],
            solids.scale[i, 2] * shapes.vertices[first + k, 2],
        )  # fmt: skip
        corners[k, 0], corners[k, 1], corners[k, 2] = x, y, z
    return corners


@routine
def _depth_along(a, b, rx, ry, rz, x, y, z, best):
    """The less of `best` and the support values of A − (B + r) along ±(x, y, z), not normalised."""
    length = np.sqrt(x * x + y * y + z * z)
    if not length > 0.0:
        return best
    x, y, z = x / length, y / length, z / length
    high_a, high_b = -np.inf, -np.inf
    low_a, low_b = np.inf, np.inf
    for k in range(len(a)):
        h = a[k, 0] * x + a[k, 1] * y + a[k, 2] * z
        high_a, low_a = max(high_a, h), min(low_a, h)
    for k in range(len(b)):
        h = b[k, 0] * x + b[k, 1] * y + b[k, 2] * z
        high_b, low_b = max(high_b, h), min(low_b, h)
    shift = rx * x + ry * y + rz * z
    return min(best, min(high_a - low_b - shift, high_b - low_a + shift))


@leaf
def _side(corners, p, q):
    return corners[q, 0] - corners[p, 0], corners[q, 1] - corners[p, 1], corners[q, 2] - corners[p, 2]


@kernel
def depth_of_hulls(shapes, solids, i, j, rx, ry, rz):
    """Least support value of A − (B + r), of hulls or spheres' centres: minus the signed distance where they overlap.

    Its facets' normals are among those of two edges that meet in a vertex, and of an edge of each body. Negative: the
    bodies are apart, by that much or more.
    """
    a, b = _corners(shapes, solids, i), _corners(shapes, solids, j)
    first_a, first_b = shapes.vertex_start[solids.shape[i]], shapes.vertex_start[solids.shape[j]]
    start, neighbors = shapes.neighbor_start, shapes.neighbors
    best = np.inf
    for body in range(2):
        corners, first = (a, first_a) if body == 0 else (b, first_b)
        for u in range(len(corners)):
            for k in range(start[first + u], start[first + u + 1]):
                ex, ey, ez = _side(corners, u, neighbors[k] - first)
                for m in range(start[first + u], k):
                    fx, fy, fz = _side(corners, u, neighbors[m] - first)
                    best = _depth_along(a, b, rx, ry, rz, ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx, best)
    for u in range(len(a)):
        for k in range(start[first_a + u], start[first_a + u + 1]):
            v = neighbors[k] - first_a
            if v < u:
                continue
            ex, ey, ez = _side(a, u, v)
            for w in range(len(b)):
                for m in range(start[first_b + w], start[first_b + w + 1]):
                    t = neighbors[m] - first_b
                    if t < w:
                        continue
                    fx, fy, fz = _side(b, w, t)
                    best = _depth_along(a, b, rx, ry, rz, ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx, best)
    return best


@kernel
def depth_by_starts(shapes, solids, i, j, rx, ry, rz, starts, spiral):
    """Least −f(n) by climbs from many directions, solid j an ellipsoid (or sphere): normals of a hull's vertex
    neighbourhoods or of ellipsoid i, those of ellipsoid j, the axes of both, and a spiral. starts: (m, 3) to fill."""
    n = 0
    count = len(spiral)
    for k in range(count):
        for kind in range(3):
            body = i if kind == 1 else j
            x, y, z = spiral[k, 0], spiral[k, 1], spiral[k, 2]
            if kind > 0:  # the normal of the surface point that lies in this direction of the unit sphere
                x, y, z = to_world(
                    solids.rotation, body,
                    x / solids.scale[body, 0], y / solids.scale[body, 1], z / solids.scale[body, 2],
                )  # fmt: skip
                if solids.kind[body] == CONVEX:  # the normal of three vertices, taken as they come
                    first = shapes.vertex_start[solids.shape[body]]
                    size = shapes.vertex_start[solids.shape[body] + 1] - first
                    u = first + k % size
                    degree = shapes.neighbor_start[u + 1] - shapes.neighbor_start[u]
                    v = shapes.neighbors[shapes.neighbor_start[u] + (k // size) % degree]
                    w = shapes.neighbors[shapes.neighbor_start[u] + (k // size + 1 + k // (size * degree)) % degree]
                    ex, ey, ez = _side(shapes.vertices, u, v)
                    fx, fy, fz = _side(shapes.vertices, u, w)
                    x, y, z = to_world(solids.rotation, body, ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx)
            length = np.sqrt(x * x + y * y + z * z)
            if length > 0.0:
                starts[n, 0], starts[n, 1], starts[n, 2] = x / length, y / length, z / length
                n += 1
    for body in (i, j):
        for axis in range(3):
            for sign in (-1.0, 1.0):
                for c in range(3):
                    starts[n, c] = sign * solids.rotation[body, c, axis]
                n += 1
    values = np.empty(n)
    for k in range(n):
        values[k] = shown(shapes, solids, i, j, rx, ry, rz, starts[k, 0], starts[k, 1], starts[k, 2])
    size = solids.radius[i] + solids.radius[j]
    best = values.max()
    for climb in range(CLIMBED):
        # Half of the climbs from the best, half from anywhere
        k = np.argmax(values) if climb % 2 == 0 else (climb * 7919) % n
        values[k] = -np.inf
        x, y, z = starts[k, 0], starts[k, 1], starts[k, 2]
        if solids.kind[i] == CONVEX:
            v = shapes.vertex_start[solids.shape[i]]
            _, x, y, z, _, _, _, _, _, _, _ = climb_feature(shapes, solids, i, j, rx, ry, rz, size, v, x, y, z, np.inf)
        else:
            _, x, y, z, _ = climb_normal(solids.form_matrix, i, j, rx, ry, rz, size, x, y, z, np.inf)
        best = max(best, shown(shapes, solids, i, j, rx, ry, rz, x, y, z))
    return -best


@kernel
def depths(shapes, solids, offset, apart, spiral):
    """Reference depth (n,) of pairs of solids 2k and 2k + 1; −inf where `apart` says that there is nothing to find."""
    depth = np.full(len(offset), -np.inf)
    starts = np.empty((3 * len(spiral) + 12, 3))
    for k in range(len(offset)):
        if apart[k]:
            continue
        i, j = 2 * k, 2 * k + 1
        rx, ry, rz = offset[k, 0], offset[k, 1], offset[k, 2]
        if solids.kind[i] != CONVEX and solids.kind[j] == CONVEX:
            i, j, rx, ry, rz = j, i, -rx, -ry, -rz
        if solids.kind[i] == CONVEX and solids.kind[j] != ELLIPSOID:
            depth[k] = depth_of_hulls(shapes, solids, i, j, rx, ry, rz)
            if solids.kind[j] == SPHERE:
                depth[k] += solids.scale[j, 0]
        else:
            depth[k] = depth_by_starts(shapes, solids, i, j, rx, ry, rz, starts, spiral)
    return depth


def spiral_directions(n: int = SPIRAL) -> np.ndarray:
    """n unit vectors (n, 3), evenly spread (golden-angle spiral)."""
    k = np.arange(n)
    z = 1.0 - (2.0 * k + 1.0) / n
    ring = np.sqrt(1.0 - z * z)
    angle = np.pi * (3.0 - np.sqrt(5.0)) * k
    return np.stack([ring * np.cos(angle), ring * np.sin(angle), z], axis=1)
