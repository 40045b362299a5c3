"""Shapes: a base shape and three scales.

The base is the unit sphere or a convex polyhedron whose principal axes are the coordinate axes. Each body has a scale
(sx, sy, sz), which represents spheres, ellipsoids, sieve scaling and the rescaling of form alike. A diagonal scaling
does not change the principal axes (mean second moments <x_i x_j> -> s_i s_j <x_i x_j>), so that volume and inertia
follow in closed form and the edge graph of the polyhedron stays valid.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from simcore.compilation import leaf
from simcore.dem.vectors import Vec
from simcore.scene.shapes import ELLIPSOID, MIXED, POLYHEDRON, SPHERE, Base, unit_sphere  # noqa: F401

HINT_GRID = 6  # cells along the edge of the cube of directions; a climb from the hint of a cell takes 1 or 2 edges
HINT_CELLS = 6 * HINT_GRID * HINT_GRID


class Shapes(NamedTuple):
    """All base shapes of a scene: the vertices of all polyhedra in one array, with their edge graph (CSR)."""

    vertex_start: np.ndarray  # (n_shapes + 1,) int64
    vertices: np.ndarray  # (n_vertices, 3)
    neighbor_start: np.ndarray  # (n_vertices + 1,) int64
    neighbors: np.ndarray  # int64, indices into vertices; counterclockwise around each vertex, viewed from outside
    hints: np.ndarray  # (n_shapes, HINT_CELLS) int32: vertex farthest along the middle of each cell of directions


def collect_shapes(bases: list[Base]) -> Shapes:
    """Return the Shapes of base shapes. ValueError if a vertex has no face or the faces around it do not close."""
    counts = [len(base.vertices) for base in bases]
    vertex_start = np.concatenate(([0], np.cumsum(counts))).astype(np.int64)
    starts, rings = [np.zeros(1, np.int64)], []
    for base, offset in zip(bases, vertex_start[:-1], strict=True):
        start, ring = _rings(base)
        starts.append(start[1:] + sum(map(len, rings)))
        rings.append(ring + offset)
    return Shapes(
        vertex_start,
        np.concatenate([base.vertices for base in bases]).astype(np.float64).reshape(-1, 3),
        np.concatenate(starts),
        np.concatenate(rings),
        np.array([_hints(base) + offset for base, offset in zip(bases, vertex_start[:-1], strict=True)], np.int32),
    )


def _rings(base: Base):
    """Return the neighbours of every vertex, counterclockwise viewed from outside: (start (n + 1,), neighbours).

    Consecutive neighbours u, w of a vertex v make the face v, u, w, so that no array of faces is needed.
    """
    n = len(base.vertices)
    after = [{} for _ in range(n)]
    for a, b, c in np.asarray(base.faces, np.int64):
        after[a][b], after[b][c], after[c][a] = c, a, b
    ring, start = [], np.zeros(n + 1, np.int64)
    for v in range(n):
        if not after[v]:
            raise ValueError(
                f"shape {base.name}: vertex {v} belongs to no face. Remove points that are not corners of the hull."
            )
        start_neighbor = u = min(after[v])
        for _ in range(len(after[v])):
            ring.append(u)
            u = after[v].get(u, -1)
        if u != start_neighbor:
            raise ValueError(
                f"shape {base.name}: the faces around vertex {v} do not close. The surface of the polyhedron must be "
                "closed, and the corners of all faces must be counterclockwise as seen from outside."
            )
        start[v + 1] = len(ring)
    return start, np.array(ring, np.int64)


def _hints(base: Base) -> np.ndarray:
    """Return the vertices (HINT_CELLS,) of the base farthest along the middle of each cell; numbers as `hint_cell`."""
    if not len(base.vertices):
        return np.zeros(HINT_CELLS, np.int64)
    middle = (np.arange(HINT_GRID) + 0.5) * (2.0 / HINT_GRID) - 1.0
    directions = np.empty((3, 2, HINT_GRID, HINT_GRID, 3))
    for axis in range(3):
        for side in range(2):
            directions[axis, side, :, :, axis] = 2.0 * side - 1.0
            directions[axis, side, :, :, (axis + 1) % 3] = middle[:, None]
            directions[axis, side, :, :, (axis + 2) % 3] = middle[None, :]
    return np.argmax(directions.reshape(-1, 3) @ base.vertices.T, axis=1)


@leaf
def hint_cell(x, y, z):
    """Return the cell of a direction of the base frame on the cube of directions.

    The axis and sign of the largest component select the face of the cube, the other two components row and column.
    """
    ax, ay, az = abs(x), abs(y), abs(z)
    if ax >= ay and ax >= az:
        first, main, size, u, v = 0, x, ax, y, z
    elif ay >= az:
        first, main, size, u, v = 2, y, ay, z, x
    else:
        first, main, size, u, v = 4, z, az, x, y
    half = 0.5 * HINT_GRID / size
    row = min(int(u * half + 0.5 * HINT_GRID), HINT_GRID - 1)
    column = min(int(v * half + 0.5 * HINT_GRID), HINT_GRID - 1)
    return ((first + (main > 0.0)) * HINT_GRID + row) * HINT_GRID + column


@leaf
def hint(shapes, shape, dx, dy, dz):
    """Return a vertex near the one farthest along a direction of the base frame, from which a climb is short."""
    if not abs(dx) + abs(dy) + abs(dz) > 0.0:
        return shapes.vertex_start[shape]
    return np.int64(shapes.hints[shape, hint_cell(dx, dy, dz)])


@leaf
def climb_from_hint(shapes, shape, dx, dy, dz):
    """Climb as `climb`, but start from the hint for the direction; for directions far from the last one."""
    return climb(shapes, hint(shapes, shape, dx, dy, dz), dx, dy, dz)


@leaf
def climb(shapes, vertex, dx, dy, dz):
    """Return the vertex farthest along a direction of the base frame, by a climb along the edges from `vertex`.

    On a convex polyhedron a vertex that is above all its neighbours is the farthest of all.
    """
    vertices, start, neighbors = shapes.vertices, shapes.neighbor_start, shapes.neighbors
    best = vertices[vertex, 0] * dx + vertices[vertex, 1] * dy + vertices[vertex, 2] * dz
    while True:
        higher = vertex
        for k in range(start[vertex], start[vertex + 1]):
            other = neighbors[k]
            value = vertices[other, 0] * dx + vertices[other, 1] * dy + vertices[other, 2] * dz
            if value > best:
                best = value
                higher = other
        if higher == vertex:
            return vertex
        vertex = higher


@leaf
def is_polyhedron(shapes, bodies, i):
    """Return whether body i is a polyhedron, that is whether its base has vertices."""
    shape = bodies.shape[i]
    return shapes.vertex_start[shape] < shapes.vertex_start[shape + 1]


@leaf
def base_direction(bodies, i, nx, ny, nz):
    """Return the direction in the base of body i whose support point is that of the world direction n: s ∘ (Rᵀ n)."""
    r = bodies.rotation
    return (
        bodies.scale[i, 0] * (r[i, 0, 0] * nx + r[i, 1, 0] * ny + r[i, 2, 0] * nz),
        bodies.scale[i, 1] * (r[i, 0, 1] * nx + r[i, 1, 1] * ny + r[i, 2, 1] * nz),
        bodies.scale[i, 2] * (r[i, 0, 2] * nx + r[i, 1, 2] * ny + r[i, 2, 2] * nz),
    )


@leaf
def vertex_offset(shapes, bodies, i, vertex):
    """Return the world vector from the centre of body i to a vertex: R (s ∘ v)."""
    r = bodies.rotation
    x = bodies.scale[i, 0] * shapes.vertices[vertex, 0]
    y = bodies.scale[i, 1] * shapes.vertices[vertex, 1]
    z = bodies.scale[i, 2] * shapes.vertices[vertex, 2]
    return (
        r[i, 0, 0] * x + r[i, 0, 1] * y + r[i, 0, 2] * z,
        r[i, 1, 0] * x + r[i, 1, 1] * y + r[i, 1, 2] * z,
        r[i, 2, 0] * x + r[i, 2, 1] * y + r[i, 2, 2] * z,
    )


@leaf
def support_vertex(shapes, bodies, i, vertex, nx, ny, nz):
    """Return the vertex of body i farthest along the world direction n, by a climb from `vertex`."""
    dx, dy, dz = base_direction(bodies, i, nx, ny, nz)
    return climb(shapes, vertex, dx, dy, dz)


@leaf
def base_direction_of(bodies, i, normal):
    """Return `base_direction` for a vector, as a vector."""
    return Vec(*base_direction(bodies, i, normal.x, normal.y, normal.z))


@leaf
def hint_along(shapes, bodies, i, normal):
    """Return `hint` for body i and a vector in world axes."""
    return hint(shapes, bodies.shape[i], *base_direction(bodies, i, normal.x, normal.y, normal.z))


@leaf
def vertex_of(shapes, bodies, i, vertex):
    """Return `vertex_offset` as a vector."""
    return Vec(*vertex_offset(shapes, bodies, i, vertex))


@leaf
def support_vertex_along(shapes, bodies, i, vertex, normal):
    """Return `support_vertex` along a vector."""
    return support_vertex(shapes, bodies, i, vertex, normal.x, normal.y, normal.z)


# Share of the extent of a polyhedron. If it is thinner, its face normals are less accurate than a query requires.
FLATTEST = 1e-7
# Share of the longest semi-axis. Rounding of the matrix R diag(s²) Rᵀ of a thinner ellipsoid changes overlaps by more
# than 1e-5 of themselves.
THINNEST_ELLIPSOID = 1e-6


@dataclass(frozen=True, eq=False)
class Shape:
    """One convex shape in its own frame, for `contact.query`. Created by `sphere`, `ellipsoid` and `convex`."""

    kind: int  # SPHERE, ELLIPSOID or POLYHEDRON
    base: Base  # for a polyhedron: relative to `center`
    scale: tuple[float, float, float]  # semi-axes [m]; 1 for a polyhedron
    center: tuple[float, float, float]  # [m], of the base in the frame in which the shape was given
    radius: float  # [m], of the bounding sphere about the centre


def sphere(radius: float) -> Shape:
    """Return a sphere about the origin. radius [m]; ValueError unless positive and finite."""
    (radius,) = _lengths("sphere", radius=radius)
    return Shape(SPHERE, unit_sphere(), (radius, radius, radius), (0.0, 0.0, 0.0), radius)


def ellipsoid(a: float, b: float, c: float) -> Shape:
    """Return an ellipsoid about the origin with semi-axes a, b, c [m] along x, y, z, in any order of size.

    ValueError unless all are positive and finite, and the shortest is at least 1e-6 of the longest.
    """
    scale = _lengths("ellipsoid", a=a, b=b, c=c)
    if min(scale) < THINNEST_ELLIPSOID * max(scale):
        raise ValueError(
            f"ellipsoid: the shortest semi-axis, {min(scale):g} m, is less than {THINNEST_ELLIPSOID:g} of the longest, "
            f"{max(scale):g} m, so that overlaps would lose their digits. Give a thicker ellipsoid."
        )
    return Shape(ELLIPSOID, unit_sphere(), scale, (0.0, 0.0, 0.0), max(scale))


def convex(vertices) -> Shape:
    """Return the convex hull of points (n, 3) [m] as a polyhedron, in the frame in which the points are given.

    Points inside are dropped, and points that are within 1e-10 of the extent in a face or on an edge, or beside another
    point. ValueError for fewer than four different points, numbers that are not finite, and points in a plane (to 1e-7
    of their extent).
    """
    from simcore.grains.polyhedron import convex_hull  # imported here because the modules of the step do not need it

    try:
        points = np.array(vertices, np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"convex: vertices must be numbers, (n, 3), but are {str(vertices)[:40]!r}.") from None
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"convex: vertices must be an array of shape (n, 3), but the shape is {points.shape}.")
    wrong = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(wrong):
        raise ValueError(f"convex: vertex {wrong[0]}, {points[wrong[0]]}, is not finite. Remove or correct it.")
    points = np.unique(points, axis=0)
    if len(points) < 4:
        raise ValueError(
            f"convex: {len(points)} different points do not make a body. Give at least 4, not all in a plane."
        )
    center = 0.5 * points.min(axis=0) + 0.5 * points.max(axis=0)
    points = points - center
    extent = np.abs(points).max()
    thickness = np.linalg.svd(points / extent - (points / extent).mean(axis=0), compute_uv=False)
    flat = ValueError(
        "convex: the points are in a plane or on a line, to 1e-7 of their extent, but a contact needs a body with "
        "volume. Add points off the plane, or make the plate thicker."
    )
    # The smallest singular value is at most √n times half the thickness; most of the n points may be in a plane.
    if not thickness[2] > FLATTEST:
        raise flat
    try:
        points, faces = convex_hull(points)
    except ValueError:
        raise flat from None
    volume, moments = _moments(points[faces] / extent)
    radius = float(np.sqrt((points**2).sum(axis=1).max()))
    base = Base("convex", points, faces.astype(np.int64), float(volume * extent**3), moments * extent**2)
    return Shape(POLYHEDRON, base, (1.0, 1.0, 1.0), tuple(center), radius)


def _lengths(name: str, **lengths: float) -> tuple[float, ...]:
    try:
        values = tuple(float(value) for value in lengths.values())
    except (TypeError, ValueError):
        given = ", ".join(f"{key} = {value!r}" for key, value in lengths.items())
        raise ValueError(f"{name}: lengths must be numbers [m], but {given}.") from None
    for key, value in zip(lengths, values, strict=True):
        if not (np.isfinite(value) and value > 0.0):
            raise ValueError(f"{name}: {key} must be a positive length [m], but it is {value}.")
    return values


def _moments(corners: np.ndarray) -> tuple[float, np.ndarray]:
    """Return the volume of a closed surface of outward triangles (n, 3, 3), and the mean of x_i² in it about 0."""
    p, q, s = corners[:, 0], corners[:, 1], corners[:, 2]
    six_volumes = (np.cross(p, q) * s).sum(axis=1)
    volume = six_volumes.sum() / 6.0
    squares = p * p + q * q + s * s + p * q + q * s + s * p  # ten times the mean over the tetrahedron with the origin
    return volume, (six_volumes @ squares) / 60.0 / volume
