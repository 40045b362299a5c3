"""All facets of the Minkowski difference M of two polyhedra, without building it.

A facet of M belongs to a face of a, to a face of b, or to an edge of each. On the sphere of normals an edge is the arc
between the normals of its two faces, and a vertex the region between its edges' arcs; the facets of two edges are
where an arc of a crosses one of b. So: follow each arc of a across the regions of b, from vertex to neighbouring
vertex. The cost is linear in edges and crossings, and nothing is stored.

The support value of M along any direction is an upper bound of the depth, whatever the rounding of the direction, and
it is what is compared: so rounding can misjudge a crossing, but never the depth that its direction shows. And where a
crossing is missed because it lies at an arc's end by rounding, that end is a face's normal, and is looked at.
"""

import numpy as np

from simcore.compilation import leaf, routine
from simcore.dem.contact.search.gjk import segment_weights, triangle_weights
from simcore.dem.contact.search.pair_frame import climb_a, climb_b, difference, support, vertex_a, vertex_b

TIE = 1e-11  # of the pair's size: vertices this close below a support plane count as on it


@leaf
def _vertex(shapes, f, of_b, v):
    if of_b:
        return vertex_b(shapes, f, v)
    return vertex_a(shapes, f, v)


@leaf
def _plane_basis(ex, ey, ez):
    """Two unit vectors p, q normal to e, with p × q along e."""
    length = np.sqrt(ex * ex + ey * ey + ez * ez)
    ex, ey, ez = ex / length, ey / length, ez / length
    sign = 1.0 if ez >= 0.0 else -1.0
    c = -1.0 / (sign + ez)
    d = ex * ey * c
    return 1.0 + sign * ex * ex * c, sign * d, -sign * ex, d, sign + ey * ey * c, -ey


@routine
def _arc(shapes, f, of_b, u, v, px, py, pz, qx, qy, qz):
    """Arc of normals of edge u, v: its two ends, from one counterclockwise to the other, in the basis p, q.

    Seen along the edge the body is a corner, and its sides are the extreme ones of the vectors to the neighbours.
    """
    ux, uy, uz = _vertex(shapes, f, of_b, u)
    lp, lq, rp, rq = 0.0, 0.0, 0.0, 0.0
    for end in range(2):
        here, there = (u, v) if end == 0 else (v, u)
        for k in range(shapes.neighbor_start[here], shapes.neighbor_start[here + 1]):
            w = shapes.neighbors[k]
            if w == there:
                continue
            x, y, z = _vertex(shapes, f, of_b, w)
            x, y, z = x - ux, y - uy, z - uz
            cp, cq = x * px + y * py + z * pz, x * qx + y * qy + z * qz
            if lp == 0.0 and lq == 0.0:
                lp, lq, rp, rq = cp, cq, cp, cq
            else:
                if lp * cq - lq * cp > 0.0:
                    lp, lq = cp, cq
                if rp * cq - rq * cp < 0.0:
                    rp, rq = cp, cq
    # Outward: to the left of the left side, to the right of the right one
    left, right = np.sqrt(lp * lp + lq * lq), np.sqrt(rp * rp + rq * rq)
    return -lq / left, lp / left, rq / right, -rp / right


@leaf
def _consider(shapes, f, a, b, nx, ny, nz, depth, bx, by, bz, ba, bb):
    """The less of the depth known, along (bx, by, bz), and that along n."""
    length = np.sqrt(nx * nx + ny * ny + nz * nz)
    if not length > 0.5:  # a degenerate edge: nan
        return depth, bx, by, bz, ba, bb
    nx, ny, nz = nx / length, ny / length, nz / length
    a, b, x, y, z = support(shapes, f, a, b, nx, ny, nz)
    reach = x * nx + y * ny + z * nz
    if reach < depth:
        return reach, nx, ny, nz, a, b
    return depth, bx, by, bz, ba, bb


