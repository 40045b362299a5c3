"""The patch in which two overlapping polyhedra press on each other: centroid and second moments of their overlap.

Seen along the contact normal n the overlap is a depth over the tangent plane: mostly the top of a less the bottom of b,
where that is positive. Depth is what an elastic bed under the patch would be pressed by, so its first moment is
where the resultant acts, and its second moment what resists rocking and twisting. Both vary continuously with the
pose, also where a face comes to lie on a face or an edge.

The overlap is a polytope, and its moments are integrals of its height over the shadows of its faces, positive where a
face looks up along n and negative where it looks down: faces of the one body, cut by the planes of the other's. Only
faces that reach into the slab between the deepest point of b and that of a can take part. Of these most do not: the
facet of the Minkowski difference tells which faces meet first, a corner's with one, or those beside two edges. Their
planes alone bound a small polytope that holds the overlap, and a plane that has all its corners behind it cuts nothing.

Overlaps at rest are some 1e-5 of the size at the study's contact time. Deeper ones show the softness of the springs
rather than the form of the grains, and reach over many faces: they are looked at as if moved apart to PATCH_DEPTH.
"""

from typing import NamedTuple

import numpy as np

from simcore.compilation import leaf, routine
from simcore.dem.contact.search.ellipsoid_climb import tangents
from simcore.dem.shapes.hulls import Shapes, base_direction, vertex_offset

PATCH_DEPTH = 1e-4  # of the pair's size: overlaps beyond are taken apart to this depth
# Of the pair's size: where two faces lie in one plane and look the same way, both bound the overlap and only one may
# count. Planes that cut faces of a stand out by this, and those that cut faces of b are set back.
TIE = 1e-14
# Lengths of an edge, or of a face beside one: a bound whose corners lie farther off, as where faces lie on each other,
# is none; rounding there, 1e-16 of the distance, has to stay below the slack.
FARTHEST = 1e3
BOUND_SLACK = 1e-10  # of the pair's size: more than the tolerance to which a remembered facet is one


class Room(NamedTuple):
    """Working space of each thread, so that nothing is allocated on the way."""

    mark: np.ndarray  # (threads, vertices) int64
    stamp: np.ndarray  # (threads,) int64
    stack: np.ndarray  # (threads, vertices) int64
    faces: np.ndarray  # (threads, 2, faces, 3, 3): corners in the frame (t1, t2, n), of a and of b
    planes: np.ndarray  # (threads, 2, faces, 4): of these faces, n · x + d > 0 without
    polygon: np.ndarray  # (threads, 2, faces + 3, 3)
    height: np.ndarray  # (threads, faces + 3)
    bound: np.ndarray  # (threads, vertices + 1, 3): corners of a polytope that holds the overlap


def make_room(shapes: Shapes, n_threads: int) -> Room:
    """Room for the largest hull of the scene; none where there is no hull."""
    counts = np.diff(shapes.vertex_start)
    n = int(counts.max(initial=0))
    threads = n_threads if n else 0
    return Room(
        mark=np.zeros((threads, n), np.int64),
        stamp=np.zeros(threads, np.int64),
        stack=np.zeros((threads, n), np.int64),
        faces=np.zeros((threads, 2, 2 * n, 3, 3)),
        planes=np.zeros((threads, 2, 2 * n, 4)),
        polygon=np.zeros((threads, 2, 2 * n + 3, 3)),
        height=np.zeros((threads, 2 * n + 3)),
        bound=np.zeros((threads, n + 1, 3)),
    )


@leaf
def _dot(vertices, v, x, y, z):
    return vertices[v, 0] * x + vertices[v, 1] * y + vertices[v, 2] * z


@leaf
def _put(faces, t, side, face, corner, x, y, z):
    faces[t, side, face, corner, 0], faces[t, side, face, corner, 1], faces[t, side, face, corner, 2] = x, y, z


