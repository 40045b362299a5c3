r"""The axes of a patch, and the coordinates of vertices along them.

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
from simcore.dem.shapes.polyhedra import base_direction_of
from simcore.dem.vectors import Vec, basis, dot, negative


class Axes(NamedTuple):
    """Three perpendicular unit vectors, or the corresponding directions in the base of a body."""

    p: Vec
    q: Vec
    n: Vec


class View(NamedTuple):
    """The overlap as viewed from one of the bodies."""

    axes: Axes
    depth: float  # [m], of the overlap along n
    sign: float  # 1 from a: the other body is along n; −1 from b: the other body is along −n


@leaf
def axes_about(normal):
    """Return axes whose n is the unit vector `normal`."""
    p, q = basis(normal)
    return Axes(p, q, normal)


@leaf
def axes_in_base(bodies, i, axes):
    """Return world axes as directions in the base of body i, for dot products with base vertices."""
    return Axes(
        base_direction_of(bodies, i, axes.p), base_direction_of(bodies, i, axes.q), base_direction_of(bodies, i, axes.n)
    )


@leaf
def toward_other(view):
    """Return the axes of a view with n from the viewing body to the other body."""
    return Axes(view.axes.p, view.axes.q, view.axes.n if view.sign > 0.0 else negative(view.axes.n))


@leaf
def coordinates(axes, v):
    """Return the components of a vector along the axes."""
    return Vec(dot(axes.p, v), dot(axes.q, v), dot(axes.n, v))
