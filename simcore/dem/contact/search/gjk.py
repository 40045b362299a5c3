"""GJK: search for the point of the Minkowski difference M nearest to the origin (Gilbert, Johnson & Keerthi 1988)."""

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

# An upper bound that is not reached in practice:
# docs/explanation/constants_contact.md#capacities-and-bounds-of-iterations
GJK_ITERATIONS = 128
NEAR = 1e-3  # of the pair's size: below it, directions follow from the features of the simplex, not its nearest point
GAP_TOLERANCE = 1e-13  # of the pair's size: accepted difference of the nearest point's distance and the certain gap
SHARPENINGS = 8  # maximum number of iterations of `sharpen`

_take_fresh = scratch(types.float64, 4)


class Approach(NamedTuple):
    """The end of a search for the gap."""

    gap: float  # [m], certain: M is below −gap along the normal; if not positive, no gap is certified
    normal: Vec  # from a to b
    a: int  # support vertices along the normal
    b: int
    distance: float  # [m], of the simplex's point nearest to the origin
    n: int  # number of points of the simplex; 4: it contains the origin


@leaf
def _normal_to_edge(points, p, q, v):
    """Return the part of a vector normal to edge p, q; a second pass removes the rounding error of the first."""
    edge = edge_of(points, p, q)
    length2 = squared(edge)
    for _ in range(2):
        v = minus_scaled(v, dot(v, edge) / length2, edge)
    return v


@leaf
def _triangle_normal(points, p, q, s):
    """Return the normal of points p, q, s towards the side of the origin, not normalised."""
    normal = cross(edge_of(points, p, q), edge_of(points, p, s))
    if along(points, p, normal) > 0.0:
        return negative(normal)
    return normal


@leaf
def _feature_normal(points, n, direction):
    """Return the direction made normal to the simplex of two or three points.

    A direction from the nearest point has an error of eps size / distance, which the normal of the feature has not.
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
    """Run GJK from vertices a and b along a normal, in the axes of the frame f: Approach.

    The search ends if the gap is at least (1 − slack) times the distance, or if rounding stops its progress. The result
    is stored in the simplex; if it has four points, it contains the origin, and the distance is zero.
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
        if not nearer < distance:  # by rounding, the previous simplex is the better one
            break
        nearest, distance = point, nearer
        n = keep_weighted(simplex, fresh, n + 1)
    return Approach(best_gap, best_normal, best_a, best_b, distance, n)


@leaf
def _subset_normal(points, subset, n, count):
    """Return the direction normal to a subset of one to three points of a simplex, not normalised.

    subset: a bit for each point; count: number of its points.
    """
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
    """Return the number of points in a subset."""
    count = 0
    for k in range(n):
        if subset >> k & 1:
            count += 1
    return count


@routine
def sharpen(shapes, f, simplex, approach):
    """Return the approach with the gap along the best direction normal to a feature of the simplex, or of an extension.

    GJK takes its direction from the nearest point, whose rounding error is eps size. At a gap g the direction is wrong
    by eps size / g, and its gap is too small by eps size² / g. The normal of a feature has no such error. If the
    nearest point is on the rim of a feature to rounding, GJK ends without the rest of the feature. Therefore the
    support along the best direction is added, and all corners, edges and triangles are tried again.
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