@routine
def least_depth(shapes, f, first_a, last_a, first_b, last_b, nx, ny, nz):
    """Least support value of M over all its facets' normals: (overlap, normal (3), its supports a and b).

    first, last: range of the bodies' vertices. n: any direction, considered too. Negative: a certain gap.
    """
    best_a, best_b, x, y, z = support(shapes, f, first_a, first_b, nx, ny, nz)
    depth, bx, by, bz = x * nx + y * ny + z * nz, nx, ny, nz
    start, neighbors = shapes.neighbor_start, shapes.neighbors
    b = best_b
    for u in range(first_a, last_a):
        ux, uy, uz = vertex_a(shapes, f, u)
        for k in range(start[u], start[u + 1]):
            v = neighbors[k]
            if v < u:
                continue
            x, y, z = vertex_a(shapes, f, v)
            px, py, pz, qx, qy, qz = _plane_basis(x - ux, y - uy, z - uz)
            lp, lq, rp, rq = _arc(shapes, f, False, u, v, px, py, pz, qx, qy, qz)
            nx, ny, nz = lp * px + lq * qx, lp * py + lq * qy, lp * pz + lq * qz
            b = climb_b(shapes, f, b, -nx, -ny, -nz)
            depth, bx, by, bz, best_a, best_b = _consider(
                shapes, f, u, b, nx, ny, nz, depth, bx, by, bz, best_a, best_b
            )
            nx, ny, nz = rp * px + rq * qx, rp * py + rq * qy, rp * pz + rq * qz
            depth, bx, by, bz, best_a, best_b = _consider(
                shapes, f, u, b, nx, ny, nz, depth, bx, by, bz, best_a, best_b
            )
            # Along the arc: the next of the directions in which b hands over to one of its neighbours
            for _ in range(last_b - first_b):
                x, y, z = vertex_b(shapes, f, b)
                after, ep, eq = -1, rp, rq
                for m in range(start[b], start[b + 1]):
                    w = neighbors[m]
                    wx, wy, wz = vertex_b(shapes, f, w)
                    wx, wy, wz = wx - x, wy - y, wz - z
                    dp, dq = wx * px + wy * py + wz * pz, wx * qx + wy * qy + wz * qz
                    length = np.sqrt(dp * dp + dq * dq)
                    hp, hq = -dq / length, dp / length
                    # Not before the present direction (vertices of one face follow each other in the same one; the
                    # way back to the last vertex lies at 180°), and before the best so far
                    turn = lp * hq - lq * hp
                    ahead = turn > 1e-14 or (turn >= -1e-14 and lp * hp + lq * hq > 0.0)
                    if ahead and hp * eq - hq * ep > 0.0:
                        after, ep, eq = w, hp, hq
                if after < 0:
                    break
                nx, ny, nz = ep * px + eq * qx, ep * py + eq * qy, ep * pz + eq * qz
                depth, bx, by, bz, best_a, best_b = _consider(
                    shapes, f, u, after, nx, ny, nz, depth, bx, by, bz, best_a, best_b
                )
                b, lp, lq = after, ep, eq
    a = best_a
    for u in range(first_b, last_b):
        ux, uy, uz = vertex_b(shapes, f, u)
        for k in range(start[u], start[u + 1]):
            v = neighbors[k]
            if v < u:
                continue
            x, y, z = vertex_b(shapes, f, v)
            px, py, pz, qx, qy, qz = _plane_basis(x - ux, y - uy, z - uz)
            lp, lq, rp, rq = _arc(shapes, f, True, u, v, px, py, pz, qx, qy, qz)
            for _ in range(2):
                nx, ny, nz = -lp * px - lq * qx, -lp * py - lq * qy, -lp * pz - lq * qz
                a = climb_a(shapes, f, a, nx, ny, nz)
                depth, bx, by, bz, best_a, best_b = _consider(
                    shapes, f, a, u, nx, ny, nz, depth, bx, by, bz, best_a, best_b
                )
                lp, lq = rp, rq
    return depth, bx, by, bz, best_a, best_b


