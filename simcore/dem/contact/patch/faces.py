r"""The faces of two polyhedra that may bound their overlap.

      n
      ^   \          b          /
      |    \   _________       /           high   top of a       faces of b are used if they reach below it
      | - - \-/- - - - -\- - -/- high      low    bottom of b    faces of a are used if they reach above it
      |      /           \   /
      | - - / \_________/_\_/ - low        The faces are stored in the workspace.
      |    /       a       \
"""

from typing import NamedTuple

from simcore.compilation import leaf
from simcore.dem.contact.patch.axes import Axes, axes_in_base, coordinates
from simcore.dem.contact.patch.workspace import start_walk, write_face
from simcore.dem.vectors import Vec, dot, plus, read

ALL_FACES = (-1, -1, -1), (-1, -1, -1)  # `but` of both bodies: no face has these vertices


class Side(NamedTuple):
    """One of the two bodies, for the walk over its faces."""

    number: int  # 0: a, whose faces reach up; 1: b
    first: int  # first vertex of its base
    top: int  # its vertex farthest toward the other body
    base: Axes  # of the patch, in its base
    centre: Vec  # [m], along the axes, from the centre of a


class Slab(NamedTuple):
    """Lowest and highest height of the overlap along n [m], relative to the centre of a."""

    low: float  # of the lowest point of b
    high: float  # of the highest point of a


@leaf
def side_of(shapes, bodies, number, i, top, base, centre):
    """Return side `number` of the pair: body i with its vertex farthest toward the other."""
    return Side(number, shapes.vertex_start[bodies.shape[i]], top, base, centre)


@leaf
def place_vertex(shapes, side, v):
    """Return the coordinates of a vertex along the axes, relative to the centre of a."""
    return plus(side.centre, coordinates(side.base, read(shapes.vertices, v)))


@leaf
def is_in_slab(side, slab, height):
    """Return whether a height [m] of this side is in the slab."""
    return (height >= slab.low) if side.number == 0 else (height <= slab.high)


@leaf
def has_vertices(face, vertices):
    """Return whether all of `vertices` (three, some of which may be equal) are vertices of a face."""
    has_first = vertices[0] == face[0] or vertices[0] == face[1] or vertices[0] == face[2]
    has_second = vertices[1] == face[0] or vertices[1] == face[1] or vertices[1] == face[2]
    return has_first and has_second and (vertices[2] == face[0] or vertices[2] == face[1] or vertices[2] == face[2])


@leaf
def gather_faces(shapes, side, slab, but, workspace, thread):
    """Store the faces of one side that may bound the overlap; return their number.

    These have a vertex in the slab, and not all of the vertices `but`. Because the body is convex, edges connect the
    vertices in the slab with each other, and a walk from the top visits all.
    """
    ring_start, ring = shapes.neighbor_start, shapes.neighbors
    stamp = start_walk(workspace, thread, side.top, side.first)
    mark, stack = workspace.mark, workspace.stack
    n_stack, n_faces = 1, 0
    while n_stack > 0:
        n_stack -= 1
        v = stack[thread, n_stack]
        corner = place_vertex(shapes, side, v)
        last = ring[ring_start[v + 1] - 1]
        last_corner = place_vertex(shapes, side, last)
        last_inside = is_in_slab(side, slab, last_corner.z)
        for k in range(ring_start[v], ring_start[v + 1]):
            u = ring[k]
            next_corner = place_vertex(shapes, side, u)
            inside = is_in_slab(side, slab, next_corner.z)
            if inside and mark[thread, u - side.first] != stamp:
                mark[thread, u - side.first] = stamp
                stack[thread, n_stack] = u
                n_stack += 1
            # To be stored once, the face v, last, u is assigned to the smallest index of its vertices in the slab.
            if not ((inside and u < v) or (last_inside and last < v) or has_vertices((v, last, u), but)):
                write_face(workspace, thread, side.number, n_faces, 0, corner)
                write_face(workspace, thread, side.number, n_faces, 1, last_corner)
                write_face(workspace, thread, side.number, n_faces, 2, next_corner)
                n_faces += 1
            last, last_corner, last_inside = u, next_corner, inside
    return n_faces


@leaf
def gather_both(shapes, bodies, pair, axes, tops, but, workspace, thread):
    """Store the faces of both bodies that may bound the overlap: (numbers of those of a and of b, top of a, Slab).

    tops: the vertex of pair.a farthest along n, and that of pair.b farthest against it. but: of a and of b, as in
    gather_faces.
    """
    base_a, base_b = axes_in_base(bodies, pair.a, axes), axes_in_base(bodies, pair.b, axes)
    top, offset = coordinates(base_a, read(shapes.vertices, tops[0])), coordinates(axes, pair.offset)
    slab = Slab(offset.z + dot(read(shapes.vertices, tops[1]), base_b.n), top.z)
    a = side_of(shapes, bodies, 0, pair.a, tops[0], base_a, Vec(0.0, 0.0, 0.0))
    b = side_of(shapes, bodies, 1, pair.b, tops[1], base_b, offset)
    n_a = gather_faces(shapes, a, slab, but[0], workspace, thread)
    n_b = gather_faces(shapes, b, slab, but[1], workspace, thread)
    return n_a, n_b, top, slab
