"""Convex polyhedron against convex polyhedron, from what the last step found.

In one step a grain moves about 1e-4 of its size. An overlapping pair keeps the three support pairs of its facet of
the Minkowski difference: the plane is rebuilt, the edge graphs are climbed from its vertices, and where no support
point lies beyond and the origin's projection stays well inside, the facet is still the minimum of the overlap.
Otherwise the pair is searched from nothing. A separated pair keeps the simplex next to the origin, and is not looked
at before the bodies can have closed the gap; then the same simplex mostly still shows one.
"""

import numpy as np
from numba import types

from simcore.compilation import leaf, routine
from simcore.dem.contact.pairs.gap_memory import STILL_GAP, remember_apart, still_apart
from simcore.dem.contact.search.gjk import segment_weights, triangle_weights
from simcore.dem.contact.search.polyhedra import search_pair, support
from simcore.dem.contact.search.scratch import scratch
from simcore.dem.shapes.hulls import vertex_offset

_take_points = scratch(types.float64, 4, 3)
CHECK_TOLERANCE = 1e-11  # of the pair's size; wider than the search's, so that what it found passes
INSIDE_TOLERANCE = 1e-9  # barycentric
GAP_SLACK = 0.1  # a step only needs a certain gap; the last tenth of its length is not worth iterations

CERTAIN_REACH = 2.0  # of the overlap: farther than that from its sides a facet is the nearest, see facet_contact

INVALID, APART, OVERLAPPING, UNCERTAIN = 0, 1, 2, 3


@leaf
def facet_contact(shapes, bodies, i, j, rx, ry, rz, size, a0, a1, a2, b0, b1, b2):
    """Judge a remembered facet: (verdict, overlap, normal (3), contact point relative to a (3), a, b).

    a, b: the support vertices along its normal. APART: overlap is minus a certain gap. UNCERTAIN: a local minimum
    of the overlap so near to a side of the facet that another facet may show less. With its projection at least x
    from all sides of a facet at depth d, the origin is at least d cos α + x sin α below any facet at an angle α to
    it, and that is no less than d where x >= d tan(α/2): CERTAIN_REACH 2 holds up to 126°. A contact that kept the
    facet until it is left would lose up to sin² α of its elastic energy there.
    """
    a0x, a0y, a0z = vertex_offset(shapes, bodies, i, a0)
    a1x, a1y, a1z = vertex_offset(shapes, bodies, i, a1)
    a2x, a2y, a2z = vertex_offset(shapes, bodies, i, a2)
    b0x, b0y, b0z = vertex_offset(shapes, bodies, j, b0)
    b1x, b1y, b1z = vertex_offset(shapes, bodies, j, b1)
    b2x, b2y, b2z = vertex_offset(shapes, bodies, j, b2)
    # The vertices of the facet
    px, py, pz = a0x - b0x - rx, a0y - b0y - ry, a0z - b0z - rz
    qx, qy, qz = a1x - b1x - rx, a1y - b1y - ry, a1z - b1z - rz
    sx, sy, sz = a2x - b2x - rx, a2y - b2y - ry, a2z - b2z - rz
    ex, ey, ez = qx - px, qy - py, qz - pz
    fx, fy, fz = sx - px, sy - py, sz - pz
    nx, ny, nz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
    area = np.sqrt(nx * nx + ny * ny + nz * nz)
    if not area > 1e-13 * size * size:
        return INVALID, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, a0, b0
    nx, ny, nz = nx / area, ny / area, nz / area
    depth = (nx * (px + qx + sx) + ny * (py + qy + sy) + nz * (pz + qz + sz)) / 3.0
    a, b, x, y, z = support(shapes, bodies, i, j, rx, ry, rz, a0, b0, nx, ny, nz)
    reach = x * nx + y * ny + z * nz
    if reach <= 0.0:  # 0 too: a contact that ended must not keep the lead of its facet as if it were a gap
        return APART, reach, nx, ny, nz, 0.0, 0.0, 0.0, a, b
    if reach - depth > CHECK_TOLERANCE * size:
        return INVALID, 0.0, nx, ny, nz, 0.0, 0.0, 0.0, a, b
    # Barycentric weights of the origin's projection: areas seen along the normal
    ux = (qy * sz - qz * sy) * nx + (qz * sx - qx * sz) * ny + (qx * sy - qy * sx) * nz
    vx = (sy * pz - sz * py) * nx + (sz * px - sx * pz) * ny + (sx * py - sy * px) * nz
    w0, w1 = ux / area, vx / area
    w2 = 1.0 - w0 - w1
    if min(w0, w1, w2) < -INSIDE_TOLERANCE:
        return INVALID, reach, nx, ny, nz, 0.0, 0.0, 0.0, a, b
    far = CERTAIN_REACH * reach
    verdict = OVERLAPPING
    if (
        _too_near(w0 * area, far, sx - qx, sy - qy, sz - qz)
        or _too_near(w1 * area, far, fx, fy, fz)
        or _too_near(w2 * area, far, ex, ey, ez)
    ):
        verdict = UNCERTAIN
    half = 0.5 * reach
    return (
        verdict,
        reach,
        nx,
        ny,
        nz,
        w0 * a0x + w1 * a1x + w2 * a2x - half * nx,
        w0 * a0y + w1 * a1y + w2 * a2y - half * ny,
        w0 * a0z + w1 * a1z + w2 * a2z - half * nz,
        a,
        b,
    )


