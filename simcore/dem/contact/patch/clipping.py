r"""The overlap of two polyhedra in general: the faces of each body, cut by the planes of the other.

      n
      ^   \          b          /
      |    \   _________       /           high   top of a       faces of b are used if they reach below it
      | - - \-/- - - - -\- - -/- high      low    bottom of b    faces of a are used if they reach above it
      |      /           \   /
      | - - / \_________/_\_/ - low        The overlap, between the two, is a polytope. Its faces are parts of faces of
      |    /       a       \               a, which point up, and of faces of b, which point down.

The moments are integrals of the height of these parts over their projections, positive if a face points up along n and
negative if it points down. Most faces in the slab do not reach the overlap. If `corner` or `crossing` has stored the
corners of a polytope that contains the overlap (the bound), a plane that has all of them behind it cuts nothing, and
its face is left out.
"""

from typing import NamedTuple

import numpy as np

from simcore.compilation import leaf, routine
from simcore.dem.contact.patch.axes import Axes, axes_in_base, coordinates
from simcore.dem.contact.patch.moments import NO_MOMENTS, add_moments, triangle_moments
from simcore.dem.contact.patch.workspace import (
    read_bound,
    read_face,
    read_polygon,
    start_walk,
    write_face,
    write_polygon,
)
from simcore.dem.vectors import Vec, cross, dot, minus, over, plus, read, scaled, squared

# Shares of the pair's size; docs/explanation/constants.md gives the reasons.
TIE = 1e-14  # planes that cut a are moved out by it, those that cut b in
BOUND_SLACK = 1e-10  # planes within it beyond the bound are kept


class Side(NamedTuple):
    """One of the two bodies, for the walk over its faces."""

    number: int  # 0: a, whose faces reach up; 1: b
    first: int  # first vertex of its base
    top: int  # its vertex farthest toward the other body
    base: Axes  # of the patch, in its base
    centre: Vec  # [m], along the axes, from the centre of a


