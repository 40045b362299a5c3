r"""Moments of the depth of an overlap over the tangent plane, from triangles.

     d       c              x, y     coordinates in the tangent plane
     ^      /|\             d        depth of the overlap, linear over a triangle
     |     / | \            a, b, c  corners of a triangle; their depths are a.z, b.z, c.z
     |  a *  |  * b
     |    |..|..|           The moments are ∫ d, ∫ d x, ∫ d y, ∫ d x², ∫ d xy, ∫ d y² over the plane.
     +-------------> x, y

The overlap of a corner with a face, or of two crossing edges, is a pyramid whose depth is `depth` at the origin and
zero at the ends s and e of each side. Its moments follow from sums of `cone_side`.
"""

from typing import NamedTuple

from simcore.compilation import leaf
from simcore.dem.vectors import cross, dot


class Point(NamedTuple):
    """A point, or a vector, in the tangent plane [m]."""

    x: float
    y: float


class Moments(NamedTuple):
    """Integrals of the depth d over the tangent plane."""

    d: float  # [m³]
    dx: float  # [m⁴]
    dy: float
    dxx: float  # [m⁵]
    dxy: float
    dyy: float


class Shortcut(NamedTuple):
    """The moments in closed form of the overlap of a corner with a face, or of two edges."""

    exact: bool  # whether the moments are those of the overlap: no other part of the bodies reaches into it
    origin: Point  # reference point of the moments, relative to the vertex that `find_patch` uses
    moments: Moments
    n_corners: int  # of a pyramid in the workspace that contains the overlap (polytope.py); 0: there is none


NO_MOMENTS = Moments(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@leaf
def shortcut(exact, origin, moments, n_corners):
    """Return a Shortcut whose fields always have the same types, as compiled code requires."""
    return Shortcut(bool(exact), origin, moments, int(n_corners))


@leaf
def point_plus(a, b):
    """Return a + b."""
    return Point(a.x + b.x, a.y + b.y)


@leaf
def point_minus(a, b):
    """Return a − b."""
    return Point(a.x - b.x, a.y - b.y)


@leaf
def point_scaled(factor, a):
    """Return factor a."""
    return Point(factor * a.x, factor * a.y)


@leaf
def turn(a, b):
    """Return twice the signed area between two vectors of the plane, positive if b is counterclockwise of a."""
    return a.x * b.y - a.y * b.x


@leaf
def add_moments(m, s):
    """Return the moments of two parts together."""
    return Moments(m.d + s.d, m.dx + s.dx, m.dy + s.dy, m.dxx + s.dxx, m.dxy + s.dxy, m.dyy + s.dyy)


@leaf
def triangle_moments(a, b, c):
    """Return the moments over a triangle whose corners have the depths a.z, b.z and c.z; minus those if clockwise.

    Products of powers a, b, c of the barycentric coordinates integrate to 2 A a! b! c! / (a + b + c + 2)!.
    """
    double_area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
    total = a.z + b.z + c.z
    first = double_area / 24.0
    w1, w2, w3 = total + a.z, total + b.z, total + c.z
    second = double_area / 120.0
    a1, a2, a3 = 2.0 * total + 4.0 * a.z, 2.0 * total + 4.0 * b.z, 2.0 * total + 4.0 * c.z
    b12, b23, b31 = total + a.z + b.z, total + b.z + c.z, total + c.z + a.z
    # Each mixed term occurs twice in the sum over i, j.
    return Moments(
        double_area * total / 6.0,
        first * (w1 * a.x + w2 * b.x + w3 * c.x),
        first * (w1 * a.y + w2 * b.y + w3 * c.y),
        second * (a1 * a.x * a.x + a2 * b.x * b.x + a3 * c.x * c.x
                  + 2.0 * (b12 * a.x * b.x + b23 * b.x * c.x + b31 * c.x * a.x)),
        second * (a1 * a.x * a.y + a2 * b.x * b.y + a3 * c.x * c.y
                  + b12 * (a.x * b.y + b.x * a.y) + b23 * (b.x * c.y + c.x * b.y) + b31 * (c.x * a.y + a.x * c.y)),
        second * (a1 * a.y * a.y + a2 * b.y * b.y + a3 * c.y * c.y
                  + 2.0 * (b12 * a.y * b.y + b23 * b.y * c.y + b31 * c.y * a.y)),
    )  # fmt: skip


@leaf
def tetrahedron_moments(a, b, c):
    """Return the moments of the tetrahedron of the origin and a, b, c, counterclockwise from outside; else minus those.

    Products of powers a, b, c of the barycentric coordinates integrate to 6 V a! b! c! / (a + b + c + 3)!.
    """
    six_volumes = dot(a, cross(b, c))
    x, y = a.x + b.x + c.x, a.y + b.y + c.y
    first, second = six_volumes / 24.0, six_volumes / 120.0
    return Moments(
        six_volumes / 6.0, first * x, first * y,
        second * (a.x * a.x + b.x * b.x + c.x * c.x + x * x),
        second * (a.x * a.y + b.x * b.y + c.x * c.y + x * y),
        second * (a.y * a.y + b.y * b.y + c.y * c.y + y * y),
    )  # fmt: skip


@leaf
def cone_side(m, area, s, e):
    """Add the triangle of the origin, s and e, of twice the area `area`, to sums m, which `cone` turns into moments."""
    return Moments(
        m.d + area,
        m.dx + area * (s.x + e.x),
        m.dy + area * (s.y + e.y),
        m.dxx + area * (s.x * s.x + e.x * e.x + s.x * e.x),
        m.dxy + area * (s.x * s.y + e.x * e.y + 0.5 * (s.x * e.y + e.x * s.y)),
        m.dyy + area * (s.y * s.y + e.y * e.y + s.y * e.y),
    )


@leaf
def cone(m, depth):
    """Return the moments of a pyramid with this depth at the origin: 1/6, 1/24 and 1/60 of the sums of `cone_side`."""
    return Moments(
        m.d * depth / 6.0, m.dx * depth / 24.0, m.dy * depth / 24.0,
        m.dxx * depth / 60.0, m.dxy * depth / 60.0, m.dyy * depth / 60.0,
    )  # fmt: skip


@leaf
def write_spread(spread, k, axes, xx, xy, yy):
    """Store second moments [m²] of the tangent plane in row k, as a symmetric matrix in world axes."""
    p, q = axes.p, axes.q
    spread[k, 0] = xx * p.x * p.x + 2.0 * xy * p.x * q.x + yy * q.x * q.x
    spread[k, 1] = xx * p.y * p.y + 2.0 * xy * p.y * q.y + yy * q.y * q.y
    spread[k, 2] = xx * p.z * p.z + 2.0 * xy * p.z * q.z + yy * q.z * q.z
    spread[k, 3] = xx * p.x * p.y + xy * (p.x * q.y + p.y * q.x) + yy * q.x * q.y
    spread[k, 4] = xx * p.x * p.z + xy * (p.x * q.z + p.z * q.x) + yy * q.x * q.z
    spread[k, 5] = xx * p.y * p.z + xy * (p.y * q.z + p.z * q.y) + yy * q.y * q.z