@leaf
def _too_near(double_area, far, x, y, z):
    """Whether the point that spans such a triangle with the side (x, y, z) is nearer to it than `far`."""
    return not (double_area > 0.0 and double_area * double_area >= far * far * (x * x + y * y + z * z))


@leaf
def recheck(shapes, bodies, contacts, p, i, j, rx, ry, rz):
    """Near pair p from its memory: (known, overlap [m], normal a to b (3), contact point relative to a (3)).

    The pair is apart where the overlap is not positive. Where the memory does not hold, known is False and the pair
    has to be searched, from the direction and the vertices that are left in its memory.
    """
    size = bodies.radius[i] + bodies.radius[j]
    facet = contacts.facet
    if contacts.touching[p] != 0:
        if facet[p, 1] < 0:
            return False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        verdict, overlap, nx, ny, nz, x, y, z, a, b = facet_contact(
            shapes, bodies, i, j, rx, ry, rz, size,
            facet[p, 0], facet[p, 1], facet[p, 2], facet[p, 3], facet[p, 4], facet[p, 5],
        )  # fmt: skip
        if verdict == APART:  # the facet stays, as the simplex next to the origin
            remember_apart(bodies, contacts, p, i, j, rx, ry, rz, -overlap)
        if verdict == UNCERTAIN and still_apart(bodies, contacts, p, i, j, rx, ry, rz):
            verdict = OVERLAPPING  # the search that found it has seen the others, and they cannot have caught up
        return verdict == OVERLAPPING or verdict == APART, overlap, nx, ny, nz, x, y, z
    if facet[p, 0] < 0:
        return False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    gap, distance, nx, ny, nz = _gap_of_simplex(shapes, bodies, contacts, p, i, j, rx, ry, rz)
    if gap > STILL_GAP * distance:
        remember_apart(bodies, contacts, p, i, j, rx, ry, rz, gap)
        return True, -gap, nx, ny, nz, 0.0, 0.0, 0.0
    return False, 0.0, nx, ny, nz, 0.0, 0.0, 0.0


@leaf
def _gap_of_simplex(shapes, bodies, contacts, p, i, j, rx, ry, rz):
    """Gap from the simplex of the Minkowski difference that lay next to the origin: (certain gap, distance, n (3)).

    The distance is to the simplex, so an upper bound of the true one: together they tell how good the gap is.
    """
    points, facet = _take_points(), contacts.facet
    n = 1
    if facet[p, 1] >= 0:
        n = 2
    if facet[p, 2] >= 0:
        n = 3
    for k in range(n):
        ax, ay, az = vertex_offset(shapes, bodies, i, facet[p, k])
        bx, by, bz = vertex_offset(shapes, bodies, j, facet[p, 3 + k])
        points[k, 0], points[k, 1], points[k, 2] = ax - bx - rx, ay - by - ry, az - bz - rz
    u, v, w = 1.0, 0.0, 0.0
    if n == 2:
        u, v = segment_weights(points, 0, 1)
    if n == 3:
        u, v, w = triangle_weights(points, 0, 1, 2)
    x, y, z = u * points[0, 0], u * points[0, 1], u * points[0, 2]
    if n > 1:
        x, y, z = x + v * points[1, 0], y + v * points[1, 1], z + v * points[1, 2]
    if n > 2:
        x, y, z = x + w * points[2, 0], y + w * points[2, 1], z + w * points[2, 2]
    distance = np.sqrt(x * x + y * y + z * z)
    if not distance > 0.0:
        return 0.0, 0.0, contacts.direction[p, 0], contacts.direction[p, 1], contacts.direction[p, 2]
    nx, ny, nz = -x / distance, -y / distance, -z / distance
    _, _, x, y, z = support(shapes, bodies, i, j, rx, ry, rz, facet[p, 0], facet[p, 3], nx, ny, nz)
    return -(x * nx + y * ny + z * nz), distance, nx, ny, nz