class Face(NamedTuple):
    """A triangle of a polyhedron, counterclockwise from outside [m]."""

    first: Vec
    second: Vec
    third: Vec


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
def gather_faces(shapes, side, slab, n_bound, slack, workspace, thread):
    """Store the faces of one side that may bound the overlap, with their planes; return their number.

    These have a vertex in the slab, and a corner of the bound is less than `slack` [m] below their plane. Because the
    body is convex, edges connect the vertices in the slab with each other, and a walk from the top visits all.
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
            if not ((inside and u < v) or (last_inside and last < v)):
                face = Face(corner, last_corner, next_corner)
                n_faces += store_face(face, side.number, n_faces, n_bound, slack, workspace, thread)
            last, last_corner, last_inside = u, next_corner, inside
    return n_faces


@leaf
def store_face(face, side, k, n_bound, slack, workspace, thread):
    """Store face k of a side with its plane and return True, unless its plane leaves the whole bound behind."""
    area = cross(minus(face.second, face.first), minus(face.third, face.first))
    area_squared = squared(area)
    if not area_squared > 0.0:
        return False
    if n_bound > 0:
        highest = dot(area, read_bound(workspace, thread, 0))
        for m in range(1, n_bound):
            highest = max(highest, dot(area, read_bound(workspace, thread, m)))
        highest -= dot(area, face.first)
        if highest < 0.0 and highest * highest > slack * slack * area_squared:
            return False
    normal, planes = over(area, np.sqrt(area_squared)), workspace.planes
    planes[thread, side, k, 0], planes[thread, side, k, 1], planes[thread, side, k, 2] = normal.x, normal.y, normal.z
    planes[thread, side, k, 3] = -dot(normal, face.first)
    write_face(workspace, thread, side, k, 0, face.first)
    write_face(workspace, thread, side, k, 1, face.second)
    write_face(workspace, thread, side, k, 2, face.third)
    return True


@leaf
def measure_heights(workspace, thread, number, n, normal, d):
    """Store the heights of the n corners of a polygon above a plane; return the lowest and the highest."""
    lowest, highest = np.inf, -np.inf
    for k in range(n):
        h = dot(normal, read_polygon(workspace, thread, number, k)) + d
        workspace.height[thread, k] = h
        lowest, highest = min(lowest, h), max(highest, h)
    return lowest, highest


@leaf
def cut_polygon(workspace, thread, number, n):
    """Store in the other polygon the part of this one that is not above the plane; return its number of corners.

    n: number of corners of this polygon. The heights above the plane are those that `measure_heights` has stored.
    """
    height, into, kept, last = workspace.height, 1 - number, 0, n - 1
    for k in range(n):
        h, g = height[thread, k], height[thread, last]
        if (h > 0.0) != (g > 0.0):
            corner = read_polygon(workspace, thread, number, last)
            edge = minus(read_polygon(workspace, thread, number, k), corner)
            write_polygon(workspace, thread, into, kept, plus(corner, scaled(g / (g - h), edge)))
            kept += 1
        if not h > 0.0:
            write_polygon(workspace, thread, into, kept, read_polygon(workspace, thread, number, k))
            kept += 1
        last = k
    return kept


@leaf
def cut_face(workspace, thread, side, face, n_planes, tie):
    """Cut a gathered face by the planes of the other side: (index of the polygon that is left, number of corners)."""
    planes, other = workspace.planes, 1 - side
    for corner in range(3):
        write_polygon(workspace, thread, 0, corner, read_face(workspace, thread, side, face, corner))
    number, n = 0, 3
    for k in range(n_planes):
        normal = Vec(planes[thread, other, k, 0], planes[thread, other, k, 1], planes[thread, other, k, 2])
        lowest, highest = measure_heights(workspace, thread, number, n, normal, planes[thread, other, k, 3] + tie)
        if not highest > 0.0:
            continue
        if not lowest < 0.0:
            return number, 0
        n = cut_polygon(workspace, thread, number, n)
        number = 1 - number
    return number, n


@leaf
def polygon_moments(sums, workspace, thread, number, n, origin):
    """Add the moments of a polygon about `origin`, cut into triangles from its first corner."""
    first = minus(read_polygon(workspace, thread, number, 0), origin)
    second = minus(read_polygon(workspace, thread, number, 1), origin)
    for k in range(2, n):
        third = minus(read_polygon(workspace, thread, number, k), origin)
        sums = add_moments(sums, triangle_moments(first, second, third))
        second = third
    return sums


@leaf
def face_moments(workspace, thread, n_a, n_b, origin, tie):
    """Return the moments about `origin` of the parts of all gathered faces that bound the overlap."""
    sums = NO_MOMENTS
    for side in range(2):
        n_faces, n_planes, moved = (n_a, n_b, -tie) if side == 0 else (n_b, n_a, tie)
        for face in range(n_faces):
            if workspace.planes[thread, side, face, 2] == 0.0:
                continue  # the face is parallel to n, and its projection has no area
            number, n = cut_face(workspace, thread, side, face, n_planes, moved)
            if n >= 3:
                sums = polygon_moments(sums, workspace, thread, number, n, origin)
    return sums


@routine
def clipped_moments(shapes, bodies, pair, axes, tops, n_bound, workspace, thread):
    """Return the moments of the overlap of a pair about the first vertex of `tops`.

    tops: the vertex of pair.a farthest along n, and that of pair.b farthest against it. n_bound: number of corners of
    the bound in the workspace; 0: there is none.
    """
    base_a, base_b = axes_in_base(bodies, pair.a, axes), axes_in_base(bodies, pair.b, axes)
    top, offset = coordinates(base_a, read(shapes.vertices, tops[0])), coordinates(axes, pair.offset)
    slab = Slab(offset.z + dot(read(shapes.vertices, tops[1]), base_b.n), top.z)
    a = side_of(shapes, bodies, 0, pair.a, tops[0], base_a, Vec(0.0, 0.0, 0.0))
    b = side_of(shapes, bodies, 1, pair.b, tops[1], base_b, offset)
    n_a = gather_faces(shapes, a, slab, n_bound, BOUND_SLACK * pair.size, workspace, thread)
    n_b = gather_faces(shapes, b, slab, n_bound, BOUND_SLACK * pair.size, workspace, thread)
    return face_moments(workspace, thread, n_a, n_b, Vec(top.x, top.y, slab.low), TIE * pair.size)
