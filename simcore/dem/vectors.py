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