@leaf
def gather_faces(shapes, bodies, i, start, frame, ox, oy, oz, low, high, side, room, t):
    """Faces of body i that reach above z = low (side 0) or below z = high (side 1); returns how many.

    frame: the unit vectors t1, t2, n as nine numbers. o: the body's centre in that frame. start: its extreme vertex.
    Vertices within the slab hang together, by convexity, so they are found by a walk along edges.
    """
    vertices, ring_start, ring = shapes.vertices, shapes.neighbor_start, shapes.neighbors
    px, py, pz = base_direction(bodies, i, frame[0], frame[1], frame[2])
    qx, qy, qz = base_direction(bodies, i, frame[3], frame[4], frame[5])
    nx, ny, nz = base_direction(bodies, i, frame[6], frame[7], frame[8])
    first = shapes.vertex_start[bodies.shape[i]]
    room.stamp[t] += 1
    stamp = room.stamp[t]
    room.mark[t, start - first] = stamp
    room.stack[t, 0] = start
    n_stack, n_faces = 1, 0
    while n_stack > 0:
        n_stack -= 1
        v = room.stack[t, n_stack]
        vx, vy, vz = (
            ox + _dot(vertices, v, px, py, pz), oy + _dot(vertices, v, qx, qy, qz), oz + _dot(vertices, v, nx, ny, nz)
        )  # fmt: skip
        last = ring[ring_start[v + 1] - 1]
        lx, ly, lz = (
            ox + _dot(vertices, last, px, py, pz), oy + _dot(vertices, last, qx, qy, qz),
            oz + _dot(vertices, last, nx, ny, nz),
        )  # fmt: skip
        last_inside = (lz >= low) if side == 0 else (lz <= high)
        for k in range(ring_start[v], ring_start[v + 1]):
            u = ring[k]
            ux, uy, uz = (
                ox + _dot(vertices, u, px, py, pz), oy + _dot(vertices, u, qx, qy, qz),
                oz + _dot(vertices, u, nx, ny, nz),
            )  # fmt: skip
            inside = (uz >= low) if side == 0 else (uz <= high)
            if inside and room.mark[t, u - first] != stamp:
                room.mark[t, u - first] = stamp
                room.stack[t, n_stack] = u
                n_stack += 1
            # The face v, last, u belongs to the least of its vertices in the slab.
            if not ((inside and u < v) or (last_inside and last < v)):
                _put(room.faces, t, side, n_faces, 0, vx, vy, vz)
                _put(room.faces, t, side, n_faces, 1, lx, ly, lz)
                _put(room.faces, t, side, n_faces, 2, ux, uy, uz)
                n_faces += 1
            last, lx, ly, lz, last_inside = u, ux, uy, uz, inside
    return n_faces


@leaf
def _find_planes(room, t, side, n_faces, n_bound, slack):
    """Planes of the gathered faces; those that the overlap cannot reach are dropped. How many are left.

    slack: distance [m] from the corners of the bound within which a plane is kept.
    """
    faces, planes, bound = room.faces, room.planes, room.bound
    kept = 0
    for k in range(n_faces):
        x, y, z = faces[t, side, k, 0, 0], faces[t, side, k, 0, 1], faces[t, side, k, 0, 2]
        ax, ay, az = faces[t, side, k, 1, 0] - x, faces[t, side, k, 1, 1] - y, faces[t, side, k, 1, 2] - z
        bx, by, bz = faces[t, side, k, 2, 0] - x, faces[t, side, k, 2, 1] - y, faces[t, side, k, 2, 2] - z
        nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        length = np.sqrt(nx * nx + ny * ny + nz * nz)
        if not length > 0.0:
            continue
        nx, ny, nz = nx / length, ny / length, nz / length
        d = -(nx * x + ny * y + nz * z)
        highest = -np.inf if n_bound > 0 else np.inf
        for m in range(n_bound):
            highest = max(highest, nx * bound[t, m, 0] + ny * bound[t, m, 1] + nz * bound[t, m, 2] + d)
        if highest < -slack:
            continue
        planes[t, side, kept, 0], planes[t, side, kept, 1], planes[t, side, kept, 2] = nx, ny, nz
        planes[t, side, kept, 3] = d
        if kept < k:
            for corner in range(3):
                for axis in range(3):
                    faces[t, side, kept, corner, axis] = faces[t, side, k, corner, axis]
        kept += 1
    return kept


