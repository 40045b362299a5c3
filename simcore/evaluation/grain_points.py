r"""Points inside grains, with weights, for integrals of waves over the solid between two heights of a bed.

------____------ high    A grain is represented by the ellipsoid with its second moments, and the part of it between
    / .  . \             the heights is sliced into discs, ellipses in fact. The points are those of a Gaussian rule
   | . .  . |            over the height and over a disc. A large grain has more points than a small one, so that a
    \ ._ . /             wave is integrated over both with the same accuracy.
"""

from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import leggauss
from scipy.spatial.transform import Rotation

# The number of points along a line is POINTS[0] + POINTS[1] k r, for a grain that reaches r and a wave number k. With
# more of them, sampling errors of beds of U5 and B50 change by less than 0.002 of their value.
POINTS = 2.0, 1.0


class GrainPoints(NamedTuple):
    """Points (m,) inside grains."""

    position: np.ndarray  # (m, 3) [m]
    volume: np.ndarray  # (m,) [m³], the weights of the points; those of a whole grain add up to its volume
    grain: np.ndarray  # (m,), index of the grain


def grain_points(packing, low, high, wave_number):
    """Return the GrainPoints of a packing between the heights `low` and `high` [m].

    packing: Dataset of read_packing. wave_number [1/m]: the largest of the waves that are integrated.
    """
    height, volume, half_axes = packing["position"].values[:, 2], packing["volume"].values, half_axes_of(packing)
    turn = Rotation.from_quat(packing["orientation"].values, scalar_first=True).as_matrix()
    to_world = turn * half_axes[:, None, :]  # from the unit ball to the ellipsoid
    half_height = np.linalg.norm(to_world[:, 2], axis=1)
    # Heights of the two planes in units of the half height: the part of the ellipsoid between is that of the ball.
    lowest, highest = (np.clip((plane - height) / half_height, -1.0, 1.0) for plane in (low, high))
    inside = np.flatnonzero(highest > lowest)
    orders = (POINTS[0] + POINTS[1] * wave_number * half_axes.max(axis=1)).astype(np.int64)
    parts = [(np.empty((0, 3)), np.empty(0), np.empty(0, np.int64))]
    for order in np.unique(orders[inside]):
        grains = inside[orders[inside] == order]
        zeta, shares = _heights(lowest[grains], highest[grains], order + 1)
        disc, of_disc = disc_rule(order)
        first, second, up = _conjugate_axes(to_world[grains], half_height[grains])
        across = disc[:, 0, None] * first[:, None] + disc[:, 1, None] * second[:, None]
        radius = np.sqrt(1.0 - zeta**2)[..., None, None]
        places = packing["position"].values[grains, None, None] + zeta[..., None, None] * up[:, None, None]
        places = places + radius * across[:, None]
        weights = volume[grains, None, None] * shares[..., None] * of_disc
        owner = np.broadcast_to(grains[:, None, None], weights.shape)
        parts.append((places.reshape(-1, 3), weights.ravel(), owner.ravel()))
    return GrainPoints(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))


def half_axes_of(packing):
    """Return the half axes of each grain's ellipsoid of equal second moments, along its own axes x, y, z, (n, 3) [m].

    A polyhedron has S along x, I along y and L along z (simcore.grains.mesh.Grain).
    """
    polyhedra = (packing["shape_kind"].values.astype(str) == "convex")[packing["shape"].values]
    of_polyhedra = 0.5 * np.column_stack([packing[axis].values for axis in "SIL"])
    return np.where(polyhedra[:, None], of_polyhedra, packing["scale"].values)


def disc_rule(order):
    """Return points (m, 2) in the unit disc and weights (m,) that add up to 1.

    Means over the disc of polynomials up to degree 2 order - 1 are exact.
    """
    squares, shares = leggauss((order + 1) // 2)
    radii = np.sqrt(0.5 * (1.0 + squares))
    angle = np.pi * np.arange(2 * order) / order
    points = radii[:, None, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return points.reshape(-1, 2), np.repeat(shares / (4.0 * order), 2 * order)


def _heights(lowest, highest, order):
    """Return heights (n, order) between those of n planes through the unit ball, and their shares of its volume."""
    nodes, weights = leggauss(order)
    half = 0.5 * (highest - lowest)[:, None]
    zeta = 0.5 * (highest + lowest)[:, None] + half * nodes
    return zeta, 0.75 * (1.0 - zeta**2) * half * weights


def _conjugate_axes(to_world, half_height):
    """Return three vectors (n, 3) of each ellipsoid: two horizontal ones that span its middle slice, one to its top.

    to_world: (n, 3, 3), from the unit ball to the ellipsoid.
    """
    up = to_world[:, 2] / half_height[:, None]  # direction in the ball that becomes the top of the ellipsoid
    least = np.eye(3)[np.abs(up).argmin(axis=1)]
    first = np.cross(up, least)
    first /= np.linalg.norm(first, axis=1)[:, None]
    return tuple(np.einsum("nij,nj->ni", to_world, axis) for axis in (first, np.cross(up, first), up))
