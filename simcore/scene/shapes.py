"""Kinds of shape of a scene, base shapes of its grains, and grains drawn for it."""

from typing import NamedTuple

import numpy as np

SPHERE = 0  # the base is the unit sphere and all scales of a body are equal
ELLIPSOID = 1  # the base is the unit sphere
POLYHEDRON = 2  # the base is a convex hull
MIXED = 3  # kind of a scene, never of a body: bodies whose base is the unit sphere are ellipsoids, others polyhedra


class Base(NamedTuple):
    """One base shape; vertices (n, 3) and outward faces (m, 3) are those of a polyhedron, empty for the unit sphere.

    A body moves about the origin of its base and has the moments below as principal ones, so that the vertices of a
    base of bodies are relative to the centre of mass and along the principal axes. The base of a
    simcore.dem.shapes.polyhedra.Shape is about the middle of its bounding box; simcore.Simulation converts it.
    """

    name: str
    vertices: np.ndarray
    faces: np.ndarray
    volume: float
    second_moments: np.ndarray  # (3,) mean of x_i² over the volume


class Draw(NamedTuple):
    """Grains to be inserted, in the order of the ids given; arrays (n,), except scale (n, 3) and uniforms (n, 8)."""

    shape: np.ndarray
    scale: np.ndarray
    sieve_size: np.ndarray
    uniforms: np.ndarray


def unit_sphere() -> Base:
    """Return the base shape of all spheres and ellipsoids."""
    empty = np.zeros((0, 3))
    return Base("sphere", empty, empty.astype(np.int64), 4.0 / 3.0 * np.pi, np.full(3, 0.2))


def grain_volumes(bases: list[Base], drawn: Draw) -> np.ndarray:
    """Return the volumes (n,) [m³] of drawn grains."""
    volume = np.array([base.volume for base in bases])
    return volume[drawn.shape] * drawn.scale.prod(axis=1)
