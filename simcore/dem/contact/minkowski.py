"""Polyhedron against polyhedron from nothing: GJK for the gap, EPA for the overlap.

Both work on the Minkowski difference M = A − (B + r), which is seen only through its support points
m = a − b − r, a and b vertices. M contains the origin where the bodies overlap.

GJK (Gilbert, Johnson & Keerthi 1988) walks to the point of M next to the origin. A direction in which M stays
below zero is a certificate of separation, whatever happened on the way.

EPA (van den Bergen 2001) grows a polytope inside M, always at the facet next to the origin, until that facet
belongs to M itself. With signed facet distances it needs no start that contains the origin: a facet that has
the origin outside is the nearest of all and is pushed out first. So it also decides the cases at the edge
between touching and not touching that GJK cannot.
"""

import numpy as np

from simcore.compilation import leaf, search
from simcore.dem.shapes import support_vertex, vertex_offset

GJK_ITERATIONS = 64
EPA_VERTICES = 256
EPA_FACES = 512
SEARCH_TOLERANCE = 1e-12  # of the pair's size: how far M may reach beyond a facet that counts as its own


@leaf
def support(shapes, bodies, i, j, rx, ry, rz, a, b, nx, ny, nz):
    """Support point of M along n: vertices a and b, and m = a − b − r."""
    a = support_vertex(shapes, bodies, i, a, nx, ny, nz)
    b = support_vertex(shapes, bodies, j, b, -nx, -ny, -nz)
    ax, ay, az = vertex_offset(shapes, bodies, i, a)
    bx, by, bz = vertex_offset(shapes, bodies, j, b)
    return a, b, ax - bx - rx, ay - by - ry, az - bz - rz


@leaf
def _difference(points, p, q):
    return points[q, 0] - points[p, 0], points[q, 1] - points[p, 1], points[q, 2] - points[p, 2]


@leaf
def _along(points, p, dx, dy, dz):
    return points[p, 0] * dx + points[p, 1] * dy + points[p, 2] * dz


@leaf
def _segment_weights(points, p, q):
    """Barycentric weights of the point of segment p, q next to the origin."""
    dx, dy, dz = _difference(points, p, q)
    length2 = dx * dx + dy * dy + dz * dz
    if length2 == 0.0:
        return 1.0, 0.0
    t = min(max(-_along(points, p, dx, dy, dz) / length2, 0.0), 1.0)
    return 1.0 - t, t


@search
def _triangle_weights(points, p, q, s):
    """Barycentric weights of the point of triangle p, q, s next to the origin (regions of Ericson 2005, 5.1.5)."""
    ex, ey, ez = _difference(points, p, q)
    fx, fy, fz = _difference(points, p, s)
    e_p, f_p = -_along(points, p, ex, ey, ez), -_along(points, p, fx, fy, fz)
    if e_p <= 0.0 and f_p <= 0.0:
        return 1.0, 0.0, 0.0
    e_q, f_q = -_along(points, q, ex, ey, ez), -_along(points, q, fx, fy, fz)
    if e_q >= 0.0 and f_q <= e_q:
        return 0.0, 1.0, 0.0
    area_s = e_p * f_q - e_q * f_p
    if area_s <= 0.0 and e_p >= 0.0 and e_q <= 0.0:
        t = e_p / (e_p - e_q) if e_p != e_q else 0.0
        return 1.0 - t, t, 0.0
    e_s, f_s = -_along(points, s, ex, ey, ez), -_along(points, s, fx, fy, fz)
    if f_s >= 0.0 and e_s <= f_s:
        return 0.0, 0.0, 1.0
    area_q = e_s * f_p - e_p * f_s
    if area_q <= 0.0 and f_p >= 0.0 and f_s <= 0.0:
        t = f_p / (f_p - f_s) if f_p != f_s else 0.0
        return 1.0 - t, 0.0, t
    area_p = e_q * f_s - e_s * f_q
    if area_p <= 0.0 and f_q >= e_q and e_s >= f_s:
        total = (f_q - e_q) + (e_s - f_s)
        t = (f_q - e_q) / total if total != 0.0 else 0.0
        return 0.0, 1.0 - t, t
    total = area_p + area_q + area_s
    return area_p / total, area_q / total, area_s / total


