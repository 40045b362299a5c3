"""Signed distance by brute force: the reference for `query`.

Support functions are maxima over all vertices, and no polytope is expanded. For two polyhedra, all directions are tried
that can be normals of a facet of A − (B + r); with an ellipsoid, some hundred directions are tried and climbs start
from the best of them. Each direction n gives a bound by itself: −f(n) bounds the depth from above, f(n) the gap from
below.
"""

import numpy as np

from simcore.compilation import kernel, leaf, routine
from simcore.dem.contact.pair import exchanged, pair_of
from simcore.dem.contact.search.ellipsoid_climb import climb_normal, support_height
from simcore.dem.contact.search.polyhedron_ellipsoid_climb import climb_feature
from simcore.dem.contact.search.simplex import edge_of
from simcore.dem.shapes.polyhedra import ELLIPSOID, POLYHEDRON, SPHERE
from simcore.dem.vectors import Vec, cross, dot, into_axes, length, negative, out_of_axes, over, read, write

SPIRAL = 64
CLIMBED = 16


@routine
def support_value(shapes, solids, i, normal):
    """Return the support value h(n) of solid i about its centre."""
    if solids.kind[i] != POLYHEDRON:
        return support_height(solids.form_matrix, i, normal)
    n, scale = into_axes(solids.rotation, i, normal), solids.scale
    direction = Vec(scale[i, 0] * n.x, scale[i, 1] * n.y, scale[i, 2] * n.z)
    best = -np.inf
    for v in range(shapes.vertex_start[solids.shape[i]], shapes.vertex_start[solids.shape[i] + 1]):
        best = max(best, dot(read(shapes.vertices, v), direction))
    return best


@leaf
def shown(shapes, solids, pair, normal):
    """Return the bound f(n) = n·r − h_a(n) − h_b(−n) for the direction n."""
    gap = dot(normal, pair.offset)
    return gap - support_value(shapes, solids, pair.a, normal) - support_value(shapes, solids, pair.b, negative(normal))


@kernel
def shown_along(shapes, solids, offset, normal):
    """Return f (n,) of pairs of solids 2k and 2k + 1 along their normals (n, 3)."""
    value = np.empty(len(offset))
    for k in range(len(offset)):
        value[k] = shown(shapes, solids, pair_of(solids, 2 * k, 2 * k + 1, read(offset, k)), read(normal, k))
    return value


@leaf
def _scaled_vertex(shapes, solids, i, v):
    scale, vertex = solids.scale, shapes.vertices
    return Vec(scale[i, 0] * vertex[v, 0], scale[i, 1] * vertex[v, 1], scale[i, 2] * vertex[v, 2])


@kernel
def _corners(shapes, solids, i):
    """Return vertices (n, 3) of polyhedron i in world axes about its centre; of a sphere, the centre."""
    first, last = shapes.vertex_start[solids.shape[i]], shapes.vertex_start[solids.shape[i] + 1]
    corners = np.empty((last - first, 3))
    for k in range(last - first):
        write(corners, k, out_of_axes(solids.rotation, i, _scaled_vertex(shapes, solids, i, first + k)))
    return corners


@routine
def _depth_along(a, b, offset, normal, best):
    """Return the minimum of `best` and the support values of A − (B + r) along ±normal, which is normalised here."""
    size = length(normal)
    if not size > 0.0:
        return best
    normal = over(normal, size)
    high_a, high_b = -np.inf, -np.inf
    low_a, low_b = np.inf, np.inf
    for k in range(len(a)):
        h = dot(read(a, k), normal)
        high_a, low_a = max(high_a, h), min(low_a, h)
    for k in range(len(b)):
        h = dot(read(b, k), normal)
        high_b, low_b = max(high_b, h), min(low_b, h)
    shift = dot(offset, normal)
    return min(best, min(high_a - low_b - shift, high_b - low_a + shift))


@kernel
def depth_of_polyhedra(shapes, solids, pair):
    """Return the minimum support value of A − (B + r), for polyhedra or centres of spheres.

    Positive: minus the signed distance of an overlap. Negative: the bodies are apart by this distance or more. The
    normals of the facets are cross products of two edges that meet in a vertex, or of an edge of each body.
    """
    a, b = _corners(shapes, solids, pair.a), _corners(shapes, solids, pair.b)
    first_a, first_b = shapes.vertex_start[solids.shape[pair.a]], shapes.vertex_start[solids.shape[pair.b]]
    start, neighbors = shapes.neighbor_start, shapes.neighbors
    best = np.inf
    for body in range(2):
        corners, first = (a, first_a) if body == 0 else (b, first_b)
        for u in range(len(corners)):
            for k in range(start[first + u], start[first + u + 1]):
                edge = edge_of(corners, u, neighbors[k] - first)
                for m in range(start[first + u], k):
                    other = edge_of(corners, u, neighbors[m] - first)
                    best = _depth_along(a, b, pair.offset, cross(edge, other), best)
    for u in range(len(a)):
        for k in range(start[first_a + u], start[first_a + u + 1]):
            v = neighbors[k] - first_a
            if v < u:
                continue
            edge = edge_of(a, u, v)
            for w in range(len(b)):
                for m in range(start[first_b + w], start[first_b + w + 1]):
                    t = neighbors[m] - first_b
                    if t >= w:
                        best = _depth_along(a, b, pair.offset, cross(edge, edge_of(b, w, t)), best)
    return best


