r"""The overlap of a single corner with a face: a pyramid, in closed form.

     n                               Viewed along n:
     ^        a                                               a           apex: the corner of body i
     |       / \     | depth            f2 ____________ f1    *           feet: where the edges of i that start at a
    _|______*___*____v_ face of j         /  *----*   /                   have fallen by `depth`
           /     \                       /   |  a |  /        f0, f1, f2  corners of the face of body j
          / body i\                     /    *----* /
                                    f0 /___________/

The moments are exact if all feet are inside the face: then only the corner reaches into j, and only this face bounds
the overlap.
"""

from typing import NamedTuple

from simcore.compilation import leaf
from simcore.dem.contact.patch.axes import axes_in_base, coordinates, toward_other
from simcore.dem.contact.patch.moments import NO_MOMENTS, Point, cone, cone_side, shortcut, turn
from simcore.dem.contact.patch.workspace import write_corner
from simcore.dem.vectors import Vec, dot, minus, read

# Maximum distance of a foot, in lengths of an edge or of a face beside it. Why: docs/explanation/constants.md#farthest
FARTHEST = 1e3


class Line(NamedTuple):
    """The line through a side of a face: x · px + y · py + constant is positive inside the face."""

    x: float
    y: float
    constant: float


class Foot(NamedTuple):
    """The point at which an edge, or its line, leaves the slab of the overlap."""

    x: float  # [m], from the apex
    y: float
    fall: float  # [m], descent of the whole edge along n


@leaf
def side_line(orientation, start, end):
    """Return the line from start to end. orientation: 1 if the face is counterclockwise, else −1."""
    x, y = orientation * (start.y - end.y), orientation * (end.x - start.x)
    return Line(x, y, -(x * start.x + y * start.y))


@leaf
def is_outside(line, point):
    """Return whether a point is on the outer side of a line."""
    return line.x * point.x + line.y * point.y + line.constant < 0.0


@leaf
def foot_of(vertices, apex, vertex, base, depth):
    """Return the foot of the edge from the apex to a neighbouring vertex."""
    edge = minus(read(vertices, vertex), apex)
    fall = -dot(edge, base.n)
    share = depth / fall
    return Foot(share * dot(edge, base.p), share * dot(edge, base.q), fall)


@leaf
def face_lines(vertices, face, base, shift):
    """Return the lines of the sides of a face (three vertices), positive inside. shift: of the centre, in the plane."""
    f0, f1, f2 = read(vertices, face[0]), read(vertices, face[1]), read(vertices, face[2])
    p0 = Point(shift.x + dot(f0, base.p), shift.y + dot(f0, base.q))
    p1 = Point(shift.x + dot(f1, base.p), shift.y + dot(f1, base.q))
    p2 = Point(shift.x + dot(f2, base.p), shift.y + dot(f2, base.q))
    twice_area = (p1.x - p0.x) * (p2.y - p0.y) - (p1.y - p0.y) * (p2.x - p0.x)
    orientation = 1.0 if twice_area > 0.0 else -1.0
    return side_line(orientation, p0, p1), side_line(orientation, p1, p2), side_line(orientation, p2, p0)


@leaf
def corner_overlap(shapes, bodies, pair, view, apex, face, workspace, thread):
    """Return the Shortcut of vertex `apex` of pair.a and a face (three vertices) of pair.b; moments are about the apex.

    view: from pair.a. If the moments are not exact, apex and feet are stored as corners of a pyramid that contains the
    overlap.
    """
    vertices, ring_start, ring = shapes.vertices, shapes.neighbor_start, shapes.neighbors
    depth, sign = view.depth, view.sign
    base = axes_in_base(bodies, pair.a, toward_other(view))
    tip = read(vertices, apex)
    offset, at_tip = coordinates(view.axes, pair.offset), coordinates(base, tip)
    # Coordinates relative to the apex
    shift = Point(offset.x - at_tip.x, offset.y - at_tip.y)
    line0, line1, line2 = face_lines(vertices, face, axes_in_base(bodies, pair.b, view.axes), shift)
    # Coordinates relative to the centre of body a of the contact, which is pair.b in the view from b
    x, y, z = at_tip.x, at_tip.y, sign * at_tip.z
    if sign < 0.0:
        x, y, z = x - offset.x, y - offset.y, z - offset.z
    write_corner(workspace, thread, 0, 0, Vec(x, y, z))
    n_corners, exact, bounded = 1, True, True
    sums = NO_MOMENTS
    start = foot_of(vertices, tip, ring[ring_start[apex + 1] - 1], base, depth)
    for k in range(ring_start[apex], ring_start[apex + 1]):
        foot = foot_of(vertices, tip, ring[k], base, depth)
        bounded = bounded and FARTHEST * foot.fall > depth
        if not foot.fall > depth or is_outside(line0, foot) or is_outside(line1, foot) or is_outside(line2, foot):
            exact = False
        write_corner(workspace, thread, 0, n_corners, Vec(x + foot.x, y + foot.y, z - sign * depth))
        n_corners += 1
        sums = cone_side(sums, turn(start, foot) * sign, start, foot)
        start = foot
    return shortcut(exact, Point(0.0, 0.0), cone(sums, depth), n_corners if bounded else 0)