@leaf
def _cut_face(room, t, side, face, n_planes, tie):
    """Part of a gathered face within the other body: (which of the polygons it is, its number of corners)."""
    faces, planes, polygon, height = room.faces, room.planes, room.polygon, room.height
    now, n = 0, 3
    for k in range(3):
        polygon[t, 0, k, 0] = faces[t, side, face, k, 0]
        polygon[t, 0, k, 1] = faces[t, side, face, k, 1]
        polygon[t, 0, k, 2] = faces[t, side, face, k, 2]
    other = 1 - side
    for q in range(n_planes):
        nx, ny, nz = planes[t, other, q, 0], planes[t, other, q, 1], planes[t, other, q, 2]
        d = planes[t, other, q, 3] + tie
        lowest, highest = np.inf, -np.inf
        for k in range(n):
            h = nx * polygon[t, now, k, 0] + ny * polygon[t, now, k, 1] + nz * polygon[t, now, k, 2] + d
            height[t, k] = h
            lowest, highest = min(lowest, h), max(highest, h)
        if not highest > 0.0:
            continue
        if not lowest < 0.0:
            return now, 0
        into, kept, last = 1 - now, 0, n - 1
        for k in range(n):
            h, g = height[t, k], height[t, last]
            if (h > 0.0) != (g > 0.0):
                s = g / (g - h)
                for axis in range(3):
                    x = polygon[t, now, last, axis]
                    polygon[t, into, kept, axis] = x + s * (polygon[t, now, k, axis] - x)
                kept += 1
            if not h > 0.0:
                for axis in range(3):
                    polygon[t, into, kept, axis] = polygon[t, now, k, axis]
                kept += 1
            last = k
        now, n = into, kept
    return now, n


@leaf
def triangle_moments(x1, y1, d1, x2, y2, d2, x3, y3, d3):
    """∫ d, ∫ d x, ∫ d y, ∫ d x², ∫ d xy, ∫ d y² over a triangle of the plane with linear depth d.

    Products of barycentric coordinates integrate to 2 A a! b! c! / (a + b + c + 2)!.
    """
    double_area = (x2 - x1) * (y3 - y1) - (y2 - y1) * (x3 - x1)
    total = d1 + d2 + d3
    first = double_area / 24.0
    w1, w2, w3 = total + d1, total + d2, total + d3
    second = double_area / 120.0
    a1, a2, a3 = 2.0 * total + 4.0 * d1, 2.0 * total + 4.0 * d2, 2.0 * total + 4.0 * d3
    b12, b23, b31 = total + d1 + d2, total + d2 + d3, total + d3 + d1
    # Every mixed pair stands twice in the sum over i, j
    return (
        double_area * total / 6.0,
        first * (w1 * x1 + w2 * x2 + w3 * x3),
        first * (w1 * y1 + w2 * y2 + w3 * y3),
        second * (a1 * x1 * x1 + a2 * x2 * x2 + a3 * x3 * x3
                  + 2.0 * (b12 * x1 * x2 + b23 * x2 * x3 + b31 * x3 * x1)),
        second * (a1 * x1 * y1 + a2 * x2 * y2 + a3 * x3 * y3
                  + b12 * (x1 * y2 + x2 * y1) + b23 * (x2 * y3 + x3 * y2) + b31 * (x3 * y1 + x1 * y3)),
        second * (a1 * y1 * y1 + a2 * y2 * y2 + a3 * y3 * y3
                  + 2.0 * (b12 * y1 * y2 + b23 * y2 * y3 + b31 * y3 * y1)),
    )  # fmt: skip