@leaf
def _surface_normal(shapes, solids, i, direction, k):
    """Return a normal of solid i, not normalised.

    For an ellipsoid: at the image of a point of the unit sphere. For a polyhedron: of three vertices chosen by k.
    """
    if solids.kind[i] != POLYHEDRON:
        scale = solids.scale
        v = Vec(direction.x / scale[i, 0], direction.y / scale[i, 1], direction.z / scale[i, 2])
        return out_of_axes(solids.rotation, i, v)
    first = shapes.vertex_start[solids.shape[i]]
    size = shapes.vertex_start[solids.shape[i] + 1] - first
    u, start = first + k % size, shapes.neighbor_start
    degree = start[u + 1] - start[u]
    v = shapes.neighbors[start[u] + (k // size) % degree]
    w = shapes.neighbors[start[u] + (k // size + 1 + k // (size * degree)) % degree]
    return out_of_axes(solids.rotation, i, cross(edge_of(shapes.vertices, u, v), edge_of(shapes.vertices, u, w)))


@kernel
def _fill_starts(shapes, solids, pair, starts, spiral):
    """Fill `starts` with directions to climb from (a spiral, normals and axes of both bodies); return their number."""
    n = 0
    for k in range(len(spiral)):
        for kind in range(3):
            direction = read(spiral, k)
            if kind > 0:
                direction = _surface_normal(shapes, solids, pair.a if kind == 1 else pair.b, direction, k)
            size = length(direction)
            if size > 0.0:
                write(starts, n, over(direction, size))
                n += 1
    for body in (pair.a, pair.b):
        for axis in range(3):
            for sign in (-1.0, 1.0):
                for c in range(3):
                    starts[n, c] = sign * solids.rotation[body, c, axis]
                n += 1
    return n


@kernel
def depth_by_starts(shapes, solids, pair, starts, spiral):
    """Return the minimum of −f(n) by climbs from many directions; solid b is an ellipsoid or sphere.

    starts: (m, 3), workspace for the directions.
    """
    n = _fill_starts(shapes, solids, pair, starts, spiral)
    values = np.empty(n)
    for k in range(n):
        values[k] = shown(shapes, solids, pair, read(starts, k))
    best = values.max()
    for climb in range(CLIMBED):
        # Half of the climbs start from the best directions, half from arbitrary ones.
        k = np.argmax(values) if climb % 2 == 0 else (climb * 7919) % n
        values[k] = -np.inf
        normal = read(starts, k)
        if solids.kind[pair.a] == POLYHEDRON:
            v = shapes.vertex_start[solids.shape[pair.a]]
            normal = climb_feature(shapes, solids, pair, v, normal, np.inf).normal
        else:
            normal = climb_normal(solids.form_matrix, pair, normal, np.inf).normal
        best = max(best, shown(shapes, solids, pair, normal))
    return -best


@kernel
def depths(shapes, solids, offset, apart, spiral):
    """Return the reference depth (n,) of pairs of solids 2k and 2k + 1; −inf where `apart` is true."""
    depth = np.full(len(offset), -np.inf)
    starts = np.empty((3 * len(spiral) + 12, 3))
    for k in range(len(offset)):
        if apart[k]:
            continue
        pair = pair_of(solids, 2 * k, 2 * k + 1, read(offset, k))
        if solids.kind[pair.a] != POLYHEDRON and solids.kind[pair.b] == POLYHEDRON:
            pair = exchanged(pair)
        if solids.kind[pair.a] == POLYHEDRON and solids.kind[pair.b] != ELLIPSOID:
            depth[k] = depth_of_polyhedra(shapes, solids, pair)
            if solids.kind[pair.b] == SPHERE:
                depth[k] += solids.scale[pair.b, 0]
        else:
            depth[k] = depth_by_starts(shapes, solids, pair, starts, spiral)
    return depth


def spiral_directions(n: int = SPIRAL) -> np.ndarray:
    """Return n evenly spread unit vectors (n, 3), on a golden-angle spiral."""
    k = np.arange(n)
    z = 1.0 - (2.0 * k + 1.0) / n
    ring = np.sqrt(1.0 - z * z)
    angle = np.pi * (3.0 - np.sqrt(5.0)) * k
    return np.stack([ring * np.cos(angle), ring * np.sin(angle), z], axis=1)
