r"""Patch contact of two overlapping polyhedra: centroid and second moments of their overlap.

         \       b       /                a, b   the bodies
          \_____________/                 n      contact normal, from a to b
     ______\__/ x \____/                  x      centroid of the overlap, weighted by depth: where the contact presses
    /       \/_____\/    ^                depth  of the overlap along n
   /     a               | n

Viewed along n, the overlap is a depth over the tangent plane: usually the top of a minus the bottom of b, where that is
positive. An elastic foundation under the patch would be compressed by this depth. The resultant force therefore acts at
the first moment of the depth, and the second moments resist rocking and twisting. Both vary continuously with the pose,
also where a face comes to rest on a face or an edge.

The facet of the Minkowski difference shows whether a corner and a face meet (corner.py) or two edges (crossing.py). The
overlap then has a closed form if no other part of the bodies reaches into it. If other parts do, the planes of their
faces cut this closed form (polytope.py). In all other cases, mostly where two faces meet, the faces of both bodies are
clipped (clipping.py).

At rest overlaps are about 1e-5 of the size, with the contact time of Rettinger et al. (2022). Deeper overlaps reflect
the softness of the springs rather than the form of the grains, and extend over many faces. The bodies are then treated
as if they were moved apart to PATCH_DEPTH.
"""

from simcore.compilation import leaf
from simcore.dem.contact.pair import exchanged, pair_of
from simcore.dem.contact.patch.axes import View, axes_about
from simcore.dem.contact.patch.clipping import clipped_moments
from simcore.dem.contact.patch.corner import corner_overlap
from simcore.dem.contact.patch.crossing import crossing_overlap
from simcore.dem.contact.patch.moments import NO_MOMENTS, Point, shortcut, write_spread
from simcore.dem.contact.patch.polytope import cut_moments
from simcore.dem.shapes.polyhedra import vertex_of
from simcore.dem.vectors import plus, plus_scaled, read, write

PATCH_DEPTH = 1e-4  # of the pair's size: the largest depth of a patch. Why: docs/explanation/constants.md#patch_depth


@leaf
def read_facet(facet, p):
    """Return the facet vertices of contact p on a and on b (3 + 3): three equal for a corner, two for an edge."""
    return (facet[p, 0], facet[p, 1], facet[p, 2]), (facet[p, 3], facet[p, 4], facet[p, 5])


@leaf
def is_corner(v):
    """Return whether three vertices are equal."""
    return v[0] == v[1] and v[0] == v[2]


@leaf
def is_edge(v):
    """Return whether at least two of three vertices are equal."""
    return v[0] == v[1] or v[0] == v[2] or v[1] == v[2]


@leaf
def edge_ends(v):
    """Return the two different vertices of an edge."""
    return v[0], v[2] if v[1] == v[0] else v[1]


@leaf
def closed_overlap(shapes, bodies, pair, view, facet, workspace, thread):
    """Return (Shortcut of a facet, whether its moments are about the corner of b instead of the first vertex of a).

    view: from a. The moments are exact only if a corner and a face, or two edges, meet.
    """
    on_a, on_b = facet
    if is_corner(on_a) and not is_edge(on_b):
        return corner_overlap(shapes, bodies, pair, view, on_a[0], on_b, workspace, thread), False
    if is_corner(on_b) and not is_edge(on_a):
        from_b = View(view.axes, view.depth, -1.0)
        shape = corner_overlap(shapes, bodies, exchanged(pair), from_b, on_b[0], on_a, workspace, thread)
        return shape, shape.exact
    if is_edge(on_a) and is_edge(on_b) and not is_corner(on_a) and not is_corner(on_b):
        ends_a, ends_b = edge_ends(on_a), edge_ends(on_b)
        return crossing_overlap(shapes, bodies, pair, view, ends_a, ends_b, workspace, thread), False
    return shortcut(False, Point(0.0, 0.0), NO_MOMENTS, 0), False


@leaf
def find_patch(shapes, bodies, contacts, p, offset, workspace, thread):
    """Move the point of touching contact p to the centroid of its patch, and store the patch's second moments.

    The point remains and the moments are zero if by rounding the overlap has no volume. offset [m]: from the centre of
    body a to that of its partner.
    """
    i, j, overlap = contacts.body_a[p], contacts.body_b[p], contacts.overlap[p]
    axes = axes_about(read(contacts.direction, p))
    depth = min(overlap, PATCH_DEPTH * (bodies.radius[i] + bodies.radius[j]))
    pair = pair_of(bodies, i, j, plus_scaled(offset, overlap - depth, axes.n))
    on_a, on_b = read_facet(contacts.facet, p)
    view = View(axes, depth, 1.0)
    shape, about_b = closed_overlap(shapes, bodies, pair, view, (on_a, on_b), workspace, thread)
    m, origin = shape.moments, shape.origin
    if not shape.exact:
        if shape.n_corners > 0:
            m, origin = cut_moments(shapes, bodies, pair, axes, (on_a, on_b), shape.n_corners, workspace, thread)
        else:
            m = clipped_moments(shapes, bodies, pair, axes, (on_a[0], on_b[0]), workspace, thread)
    if not m.d > 0.0:
        for k in range(6):
            contacts.spread[p, k] = 0.0
        return
    x, y = m.dx / m.d, m.dy / m.d
    write_spread(contacts.spread, p, axes, m.dxx / m.d - x * x, m.dxy / m.d - x * y, m.dyy / m.d - y * y)
    # The reference vertex of the moments is on the surface of its body; the contact point is half the overlap away.
    if about_b:
        about, half = plus(vertex_of(shapes, bodies, j, on_b[0]), offset), 0.5 * overlap
    else:
        about, half = vertex_of(shapes, bodies, i, on_a[0]), -0.5 * overlap
        x, y = x + origin.x, y + origin.y
    write(contacts.point, p, plus_scaled(plus_scaled(plus_scaled(about, x, axes.p), y, axes.q), half, axes.n))
