"""Vectors of three numbers as values: what kernels compute with instead of three scalars each.

A Vec is a NamedTuple, so numba keeps its numbers in registers. Each function states its sums in one order, on which the
bits of results depend.
"""

from typing import NamedTuple

import numpy as np

from simcore.compilation import leaf


class Vec(NamedTuple):
    """A vector of three numbers."""

    x: float
    y: float
    z: float


class Contact(NamedTuple):
    """Where two grains touch. overlap [m], positive; normal from a to b; point [m], relative to the centre of a."""

    overlap: float
    normal: Vec
    point: Vec


ZERO = Vec(0.0, 0.0, 0.0)


@leaf
def read(array, i):
    """Row i of an array (n, 3)."""
    return Vec(array[i, 0], array[i, 1], array[i, 2])


@leaf
def write(array, i, v):
    """Store v in row i of an array (n, 3)."""
    array[i, 0], array[i, 1], array[i, 2] = v.x, v.y, v.z


@leaf
def plus(a, b):
    return Vec(a.x + b.x, a.y + b.y, a.z + b.z)


@leaf
def minus(a, b):
    return Vec(a.x - b.x, a.y - b.y, a.z - b.z)


@leaf
def plus_scaled(a, factor, b):
    """a + factor b"""
    return Vec(a.x + factor * b.x, a.y + factor * b.y, a.z + factor * b.z)


@leaf
def minus_scaled(a, factor, b):
    """a − factor b"""
    return Vec(a.x - factor * b.x, a.y - factor * b.y, a.z - factor * b.z)


@leaf
def negative(a):
    return Vec(-a.x, -a.y, -a.z)


@leaf
def scaled(factor, a):
    return Vec(factor * a.x, factor * a.y, factor * a.z)


@leaf
def over(a, divisor):
    """a / divisor, which rounds differently from a product with its inverse."""
    return Vec(a.x / divisor, a.y / divisor, a.z / divisor)


@leaf
def dot(a, b):
    return a.x * b.x + a.y * b.y + a.z * b.z


@leaf
def cross(a, b):
    return Vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)


@leaf
def triple(a, b, c):
    """(a × b) · c: six times the volume of the tetrahedron that the three vectors span, with its sign."""
    return dot(cross(a, b), c)


@leaf
def squared(a):
    return a.x * a.x + a.y * a.y + a.z * a.z


@leaf
def length(a):
    return np.sqrt(a.x * a.x + a.y * a.y + a.z * a.z)


@leaf
def across(a, unit):
    """The part of a that is perpendicular to a unit vector."""
    along = dot(a, unit)
    return Vec(a.x - along * unit.x, a.y - along * unit.y, a.z - along * unit.z)


@leaf
def beside(a, unit):
    """Length of the part of a that is perpendicular to a unit vector."""
    return length(across(a, unit))


@leaf
def direction_of(a):
    """The unit vector along a, or along x where a is zero."""
    reach = length(a)
    if reach > 0.0:
        return over(a, reach)
    return Vec(1.0, 0.0, 0.0)


@leaf
def sideways(a):
    """A vector perpendicular to a, not normalised: the cross product with the axis along which a is shortest."""
    if abs(a.x) <= abs(a.y) and abs(a.x) <= abs(a.z):
        return Vec(0.0, -a.z, a.y)
    if abs(a.y) <= abs(a.z):
        return Vec(a.z, 0.0, -a.x)
    return Vec(-a.y, a.x, 0.0)


@leaf
def basis(unit):
    """Two unit vectors that complete a unit vector to a right-handed frame (Duff et al. 2017)."""
    sign = 1.0 if unit.z >= 0.0 else -1.0
    a = -1.0 / (sign + unit.z)
    b = unit.x * unit.y * a
    first = Vec(1.0 + sign * unit.x * unit.x * a, sign * b, -sign * unit.x)
    return first, Vec(b, sign + unit.y * unit.y * a, -unit.y)


@leaf
def into_axes(rotation, i, a):
    """A world vector in the axes of body i: Rᵀ a, rotation (n, 3, 3)."""
    return Vec(
        rotation[i, 0, 0] * a.x + rotation[i, 1, 0] * a.y + rotation[i, 2, 0] * a.z,
        rotation[i, 0, 1] * a.x + rotation[i, 1, 1] * a.y + rotation[i, 2, 1] * a.z,
        rotation[i, 0, 2] * a.x + rotation[i, 1, 2] * a.y + rotation[i, 2, 2] * a.z,
    )


@leaf
def out_of_axes(rotation, i, a):
    """A vector in the axes of body i as a world vector: R a, rotation (n, 3, 3)."""
    return Vec(
        rotation[i, 0, 0] * a.x + rotation[i, 0, 1] * a.y + rotation[i, 0, 2] * a.z,
        rotation[i, 1, 0] * a.x + rotation[i, 1, 1] * a.y + rotation[i, 1, 2] * a.z,
        rotation[i, 2, 0] * a.x + rotation[i, 2, 1] * a.y + rotation[i, 2, 2] * a.z,
    )