@search
def _nearest_on_simplex(points, n, weights):
    """Fill the weights of the simplex point next to the origin; True where a tetrahedron contains the origin."""
    weights[:] = 0.0
    if n == 1:
        weights[0] = 1.0
        return False
    if n == 2:
        weights[0], weights[1] = _segment_weights(points, 0, 1)
        return False
    if n == 3:
        weights[0], weights[1], weights[2] = _triangle_weights(points, 0, 1, 2)
        return False
    best = np.inf
    inside = True
    for apex in range(4):
        p, q, s = (apex + 1) % 4, (apex + 2) % 4, (apex + 3) % 4
        ex, ey, ez = _difference(points, p, q)
        fx, fy, fz = _difference(points, p, s)
        nx, ny, nz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
        origin_side = -_along(points, p, nx, ny, nz)
        apex_side = _along(points, apex, nx, ny, nz) + origin_side
        if origin_side * apex_side > 0.0:
            continue  # the origin lies on the inner side of this face
        inside = False
        u, v, w = _triangle_weights(points, p, q, s)
        x = u * points[p, 0] + v * points[q, 0] + w * points[s, 0]
        y = u * points[p, 1] + v * points[q, 1] + w * points[s, 1]
        z = u * points[p, 2] + v * points[q, 2] + w * points[s, 2]
        distance2 = x * x + y * y + z * z
        if distance2 < best:
            best = distance2
            weights[apex] = 0.0
            weights[p], weights[q], weights[s] = u, v, w
    return inside


@search
def separation(shapes, bodies, i, j, rx, ry, rz, size, a, b, nx, ny, nz, slack):
    """Gap by GJK: (gap, direction (3), a, b) with a gap > 0 that is certain; gap <= 0 where none was found.

    The direction given starts the search. The gap is a lower bound of the distance and not less than (1 − slack)
    times it; below some 1e-7 of the size, where rounding ends the search early, it may be shorter.
    a, b: vertices to climb from, on return the supports along the direction.
    """
    points = np.empty((4, 3))
    weights = np.empty(4)
    a, b, x, y, z = support(shapes, bodies, i, j, rx, ry, rz, a, b, nx, ny, nz)
    best_gap = -(x * nx + y * ny + z * nz)
    best_x, best_y, best_z, best_a, best_b = nx, ny, nz, a, b
    points[0, 0], points[0, 1], points[0, 2] = x, y, z
    n = 1
    vx, vy, vz = x, y, z
    for _ in range(GJK_ITERATIONS):
        distance = np.sqrt(vx * vx + vy * vy + vz * vz)
        if distance <= 1e-14 * size:
            break
        nx, ny, nz = -vx / distance, -vy / distance, -vz / distance
        a, b, x, y, z = support(shapes, bodies, i, j, rx, ry, rz, a, b, nx, ny, nz)
        gap = -(x * nx + y * ny + z * nz)
        if gap > best_gap:
            best_gap = gap
            best_x, best_y, best_z, best_a, best_b = nx, ny, nz, a, b
        if best_gap >= (1.0 - slack) * distance:
            break
        repeated = False
        for k in range(n):
            if points[k, 0] == x and points[k, 1] == y and points[k, 2] == z:
                repeated = True
        if repeated:
            break
        points[n, 0], points[n, 1], points[n, 2] = x, y, z
        n += 1
        if _nearest_on_simplex(points, n, weights):
            break
        kept = 0
        vx, vy, vz = 0.0, 0.0, 0.0
        for k in range(n):
            if weights[k] > 0.0:
                vx += weights[k] * points[k, 0]
                vy += weights[k] * points[k, 1]
                vz += weights[k] * points[k, 2]
                points[kept] = points[k]
                kept += 1
        n = kept
        if n == 4:
            break
    return best_gap, best_x, best_y, best_z, best_a, best_b


