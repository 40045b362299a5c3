"""Support function of ellipsoids, and the climb to the direction of the largest gap.

f(n) = n·r − h_A(n) − h_B(n) with h(n) = √(nᵀ M n), M = R diag(s²) Rᵀ.
"""

from typing import NamedTuple

import numpy as np

from simcore.compilation import leaf, routine
from simcore.dem.vectors import Vec, basis, dot, length, minus, over, plus_scaled

TOLERANCE = 1e-11  # of the pair's size: tangential distance of the two surface points that is accepted
ITERATIONS = 60
SETTLINGS = 10


class Support(NamedTuple):
    """Support of an ellipsoid along a direction n: M n, and its height h(n), the extent from its centre."""

    image: Vec  # [m²]
    height: float  # [m]


class Summit(NamedTuple):
    """The end of a climb."""

    value: float  # [m], f: a gap, or minus an overlap
    normal: Vec
    converged: bool  # False: f may be larger in a direction close by


@leaf
def image(m, i, v):
    """Return M v of body i."""
    return Vec(
        m[i, 0] * v.x + m[i, 3] * v.y + m[i, 4] * v.z,
        m[i, 3] * v.x + m[i, 1] * v.y + m[i, 5] * v.z,
        m[i, 4] * v.x + m[i, 5] * v.y + m[i, 2] * v.z,
    )


@leaf
def support(m, i, normal):
    """Return the Support of body i along n."""
    point = image(m, i, normal)
    return Support(point, np.sqrt(dot(normal, point)))


@leaf
def support_height(m, i, normal):
    """Return h(n) of body i."""
    return support(m, i, normal).height


@leaf
def surface_point(m, i, normal):
    """Return the point of ellipsoid i farthest along n, relative to its centre, and its height h(n)."""
    point, height = support(m, i, normal)
    return over(point, height), height


@leaf
def gap_along(m, pair, normal):
    """Return f(n), the gap along the direction n, negative for an overlap."""
    return dot(normal, pair.offset) - support_height(m, pair.a, normal) - support_height(m, pair.b, normal)


@leaf
def curvatures(m, i, p, q, point, height):
    """Return the second derivatives of h of ellipsoid i along the tangents p and q at n: (pp, qq, pq).

    They are the tangential part of M/h − (M n)(M n)ᵀ/h³. point, height: those of `surface_point` along n.
    """
    image_p, image_q = image(m, i, p), image(m, i, q)
    at_p, at_q = dot(point, p), dot(point, q)
    return (
        (dot(p, image_p) - at_p * at_p) / height,
        (dot(q, image_q) - at_q * at_q) / height,
        (dot(p, image_q) - at_p * at_q) / height,
    )


@leaf
def made_positive(kpp, kqq, kpq):
    """Return the diagonal (pp, qq) of a symmetric matrix, shifted so that the matrix is positive definite."""
    mean, spread = 0.5 * (kpp + kqq), np.sqrt(0.25 * (kpp - kqq) ** 2 + kpq * kpq)
    smaller, largest = mean - spread, max(abs(mean - spread), abs(mean + spread))
    if smaller < 1e-6 * largest:
        return kpp + (1e-2 * largest - smaller), kqq + (1e-2 * largest - smaller)
    return kpp, kqq


@leaf
def solved(kpp, kqq, kpq, gp, gq):
    """Return K⁻¹ g of a symmetric matrix and a vector in two dimensions."""
    det = kpp * kqq - kpq * kpq
    return (kqq * gp - kpq * gq) / det, (kpp * gq - kpq * gp) / det


@leaf
def turned(normal, sp, p, sq, q):
    """Return the unit vector along n + s_p p + s_q q."""
    v = plus_scaled(plus_scaled(normal, sp, p), sq, q)
    return over(v, length(v))


@leaf
def climb_normal(m, pair, normal, enough):
    """Climb from n to a local maximum of f: Summit. A gap f > enough ends the climb early.

    This is Newton's iteration on the sphere. A Hessian that does not belong to a maximum is shifted until it does, and
    a step that reduces f is halved, so that every step climbs.
    """
    a, b = support(m, pair.a, normal), support(m, pair.b, normal)
    value = dot(normal, pair.offset) - a.height - b.height
    for _ in range(ITERATIONS):
        point_a, point_b = over(a.image, a.height), over(b.image, b.height)
        slope = minus(minus(pair.offset, point_a), point_b)
        value = dot(slope, normal)
        p, q = basis(normal)
        gp, gq = dot(slope, p), dot(slope, q)
        converged = abs(gp) + abs(gq) <= TOLERANCE * pair.size
        if converged or value > enough:
            return Summit(value, normal, converged)
        app, aqq, apq = curvatures(m, pair.a, p, q, point_a, a.height)
        bpp, bqq, bpq = curvatures(m, pair.b, p, q, point_b, b.height)
        kpq = apq + bpq
        kpp, kqq = made_positive(app + (bpp + value), aqq + (bqq + value), kpq)
        sp, sq = solved(kpp, kqq, kpq, gp, gq)
        step = np.sqrt(sp * sp + sq * sq)
        if step > 0.5:
            sp, sq = 0.5 * sp / step, 0.5 * sq / step
        climbed, trial = False, normal
        for _ in range(30):
            trial = turned(normal, sp, p, sq, q)
            a, b = support(m, pair.a, trial), support(m, pair.b, trial)
            if dot(trial, pair.offset) - a.height - b.height >= value - 4e-16 * pair.size:
                climbed = True
                break
            sp, sq = 0.5 * sp, 0.5 * sq
        if not climbed:
            return Summit(value, normal, False)
        normal = trial
    return Summit(value, normal, False)


@routine
def settle_normal(m, pair, normal):
    """Refine the normal at the end of a climb by Newton's iteration for a vanishing slope, while the slope decreases.

    f is flat at its maximum, so that a climb ends at the maximum to rounding, where the points of flat ellipsoids may
    still move by about 1e-7 of their size. No step changes f by more than rounding; larger steps are left out.
    """
    last, settled = np.inf, normal
    for _ in range(SETTLINGS):
        point_a, height_a = surface_point(m, pair.a, normal)
        point_b, height_b = surface_point(m, pair.b, normal)
        slope = minus(minus(pair.offset, point_a), point_b)
        value = dot(slope, normal)
        p, q = basis(normal)
        gp, gq = dot(slope, p), dot(slope, q)
        steepness = abs(gp) + abs(gq)
        if not steepness < 0.5 * last:
            return settled
        last, settled = steepness, normal
        app, aqq, apq = curvatures(m, pair.a, p, q, point_a, height_a)
        bpp, bqq, bpq = curvatures(m, pair.b, p, q, point_b, height_b)
        kpp, kqq, kpq = value + app + bpp, value + aqq + bqq, apq + bpq
        if not (kpp * kqq - kpq * kpq > 0.0 and kpp > 0.0):
            return settled
        sp, sq = solved(kpp, kqq, kpq, gp, gq)
        if sp * sp + sq * sq > 1e-6:  # not near the maximum: the climb stopped for another reason
            return settled
        normal = turned(normal, sp, p, sq, q)
    return settled