@leaf
def _moments_of_faces(room, t, n_a, n_b, low, x0, y0, tie):
    """Sums of triangle_moments over all gathered faces, as far as they bound the overlap, about (x0, y0)."""
    m0, mx, my, mxx, mxy, myy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    polygon = room.polygon
    for side in range(2):
        n_faces, n_planes, gap = (n_a, n_b, -tie) if side == 0 else (n_b, n_a, tie)
        for face in range(n_faces):
            if room.planes[t, side, face, 2] == 0.0:
                continue  # seen edge-on
            now, n = _cut_face(room, t, side, face, n_planes, gap)
            if n < 3:
                continue
            x1, y1, z1 = polygon[t, now, 0, 0] - x0, polygon[t, now, 0, 1] - y0, polygon[t, now, 0, 2] - low
            x2, y2, z2 = polygon[t, now, 1, 0] - x0, polygon[t, now, 1, 1] - y0, polygon[t, now, 1, 2] - low
            for k in range(2, n):
                x3, y3, z3 = polygon[t, now, k, 0] - x0, polygon[t, now, k, 1] - y0, polygon[t, now, k, 2] - low
                s0, sx, sy, sxx, sxy, syy = triangle_moments(x1, y1, z1, x2, y2, z2, x3, y3, z3)
                m0, mx, my = m0 + s0, mx + sx, my + sy
                mxx, mxy, myy = mxx + sxx, mxy + sxy, myy + syy
                x2, y2, z2 = x3, y3, z3
    return m0, mx, my, mxx, mxy, myy


@routine
def clipped_patch(shapes, bodies, i, j, rx, ry, rz, a, b, nx, ny, nz, n_bound, room, t):
    """Moments of the depth, in general: (∫ d, ∫ d x, ∫ d y, ∫ d x², ∫ d xy, ∫ d y²) about vertex a, along t1 and t2.

    a, b: the support vertices along n. r: from the centre of body i to that of j. n_bound: corners in room.bound, 0
    where no bound is known.
    """
    px, py, pz, qx, qy, qz = tangents(nx, ny, nz)
    frame = (px, py, pz, qx, qy, qz, nx, ny, nz)
    dx, dy, dz = base_direction(bodies, i, nx, ny, nz)
    high = _dot(shapes.vertices, a, dx, dy, dz)
    dx, dy, dz = base_direction(bodies, j, nx, ny, nz)
    ox, oy, oz = (
        px * rx + py * ry + pz * rz, qx * rx + qy * ry + qz * rz, nx * rx + ny * ry + nz * rz
    )  # fmt: skip
    low = oz + _dot(shapes.vertices, b, dx, dy, dz)
    dx, dy, dz = base_direction(bodies, i, px, py, pz)
    x0 = _dot(shapes.vertices, a, dx, dy, dz)
    dx, dy, dz = base_direction(bodies, i, qx, qy, qz)
    y0 = _dot(shapes.vertices, a, dx, dy, dz)
    n_a = gather_faces(shapes, bodies, i, a, frame, 0.0, 0.0, 0.0, low, high, 0, room, t)
    n_b = gather_faces(shapes, bodies, j, b, frame, ox, oy, oz, low, high, 1, room, t)
    size = bodies.radius[i] + bodies.radius[j]
    n_a = _find_planes(room, t, 0, n_a, n_bound, BOUND_SLACK * size)
    n_b = _find_planes(room, t, 1, n_b, n_bound, BOUND_SLACK * size)
    return _moments_of_faces(room, t, n_a, n_b, low, x0, y0, TIE * size)