@search
def _set_face(k, p, q, s, points, faces, normals, distances, size):
    """Face k of vertices p, q, s: unit outward normal and signed distance of its plane from the origin."""
    faces[k, 0], faces[k, 1], faces[k, 2] = p, q, s
    ax, ay, az = points[q, 0] - points[p, 0], points[q, 1] - points[p, 1], points[q, 2] - points[p, 2]
    bx, by, bz = points[s, 0] - points[p, 0], points[s, 1] - points[p, 1], points[s, 2] - points[p, 2]
    nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    area = np.sqrt(nx * nx + ny * ny + nz * nz)
    if area <= 1e-13 * size * size:
        # A sliver has no reliable plane: never the nearest face and never seen from a new vertex, but the
        # polytope stays closed.
        normals[k, 0], normals[k, 1], normals[k, 2] = 0.0, 0.0, 0.0
        distances[k] = np.inf
        return
    nx, ny, nz = nx / area, ny / area, nz / area
    normals[k, 0], normals[k, 1], normals[k, 2] = nx, ny, nz
    # The mean over the vertices halves the rounding of a single one.
    distances[k] = (
        nx * (points[p, 0] + points[q, 0] + points[s, 0])
        + ny * (points[p, 1] + points[q, 1] + points[s, 1])
        + nz * (points[p, 2] + points[q, 2] + points[s, 2])
    ) / 3.0


@search
def _farther(shapes, bodies, i, j, rx, ry, rz, a, b, nx, ny, nz, px, py, pz):
    """Of the supports along n and −n the one farther from the plane through p: (height, a, b, m)."""
    a1, b1, x1, y1, z1 = support(shapes, bodies, i, j, rx, ry, rz, a, b, nx, ny, nz)
    a2, b2, x2, y2, z2 = support(shapes, bodies, i, j, rx, ry, rz, a, b, -nx, -ny, -nz)
    up = nx * (x1 - px) + ny * (y1 - py) + nz * (z1 - pz)
    down = -(nx * (x2 - px) + ny * (y2 - py) + nz * (z2 - pz))
    if up >= down:
        return up, a1, b1, x1, y1, z1
    return down, a2, b2, x2, y2, z2


@search
def _facet_below(points, faces, normals, distances, alive, n_faces, nearest, tolerance):
    """Of the faces in the plane of the nearest one, that which holds the origin's projection.

    A facet of M is a triangle only by chance: that of two edges is a parallelogram, and EPA meets its triangles in
    any order.
    """
    nx, ny, nz = normals[nearest, 0], normals[nearest, 1], normals[nearest, 2]
    best, most = nearest, -np.inf
    for k in range(n_faces):
        if not alive[k] or distances[k] > distances[nearest] + tolerance:
            continue
        p, q, s = faces[k, 0], faces[k, 1], faces[k, 2]
        # A face as near may also lie elsewhere (concentric bodies): then its corners are not in the plane.
        lowest = min(_along(points, p, nx, ny, nz), _along(points, q, nx, ny, nz), _along(points, s, nx, ny, nz))
        if lowest < distances[nearest] - 4.0 * tolerance:
            continue
        least = _least_weight(points, p, q, s, nx, ny, nz)
        if least > most:
            best, most = k, least
    return best


@leaf
def _least_weight(points, p, q, s, nx, ny, nz):
    """Least barycentric weight of the origin's projection along n on triangle p, q, s: negative outside."""
    px, py, pz = points[p, 0], points[p, 1], points[p, 2]
    qx, qy, qz = points[q, 0], points[q, 1], points[q, 2]
    sx, sy, sz = points[s, 0], points[s, 1], points[s, 2]
    u = (qy * sz - qz * sy) * nx + (qz * sx - qx * sz) * ny + (qx * sy - qy * sx) * nz
    v = (sy * pz - sz * py) * nx + (sz * px - sx * pz) * ny + (sx * py - sy * px) * nz
    w = (py * qz - pz * qy) * nx + (pz * qx - px * qz) * ny + (px * qy - py * qx) * nz
    return min(u, v, w) / (u + v + w)