@leaf
def _tied_a(shapes, f, a, nx, ny, nz, lowest, tx, ty, tz):
    """Vertex of a farthest along t among those that reach `lowest` along n, from vertex a."""
    x, y, z = vertex_a(shapes, f, a)
    best = x * tx + y * ty + z * tz
    for _ in range(len(shapes.vertices)):
        higher = a
        for k in range(shapes.neighbor_start[a], shapes.neighbor_start[a + 1]):
            w = shapes.neighbors[k]
            x, y, z = vertex_a(shapes, f, w)
            if x * nx + y * ny + z * nz >= lowest and x * tx + y * ty + z * tz > best:
                best, higher = x * tx + y * ty + z * tz, w
        if higher == a:
            break
        a = higher
    return a


@leaf
def _tied_b(shapes, f, b, nx, ny, nz, lowest, tx, ty, tz):
    """As `_tied_a`, for b."""
    x, y, z = vertex_b(shapes, f, b)
    best = x * tx + y * ty + z * tz
    for _ in range(len(shapes.vertices)):
        higher = b
        for k in range(shapes.neighbor_start[b], shapes.neighbor_start[b + 1]):
            w = shapes.neighbors[k]
            x, y, z = vertex_b(shapes, f, w)
            if x * nx + y * ny + z * nz >= lowest and x * tx + y * ty + z * tz > best:
                best, higher = x * tx + y * ty + z * tz, w
        if higher == b:
            break
        b = higher
    return b


@routine
def facet_at(shapes, f, size, a, b, nx, ny, nz, points, vertices, weights):
    """Triangle in M's facet along n that holds the origin's projection, or comes nearest: number of its corners.

    a, b: supports along n. Fills points (4, 3), their parts normal to n, vertices (4, 2) and weights (4). This is GJK
    in the plane, over the vertices that reach the facet within TIE.
    """
    x, y, z = vertex_a(shapes, f, a)
    lowest_a = x * nx + y * ny + z * nz - TIE * size
    x, y, z = vertex_b(shapes, f, b)
    lowest_b = -(x * nx + y * ny + z * nz) - TIE * size
    n = 0
    vx, vy, vz, distance = 0.0, 0.0, 0.0, np.inf
    for _ in range(64):
        if n > 0:
            a = _tied_a(shapes, f, a, nx, ny, nz, lowest_a, -vx, -vy, -vz)
            b = _tied_b(shapes, f, b, -nx, -ny, -nz, lowest_b, vx, vy, vz)
            repeated = False
            for k in range(n):
                if vertices[k, 0] == a and vertices[k, 1] == b:
                    repeated = True
            if repeated:
                break
        x, y, z = difference(shapes, f, a, b)
        depth = x * nx + y * ny + z * nz
        points[n, 0], points[n, 1], points[n, 2] = x - depth * nx, y - depth * ny, z - depth * nz
        vertices[n, 0], vertices[n, 1] = a, b
        n += 1
        if n == 1:
            weights[0] = 1.0
        elif n == 2:
            weights[0], weights[1] = segment_weights(points, 0, 1)
        else:
            weights[0], weights[1], weights[2] = triangle_weights(points, 0, 1, 2)
        vx, vy, vz = 0.0, 0.0, 0.0
        for k in range(n):
            vx += weights[k] * points[k, 0]
            vy += weights[k] * points[k, 1]
            vz += weights[k] * points[k, 2]
        last, distance = distance, np.sqrt(vx * vx + vy * vy + vz * vz)
        if distance <= 1e-14 * size or distance >= last:
            break
        if n == 3:
            kept = 0
            for k in range(n):
                if weights[k] > 0.0:
                    points[kept, 0], points[kept, 1], points[kept, 2] = points[k, 0], points[k, 1], points[k, 2]
                    vertices[kept, 0], vertices[kept, 1] = vertices[k, 0], vertices[k, 1]
                    weights[kept] = weights[k]
                    kept += 1
            n = kept
            if n == 3:  # the origin's projection lies within: what is left is rounding
                break
    return n