@leaf
def cone_moments(shapes, bodies, i, apex, j, f0, f1, f2, rx, ry, rz, depth, frame, sign, room, t):
    """Moments about an apex that alone reaches into the other body, where its cone ends inside one face there.

    apex: of body i, extreme along sign × n. f0, f1, f2: the face of body j, r from the centre of i to that of j.
    Returns (whether that is so, moments as clipped_patch, number of corners left in room.bound).
    """
    vertices, ring_start, ring = shapes.vertices, shapes.neighbor_start, shapes.neighbors
    px, py, pz = base_direction(bodies, i, frame[0], frame[1], frame[2])
    qx, qy, qz = base_direction(bodies, i, frame[3], frame[4], frame[5])
    nx, ny, nz = base_direction(bodies, i, sign * frame[6], sign * frame[7], sign * frame[8])
    ax, ay, az = vertices[apex, 0], vertices[apex, 1], vertices[apex, 2]
    ox = frame[0] * rx + frame[1] * ry + frame[2] * rz - (ax * px + ay * py + az * pz)
    oy = frame[3] * rx + frame[4] * ry + frame[5] * rz - (ax * qx + ay * qy + az * qz)
    dx, dy, dz = base_direction(bodies, j, frame[0], frame[1], frame[2])
    ex, ey, ez = base_direction(bodies, j, frame[3], frame[4], frame[5])
    x0, y0 = ox + _dot(vertices, f0, dx, dy, dz), oy + _dot(vertices, f0, ex, ey, ez)
    x1, y1 = ox + _dot(vertices, f1, dx, dy, dz), oy + _dot(vertices, f1, ex, ey, ez)
    x2, y2 = ox + _dot(vertices, f2, dx, dy, dz), oy + _dot(vertices, f2, ex, ey, ez)
    turn = 1.0 if (x1 - x0) * (y2 - y0) - (y1 - y0) * (x2 - x0) > 0.0 else -1.0
    # Lines of the face's sides: c x + d y + e >= 0 inside
    c0, d0 = turn * (y0 - y1), turn * (x1 - x0)
    c1, d1 = turn * (y1 - y2), turn * (x2 - x1)
    c2, d2 = turn * (y2 - y0), turn * (x0 - x2)
    e0, e1, e2 = -(c0 * x0 + d0 * y0), -(c1 * x1 + d1 * y1), -(c2 * x2 + d2 * y2)
    # The apex from the centre of the first body
    apex_x, apex_y, apex_z = (
        ax * px + ay * py + az * pz,
        ax * qx + ay * qy + az * qz,
        sign * (ax * nx + ay * ny + az * nz),
    )
    if sign < 0.0:
        apex_x -= frame[0] * rx + frame[1] * ry + frame[2] * rz
        apex_y -= frame[3] * rx + frame[4] * ry + frame[5] * rz
        apex_z -= frame[6] * rx + frame[7] * ry + frame[8] * rz
    _put_corner(room, t, 0, apex_x, apex_y, apex_z)
    n_bound, alone, bounded = 1, True, True
    m0, mx, my, mxx, mxy, myy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    last = ring_start[apex + 1] - 1
    sx, sy, _ = _foot(vertices, ring[last], ax, ay, az, px, py, pz, qx, qy, qz, nx, ny, nz, depth)
    for k in range(ring_start[apex], ring_start[apex + 1]):
        x, y, fall = _foot(vertices, ring[k], ax, ay, az, px, py, pz, qx, qy, qz, nx, ny, nz, depth)
        bounded = bounded and FARTHEST * fall > depth
        if not fall > depth or c0 * x + d0 * y + e0 < 0.0 or c1 * x + d1 * y + e1 < 0.0 or c2 * x + d2 * y + e2 < 0.0:
            alone = False
        _put_corner(room, t, n_bound, apex_x + x, apex_y + y, apex_z - sign * depth)
        n_bound += 1
        s0, s1, s2, s11, s12, s22 = cone_side(sx, sy, x, y)
        s0 *= sign
        m0, mx, my = m0 + s0, mx + s0 * s1, my + s0 * s2
        mxx, mxy, myy = mxx + s0 * s11, mxy + s0 * s12, myy + s0 * s22
        sx, sy = x, y
    return (
        alone, m0 * depth / 6.0, mx * depth / 24.0, my * depth / 24.0,
        mxx * depth / 60.0, mxy * depth / 60.0, myy * depth / 60.0, n_bound if bounded else 0,
    )  # fmt: skip


@leaf
def _foot(vertices, u, ax, ay, az, px, py, pz, qx, qy, qz, nx, ny, nz, depth):
    """Where the edge from a to u, or its line, leaves the slab of that depth: (x, y) from a, and how far it falls."""
    ux, uy, uz = vertices[u, 0] - ax, vertices[u, 1] - ay, vertices[u, 2] - az
    fall = -(ux * nx + uy * ny + uz * nz)
    t = depth / fall
    return t * (ux * px + uy * py + uz * pz), t * (ux * qx + uy * qy + uz * qz), fall


@leaf
def _facing(shapes, v, u):
    """The two vertices that make a face with the edge v, u; v twice where there is no such edge."""
    start, ring = shapes.neighbor_start, shapes.neighbors
    first, last = start[v], start[v + 1] - 1
    for k in range(first, last + 1):
        if ring[k] == u:
            return ring[k - 1] if k > first else ring[last], ring[k + 1] if k < last else ring[first]
    return v, v


