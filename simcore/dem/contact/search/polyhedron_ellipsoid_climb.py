"""Convex polyhedron against ellipsoid by the common normal.

f(n) = n·r − h_polyhedron(n) − h_ellipsoid(n) is the least of smooth functions, one for each vertex v of the polyhedron:
f_v(n) = n·(r − v) − h_ellipsoid(n). At its maximum one, two or three of them are equal: the ellipsoid touches a
corner, an edge or a face. Newton's iteration is then a sequence of small problems: maximise the least of the f_v, each
with its slope and all with the ellipsoid's curvature, over the vertices that matter. The vertices are found on the way:
where a step leads to another support vertex that spoils it, that vertex joins in.
"""

from typing import NamedTuple

import numpy as np
from numba import types

from simcore.compilation import leaf, routine
from simcore.dem.contact.search.ellipsoid_climb import (
    curvatures,
    made_positive,
    support_height,
    surface_point,
    turned,
)
from simcore.dem.contact.search.scratch import scratch_tuple
from simcore.dem.shapes.hulls import support_vertex_along, vertex_of
from simcore.dem.vectors import Vec, basis, dot, minus, plus_scaled

TOLERANCE = 1e-12  # of the pair's size: tangential distance of the two surface points that is left
GAIN = 1e-15  # of the pair's size: a step that promises less is the last
ITERATIONS = 60
CORNERS = 4


class Feature(NamedTuple):
    """Where a climb ended: what of the polyhedron the ellipsoid touches, or comes nearest to."""

    value: float  # [m], f: a gap, or minus an overlap
    normal: Vec  # from the polyhedron to the ellipsoid
    converged: bool
    point: Vec  # [m], of the polyhedron, from its centre: a convex combination of the vertices
    a0: int  # vertices of the corner, edge or face; -1 for those that it does not have
    a1: int
    a2: int


class Active(NamedTuple):
    """The vertices that matter; how many are in use is passed beside them."""

    vertices: np.ndarray  # (CORNERS,) int64
    slopes: np.ndarray  # (CORNERS, 3): f_v less f, and its slope in axes in which the curvature is one
    weights: np.ndarray  # (CORNERS,) of the convex combination


class Place(NamedTuple):
    """A direction, the value of f there and the polyhedron's support vertex."""

    normal: Vec
    value: float
    vertex: int


class Model(NamedTuple):
    """The ellipsoid's point at a direction, the tangents p and q, and the curvature K = L Lᵀ in them."""

    point: Vec
    p: Vec
    q: Vec
    lpp: float
    lpq: float
    lqq: float


class Proposal(NamedTuple):
    """A step in the tangents, its share of the one that was promised, and the gain [m] that was promised."""

    sp: float
    sq: float
    share: float
    gain: float
    open_to_more: bool  # whether a vertex that is not active yet may join in


class Step(NamedTuple):
    """Where a step leads, and what the active vertices were for it."""

    place: Place
    moved: bool
    gain: float
    residual: float
    feature: Feature
    n: int


_take_active = scratch_tuple(
    Active, vertices=(types.int64, CORNERS), slopes=(types.float64, CORNERS, 3), weights=(types.float64, CORNERS)
)


@leaf
def gap_and_vertex(shapes, bodies, pair, v, normal):
    """f(n) of polyhedron a and ellipsoid b, and the polyhedron's support vertex there, climbed to from vertex v."""
    v = support_vertex_along(shapes, bodies, pair.a, v, normal)
    height = support_height(bodies.form_matrix, pair.b, normal)
    return dot(normal, minus(pair.offset, vertex_of(shapes, bodies, pair.a, v))) - height, v


@leaf
def _clear(weights, n):
    for c in range(n):
        weights[c] = 0.0


