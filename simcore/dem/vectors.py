"""Vectors of three numbers for compiled code, used instead of three separate scalars.

A Vec is a NamedTuple, so numba keeps its numbers in registers. The order of the terms in each function must not change,
because the last bits of the results depend on it.
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
    """Contact of two grains: overlap [m], positive; normal from a to b; point [m], relative to the centre of a."""

    overlap: float
    normal: Vec
    point: Vec


ZERO = Vec(0.0, 0.0, 0.0)


@leaf
def read(array, i):
    """Return row i of an array (n, 3) as a vector."""
    return Vec(array[i, 0], array[i, 1], array[i, 2])


@leaf
def write(array, i, v):
    """Store v in row i of an array (n, 3)."""
    array[i, 0], array[i, 1], array[i, 2] = v.x, v.y, v.z


@leaf
def plus(a, b):
    """Return a + b."""
    return Vec(a.x + b.x, a.y + b.y, a.z + b.z)


@leaf
def minus(a, b):
    """Return a − b."""
    return Vec(a.x - b.x, a.y - b.y, a.z - b.z)


@leaf
def plus_scaled(a, factor, b):
    """Return a + factor b."""
    return Vec(a.x + factor * b.x, a.y + factor * b.y, a.z + factor * b.z)


@leaf
def minus_scaled(a, factor, b):
    """Return a − factor b."""
    return Vec(a.x - factor * b.x, a.y - factor * b.y, a.z - factor * b.z)


@leaf
def negative(a):
    """Return −a."""
    return Vec(-a.x, -a.y, -a.z)


@leaf
def scaled(factor, a):
    """Return factor a."""
    return Vec(factor * a.x, factor * a.y, factor * a.z)


@leaf
def over(a, divisor):
    """Return a / divisor, which rounds differently from the product with the inverse of the divisor."""
    return Vec(a.x / divisor, a.y / divisor, a.z / divisor)


@leaf
def dot(a, b):
    """Return a · b."""
    return a.x * b.x + a.y * b.y + a.z * b.z


@leaf
def cross(a, b):
    """Return a × b."""
    return Vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)


@leaf
def triple(a, b, c):
    """Return (a × b) · c, six times the signed volume of the tetrahedron that the three vectors span."""
    return dot(cross(a, b), c)


@leaf
def squared(a):
    """Return a · a."""
    return a.x * a.x + a.y * a.y + a.z * a.z


@leaf
def length(a):
    """Return the length of a."""
    return np.sqrt(a.x * a.x + a.y * a.y + a.z * a.z)


@leaf
def across(a, unit):
    """Return the part of a that is perpendicular to a unit vector."""
    along = dot(a, unit)
    return Vec(a.x - along * unit.x, a.y - along * unit.y, a.z - along * unit.z)


@leaf
def beside(a, unit):
    """Return the length of the part of a that is perpendicular to a unit vector."""
    return length(across(a, unit))


@leaf
def direction_of(a):
    """Return the unit vector along a, or along x if a is zero."""
    reach = length(a)
    if reach > 0.0:
        return over(a, reach)
    return Vec(1.0, 0.0, 0.0)


@leaf
def sideways(a):
    """Return a vector perpendicular to a, not normalised: the cross product with the axis along which a is shortest."""
    if abs(a.x) <= abs(a.y) and abs(a.x) <= abs(a.z):
        return Vec(0.0, -a.z, a.y)
    if abs(a.y) <= abs(a.z):
        return Vec(a.z, 0.0, -a.x)
    return Vec(-a.y, a.x, 0.0)


@leaf
def basis(unit):
    """Return two unit vectors that complete a unit vector to a right-handed frame (Duff et al. 2017)."""
    sign = 1.0 if unit.z >= 0.0 else -1.0
    a = -1.0 / (sign + unit.z)
    b = unit.x * unit.y * a
    tangent = Vec(1.0 + sign * unit.x * unit.x * a, sign * b, -sign * unit.x)
    return tangent, Vec(b, sign + unit.y * unit.y * a, -unit.y)


@leaf
def into_axes(rotation, i, a):
    """Return a world vector in the axes of body i: Rᵀ a, rotation (n, 3, 3)."""
    return Vec(
        rotation[i, 0, 0] * a.x + rotation[i, 1, 0] * a.y + rotation[i, 2, 0] * a.z,
        rotation[i, 0, 1] * a.x + rotation[i, 1, 1] * a.y + rotation[i, 2, 1] * a.z,
        rotation[i, 0, 2] * a.x + rotation[i, 1, 2] * a.y + rotation[i, 2, 2] * a.z,
    )


@leaf
def out_of_axes(rotation, i, a):
    """Return a vector given in the axes of body i as a world vector: R a, rotation (n, 3, 3)."""
    return Vec(
        rotation[i, 0, 0] * a.x + rotation[i, 0, 1] * a.y + rotation[i, 0, 2] * a.z,
        rotation[i, 1, 0] * a.x + rotation[i, 1, 1] * a.y + rotation[i, 1, 2] * a.z,
        rotation[i, 2, 0] * a.x + rotation[i, 2, 1] * a.y + rotation[i, 2, 2] * a.z,
    )