@leaf
def _ridge(vertices, w, x0, y0, x1, y1, ox, oy, level, px, py, pz, qx, qy, qz, nx, ny, nz, depth):
    """Face beside an edge from 0 to 1: (its third corner (2), signed distance of that from the edge's line times the
    edge's length, where the face, or its plane, has left the slab, as a share of that distance)."""
    x, y = ox + _dot(vertices, w, px, py, pz), oy + _dot(vertices, w, qx, qy, qz)
    fall = level - _dot(vertices, w, nx, ny, nz)
    side = (x1 - x0) * (y - y0) - (y1 - y0) * (x - x0)
    return x, y, side, depth / fall


@leaf
def _put_corner(room, t, corner, x, y, z):
    room.bound[t, corner, 0], room.bound[t, corner, 1], room.bound[t, corner, 2] = x, y, z


@leaf
def _inside(x, y, x0, y0, x1, y1, x2, y2):
    """Whether a point lies in a triangle, whichever way that runs."""
    a = (x1 - x0) * (y - y0) - (y1 - y0) * (x - x0)
    b = (x2 - x1) * (y - y1) - (y2 - y1) * (x - x1)
    c = (x0 - x2) * (y - y2) - (y0 - y2) * (x - x2)
    return (a >= 0.0 and b >= 0.0 and c >= 0.0) or (a <= 0.0 and b <= 0.0 and c <= 0.0)


