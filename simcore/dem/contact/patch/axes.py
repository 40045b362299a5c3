r"""The axes of a patch, and how vertices of a body are measured along them.

        n
        ^    b
 \      |      /       n      contact normal, from a to b
  \_____|_____/        p, q   span the tangent plane; p, q, n are unit vectors of a right-handed frame
        +-----> p
 ___________           A vertex v of a base, which is neither scaled nor turned, is at (base.p · v, base.q · v,
/     a     \          base.n · v) from the centre of its body, along these axes: base = axes_in_base(...).
"""

from typing import NamedTuple

from simcore.compilation import leaf
from simcore.dem.shapes.hulls import base_direction_of
from simcore.dem.vectors import Vec, basis, dot, negative


class Axes(NamedTuple):
    """Three perpendicular unit vectors; or, of a base, the directions that stand for them there."""

    p: Vec
    q: Vec
    n: Vec


class View(NamedTuple):
    """How one of the bodies sees the overlap."""

    axes: Axes
    depth: float  # [m], of the overlap along n
    sign: float  # 1 from a, where the other body lies along n; −1 from b, where it lies along −n


@leaf
def axes_about(normal):
    """Axes whose n is the unit vector `normal`."""
    p, q = basis(normal)
    return Axes(p, q, normal)


@leaf
def axes_in_base(bodies, i, axes):
    """World axes as directions in the base of body i: their products with a base vertex are those with the vertex."""
    return Axes(
        base_direction_of(bodies, i, axes.p), base_direction_of(bodies, i, axes.q), base_direction_of(bodies, i, axes.n)
    )


@leaf
def toward_other(view):
    """The axes of a view, n pointing from the body that sees the overlap to the other."""
    return Axes(view.axes.p, view.axes.q, view.axes.n if view.sign > 0.0 else negative(view.axes.n))


@leaf
def coordinates(axes, v):
    """Components of a vector along the axes."""
    return Vec(dot(axes.p, v), dot(axes.q, v), dot(axes.n, v))
