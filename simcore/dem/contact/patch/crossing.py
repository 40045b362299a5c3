r"""The overlap of two crossing edges: a pyramid with four sides, in closed form.

     Viewed along n:                    Across the edge of a:

              b1                            n
              |                             ^         c     |
        al    k1                            |        / \    | depth
              |                             |  b0 __/___\___v_ b1
     a0 ---l1-c-l2--- a1                    |     k2     k1
              |                                  /   a   \
        ar    k2
              |
              b0

     a0, a1; b0, b1   ends of the edges           c        where the edges cross in the tangent plane
     al, ar; bl, br   third corners of the        k1, k2   ends of the overlap on the edge of b, left and right of a
                      faces left and right        l1, l2   ends of the overlap on the edge of a, left and right of b

The moments are exact if the four ends are on the edges and on the faces beside them: then no other part of the bodies
reaches into the overlap.
"""

from typing import NamedTuple

from simcore.compilation import leaf
from simcore.dem.contact.patch.axes import Axes, axes_in_base, coordinates
from simcore.dem.contact.patch.corner import FARTHEST
from simcore.dem.contact.patch.moments import (
    NO_MOMENTS,
    Point,
    cone,
    cone_side,
    point_minus,
    point_plus,
    point_scaled,
    shortcut,
    turn,
)
from simcore.dem.contact.patch.workspace import write_corner
from simcore.dem.shapes.polyhedra import vertex_of
from simcore.dem.vectors import Vec, dot, negative, read

NO_SHIFT = Point(-0.0, -0.0)  # adding −0 leaves every number unchanged, including the sign of zero


class Ridge(NamedTuple):
    """The face on one side of an edge."""

    corner: Point  # [m], its third corner
    side: float  # [m²], signed distance of that corner from the line of the edge, times the length of the edge
    share: float  # share of that distance at which the face, or its plane, leaves the slab of the overlap


class Edge(NamedTuple):
    """An edge in the tangent plane, relative to the centre of body a."""

    start: Point  # [m]
    end: Point
    level: float  # [m], height of the start along the body's outward direction
    left: Ridge
    right: Ridge


@leaf
def facing_vertices(shapes, v, u):
    """Return the two vertices that make a face with the edge v, u; v twice if there is no such edge."""
    start, ring = shapes.neighbor_start, shapes.neighbors
    first, last = start[v], start[v + 1] - 1
    for k in range(first, last + 1):
        if ring[k] == u:
            return ring[k - 1] if k > first else ring[last], ring[k + 1] if k < last else ring[first]
    return v, v


@leaf
def in_plane(v, base, shift):
    """Return a base vertex in the tangent plane."""
    return Point(shift.x + dot(v, base.p), shift.y + dot(v, base.q))


@leaf
def ridge_of(v, base, shift, start, end, level, depth):
    """Return the Ridge beside the edge from start to end, with the third corner v of its face, a base vertex."""
    corner = in_plane(v, base, shift)
    fall = level - dot(v, base.n)
    return Ridge(corner, turn(point_minus(end, start), point_minus(corner, start)), depth / fall)


@leaf
def edge_of(vertices, ends, facing, base, shift, depth):
    """Return the Edge between two vertices. facing: the third vertices of the faces beside it; base.n: outward."""
    v = read(vertices, ends[0])
    start, end = in_plane(v, base, shift), in_plane(read(vertices, ends[1]), base, shift)
    level = dot(v, base.n)
    left = ridge_of(read(vertices, facing[0]), base, shift, start, end, level, depth)
    right = ridge_of(read(vertices, facing[1]), base, shift, start, end, level, depth)
    return Edge(start, end, level, left, right)


@leaf
def is_in_triangle(p, a, b, c):
    """Return whether a point is in a triangle of either orientation."""
    at_a = turn(point_minus(b, a), point_minus(p, a))
    at_b = turn(point_minus(c, b), point_minus(p, b))
    at_c = turn(point_minus(a, c), point_minus(p, c))
    return (at_a >= 0.0 and at_b >= 0.0 and at_c >= 0.0) or (at_a <= 0.0 and at_b <= 0.0 and at_c <= 0.0)


@leaf
def is_on_face(point, edge, ridge):
    """Return whether a point is on the face beside an edge."""
    return is_in_triangle(point, edge.start, edge.end, ridge.corner)


