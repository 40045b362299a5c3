"""Climb to the common normal of a convex polyhedron and an ellipsoid.

f(n) = n·r − h_polyhedron(n) − h_ellipsoid(n) is the minimum of smooth functions, one for each vertex v of the
polyhedron: f_v(n) = n·(r − v) − h_ellipsoid(n). At the maximum of f one, two or three of them are equal: the ellipsoid
touches a corner, an edge or a face. Each step of Newton's iteration solves a small problem: it maximises the minimum of
the f_v of the active vertices, each with its slope and all with the curvature of the ellipsoid. If a step leads to
another support vertex at which f is too small, that vertex becomes active.
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
from simcore.dem.shapes.polyhedra import support_vertex_along, vertex_of
from simcore.dem.vectors import Vec, basis, dot, minus, plus_scaled

TOLERANCE = 1e-12  # of the pair's size: tangential distance of the two surface points that is accepted
GAIN = 1e-15  # of the pair's size: a step with a smaller predicted gain is the last
ITERATIONS = 60
CORNERS = 4  # maximum number of active vertices


class Feature(NamedTuple):
    """The end of a climb: the corner, edge or face of the polyhedron that is nearest to the ellipsoid."""

    value: float  # [m], f: a gap, or minus an overlap
    normal: Vec  # from the polyhedron to the ellipsoid
    converged: bool
    point: Vec  # [m], of the polyhedron, relative to its centre: a convex combination of the vertices
    a0: int  # vertices of the corner, edge or face; -1 for vertices that it does not have
    a1: int
    a2: int


class Active(NamedTuple):
    """The active vertices; the number in use is a separate argument."""

    vertices: np.ndarray  # (CORNERS,) int64
    slopes: np.ndarray  # (CORNERS, 3): f_v − f, and the slope of f_v in axes in which the curvature is one
    weights: np.ndarray  # (CORNERS,) of the convex combination


class Place(NamedTuple):
    """A direction, the value of f along it and the support vertex of the polyhedron."""

    normal: Vec
    value: float
    vertex: int


class Model(NamedTuple):
    """The point of the ellipsoid along a direction, the tangents p and q, and the curvature K = L Lᵀ in them."""

    point: Vec
    p: Vec
    q: Vec
    lpp: float
    lpq: float
    lqq: float


class Proposal(NamedTuple):
    """A step along the tangents."""

    sp: float
    sq: float
    share: float  # ratio of the step to that of the full prediction
    gain: float  # [m], predicted for the full step
    open_to_more: bool  # whether another vertex may become active


class Step(NamedTuple):
    """The result of a step, and the feature of its active vertices."""

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
    """Return f(n) of polyhedron a and ellipsoid b, and the support vertex of the polyhedron, by a climb from v."""
    v = support_vertex_along(shapes, bodies, pair.a, v, normal)
    height = support_height(bodies.form_matrix, pair.b, normal)
    return dot(normal, minus(pair.offset, vertex_of(shapes, bodies, pair.a, v))) - height, v


@leaf
def _clear(weights, n):
    for c in range(n):
        weights[c] = 0.0


@routine
def _balance(slopes, n, weights):
    """Store the weights λ that minimise Σ λ f + ½ |Σ λ t|² with λ >= 0, Σ λ = 1; return the minimum. slopes: rows f, t.

    This is the dual of the small problem, with t in axes in which the curvature is one. A convex function over a
    simplex has its minimum at a corner or at the stationary point of an edge or a triangle; all are tried.
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
                # The derivatives along d and e vanish. The point p, q is computed first, then the weights.
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
    """Return the Model of f near a place, with the curvature of ellipsoid and sphere of directions, made positive."""
    point, height = surface_point(m, pair.b, place.normal)
    p, q = basis(place.normal)
    kpp, kqq, kpq = curvatures(m, pair.b, p, q, point, height)
    kpp, kqq = made_positive(kpp + place.value, kqq + place.value, kpq)
    lpp = np.sqrt(kpp)
    lpq = kpq / lpp
    return Model(point, p, q, lpp, lpq, np.sqrt(kqq - lpq * lpq))


@leaf
def _fill_slopes(shapes, bodies, pair, place, model, active, n):
    """Store value and slope of each active vertex."""
    for k in range(n):
        corner = vertex_of(shapes, bodies, pair.a, active.vertices[k])
        slope = minus(minus(pair.offset, model.point), corner)
        tp = dot(slope, model.p) / model.lpp
        active.slopes[k, 0] = dot(slope, place.normal) - place.value
        active.slopes[k, 1] = tp
        active.slopes[k, 2] = (dot(slope, model.q) - model.lpq * tp) / model.lqq


@leaf
def _combine(shapes, bodies, pair, active, n):
    """Return the weighted slope (2) of the active vertices and their weighted point on the polyhedron."""
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
    """Halve a step until it climbs, or until it leads to a vertex that may become active: (place, moved, joins)."""
    sp, sq, share = proposal.sp, proposal.sq, proposal.share
    trial, moved, joins = place, False, False
    for _ in range(40):
        normal = turned(place.normal, sp, model.p, sq, model.q)
        value, v = gap_and_vertex(shapes, bodies, pair, place.vertex, normal)
        trial = Place(normal, value, v)
        joins = not _is_active(active, n, v)
        # A step must achieve a tenth of its predicted gain, or it could oscillate across a sharp edge.
        moved = value >= place.value + 0.1 * share * proposal.gain - 1e-15 * pair.size
        if moved or (joins and proposal.open_to_more):
            break
        joins = False
        sp, sq, share = 0.5 * sp, 0.5 * sq, 0.5 * share
    return trial, moved, joins


@leaf
def _update_active(active, n, v, joins):
    """Remove vertices without weight, and add v if it joins and is not active: (number, first three that were kept)."""
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
    """Make one step of Newton's iteration: Step. Vertices that spoil it become active while they lower its gain."""
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
        # If the last vertex that became active did not lower the predicted gain, the step is spoiled by curvature and
        # not by slope: it is too long and must be halved.
        proposal = Proposal(sp, sq, share, gain, gain < promised * (1.0 - 1e-9))
        promised = gain
        trial, moved, joins = _shorten(shapes, bodies, pair, place, model, active, n, proposal)
        # The support vertex at the end of a step that moved is always kept.
        n, a0, a1, a2 = _update_active(active, n, trial.vertex, joins or moved)
        if moved or not joins:
            break
    return Step(trial, moved, gain, residual, Feature(place.value, place.normal, moved, point, a0, a1, a2), n)


@routine
def climb_feature(shapes, bodies, pair, v, normal, enough):
    """Climb from n and vertex v to a local maximum of f of polyhedron a and ellipsoid b: Feature.

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
        if idle:  # no gain is left, but the points of flat ellipsoids still move
            last = step.residual
        place = step.place
    return _ended(feature, place, place.value > enough)


@leaf
def _ended(feature, place, converged):
    return Feature(place.value, place.normal, converged, feature.point, feature.a0, feature.a1, feature.a2)