@leaf
def crossing_moments(shapes, bodies, i, a0, a1, j, b0, b1, rx, ry, rz, depth, frame, room, thread):
    """Moments about the crossing of two edges that alone reach into each other, and the crossing from a's centre.

    The depth is that of a pyramid: all of it where the edges cross, and none where, along either edge, the other
    body's two faces have gone by. Returns (whether that is so, crossing (2), moments as clipped_patch, number of
    corners left in room.bound).
    """
    no = (False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0)
    vertices = shapes.vertices
    al, ar = _facing(shapes, a0, a1)
    bl, br = _facing(shapes, b0, b1)
    if al == a0 or bl == b0:
        return no
    px, py, pz = base_direction(bodies, i, frame[0], frame[1], frame[2])
    qx, qy, qz = base_direction(bodies, i, frame[3], frame[4], frame[5])
    nx, ny, nz = base_direction(bodies, i, frame[6], frame[7], frame[8])
    x0, y0 = _dot(vertices, a0, px, py, pz), _dot(vertices, a0, qx, qy, qz)
    x1, y1 = _dot(vertices, a1, px, py, pz), _dot(vertices, a1, qx, qy, qz)
    top = level = _dot(vertices, a0, nx, ny, nz)
    xl, yl, left_a, share_al = _ridge(
        vertices, al, x0, y0, x1, y1, 0.0, 0.0, level, px, py, pz, qx, qy, qz, nx, ny, nz, depth
    )
    xr, yr, right_a, share_ar = _ridge(
        vertices, ar, x0, y0, x1, y1, 0.0, 0.0, level, px, py, pz, qx, qy, qz, nx, ny, nz, depth
    )
    ox, oy = frame[0] * rx + frame[1] * ry + frame[2] * rz, frame[3] * rx + frame[4] * ry + frame[5] * rz
    px, py, pz = base_direction(bodies, j, frame[0], frame[1], frame[2])
    qx, qy, qz = base_direction(bodies, j, frame[3], frame[4], frame[5])
    nx, ny, nz = base_direction(bodies, j, -frame[6], -frame[7], -frame[8])
    u0, v0 = ox + _dot(vertices, b0, px, py, pz), oy + _dot(vertices, b0, qx, qy, qz)
    u1, v1 = ox + _dot(vertices, b1, px, py, pz), oy + _dot(vertices, b1, qx, qy, qz)
    level = _dot(vertices, b0, nx, ny, nz)
    ul, vl, left_b, share_bl = _ridge(
        vertices, bl, u0, v0, u1, v1, ox, oy, level, px, py, pz, qx, qy, qz, nx, ny, nz, depth
    )
    ur, vr, right_b, share_br = _ridge(
        vertices, br, u0, v0, u1, v1, ox, oy, level, px, py, pz, qx, qy, qz, nx, ny, nz, depth
    )
    least, most = (
        min(min(share_al, share_ar), min(share_bl, share_br)),
        max(max(share_al, share_ar), max(share_bl, share_br)),
    )
    if not (least > 0.0 and most < FARTHEST) or left_a * right_a >= 0.0 or left_b * right_b >= 0.0:
        return no
    ex, ey, fx, fy = x1 - x0, y1 - y0, u1 - u0, v1 - v0
    cross = ex * fy - ey * fx
    if cross == 0.0:
        return no
    # The crossing: share s of the way along a, t along b
    s = ((u0 - x0) * fy - (v0 - y0) * fx) / cross
    t = ((u0 - x0) * ey - (v0 - y0) * ex) / cross
    # Along b the signed distance from a's line grows by `cross` per length of b; and along a by −cross.
    t1, t2 = share_al * left_a / cross, share_ar * right_a / cross
    s1, s2 = -share_bl * left_b / cross, -share_br * right_b / cross
    cx, cy = x0 + s * ex, y0 + s * ey
    k1x, k1y, k2x, k2y = t1 * fx, t1 * fy, t2 * fx, t2 * fy  # ends on b, from the crossing: left of a, right of a
    l1x, l1y, l2x, l2y = s1 * ex, s1 * ey, s2 * ex, s2 * ey  # ends on a: left of b, right of b
    if not (
        most < 1.0
        and min(t + t1, t + t2) >= 0.0 and max(t + t1, t + t2) <= 1.0
        and min(s + s1, s + s2) >= 0.0 and max(s + s1, s + s2) <= 1.0
        and _inside(cx + k1x, cy + k1y, x0, y0, x1, y1, xl, yl)
        and _inside(cx + k2x, cy + k2y, x0, y0, x1, y1, xr, yr)
        and _inside(cx + l1x, cy + l1y, u0, v0, u1, v1, ul, vl)
        and _inside(cx + l2x, cy + l2y, u0, v0, u1, v1, ur, vr)
    ):  # fmt: skip
        _put_corner(room, thread, 0, cx + k1x, cy + k1y, top - depth)
        _put_corner(room, thread, 1, cx + k2x, cy + k2y, top - depth)
        _put_corner(room, thread, 2, cx + l1x, cy + l1y, top)
        _put_corner(room, thread, 3, cx + l2x, cy + l2y, top)
        return False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4
    m0, mx, my, mxx, mxy, myy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for fx, fy in ((k1x, k1y), (k2x, k2y)):
        for gx, gy in ((l1x, l1y), (l2x, l2y)):
            s0, sx, sy, sxx, sxy, syy = cone_side(fx, fy, gx, gy)
            s0 = abs(s0)
            m0, mx, my = m0 + s0, mx + s0 * sx, my + s0 * sy
            mxx, mxy, myy = mxx + s0 * sxx, mxy + s0 * sxy, myy + s0 * syy
    return (
        True, cx, cy, m0 * depth / 6.0, mx * depth / 24.0, my * depth / 24.0,
        mxx * depth / 60.0, mxy * depth / 60.0, myy * depth / 60.0, 0,
    )  # fmt: skip


@leaf
def cone_side(sx, sy, x, y):
    """Of a triangle with the origin, where the depth is d, and two corners without: (2 area, and with a sixth,
    24th, 60th of d times that area the moments: x, y, x², xy, y²). See triangle_moments."""
    return (
        sx * y - sy * x, sx + x, sy + y, sx * sx + x * x + sx * x,
        sx * sy + x * y + 0.5 * (sx * y + x * sy), sy * sy + y * y + sy * y,
    )  # fmt: skip


