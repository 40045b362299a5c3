"""A pair of polyhedra in the axes of body a: the form in which the searches compute.

The Minkowski difference is M = A − (B + r). The matrix of b carries its scale, so a vertex of b is one matrix times its
base vertex, and a direction for its base the transpose times the direction.
"""

from typing import NamedTuple

from simcore.compilation import leaf
from simcore.dem.shapes.hulls import climb, climb_from_hint
from simcore.dem.vectors import Vec, dot, into_axes, minus, negative, plus_scaled, read, scaled


class Frame(NamedTuple):
    """Polyhedra a and b in the axes of a. The rows are those of the matrix W = Rₐᵀ R_b diag(scale of b)."""

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
    """Vertices of a and of b whose differences are three corners of a facet of M, or of its part next to the origin.

    -1 for corners that the part does not have.
    """

    a0: int
    a1: int
    a2: int
    b0: int
    b1: int
    b2: int


@leaf
def frame_of(bodies, pair):
    """The pair in the axes of its body a."""
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
    """Vertex of a, from its centre."""
    v = shapes.vertices
    return Vec(f.scale.x * v[a, 0], f.scale.y * v[a, 1], f.scale.z * v[a, 2])


@leaf
def vertex_b(shapes, f, b):
    """Vertex of b, from its centre."""
    v = read(shapes.vertices, b)
    return Vec(dot(f.row_x, v), dot(f.row_y, v), dot(f.row_z, v))


@leaf
def direction_a(f, normal):
    """A direction as that in which the base of a has its support point."""
    return Vec(f.scale.x * normal.x, f.scale.y * normal.y, f.scale.z * normal.z)


@leaf
def direction_b(f, normal):
    """A direction as that in which the base of b has its support point."""
    return plus_scaled(plus_scaled(scaled(normal.x, f.row_x), normal.y, f.row_y), normal.z, f.row_z)


@leaf
def climb_a(shapes, f, a, normal):
    """Vertex of a farthest along n, from vertex a."""
    d = direction_a(f, normal)
    return climb(shapes, a, d.x, d.y, d.z)


@leaf
def climb_b(shapes, f, b, normal):
    """Vertex of b farthest along n, from vertex b."""
    d = direction_b(f, normal)
    return climb(shapes, b, d.x, d.y, d.z)


@leaf
def difference(shapes, f, a, b):
    """The point m = a − b − r of vertices a and b."""
    return minus(minus(vertex_a(shapes, f, a), vertex_b(shapes, f, b)), f.offset)


@leaf
def support(shapes, f, a, b, normal):
    """Support point of M along n; vertices a and b are where the climbs start."""
    a = climb_a(shapes, f, a, normal)
    b = climb_b(shapes, f, b, negative(normal))
    return Support(a, b, difference(shapes, f, a, b))


@leaf
def support_afar(shapes, f, normal):
    """Support point of M along a direction far from the last one."""
    d = direction_a(f, normal)
    a = climb_from_hint(shapes, f.shape_a, d.x, d.y, d.z)
    d = negative(direction_b(f, normal))
    b = climb_from_hint(shapes, f.shape_b, d.x, d.y, d.z)
    return Support(a, b, difference(shapes, f, a, b))
