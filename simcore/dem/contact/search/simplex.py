"""A simplex of up to four points of the Minkowski difference M, and its point nearest to the origin."""

from typing import NamedTuple

import numpy as np
from numba import types

from simcore.compilation import leaf, routine
from simcore.dem.contact.search.scratch import scratch_tuple
from simcore.dem.vectors import Vec, cross, dot, minus, plus_scaled, read, scaled, squared, write


class Simplex(NamedTuple):
    """Corners of a part of M near the origin; the number of corners in use is passed as a separate argument."""

    points: np.ndarray  # (4, 3) m = a − b − r
    vertices: np.ndarray  # (4, 2) int64: the vertices a and b
    weights: np.ndarray  # (4,) barycentric weights of the simplex's point nearest to the origin


take_simplex = scratch_tuple(
    Simplex, points=(types.float64, 4, 3), vertices=(types.int64, 4, 2), weights=(types.float64, 4)
)


@leaf
def put_support(target, k, support):
    """Store a support point as point k of a simplex or a polytope."""
    write(target.points, k, support.point)
    target.vertices[k, 0], target.vertices[k, 1] = support.a, support.b


@leaf
def copy_point(target, k, source, m):
    """Store point m of a simplex as point k of a simplex or a polytope."""
    write(target.points, k, read(source.points, m))
    target.vertices[k, 0], target.vertices[k, 1] = source.vertices[m, 0], source.vertices[m, 1]


@leaf
def has_point(simplex, n, a, b):
    """Return whether one of the first n points is the difference of vertices a and b."""
    repeated = False
    for k in range(n):
        if simplex.vertices[k, 0] == a and simplex.vertices[k, 1] == b:
            repeated = True
    return repeated


@leaf
def keep_weighted(simplex, weights, n):
    """Keep those of the first n points that have a positive weight; return their number.

    weights: (4,) to be copied to the simplex, or its own.
    """
    kept = 0
    for k in range(n):
        if weights[k] > 0.0:
            if kept < k:
                copy_point(simplex, kept, simplex, k)
            simplex.weights[kept] = weights[k]
            kept += 1
    return kept


@leaf
def weighted_point(points, weights, n):
    """Return Σ w m over the first n points."""
    point = Vec(0.0, 0.0, 0.0)
    for k in range(n):
        point = plus_scaled(point, weights[k], read(points, k))
    return point


@leaf
def edge_of(points, p, q):
    """Return the vector from point p to point q."""
    return minus(read(points, q), read(points, p))


@leaf
def along(points, p, direction):
    """Return the coordinate of point p along a direction."""
    return dot(read(points, p), direction)


@leaf
def segment_weights(points, p, q):
    """Return the barycentric weights of the point of segment p, q nearest to the origin."""
    edge = edge_of(points, p, q)
    length2 = squared(edge)
    if length2 == 0.0:
        return 1.0, 0.0
    t = min(max(-along(points, p, edge) / length2, 0.0), 1.0)
    return 1.0 - t, t


@leaf
def _side_distance2(points, p, q):
    """Return the squared distance of side p, q from the origin, and the weights of its nearest point."""
    u, v = segment_weights(points, p, q)
    return squared(plus_scaled(scaled(u, read(points, p)), v, read(points, q))), u, v


@routine
def _nearest_side(points, p, q, s):
    """Return the result of `triangle_weights` by the nearest side, for a triangle that is degenerate to rounding."""
    d_s, p_s, q_s = _side_distance2(points, p, q)
    d_q, p_q, s_q = _side_distance2(points, p, s)
    d_p, q_p, s_p = _side_distance2(points, q, s)
    if d_s <= d_q and d_s <= d_p:
        return p_s, q_s, 0.0
    if d_q <= d_p:
        return p_q, 0.0, s_q
    return 0.0, q_p, s_p


@routine
def triangle_weights(points, p, q, s):
    """Return the weights of the point of triangle p, q, s nearest to the origin (regions of Ericson 2005, 5.1.5)."""
    e, f = edge_of(points, p, q), edge_of(points, p, s)
    e_p, f_p = -along(points, p, e), -along(points, p, f)
    if e_p <= 0.0 and f_p <= 0.0:
        return 1.0, 0.0, 0.0
    e_q, f_q = -along(points, q, e), -along(points, q, f)
    if e_q >= 0.0 and f_q <= e_q:
        return 0.0, 1.0, 0.0
    area_s = e_p * f_q - e_q * f_p
    if area_s <= 0.0 and e_p >= 0.0 and e_q <= 0.0:
        t = e_p / (e_p - e_q) if e_p != e_q else 0.0
        return 1.0 - t, t, 0.0
    e_s, f_s = -along(points, s, e), -along(points, s, f)
    if f_s >= 0.0 and e_s <= f_s:
        return 0.0, 0.0, 1.0
    area_q = e_s * f_p - e_p * f_s
    if area_q <= 0.0 and f_p >= 0.0 and f_s <= 0.0:
        t = f_p / (f_p - f_s) if f_p != f_s else 0.0
        return 1.0 - t, 0.0, t
    area_p = e_q * f_s - e_s * f_q
    if area_p <= 0.0 and f_q >= e_q and e_s >= f_s:
        total = (f_q - e_q) + (e_s - f_s)
        t = (f_q - e_q) / total if total != 0.0 else 0.0
        return 0.0, 1.0 - t, t
    total = area_p + area_q + area_s
    if total > 0.0 and area_p >= 0.0 and area_q >= 0.0 and area_s >= 0.0:
        return area_p / total, area_q / total, area_s / total
    return _nearest_side(points, p, q, s)


@routine
def nearest_on_simplex(points, n, weights):
    """Store the weights of the point nearest to the origin; return whether the simplex is a tetrahedron around it."""
    weights[0], weights[1], weights[2], weights[3] = 0.0, 0.0, 0.0, 0.0
    if n == 1:
        weights[0] = 1.0
        return False
    if n == 2:
        weights[0], weights[1] = segment_weights(points, 0, 1)
        return False
    if n == 3:
        weights[0], weights[1], weights[2] = triangle_weights(points, 0, 1, 2)
        return False
    best = np.inf
    inside = True
    for apex in range(4):
        p, q, s = (apex + 1) & 3, (apex + 2) & 3, (apex + 3) & 3
        normal = cross(edge_of(points, p, q), edge_of(points, p, s))
        origin_side = -along(points, p, normal)
        apex_side = along(points, apex, normal) + origin_side
        if origin_side * apex_side > 0.0:
            continue  # the origin is on the inner side of this face
        inside = False
        u, v, w = triangle_weights(points, p, q, s)
        point = plus_scaled(plus_scaled(scaled(u, read(points, p)), v, read(points, q)), w, read(points, s))
        distance2 = squared(point)
        if distance2 < best:
            best = distance2
            weights[apex] = 0.0
            weights[p], weights[q], weights[s] = u, v, w
    return inside