@routine
def search_contact(shapes, bodies, contacts, p, i, j, rx, ry, rz):
    """Near pair p by GJK and EPA: (overlap [m], normal a to b (3), contact point relative to a (3))."""
    size = bodies.radius[i] + bodies.radius[j]
    facet = contacts.facet
    a, b = facet[p, 0], facet[p, 3]
    if a < 0:
        a, b = shapes.vertex_start[bodies.shape[i]], shapes.vertex_start[bodies.shape[j]]
    nx, ny, nz = contacts.direction[p, 0], contacts.direction[p, 1], contacts.direction[p, 2]
    if nx == 0.0 and ny == 0.0 and nz == 0.0:
        nx, ny, nz = _toward(rx, ry, rz)
    distance, nx, ny, nz, a0, a1, a2, b0, b1, b2, lead = search_pair(
        shapes, bodies, i, j, rx, ry, rz, size, a, b, nx, ny, nz, GAP_SLACK
    )
    facet[p, 0], facet[p, 1], facet[p, 2] = a0, a1, a2
    facet[p, 3], facet[p, 4], facet[p, 5] = b0, b1, b2
    if distance >= 0.0:
        remember_apart(bodies, contacts, p, i, j, rx, ry, rz, distance)
        return -distance, nx, ny, nz, 0.0, 0.0, 0.0
    overlap = -distance
    # Support heights change by no more than the bodies move: half the lead for each of the two facets.
    remember_apart(bodies, contacts, p, i, j, rx, ry, rz, 0.5 * lead)
    x, y, z = facet_point(shapes, bodies, i, j, rx, ry, rz, overlap, nx, ny, nz, a0, a1, a2, b0, b1, b2)
    return overlap, nx, ny, nz, x, y, z


@leaf
def facet_point(shapes, bodies, i, j, rx, ry, rz, overlap, nx, ny, nz, a0, a1, a2, b0, b1, b2):
    """Contact point relative to a on a facet that the search has found: the origin's projection, kept inside it."""
    verdict, _, _, _, _, x, y, z, _, _ = facet_contact(
        shapes, bodies, i, j, rx, ry, rz, bodies.radius[i] + bodies.radius[j], a0, a1, a2, b0, b1, b2
    )
    if verdict == OVERLAPPING or verdict == UNCERTAIN:
        return x, y, z
    # Rounding put the projection outside a thin facet: the corner that it lies next to is as good.
    ax, ay, az = vertex_offset(shapes, bodies, i, a0)
    bx, by, bz = vertex_offset(shapes, bodies, j, b0)
    x, y, z = ax, ay, az
    least = _beside(ax - bx - rx, ay - by - ry, az - bz - rz, nx, ny, nz)
    for va, vb in ((a1, b1), (a2, b2)):
        ax, ay, az = vertex_offset(shapes, bodies, i, va)
        bx, by, bz = vertex_offset(shapes, bodies, j, vb)
        distance2 = _beside(ax - bx - rx, ay - by - ry, az - bz - rz, nx, ny, nz)
        if distance2 < least:
            least, x, y, z = distance2, ax, ay, az
    return x - 0.5 * overlap * nx, y - 0.5 * overlap * ny, z - 0.5 * overlap * nz


@leaf
def _beside(x, y, z, nx, ny, nz):
    """Squared distance of a point from the line through the origin along the unit vector n."""
    along = x * nx + y * ny + z * nz
    return x * x + y * y + z * z - along * along


@leaf
def _toward(rx, ry, rz):
    """Unit vector along r, or x where the centres coincide."""
    length = np.sqrt(rx * rx + ry * ry + rz * rz)
    if length > 0.0:
        return rx / length, ry / length, rz / length
    return 1.0, 0.0, 0.0
