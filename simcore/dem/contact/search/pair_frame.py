"""A pair of polyhedra in the axes of body a, in which the searches compute.

The Minkowski difference is M = A − (B + r). The matrix of b includes its scale, so that a vertex of b is this matrix
times the base vertex, and a direction in its base is the transposed matrix times the direction.
"""

from typing import NamedTuple

from simcore.compilation import leaf
from simcore.dem.shapes.polyhedra import climb, climb_from_hint
from simcore.dem.vectors import Vec, dot, into_axes, minus, negative, plus_scaled, read, scaled


class Frame(NamedTuple):
    """Polyhedra a and b in the axes of a. row_x, row_y, row_z: rows of the matrix W = Rₐᵀ R_b diag(scale of b)."""

    scale: Vec  # of a
    row_x: Vec
    row_y: Vec
    row_z: Vec
    offset: Vec  # [m], from the centre of a to that of b
    shape_a: int
    shape_b: int
    size: float  # [m], of the pair


class Support(NamedTuple):
    """A point of M: the vertices a and b whose difference it is, and the point m = a − b − r."""

    a: int
    b: int
    point: Vec


class Facet(NamedTuple):
    """Vertices of a and b whose differences are three corners of a facet of M, or of its part nearest to the origin.

    Corners that the part does not have are -1.
    """

    a0: int
    a1: int
    a2: int
    b0: int
    b1: int
    b2: int


@leaf
def frame_of(bodies, pair):
    """Return the pair in the axes of its body a."""
    rotation, scale, i, j = bodies.rotation, bodies.scale, pair.a, pair.b
    x = into_axes(rotation, i, Vec(rotation[j, 0, 0], rotation[j, 1, 0], rotation[j, 2, 0]))
    y = into_axes(rotation, i, Vec(rotation[j, 0, 1], rotation[j, 1, 1], rotation[j, 2, 1]))
    z = into_axes(rotation, i, Vec(rotation[j, 0, 2], rotation[j, 1, 2], rotation[j, 2, 2]))
    x, y, z = scaled(scale[j, 0], x), scaled(scale[j, 1], y), scaled(scale[j, 2], z)
    return Frame(
        read(scale, i),
        Vec(x.x, y.x, z.x), Vec(x.y, y.y, z.y), Vec(x.z, y.z, z.z),
        into_axes(rotation, i, pair.offset), bodies.shape[i], bodies.shape[j], pair.size,
    )  # fmt: skip


@leaf
def vertex_a(shapes, f, a):
    """Return a vertex of a, relative to its centre."""
    v = shapes.vertices
    return Vec(f.scale.x * v[a, 0], f.scale.y * v[a, 1], f.scale.z * v[a, 2])


@leaf
def vertex_b(shapes, f, b):
    """Return a vertex of b, relative to its centre."""
    v = read(shapes.vertices, b)
    return Vec(dot(f.row_x, v), dot(f.row_y, v), dot(f.row_z, v))


@leaf
def direction_a(f, normal):
    """Return the direction in the base of a whose support point is that of a along n."""
    return Vec(f.scale.x * normal.x, f.scale.y * normal.y, f.scale.z * normal.z)


@leaf
def direction_b(f, normal):
    """Return the direction in the base of b whose support point is that of b along n."""
    return plus_scaled(plus_scaled(scaled(normal.x, f.row_x), normal.y, f.row_y), normal.z, f.row_z)


@leaf
def climb_a(shapes, f, a, normal):
    """Return the vertex of a farthest along n, by a climb from vertex a."""
    d = direction_a(f, normal)
    return climb(shapes, a, d.x, d.y, d.z)


@leaf
def climb_b(shapes, f, b, normal):
    """Return the vertex of b farthest along n, by a climb from vertex b."""
    d = direction_b(f, normal)
    return climb(shapes, b, d.x, d.y, d.z)


@leaf
def difference(shapes, f, a, b):
    """Return the point m = a − b − r of vertices a and b."""
    return minus(minus(vertex_a(shapes, f, a), vertex_b(shapes, f, b)), f.offset)


@leaf
def support(shapes, f, a, b, normal):
    """Return the support point of M along n; the climbs start from vertices a and b."""
    a = climb_a(shapes, f, a, normal)
    b = climb_b(shapes, f, b, negative(normal))
    return Support(a, b, difference(shapes, f, a, b))


@leaf
def support_afar(shapes, f, normal):
    """Return the support point of M along a direction far from the last one; the climbs start from hints."""
    d = direction_a(f, normal)
    a = climb_from_hint(shapes, f.shape_a, d.x, d.y, d.z)
    d = negative(direction_b(f, normal))
    b = climb_from_hint(shapes, f.shape_b, d.x, d.y, d.z)
    return Support(a, b, difference(shapes, f, a, b))
