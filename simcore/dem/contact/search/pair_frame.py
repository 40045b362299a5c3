"""A pair of polyhedra in the axes of body a, as scalars: the form in which the searches compute.

The matrix of b carries its scale, so a vertex of b is one matrix times its base vertex, and a direction for its base
the transpose times the direction.
"""

from typing import NamedTuple

from simcore.compilation import leaf
from simcore.dem.shapes.hulls import climb, climb_from_hint


class Frame(NamedTuple):
    """Scale of a; W = Rₐᵀ R_b diag(scale of b); offset Rₐᵀ r from the centre of a to that of b."""

    ax: float
    ay: float
    az: float
    xx: float
    xy: float
    xz: float
    yx: float
    yy: float
    yz: float
    zx: float
    zy: float
    zz: float
    rx: float
    ry: float
    rz: float
    shape_a: int
    shape_b: int


@leaf
def to_body(rotation, i, x, y, z):
    """A world vector in the axes of body i."""
    return (
        rotation[i, 0, 0] * x + rotation[i, 1, 0] * y + rotation[i, 2, 0] * z,
        rotation[i, 0, 1] * x + rotation[i, 1, 1] * y + rotation[i, 2, 1] * z,
        rotation[i, 0, 2] * x + rotation[i, 1, 2] * y + rotation[i, 2, 2] * z,
    )


@leaf
def to_world(rotation, i, x, y, z):
    """A vector in the axes of body i in the world's."""
    return (
        rotation[i, 0, 0] * x + rotation[i, 0, 1] * y + rotation[i, 0, 2] * z,
        rotation[i, 1, 0] * x + rotation[i, 1, 1] * y + rotation[i, 1, 2] * z,
        rotation[i, 2, 0] * x + rotation[i, 2, 1] * y + rotation[i, 2, 2] * z,
    )


@leaf
def frame_of(bodies, i, j, rx, ry, rz):
    """The pair i, j with offset r [m, world] from i to j."""
    rotation, scale = bodies.rotation, bodies.scale
    xx, yx, zx = to_body(rotation, i, rotation[j, 0, 0], rotation[j, 1, 0], rotation[j, 2, 0])
    xy, yy, zy = to_body(rotation, i, rotation[j, 0, 1], rotation[j, 1, 1], rotation[j, 2, 1])
    xz, yz, zz = to_body(rotation, i, rotation[j, 0, 2], rotation[j, 1, 2], rotation[j, 2, 2])
    rx, ry, rz = to_body(rotation, i, rx, ry, rz)
    bx, by, bz = scale[j, 0], scale[j, 1], scale[j, 2]
    return Frame(
        scale[i, 0], scale[i, 1], scale[i, 2],
        xx * bx, xy * by, xz * bz, yx * bx, yy * by, yz * bz, zx * bx, zy * by, zz * bz,
        rx, ry, rz, bodies.shape[i], bodies.shape[j],
    )  # fmt: skip


@leaf
def vertex_a(shapes, f, a):
    """Vertex of a from its centre."""
    v = shapes.vertices
    return f.ax * v[a, 0], f.ay * v[a, 1], f.az * v[a, 2]


@leaf
def vertex_b(shapes, f, b):
    """Vertex of b from its centre."""
    v = shapes.vertices
    x, y, z = v[b, 0], v[b, 1], v[b, 2]
    return f.xx * x + f.xy * y + f.xz * z, f.yx * x + f.yy * y + f.yz * z, f.zx * x + f.zy * y + f.zz * z


@leaf
def climb_a(shapes, f, a, nx, ny, nz):
    """Vertex of a farthest along n, from vertex a."""
    return climb(shapes, a, f.ax * nx, f.ay * ny, f.az * nz)


@leaf
def climb_b(shapes, f, b, nx, ny, nz):
    """Vertex of b farthest along n, from vertex b."""
    return climb(
        shapes,
        b,
        f.xx * nx + f.yx * ny + f.zx * nz,
        f.xy * nx + f.yy * ny + f.zy * nz,
        f.xz * nx + f.yz * ny + f.zz * nz,
    )


@leaf
def difference(shapes, f, a, b):
    """The point m = a − b − r of vertices a and b."""
    ax, ay, az = vertex_a(shapes, f, a)
    bx, by, bz = vertex_b(shapes, f, b)
    return ax - bx - f.rx, ay - by - f.ry, az - bz - f.rz


@leaf
def support(shapes, f, a, b, nx, ny, nz):
    """Support point of M along n: vertices a and b, climbed to from those given, and m = a − b − r."""
    a = climb_a(shapes, f, a, nx, ny, nz)
    b = climb_b(shapes, f, b, -nx, -ny, -nz)
    x, y, z = difference(shapes, f, a, b)
    return a, b, x, y, z


@leaf
def support_afar(shapes, f, nx, ny, nz):
    """As `support`, along a direction far from the last."""
    a = climb_from_hint(shapes, f.shape_a, f.ax * nx, f.ay * ny, f.az * nz)
    b = climb_from_hint(
        shapes,
        f.shape_b,
        -(f.xx * nx + f.yx * ny + f.zx * nz),
        -(f.xy * nx + f.yy * ny + f.zy * nz),
        -(f.xz * nx + f.yz * ny + f.zz * nz),
    )
    x, y, z = difference(shapes, f, a, b)
    return a, b, x, y, z