@leaf
def find_patch(shapes, bodies, contacts, p, i, j, rx, ry, rz, room, t):
    """Move the point of touching contact p to the centroid of its patch, and note the patch's second moments."""
    facet = contacts.facet
    nx, ny, nz = contacts.direction[p, 0], contacts.direction[p, 1], contacts.direction[p, 2]
    overlap = contacts.overlap[p]
    depth = min(overlap, PATCH_DEPTH * (bodies.radius[i] + bodies.radius[j]))
    sx, sy, sz = rx + (overlap - depth) * nx, ry + (overlap - depth) * ny, rz + (overlap - depth) * nz
    px, py, pz, qx, qy, qz = tangents(nx, ny, nz)
    frame = (px, py, pz, qx, qy, qz, nx, ny, nz)
    a0, a1, a2 = facet[p, 0], facet[p, 1], facet[p, 2]
    b0, b1, b2 = facet[p, 3], facet[p, 4], facet[p, 5]
    # Where the moments are about: vertex a0, vertex b0, or a crossing of edges
    found, about_b, ox, oy = False, False, 0.0, 0.0
    m0, mx, my, mxx, mxy, myy, n_bound = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0
    if a0 == a1 and a0 == a2:
        found, m0, mx, my, mxx, mxy, myy, n_bound = cone_moments(
            shapes, bodies, i, a0, j, b0, b1, b2, sx, sy, sz, depth, frame, 1.0, room, t
        )
    elif b0 == b1 and b0 == b2:
        found, m0, mx, my, mxx, mxy, myy, n_bound = cone_moments(
            shapes, bodies, j, b0, i, a0, a1, a2, -sx, -sy, -sz, depth, frame, -1.0, room, t
        )
        about_b = found
    elif (a0 == a1 or a0 == a2 or a1 == a2) and (b0 == b1 or b0 == b2 or b1 == b2):
        found, ox, oy, m0, mx, my, mxx, mxy, myy, n_bound = crossing_moments(
            shapes, bodies, i, a0, a2 if a1 == a0 else a1, j, b0, b2 if b1 == b0 else b1,
            sx, sy, sz, depth, frame, room, t,
        )  # fmt: skip
        if found:  # from the centre of a to vertex a0
            dx, dy, dz = vertex_offset(shapes, bodies, i, a0)
            ox, oy = ox - (px * dx + py * dy + pz * dz), oy - (qx * dx + qy * dy + qz * dz)
    if not found:
        m0, mx, my, mxx, mxy, myy = clipped_patch(
            shapes, bodies, i, j, sx, sy, sz, a0, b0, nx, ny, nz, n_bound, room, t
        )
    if not m0 > 0.0:
        for k in range(6):
            contacts.spread[p, k] = 0.0
        return
    cx, cy = mx / m0, my / m0
    note_spread(contacts.spread, p, frame, mxx / m0 - cx * cx, mxy / m0 - cx * cy, myy / m0 - cy * cy)
    half = -0.5 * overlap
    if about_b:
        x, y, z = vertex_offset(shapes, bodies, j, b0)
        x, y, z = x + rx, y + ry, z + rz
        half = -half
    else:
        x, y, z = vertex_offset(shapes, bodies, i, a0)
        cx, cy = cx + ox, cy + oy
    contacts.point[p, 0] = x + cx * px + cy * qx + half * nx
    contacts.point[p, 1] = y + cx * py + cy * qy + half * ny
    contacts.point[p, 2] = z + cx * pz + cy * qz + half * nz


@leaf
def note_spread(spread, p, frame, sxx, sxy, syy):
    """Second moments in the tangent plane as a symmetric world matrix."""
    px, py, pz, qx, qy, qz = frame[0], frame[1], frame[2], frame[3], frame[4], frame[5]
    spread[p, 0] = sxx * px * px + 2.0 * sxy * px * qx + syy * qx * qx
    spread[p, 1] = sxx * py * py + 2.0 * sxy * py * qy + syy * qy * qy
    spread[p, 2] = sxx * pz * pz + 2.0 * sxy * pz * qz + syy * qz * qz
    spread[p, 3] = sxx * px * py + sxy * (px * qy + py * qx) + syy * qx * qy
    spread[p, 4] = sxx * px * pz + sxy * (px * qz + pz * qx) + syy * qx * qz
    spread[p, 5] = sxx * py * pz + sxy * (py * qz + pz * qy) + syy * qy * qz