@routine
def _balance(slopes, n, weights):
    """Weights λ of the least Σ λ f + ½ |Σ λ t|² with λ >= 0, Σ λ = 1; slopes: rows f, t. Returns that least value.

    It is the dual of the small problem, with t in axes in which the curvature is one. A convex function over a simplex
    is least at a corner or at the stationary point of an edge or a triangle: all are tried.
    """
    best = np.inf
    for k in range(n):
        value = slopes[k, 0] + 0.5 * (slopes[k, 1] ** 2 + slopes[k, 2] ** 2)
        if value < best:
            best = value
            _clear(weights, n)
            weights[k] = 1.0
    for k in range(n):
        for m in range(k):
            df, dp, dq = slopes[k, 0] - slopes[m, 0], slopes[k, 1] - slopes[m, 1], slopes[k, 2] - slopes[m, 2]
            mu = -(df + dp * slopes[m, 1] + dq * slopes[m, 2]) / (dp * dp + dq * dq)
            if mu > 0.0 and mu < 1.0:
                p, q = slopes[m, 1] + mu * dp, slopes[m, 2] + mu * dq
                value = slopes[m, 0] + mu * df + 0.5 * (p * p + q * q)
                if value < best:
                    best = value
                    _clear(weights, n)
                    weights[k], weights[m] = mu, 1.0 - mu
            for o in range(m):
                ef, ep, eq = slopes[o, 0] - slopes[m, 0], slopes[o, 1] - slopes[m, 1], slopes[o, 2] - slopes[m, 2]
                # Both t along d and e vanish: solved for the point p, q itself, then for the weights
                bd = -(df + dp * slopes[m, 1] + dq * slopes[m, 2])
                be = -(ef + ep * slopes[m, 1] + eq * slopes[m, 2])
                det = dp * eq - dq * ep
                sp, sq = (bd * eq - be * dq) / det, (dp * be - ep * bd) / det  # d·s = bd, e·s = be
                mu, nu = (sp * eq - sq * ep) / det, (dp * sq - dq * sp) / det  # s = mu d + nu e
                if mu > 0.0 and nu > 0.0 and mu + nu < 1.0:
                    p, q = slopes[m, 1] + sp, slopes[m, 2] + sq
                    value = slopes[m, 0] + mu * df + nu * ef + 0.5 * (p * p + q * q)
                    if value < best:
                        best = value
                        _clear(weights, n)
                        weights[k], weights[o], weights[m] = mu, nu, 1.0 - mu - nu
    return best


@leaf
def _model_at(m, pair, place):
    """Model of f near a place; the curvature is of the ellipsoid and of the sphere of directions, made positive."""
    point, height = surface_point(m, pair.b, place.normal)
    p, q = basis(place.normal)
    kpp, kqq, kpq = curvatures(m, pair.b, p, q, point, height)
    kpp, kqq = made_positive(kpp + place.value, kqq + place.value, kpq)
    lpp = np.sqrt(kpp)
    lpq = kpq / lpp
    return Model(point, p, q, lpp, lpq, np.sqrt(kqq - lpq * lpq))


@leaf
def _fill_slopes(shapes, bodies, pair, place, model, active, n):
    for k in range(n):
        corner = vertex_of(shapes, bodies, pair.a, active.vertices[k])
        slope = minus(minus(pair.offset, model.point), corner)
        tp = dot(slope, model.p) / model.lpp
        active.slopes[k, 0] = dot(slope, place.normal) - place.value
        active.slopes[k, 1] = tp
        active.slopes[k, 2] = (dot(slope, model.q) - model.lpq * tp) / model.lqq


@leaf
def _combine(shapes, bodies, pair, active, n):
    """Slope (2) and point of the polyhedron by the weights of the active vertices."""
    tp, tq, point = 0.0, 0.0, Vec(0.0, 0.0, 0.0)
    for k in range(n):
        tp += active.weights[k] * active.slopes[k, 1]
        tq += active.weights[k] * active.slopes[k, 2]
        point = plus_scaled(point, active.weights[k], vertex_of(shapes, bodies, pair.a, active.vertices[k]))
    return tp, tq, point


@leaf
def _is_active(active, n, v):
    fresh = True
    for k in range(n):
        if active.vertices[k] == v:
            fresh = False
    return not fresh


