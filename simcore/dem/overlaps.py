"""The deepest overlap of bodies, relative to their thickness."""

import numpy as np

from simcore.dem.state.bodies import Bodies
from simcore.dem.state.contacts import CandidatePairs

DEEPEST = 1.0  # largest allowed overlap over the thinner grain's half thickness


def half_thickness(bodies: Bodies) -> np.ndarray:
    """Return the shortest semi-axis (n,) [m] of the ellipsoid of the same mass and moments of inertia."""
    moments = 0.5 * bodies.inertia.sum(axis=1) - bodies.inertia.max(axis=1)
    return np.sqrt(5.0 * moments / bodies.mass)


def deepest_overlap(candidates: CandidatePairs, thickness, ids, counted=None):
    """Return (overlap [m], (row of the thinner body, row of the other), ratio) of the contact with the largest ratio.

    ratio: overlap over the thinner grain's half thickness. thickness (n,) [m]: half thickness of each grain. ids (n,):
    of two equally thick grains, the one with the lower id counts as thinner. counted (n,) bool: only contacts whose
    thinner grain is marked are considered; None: all. The row of a wall is -1. Without contacts: (0, (-1, -1), 0).
    """
    contacts, walls = candidates
    counted = np.ones(len(thickness), bool) if counted is None else counted
    deepest = 0.0, (-1, -1), 0.0
    p = np.flatnonzero(contacts.touching)
    a, b = contacts.body_a[p], contacts.body_b[p]
    a_thinner = (thickness[a] < thickness[b]) | ((thickness[a] == thickness[b]) & (ids[a] < ids[b]))
    thin, other = np.where(a_thinner, a, b), np.where(a_thinner, b, a)
    p, thin, other = p[counted[thin]], thin[counted[thin]], other[counted[thin]]
    if len(p):
        ratio = contacts.overlap[p] / thickness[thin]
        k = int(np.argmax(ratio))
        deepest = float(contacts.overlap[p[k]]), (int(thin[k]), int(other[k])), float(ratio[k])
    w = np.flatnonzero(walls.touching)
    w = w[counted[walls.body[w]]]
    if len(w):
        ratio = walls.overlap[w] / thickness[walls.body[w]]
        k = int(np.argmax(ratio))
        if ratio[k] > deepest[2]:
            deepest = float(walls.overlap[w[k]]), (int(walls.body[w[k]]), -1), float(ratio[k])
    return deepest
