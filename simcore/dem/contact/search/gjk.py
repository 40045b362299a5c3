"""GJK: the point of the Minkowski difference M next to the origin (Gilbert, Johnson & Keerthi 1988)."""

from typing import NamedTuple

from numba import types

from simcore.compilation import leaf, routine
from simcore.dem.contact.search.pair_frame import Support, difference, support, support_afar
from simcore.dem.contact.search.scratch import scratch
from simcore.dem.contact.search.simplex import (
    along,
    copy_point,
    edge_of,
    has_point,
    keep_weighted,
    nearest_on_simplex,
    put_support,
    take_simplex,
    weighted_point,
)
from simcore.dem.vectors import Vec, cross, dot, length, minus_scaled, negative, over, read, squared

GJK_ITERATIONS = 128  # a bound, not a budget (docs/constants_contact.md#capacities-and-bounds-of-iterations)
NEAR = 1e-3  # of the pair's size: nearer, directions come from the simplex's features, not from its nearest point
GAP_TOLERANCE = 1e-13  # of the pair's size: how far the certain gap may fall short of the nearest point's distance
SHARPENINGS = 8

_take_fresh = scratch(types.float64, 4)


class Approach(NamedTuple):
    """Where a search for the gap ended."""

    gap: float  # [m], certain: M stays below −gap along the normal; not positive: it certifies nothing
    normal: Vec  # from a to b
    a: int  # support vertices along the normal
    b: int
    distance: float  # [m], of the simplex's point next to the origin
    n: int  # points of the simplex; 4: it contains the origin


@leaf
def _normal_to_edge(points, p, q, v):
    """The part of a vector normal to edge p, q; twice, since the first pass leaves rounding of the vector's length."""
    edge = edge_of(points, p, q)
    length2 = squared(edge)
    for _ in range(2):
        v = minus_scaled(v, dot(v, edge) / length2, edge)
    return v


@leaf
def _triangle_normal(points, p, q, s):
    """Normal of points p, q, s towards the origin's side, not normalised."""
    normal = cross(edge_of(points, p, q), edge_of(points, p, s))
    if along(points, p, normal) > 0.0:
        return negative(normal)
    return normal


@leaf
def _feature_normal(points, n, direction):
    """The direction made normal to the simplex of two or three points.

    From the nearest point a direction has an error of eps size / distance, whatever the feature's own normal.
    """
    if n == 2:
        normal = _normal_to_edge(points, 0, 1, direction)
    else:
        normal = _triangle_normal(points, 0, 1, 2)
    size = length(normal)
    if not size > 0.0:
        return direction
    return over(normal, size)


@routine
def walk_to_origin(shapes, f, a, b, normal, slack, simplex):
    """GJK, from vertices a and b along a normal, in the axes of the frame f: Approach.

    Ends where the gap is not less than (1 − slack) of the distance, or where rounding ends the progress. Fills the
    simplex; of four points it contains the origin, and the distance is zero.
    """
    fresh, points = _take_fresh(), simplex.points
    m = support(shapes, f, a, b, normal)
    best_gap = -dot(m.point, normal)
    best_normal, best_a, best_b = normal, m.a, m.b
    put_support(simplex, 0, m)
    simplex.weights[0] = 1.0
    n = 1
    nearest = m.point
    distance = length(nearest)
    for _ in range(GJK_ITERATIONS):
        if distance <= 1e-14 * f.size or best_gap >= (1.0 - slack) * distance:
            break
        normal = over(negative(nearest), distance)
        if distance < NEAR * f.size and n > 1:
            normal = _feature_normal(points, n, normal)
        m = support_afar(shapes, f, normal)
        gap = -dot(m.point, normal)
        if gap > best_gap:
            best_gap = gap
            best_normal, best_a, best_b = normal, m.a, m.b
        if has_point(simplex, n, m.a, m.b):
            break
        put_support(simplex, n, m)
        if nearest_on_simplex(points, n + 1, fresh):
            n, distance = 4, 0.0
            break
        point = weighted_point(points, fresh, n + 1)
        nearer = length(point)
        if not nearer < distance:  # rounding: the simplex as it was is the better one
            break
        nearest, distance = point, nearer
        n = keep_weighted(simplex, fresh, n + 1)
    return Approach(best_gap, best_normal, best_a, best_b, distance, n)


@leaf
def _subset_normal(points, subset, n, count):
    """Direction normal to a subset, a bit for each point, of one to three points of a simplex; not normalised."""
    p, q, s = -1, -1, -1
    for k in range(n):
        if subset >> k & 1:
            p, q, s = q, s, k
    normal = negative(read(points, s))
    if count == 2:
        normal = _normal_to_edge(points, q, s, normal)
    elif count == 3:
        normal = _triangle_normal(points, p, q, s)
    return normal


@leaf
def _count_points(subset, n):
    count = 0
    for k in range(n):
        if subset >> k & 1:
            count += 1
    return count


@routine
def sharpen(shapes, f, simplex, approach):
    """The approach with the gap along the best of the directions normal to the simplex's features and those beside it.

    GJK takes its direction from the nearest point, whose rounding is that of the size; over a gap g it is wrong by
    eps size / g, and shows a gap that is short by eps size² / g. The normal of a feature is not, whatever the gap.
    Where the nearest point lies on a feature's rim to rounding, GJK ends without the rest of the feature: so the
    support along the best direction joins, and all corners, edges and triangles are tried again.
    """
    near, n = take_simplex(), approach.n
    for k in range(n):
        copy_point(near, k, simplex, k)
    gap, normal, a, b = approach.gap, approach.normal, approach.a, approach.b
    for _ in range(SHARPENINGS):
        if not has_point(near, n, a, b) and n < 4:
            put_support(near, n, Support(a, b, difference(shapes, f, a, b)))
            n += 1
        improved = 0
        for subset in range(1, 1 << n):
            count = _count_points(subset, n)
            if count == 4:
                continue
            direction = _subset_normal(near.points, subset, n, count)
            size = length(direction)
            if not size > 0.0:
                continue
            direction = over(direction, size)
            m = support(shapes, f, a, b, direction)
            trial = -dot(m.point, direction)
            if trial > gap:
                gap, normal, a, b = trial, direction, m.a, m.b
                improved = subset
        if improved == 0 or approach.distance - gap <= GAP_TOLERANCE * f.size:
            break
        kept = 0
        for k in range(n):
            if improved >> k & 1:
                copy_point(near, kept, near, k)
                kept += 1
        n = kept
    return Approach(gap, normal, a, b, approach.distance, approach.n)