@search
def penetration(shapes, bodies, i, j, rx, ry, rz, size, a, b, nx, ny, nz):
    """Signed facet distance by EPA: (overlap, normal (3), facet a0 a1 a2 b0 b1 b2).

    A negative overlap is a certain gap along the normal. The first entry of the facet is -1 where the polytope
    ran out of room or could not be kept closed: then the normal is the best direction met, and the overlap its
    support value, an upper bound of the depth with a normal that belongs to it.
    """
    points = np.empty((EPA_VERTICES, 3))
    of_a = np.empty(EPA_VERTICES, np.int64)
    of_b = np.empty(EPA_VERTICES, np.int64)
    faces = np.empty((EPA_FACES, 3), np.int64)
    adjacent = np.empty((EPA_FACES, 3), np.int64)
    normals = np.empty((EPA_FACES, 3))
    distances = np.empty(EPA_FACES)
    alive = np.zeros(EPA_FACES, np.bool_)
    seen = np.zeros(EPA_FACES, np.int64)
    stack = np.empty(EPA_FACES, np.int64)
    free = np.empty(EPA_FACES, np.int64)
    rim = np.empty((EPA_FACES, 4), np.int64)  # edges between what w sees and does not: start, end, face, its slot
    from_vertex = np.empty(EPA_VERTICES, np.int64)

    # A tetrahedron from the direction given: there and back, then as far sideways as M reaches.
    a, b, x, y, z = support(shapes, bodies, i, j, rx, ry, rz, a, b, nx, ny, nz)
    best, best_x, best_y, best_z = x * nx + y * ny + z * nz, nx, ny, nz
    points[0, 0], points[0, 1], points[0, 2], of_a[0], of_b[0] = x, y, z, a, b
    a, b, x, y, z = support(shapes, bodies, i, j, rx, ry, rz, a, b, -nx, -ny, -nz)
    points[1, 0], points[1, 1], points[1, 2], of_a[1], of_b[1] = x, y, z, a, b
    ex, ey, ez = x - points[0, 0], y - points[0, 1], z - points[0, 2]
    if abs(ex) <= abs(ey) and abs(ex) <= abs(ez):
        sx, sy, sz = 0.0, -ez, ey
    elif abs(ey) <= abs(ez):
        sx, sy, sz = ez, 0.0, -ex
    else:
        sx, sy, sz = -ey, ex, 0.0
    length = np.sqrt(sx * sx + sy * sy + sz * sz)
    sx, sy, sz = sx / length, sy / length, sz / length
    _, a, b, x, y, z = _farther(
        shapes, bodies, i, j, rx, ry, rz, a, b, sx, sy, sz, points[0, 0], points[0, 1], points[0, 2]
    )
    points[2, 0], points[2, 1], points[2, 2], of_a[2], of_b[2] = x, y, z, a, b
    fx, fy, fz = x - points[0, 0], y - points[0, 1], z - points[0, 2]
    sx, sy, sz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
    length = np.sqrt(sx * sx + sy * sy + sz * sz)
    sx, sy, sz = sx / length, sy / length, sz / length
    height, a, b, x, y, z = _farther(
        shapes, bodies, i, j, rx, ry, rz, a, b, sx, sy, sz, points[0, 0], points[0, 1], points[0, 2]
    )
    points[3, 0], points[3, 1], points[3, 2], of_a[3], of_b[3] = x, y, z, a, b
    n_points = 4
    above = sx * (x - points[0, 0]) + sy * (y - points[0, 1]) + sz * (z - points[0, 2]) > 0.0
    if above:  # vertices 0, 1, 2 run outward, seen from outside, where 3 lies below them
        p, q, s = 0, 2, 1
    else:
        p, q, s = 0, 1, 2
    _set_face(0, p, q, s, points, faces, normals, distances, size)
    _set_face(1, q, p, 3, points, faces, normals, distances, size)
    _set_face(2, s, q, 3, points, faces, normals, distances, size)
    _set_face(3, p, s, 3, points, faces, normals, distances, size)
    for k in range(3):
        adjacent[0, k] = k + 1
        adjacent[k + 1, 0] = 0
        adjacent[k + 1, 1] = 1 + (k + 2) % 3
        adjacent[k + 1, 2] = 1 + (k + 1) % 3
    alive[:4] = True
    n_faces, n_free = 4, 0
    tolerance = SEARCH_TOLERANCE * size

    for iteration in range(EPA_VERTICES - 4):
        nearest = -1
        least = np.inf
        for k in range(n_faces):
            if alive[k] and distances[k] < least:
                least = distances[k]
                nearest = k
        if nearest < 0 or not height > 0.0:
            break
        nx, ny, nz = normals[nearest, 0], normals[nearest, 1], normals[nearest, 2]
        start = faces[nearest, 0]
        a, b, x, y, z = support(shapes, bodies, i, j, rx, ry, rz, of_a[start], of_b[start], nx, ny, nz)
        reach = x * nx + y * ny + z * nz
        if reach < best:
            best, best_x, best_y, best_z = reach, nx, ny, nz
        if reach - least <= tolerance:
            nearest = _facet_below(points, faces, normals, distances, alive, n_faces, nearest, tolerance)
            p, q, s = faces[nearest, 0], faces[nearest, 1], faces[nearest, 2]
            return reach, nx, ny, nz, of_a[p], of_a[q], of_a[s], of_b[p], of_b[q], of_b[s]

        # Faces that the new vertex sees, found by walking from the nearest, so that they hang together.
        w = n_points
        points[w, 0], points[w, 1], points[w, 2], of_a[w], of_b[w] = x, y, z, a, b
        n_points += 1
        mark = iteration + 1
        n_rim, n_stack = 0, 1
        stack[0] = nearest
        seen[nearest] = mark
        while n_stack > 0:
            n_stack -= 1
            face = stack[n_stack]
            alive[face] = False
            for k in range(3):
                other = adjacent[face, k]
                if seen[other] == mark:
                    continue
                beyond = normals[other, 0] * x + normals[other, 1] * y + normals[other, 2] * z - distances[other]
                if beyond > 1e-15 * size:
                    seen[other] = mark
                    stack[n_stack] = other
                    n_stack += 1
        for face in range(n_faces):
            if seen[face] == mark:
                for k in range(3):
                    other = adjacent[face, k]
                    if seen[other] != mark:
                        slot = 0
                        while slot < 2 and faces[other, slot] != faces[face, (k + 1) % 3]:
                            slot += 1
                        rim[n_rim, 0] = faces[face, k]
                        rim[n_rim, 1] = faces[face, (k + 1) % 3]
                        rim[n_rim, 2] = other
                        rim[n_rim, 3] = slot
                        n_rim += 1
        for face in range(n_faces):
            if seen[face] == mark:
                seen[face] = 0
                free[n_free] = face
                n_free += 1

        for k in range(n_points):
            from_vertex[k] = -1
        closed = n_rim >= 3
        if n_faces - n_free + n_rim > EPA_FACES - 2:
            break
        first = n_free
        for k in range(n_rim):
            if from_vertex[rim[k, 0]] >= 0:
                closed = False
            if first > 0:
                first -= 1
                slot = free[first]
            else:
                slot = n_faces
                n_faces += 1
            from_vertex[rim[k, 0]] = slot
        for k in range(n_rim):
            if from_vertex[rim[k, 1]] < 0:
                closed = False
        if not closed:
            break
        n_free = first
        for k in range(n_rim):
            face = from_vertex[rim[k, 0]]
            after = from_vertex[rim[k, 1]]
            _set_face(face, rim[k, 0], rim[k, 1], w, points, faces, normals, distances, size)
            alive[face] = True
            adjacent[face, 0] = rim[k, 2]
            adjacent[rim[k, 2], rim[k, 3]] = face
            adjacent[face, 1] = after
            adjacent[after, 2] = face
    return best, best_x, best_y, best_z, -1, -1, -1, of_a[0], -1, of_b[0]
