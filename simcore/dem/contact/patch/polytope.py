r"""The overlap of a corner with a face, or of two edges, if other faces bound it too: a polytope cut by their planes.

  corner 0                 The pyramid of corner.py or crossing.py contains the overlap. The planes of all other
     /\                    faces that reach into it cut it, one after the other. A cut removes the corners above the
    /  \     plane         plane (x) and shortens the edges that cross it. It adds corners (o) and a face, whose
---o----o----------        edges join them.
  x......x
                           An edge has the numbers of its two corners, and of its faces left and right of it as seen
     second                from outside. The corners of a face are therefore counterclockwise from outside. Corners
  left | right             are in the axes of the patch, relative to the centre of a.
     first

By rounding, corners of one face that lie in the plane of a cut may be above and below it in turn. The edges of the cap
then do not close, and the faces of both bodies are clipped instead (clipping.py).
"""

from typing import NamedTuple

import numpy as np

from simcore.compilation import leaf, routine
from simcore.dem.contact.patch.clipping import TIE, clipped_moments
from simcore.dem.contact.patch.faces import gather_both
from simcore.dem.contact.patch.moments import NO_MOMENTS, Point, add_moments, tetrahedron_moments
from simcore.dem.contact.patch.workspace import read_corner, read_face, write_corner
from simcore.dem.vectors import cross, dot, minus, plus, scaled, squared

OPEN = -1  # instead of a number of corners


class Polytope(NamedTuple):
    """What of the workspace is the polytope."""

    current: int  # which of the two arrays of corners
    corners: int  # number of corners; OPEN after a cut whose cap does not close
    edges: int
    faces: int  # number of faces that it has had


@leaf
def write_edge(workspace, thread, k, first, second, left, right):
    """Store edge k: its corners and its faces."""
    edge = workspace.edge
    edge[thread, k, 0], edge[thread, k, 1], edge[thread, k, 2], edge[thread, k, 3] = first, second, left, right


@leaf
def pyramid(workspace, thread, n):
    """Return the Polytope of corner 0, the apex, and the corners 1 to n of the base, counterclockwise from the apex.

    Its corners are stored by `write_corner`. Face k − 1 is beside the apex and the corners k − 1 and k of the base,
    face 0 beside the corners n and 1, and face n is the base.
    """
    last = n
    for k in range(1, n + 1):
        write_edge(workspace, thread, 2 * k - 2, 0, k, k % n, k - 1)
        write_edge(workspace, thread, 2 * k - 1, last, k, k - 1, n)
        last = k
    return Polytope(0, n + 1, 2 * n, n + 1)


@leaf
def measure_heights(workspace, thread, polytope, side, face):
    """Store the heights of the corners above the plane of a face, times its doubled area: (the greatest, that area)."""
    at_first, highest = read_face(workspace, thread, side, face, 0), -np.inf
    to_second = minus(read_face(workspace, thread, side, face, 1), at_first)
    area = cross(to_second, minus(read_face(workspace, thread, side, face, 2), at_first))
    level = dot(area, at_first)
    for k in range(polytope.corners):
        h = dot(area, read_corner(workspace, thread, polytope.current, k)) - level
        workspace.height[thread, k] = h
        if h > highest:
            highest = h
    return highest, area


@leaf
def keep_corners(workspace, thread, polytope):
    """Move the corners that are not above the plane to the other array, and return their number.

    Their new numbers are stored in `renumbered`, which is -1 for the others.
    """
    height, renumbered, kept = workspace.height, workspace.renumbered, 0
    for k in range(polytope.corners):
        if height[thread, k] > 0.0:
            renumbered[thread, k] = -1
        else:
            renumbered[thread, k] = kept
            corner = read_corner(workspace, thread, polytope.current, k)
            write_corner(workspace, thread, 1 - polytope.current, kept, corner)
            kept += 1
    return kept


@leaf
def join(workspace, thread, face, corner, leaves, cap, edges):
    """Note that the boundary of a face leaves the polytope at a corner of the cap, or comes back; return the edges.

    When both corners of a face are known, the edge between them is stored.
    """
    way_out, way_in = workspace.way_out, workspace.way_in
    if leaves:
        way_out[thread, face] = corner
    else:
        way_in[thread, face] = corner
    if way_out[thread, face] < 0 or way_in[thread, face] < 0:
        return edges
    write_edge(workspace, thread, edges, way_out[thread, face], way_in[thread, face], face, cap)
    way_out[thread, face], way_in[thread, face] = -1, -1
    return edges + 1