@leaf
def crossing_overlap(shapes, bodies, pair, view, ends_a, ends_b, workspace, thread):
    """Return the Shortcut of an edge of pair.a and one of pair.b (two vertices each); moments are about the crossing.

    The origin is the crossing, relative to the first vertex of the edge of a. If the moments are not exact, the four
    ends are stored as corners of a pyramid that contains the overlap, unless they are too far away.
    """
    nothing = shortcut(False, Point(0.0, 0.0), NO_MOMENTS, 0)
    depth, vertices = view.depth, shapes.vertices
    facing_a = facing_vertices(shapes, ends_a[0], ends_a[1])
    facing_b = facing_vertices(shapes, ends_b[0], ends_b[1])
    if facing_a[0] == ends_a[0] or facing_b[0] == ends_b[0]:
        return nothing
    axes, offset = view.axes, coordinates(view.axes, pair.offset)
    a = edge_of(vertices, ends_a, facing_a, axes_in_base(bodies, pair.a, axes), NO_SHIFT, depth)
    toward_a = axes_in_base(bodies, pair.b, Axes(axes.p, axes.q, negative(axes.n)))
    b = edge_of(vertices, ends_b, facing_b, toward_a, Point(offset.x, offset.y), depth)
    smallest = min(min(a.left.share, a.right.share), min(b.left.share, b.right.share))
    largest = max(max(a.left.share, a.right.share), max(b.left.share, b.right.share))
    if not (smallest > 0.0 and largest < FARTHEST):
        return nothing
    if a.left.side * a.right.side >= 0.0 or b.left.side * b.right.side >= 0.0:
        return nothing
    along_a, along_b = point_minus(a.end, a.start), point_minus(b.end, b.start)
    area = turn(along_a, along_b)
    if area == 0.0:
        return nothing
    # The crossing is at the share s of the edge of a and t of the edge of b.
    between = point_minus(b.start, a.start)
    s, t = turn(between, along_b) / area, turn(between, along_a) / area
    # Along the edge of b the signed distance (side) from the line of a grows by `area`; along a, that from b by −area.
    t1, t2 = a.left.share * a.left.side / area, a.right.share * a.right.side / area
    s1, s2 = -b.left.share * b.left.side / area, -b.right.share * b.right.side / area
    crossing = point_plus(a.start, point_scaled(s, along_a))
    k1, k2, l1, l2 = (
        point_scaled(t1, along_b), point_scaled(t2, along_b), point_scaled(s1, along_a), point_scaled(s2, along_a)
    )  # fmt: skip
    end_k1, end_k2 = point_plus(crossing, k1), point_plus(crossing, k2)
    end_l1, end_l2 = point_plus(crossing, l1), point_plus(crossing, l2)
    if not (
        largest < 1.0
        and min(t + t1, t + t2) >= 0.0 and max(t + t1, t + t2) <= 1.0
        and min(s + s1, s + s2) >= 0.0 and max(s + s1, s + s2) <= 1.0
        and is_on_face(end_k1, a, a.left) and is_on_face(end_k2, a, a.right)
        and is_on_face(end_l1, b, b.left) and is_on_face(end_l2, b, b.right)
    ):  # fmt: skip
        if not max(max(abs(t1), abs(t2)), max(abs(s1), abs(s2))) < FARTHEST:
            return nothing
        # A pyramid with the apex k1; the order of the others depends on the side on which it is.
        if (s2 - s1) * (t2 - t1) * area > 0.0:
            end_l1, end_l2 = end_l2, end_l1
        write_corner(workspace, thread, 0, 0, Vec(end_k1.x, end_k1.y, a.level - depth))
        write_corner(workspace, thread, 0, 1, Vec(end_k2.x, end_k2.y, a.level - depth))
        write_corner(workspace, thread, 0, 2, Vec(end_l1.x, end_l1.y, a.level))
        write_corner(workspace, thread, 0, 3, Vec(end_l2.x, end_l2.y, a.level))
        return shortcut(False, Point(0.0, 0.0), NO_MOMENTS, 4)
    sums = NO_MOMENTS
    for k in (k1, k2):
        for l in (l1, l2):  # noqa: E741
            sums = cone_side(sums, abs(turn(k, l)), k, l)
    start = coordinates(axes, vertex_of(shapes, bodies, pair.a, ends_a[0]))
    return shortcut(True, Point(crossing.x - start.x, crossing.y - start.y), cone(sums, depth), 0)
