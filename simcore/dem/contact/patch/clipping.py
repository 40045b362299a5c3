r"""The overlap of two polyhedra in general: the faces of each body, cut by the planes of the other.

      n
      ^   \          b          /
      |    \   _________       /           high   top of a       faces of b are used if they reach below it
      | - - \-/- - - - -\- - -/- high      low    bottom of b    faces of a are used if they reach above it
      |      /           \   /
      | - - / \_________/_\_/ - low        The overlap, between the two, is a polytope. Its faces are parts of faces of
      |    /       a       \               a, which point up, and of faces of b, which point down.

The moments are integrals of the height of these parts over their projections, positive if a face points up along n and
negative if it points down. If a corner and a face meet, or two edges, polytope.py is faster.
"""

import numpy as np

from simcore.compilation import leaf, routine
from simcore.dem.contact.patch.faces import ALL_FACES, gather_both
from simcore.dem.contact.patch.moments import NO_MOMENTS, add_moments, triangle_moments
from simcore.dem.contact.patch.workspace import read_face, read_polygon, write_polygon
from simcore.dem.vectors import Vec, cross, dot, length, minus, over, plus, scaled

# Of the pair's size: planes that cut faces of a are moved out by it, those that cut faces of b in, and those that cut a
# polytope (polytope.py) out. Why: docs/explanation/constants.md#tie
TIE = 1e-14


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


@leaf
def write_planes(workspace, thread, side, n_faces):
    """Store the planes of the gathered faces of a side. The plane of a face without area is above everything."""
    planes = workspace.planes
    for k in range(n_faces):
        first = read_face(workspace, thread, side, k, 0)
        to_second = minus(read_face(workspace, thread, side, k, 1), first)
        area = cross(to_second, minus(read_face(workspace, thread, side, k, 2), first))
        size = length(area)
        n, d = Vec(0.0, 0.0, 0.0), -np.inf
        if size > 0.0:
            n = over(area, size)
            d = -dot(n, first)
        planes[thread, side, k, 0], planes[thread, side, k, 1], planes[thread, side, k, 2] = n.x, n.y, n.z
        planes[thread, side, k, 3] = d


@routine
def clipped_moments(shapes, bodies, pair, axes, tops, workspace, thread):
    """Return the moments of the overlap of a pair about the first vertex of `tops`; `tops`: as in gather_both."""
    n_a, n_b, top, slab = gather_both(shapes, bodies, pair, axes, tops, ALL_FACES, workspace, thread)
    write_planes(workspace, thread, 0, n_a)
    write_planes(workspace, thread, 1, n_b)
    return face_moments(workspace, thread, n_a, n_b, Vec(top.x, top.y, slab.low), TIE * pair.size)