@leaf
def cut(workspace, thread, polytope):
    """Remove what is above a plane, and return what is left; `measure_heights` has stored the heights.

    A closed cap has as many edges as corners. If it has not, the result is OPEN.
    """
    height, edge, renumbered, current = workspace.height, workspace.edge, workspace.renumbered, polytope.current
    kept = keep_corners(workspace, thread, polytope)
    corners, edges, end, cap = kept, 0, polytope.edges, polytope.faces
    for k in range(polytope.edges):
        first, second, left, right = edge[thread, k, 0], edge[thread, k, 1], edge[thread, k, 2], edge[thread, k, 3]
        new_first, new_second = renumbered[thread, first], renumbered[thread, second]
        if new_first < 0 and new_second < 0:
            continue
        if new_first < 0 or new_second < 0:
            h, g = height[thread, second], height[thread, first]
            at_first = read_corner(workspace, thread, current, first)
            along = minus(read_corner(workspace, thread, current, second), at_first)
            write_corner(workspace, thread, 1 - current, corners, plus(at_first, scaled(g / (g - h), along)))
            end = join(workspace, thread, left, corners, new_second < 0, cap, end)
            end = join(workspace, thread, right, corners, new_first < 0, cap, end)
            if new_first < 0:
                new_first = corners
            else:
                new_second = corners
            corners += 1
        write_edge(workspace, thread, edges, new_first, new_second, left, right)
        edges += 1
    if end - polytope.edges != corners - kept:
        for face in range(cap):
            workspace.way_out[thread, face], workspace.way_in[thread, face] = -1, -1
        return Polytope(current, OPEN, 0, 0)
    for k in range(polytope.edges, end):
        first, second, left, right = edge[thread, k, 0], edge[thread, k, 1], edge[thread, k, 2], edge[thread, k, 3]
        write_edge(workspace, thread, edges, first, second, left, right)
        edges += 1
    return Polytope(1 - current, corners, edges, cap + 1)


@leaf
def cut_by_faces(workspace, thread, polytope, side, n_faces, tie):
    """Cut a polytope by the planes of all gathered faces of a side, moved out by `tie` [m]: Polytope.

    Corners at `tie` above a plane may come from the cut by another triangle in the same plane, so that corners up to
    twice as high are not cut off.
    """
    for face in range(n_faces):
        highest, area = measure_heights(workspace, thread, polytope, side, face)
        if highest > 0.0:
            moved = tie * np.sqrt(squared(area))
            if highest > 2.0 * moved:
                for k in range(polytope.corners):
                    workspace.height[thread, k] -= moved
                polytope = cut(workspace, thread, polytope)
                if polytope.corners == OPEN:
                    break
    return polytope


@leaf
def polytope_moments(workspace, thread, polytope):
    """Return (moments, corner 0, about which they are): sums over tetrahedra of it, a corner of a face and an edge."""
    edge, reference, sums = workspace.edge, workspace.reference, NO_MOMENTS
    for face in range(polytope.faces):
        reference[thread, face] = -1
    for k in range(polytope.edges):
        if edge[thread, k, 0] == 0 or edge[thread, k, 1] == 0:  # tetrahedra of the faces at corner 0 have no volume
            reference[thread, edge[thread, k, 2]], reference[thread, edge[thread, k, 3]] = 0, 0
    origin = read_corner(workspace, thread, polytope.current, 0)
    for k in range(polytope.edges):
        first, second = edge[thread, k, 0], edge[thread, k, 1]
        for side in range(2):
            face = edge[thread, k, 2 + side]
            from_corner = reference[thread, face]
            if from_corner < 0:
                reference[thread, face] = first
            elif from_corner > 0 and from_corner != first and from_corner != second:
                a = minus(read_corner(workspace, thread, polytope.current, from_corner), origin)
                b = minus(read_corner(workspace, thread, polytope.current, first), origin)
                c = minus(read_corner(workspace, thread, polytope.current, second), origin)
                if side == 0:
                    sums = add_moments(sums, tetrahedron_moments(a, b, c))
                else:
                    sums = add_moments(sums, tetrahedron_moments(a, c, b))
    return sums, origin


@routine
def cut_moments(shapes, bodies, pair, axes, facet, n_corners, workspace, thread):
    """Return the moments of the overlap of a corner and a face, or of two edges, if other faces bound it too.

    facet: three vertices on a and three on b. n_corners: number of corners of the pyramid, which the functions of
    corner.py and crossing.py have stored. Returns (moments, their reference point relative to the first vertex of a).
    """
    on_a, on_b = facet
    tops = on_a[0], on_b[0]
    n_a, n_b, top, _ = gather_both(shapes, bodies, pair, axes, tops, facet, workspace, thread)
    polytope, tie = pyramid(workspace, thread, n_corners - 1), TIE * pair.size
    polytope = cut_by_faces(workspace, thread, polytope, 0, n_a, tie)
    if polytope.corners != OPEN:
        polytope = cut_by_faces(workspace, thread, polytope, 1, n_b, tie)
    if polytope.corners == OPEN:
        return clipped_moments(shapes, bodies, pair, axes, tops, workspace, thread), Point(0.0, 0.0)
    if polytope.corners == 0:
        return NO_MOMENTS, Point(0.0, 0.0)
    moments, origin = polytope_moments(workspace, thread, polytope)
    return moments, Point(origin.x - top.x, origin.y - top.y)