@leaf
def _shorten(shapes, bodies, pair, place, model, active, n, proposal):
    """Halve a proposed step until it climbs, or until it leads to a vertex that may join: (place, moved, joins)."""
    sp, sq, share = proposal.sp, proposal.sq, proposal.share
    trial, moved, joins = place, False, False
    for _ in range(40):
        normal = turned(place.normal, sp, model.p, sq, model.q)
        value, v = gap_and_vertex(shapes, bodies, pair, place.vertex, normal)
        trial = Place(normal, value, v)
        joins = not _is_active(active, n, v)
        # A step must bring its share of the promise, or it would leap to and fro over a sharp rim.
        moved = value >= place.value + 0.1 * share * proposal.gain - 1e-15 * pair.size
        if moved or (joins and proposal.open_to_more):
            break
        joins = False
        sp, sq, share = 0.5 * sp, 0.5 * sq, 0.5 * share
    return trial, moved, joins


@leaf
def _update_active(active, n, v, joins):
    """Drop the vertices of no weight, and let v join, unless it is active; returns (their number, first three kept)."""
    kept = 0
    for k in range(n):
        if active.weights[k] > 0.0:
            joins = joins and active.vertices[k] != v
            active.vertices[kept] = active.vertices[k]
            kept += 1
    a0, a1, a2 = active.vertices[0], -1, -1
    if kept > 1:
        a1 = active.vertices[1]
    if kept > 2:
        a2 = active.vertices[2]
    if joins:
        active.vertices[kept] = v
        kept += 1
    return kept, a0, a1, a2


@leaf
def _step_from(shapes, bodies, pair, place, active, n):
    """One step of Newton's iteration: Step. Vertices that spoil it join in, as long as they lower its promise."""
    model = _model_at(bodies.form_matrix, pair, place)
    trial, moved, gain, residual, promised = place, False, 0.0, 0.0, np.inf
    point, a0, a1, a2 = Vec(0.0, 0.0, 0.0), -1, -1, -1
    for _ in range(30):
        _fill_slopes(shapes, bodies, pair, place, model, active, n)
        gain = _balance(active.slopes, n, active.weights)
        tp, tq, point = _combine(shapes, bodies, pair, active, n)
        residual = abs(model.lpp * tp) + abs(model.lpq * tp + model.lqq * tq)
        sq = tq / model.lqq
        sp = (tp - model.lpq * sq) / model.lpp
        reach, share = np.sqrt(sp * sp + sq * sq), 1.0
        if reach > 0.5:
            share = 0.5 / reach
            sp, sq = share * sp, share * sq
        # A vertex that joined and took nothing from the promise spoils the step by curvature, not by slope: then the
        # step is too long.
        proposal = Proposal(sp, sq, share, gain, gain < promised * (1.0 - 1e-9))
        promised = gain
        trial, moved, joins = _shorten(shapes, bodies, pair, place, model, active, n, proposal)
        # The support vertex of where the step leads stays in any case.
        n, a0, a1, a2 = _update_active(active, n, trial.vertex, joins or moved)
        if moved or not joins:
            break
    return Step(trial, moved, gain, residual, Feature(place.value, place.normal, moved, point, a0, a1, a2), n)


@routine
def climb_feature(shapes, bodies, pair, v, normal, enough):
    """The feature at a local maximum of f, climbed to from n and from vertex v, of polyhedron a and ellipsoid b.

    A gap f > enough ends the climb early.
    """
    active = _take_active()
    value, v = gap_and_vertex(shapes, bodies, pair, v, normal)
    place = Place(normal, value, v)
    active.vertices[0] = v
    n, last = 1, np.inf
    feature = Feature(value, normal, False, vertex_of(shapes, bodies, pair.a, v), v, -1, -1)
    for _ in range(ITERATIONS):
        if place.value > enough:
            break
        step = _step_from(shapes, bodies, pair, place, active, n)
        feature, n = step.feature, step.n
        idle = step.gain <= GAIN * pair.size
        if idle and (step.residual <= TOLERANCE * pair.size or step.residual > 0.5 * last or not step.moved):
            return _ended(feature, place, True)
        if not step.moved:
            return _ended(feature, place, False)
        if idle:  # nothing left to gain, but the points of flat ellipsoids still move
            last = step.residual
        place = step.place
    return _ended(feature, place, place.value > enough)


@leaf
def _ended(feature, place, converged):
    return Feature(place.value, place.normal, converged, feature.point, feature.a0, feature.a1, feature.a2)
