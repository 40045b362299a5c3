"""Two convex hulls, of which one may be a single point, from nothing: distance to the last digits, normal, points."""

import numpy as np
from numba import types

from simcore.compilation import leaf, routine
from simcore.dem.contact.search.facets import facet_at
from simcore.dem.contact.search.gjk import GAP_TOLERANCE, sharpen, triangle_weights, walk_to_origin
from simcore.dem.contact.search.pair_frame import (
    difference,
    frame_of,
    support,
    support_afar,
    to_body,
    to_world,
    vertex_a,
    vertex_b,
)
from simcore.dem.contact.search.polyhedra import facet_distance
from simcore.dem.contact.search.scratch import scratch

UNSURE = 1e-12  # of the pair's size: between the bounds of a gap from below and above
BESIDE = 1e-13  # of the pair's size: how far from the normal's line through the origin M's point may lie

_take_points = scratch(types.float64, 4, 3)
_take_vertices = scratch(types.int64, 4, 2)
_take_weights = scratch(types.float64, 4)


@leaf
def _project(shapes, f, nx, ny, nz, points, vertices, weights):
    """Weights, of the three corners of a facet with normal n, of the point next to the origin's projection."""
    for k in range(3):
        x, y, z = difference(shapes, f, vertices[k, 0], vertices[k, 1])
        depth = x * nx + y * ny + z * nz
        points[k, 0], points[k, 1], points[k, 2] = x - depth * nx, y - depth * ny, z - depth * nz
    weights[0], weights[1], weights[2] = triangle_weights(points, 0, 1, 2)


@leaf
def _drop(points, vertices, weights, n):
    """Drop simplex points of no weight: how many are left."""
    kept = 0
    for k in range(n):
        if weights[k] > 0.0:
            points[kept, 0], points[kept, 1], points[kept, 2] = points[k, 0], points[k, 1], points[k, 2]
            vertices[kept, 0], vertices[kept, 1] = vertices[k, 0], vertices[k, 1]
            weights[kept] = weights[k]
            kept += 1
    return kept


@leaf
def _beside(shapes, f, nx, ny, nz, vertices, weights, n):
    """Distance of the point Σ w m of M from the line along n through the origin."""
    x, y, z = 0.0, 0.0, 0.0
    for k in range(n):
        mx, my, mz = difference(shapes, f, vertices[k, 0], vertices[k, 1])
        x, y, z = x + weights[k] * mx, y + weights[k] * my, z + weights[k] * mz
    along = x * nx + y * ny + z * nz
    x, y, z = x - along * nx, y - along * ny, z - along * nz
    return np.sqrt(x * x + y * y + z * z)


@routine
def query_hulls(shapes, bodies, i, j, rx, ry, rz, size):
    """Signed distance of hulls i and j: (distance, normal a to b (3), point of a from its centre (3), of b (3)).

    size: of the pair, which the tolerances refer to. r: offset from the centre of a to that of b. World axes.
    """
    points, vertices, weights = _take_points(), _take_vertices(), _take_weights()
    fresh_vertices, fresh_weights = _take_vertices(), _take_weights()
    f = frame_of(bodies, i, j, rx, ry, rz)
    shape_a, shape_b = bodies.shape[i], bodies.shape[j]
    length = np.sqrt(rx * rx + ry * ry + rz * rz)
    nx, ny, nz = 1.0, 0.0, 0.0
    if length > 0.0:
        nx, ny, nz = to_body(bodies.rotation, i, rx / length, ry / length, rz / length)
    a, b, _, _, _ = support_afar(shapes, f, nx, ny, nz)
    value, nx, ny, nz, a, b, distance, n = walk_to_origin(
        shapes, f, size, a, b, nx, ny, nz, 0.0, points, vertices, weights
    )
    if value <= 0.0:
        overlap, nx, ny, nz, a0, a1, a2, b0, b1, b2, _ = facet_distance(
            shapes, f, size, shape_a, shape_b, a, b, nx, ny, nz, points, vertices, weights, n
        )
        value = -overlap
        vertices[0, 0], vertices[1, 0], vertices[2, 0] = a0, a1, a2
        vertices[0, 1], vertices[1, 1], vertices[2, 1] = b0, b1, b2
        _project(shapes, f, nx, ny, nz, points, vertices, weights)
        n = _drop(points, vertices, weights, 3)
        distance = 0.0
        if value > 0.0:  # a gap too small for GJK: the nearest feature may be an edge or a corner of the facet
            x, y, z = 0.0, 0.0, 0.0
            for k in range(3):
                points[k, 0], points[k, 1], points[k, 2] = difference(shapes, f, vertices[k, 0], vertices[k, 1])
            weights[0], weights[1], weights[2] = triangle_weights(points, 0, 1, 2)
            n = _drop(points, vertices, weights, 3)
            for k in range(n):
                x, y, z = x + weights[k] * points[k, 0], y + weights[k] * points[k, 1], z + weights[k] * points[k, 2]
            distance = np.sqrt(x * x + y * y + z * z)
    if value > 0.0 and distance - value > GAP_TOLERANCE * size:
        value, nx, ny, nz, a, b = sharpen(shapes, f, size, distance, points, vertices, n, value, nx, ny, nz, a, b)
        if distance - value > UNSURE * size:  # a face whose corners GJK never met together: EPA finds its normal
            overlap, ex, ey, ez, a0, _, _, b0, _, _, _ = facet_distance(
                shapes, f, size, shape_a, shape_b, a, b, nx, ny, nz, points, fresh_vertices, fresh_weights, 0
            )
            if -overlap > value:
                value, nx, ny, nz, a, b = -overlap, ex, ey, ez, a0, b0
    if _beside(shapes, f, nx, ny, nz, vertices, weights, n) > BESIDE * size:
        a, b, _, _, _ = support(shapes, f, a, b, nx, ny, nz)
        m = facet_at(shapes, f, size, a, b, nx, ny, nz, points, fresh_vertices, fresh_weights)
        if _beside(shapes, f, nx, ny, nz, fresh_vertices, fresh_weights, m) < _beside(
            shapes, f, nx, ny, nz, vertices, weights, n
        ):
            n = m
            for k in range(n):
                vertices[k, 0], vertices[k, 1] = fresh_vertices[k, 0], fresh_vertices[k, 1]
                weights[k] = fresh_weights[k]
    ax, ay, az, bx, by, bz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(n):
        x, y, z = vertex_a(shapes, f, vertices[k, 0])
        ax, ay, az = ax + weights[k] * x, ay + weights[k] * y, az + weights[k] * z
        x, y, z = vertex_b(shapes, f, vertices[k, 1])
        bx, by, bz = bx + weights[k] * x, by + weights[k] * y, bz + weights[k] * z
    nx, ny, nz = to_world(bodies.rotation, i, nx, ny, nz)
    ax, ay, az = to_world(bodies.rotation, i, ax, ay, az)
    bx, by, bz = to_world(bodies.rotation, i, bx, by, bz)
    return value, nx, ny, nz, ax, ay, az, bx, by, bz
