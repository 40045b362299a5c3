r"""Exact contacts of bodies with the floor and the cylinder.

|   ____   |          Every function updates one row of Walls: whether body and wall touch, overlap [m], normal
|  /    \  |          into the body, and the contact point midway between the surfaces, relative to the centre of
| /  *   \_|__        the body. The contact point belongs to the deepest point x of the body behind the wall. With
| \      / |x         patch contact, polyhedra press at the centroid of the part below the floor, or at the mean of
|  \__x_/  |          the vertices behind the cylinder by depth. Both move continuously when a face comes to rest.
+----------+  z = 0
     r = 0            The axis of the cylinder is x = y = 0, the floor is z = 0.
"""

import numpy as np

from simcore.compilation import leaf
from simcore.dem.contact.patch.axes import Axes, axes_in_base, coordinates
from simcore.dem.contact.patch.moments import NO_MOMENTS, add_moments, triangle_moments
from simcore.dem.contact.patch.patch import PATCH_DEPTH
from simcore.dem.contact.patch.workspace import start_walk
from simcore.dem.shapes.polyhedra import support_vertex_along, vertex_of
from simcore.dem.state.touches import forget_springs
from simcore.dem.vectors import ZERO, Vec, minus, plus_scaled, read, write

UP = Vec(0.0, 0.0, 1.0)
DOWNWARD = Axes(Vec(1.0, 0.0, 0.0), Vec(0.0, 1.0, 0.0), Vec(0.0, 0.0, -1.0))
ALIKE = 1e-6  # of the sum of depths: a shorter sum of normals has no reliable direction


@leaf
def _clear(walls, w):
    """Mark body and wall as apart and reset force, torque and springs of a touch."""
    if walls.touching[w] != 0:
        walls.touching[w] = 0
        walls.overlap[w] = 0.0
        write(walls.force, w, ZERO)
        write(walls.torque, w, ZERO)
        forget_springs(walls, w)


@leaf
def _note(walls, w, overlap, normal, deepest):
    """Store a touch. normal: into the body; deepest: deepest point of the body, relative to its centre."""
    walls.touching[w] = 1
    walls.overlap[w] = overlap
    write(walls.normal, w, normal)
    write(walls.point, w, plus_scaled(deepest, 0.5 * overlap, normal))


@leaf
def floor_sphere(bodies, walls, w):
    """Update row w: a sphere at the floor."""
    i = walls.body[w]
    radius = bodies.scale[i, 0]
    overlap = radius - bodies.position[i, 2]
    if overlap > 0.0:
        _note(walls, w, overlap, UP, Vec(0.0, 0.0, -radius))
    else:
        _clear(walls, w)


@leaf
def floor_ellipsoid(bodies, walls, w):
    """Update row w: an ellipsoid at the floor."""
    i, m = walls.body[w], bodies.form_matrix
    height = np.sqrt(m[i, 2])
    overlap = height - bodies.position[i, 2]
    if overlap > 0.0:
        _note(walls, w, overlap, UP, Vec(-m[i, 4] / height, -m[i, 5] / height, -height))
    else:
        _clear(walls, w)


@leaf
def floor_convex(shapes, bodies, walls, w):
    """Update row w: a polyhedron at the floor; return whether it touches.

    The climb starts from the vertex that was lowest in the last step, and the new lowest vertex is stored.
    """
    i = walls.body[w]
    if bodies.position[i, 2] >= bodies.radius[i]:
        _clear(walls, w)
        return False
    vertex = support_vertex_along(shapes, bodies, i, walls.vertex[w], DOWNWARD.n)
    walls.vertex[w] = vertex
    lowest = vertex_of(shapes, bodies, i, vertex)
    overlap = -lowest.z - bodies.position[i, 2]
    if overlap <= 0.0:
        _clear(walls, w)
        return False
    _note(walls, w, overlap, UP, lowest)
    return True


@leaf
def floor_patch(shapes, bodies, walls, w, workspace, thread):
    """Update the patch of a touching polyhedron: moments of the depth of the part of it that is below the floor.

    As between two polyhedra, a deeper one counts as if it were lifted to PATCH_DEPTH. Because it is convex, edges
    connect its vertices below the floor with each other, and a walk along edges visits all. A triangle with several of
    them is added once, at the one with the smallest number. Moments are about the deepest vertex.
    """
    i = walls.body[w]
    base = axes_in_base(bodies, i, DOWNWARD)
    vertices, ring_start, ring = shapes.vertices, shapes.neighbor_start, shapes.neighbors
    first = shapes.vertex_start[bodies.shape[i]]
    deepest = coordinates(base, read(vertices, walls.vertex[w]))
    origin = Vec(deepest.x, deepest.y, deepest.z - min(walls.overlap[w], PATCH_DEPTH * bodies.radius[i]))
    stamp = start_walk(workspace, thread, walls.vertex[w], first)
    mark, stack = workspace.mark, workspace.stack
    n_stack = 1
    m = NO_MOMENTS
    while n_stack > 0:
        n_stack -= 1
        v = stack[thread, n_stack]
        corner, last = minus(coordinates(base, read(vertices, v)), origin), ring[ring_start[v + 1] - 1]
        after = minus(coordinates(base, read(vertices, last)), origin)
        for k in range(ring_start[v], ring_start[v + 1]):
            u = ring[k]
            before, after = after, minus(coordinates(base, read(vertices, u)), origin)
            if not (before.z > 0.0 and last < v) and not (after.z > 0.0 and u < v):
                m = add_moments(m, _below_floor(corner, before, after))
            if after.z > 0.0 and mark[thread, u - first] != stamp:
                mark[thread, u - first] = stamp
                stack[thread, n_stack] = u
                n_stack += 1
            last = u
    # Faces that point down are clockwise as seen from above, so that the moments are negative.
    if not m.d < 0.0:
        for k in range(6):  # by rounding the part has no volume: the contact stays at the deepest vertex, as a point
            walls.spread[w, k] = 0.0
        return
    x, y = m.dx / m.d, m.dy / m.d
    walls.point[w, 0], walls.point[w, 1] = deepest.x + x, deepest.y + y
    walls.spread[w, 0], walls.spread[w, 1], walls.spread[w, 2] = m.dxx / m.d - x * x, m.dyy / m.d - y * y, 0.0
    walls.spread[w, 3], walls.spread[w, 4], walls.spread[w, 5] = m.dxy / m.d - x * y, 0.0, 0.0


@leaf
def _below_floor(a, b, c):
    """Return the moments of the part of a triangle with positive depth z; a.z is positive."""
    if b.z > 0.0 and c.z > 0.0:
        return triangle_moments(a, b, c)
    if b.z > 0.0:
        on_bc, on_ca = _at_floor(b, c), _at_floor(a, c)
        return add_moments(triangle_moments(a, b, on_bc), triangle_moments(a, on_bc, on_ca))
    if c.z > 0.0:
        on_ab, on_bc = _at_floor(a, b), _at_floor(c, b)
        return add_moments(triangle_moments(a, on_ab, on_bc), triangle_moments(a, on_bc, c))
    return triangle_moments(a, _at_floor(a, b), _at_floor(a, c))


@leaf
def _at_floor(below, above):
    """Return the point between two points, of positive and of no positive depth z, where the depth is zero."""
    share = below.z / (below.z - above.z)
    return Vec(below.x + share * (above.x - below.x), below.y + share * (above.y - below.y), 0.0)


@leaf
def _note_outward(bodies, walls, w, overlap, deepest):
    """Store a touch with the cylinder at the deepest point of the body."""
    i = walls.body[w]
    px, py = bodies.position[i, 0] + deepest.x, bodies.position[i, 1] + deepest.y
    distance = np.sqrt(px * px + py * py)
    _note(walls, w, overlap, Vec(-px / distance, -py / distance, 0.0), deepest)


@leaf
def cylinder_sphere(bodies, walls, w, wall_radius):
    """Update row w: a sphere at the cylinder."""
    i = walls.body[w]
    px, py = bodies.position[i, 0], bodies.position[i, 1]
    distance = np.sqrt(px * px + py * py)
    radius = bodies.scale[i, 0]
    overlap = distance + radius - wall_radius
    if overlap <= 0.0:
        _clear(walls, w)
    elif distance == 0.0:
        _note_outward(bodies, walls, w, overlap, Vec(radius, 0.0, 0.0))
    else:
        _note_outward(bodies, walls, w, overlap, Vec(radius * px / distance, radius * py / distance, 0.0))


@leaf
def cylinder_convex(shapes, bodies, walls, w, wall_radius):
    """Update row w: a polyhedron at the cylinder.

    The distance from the axis is a convex function, so that the farthest point is a vertex. All vertices are tested,
    because a climb along edges could end at the wrong one: a long grain across the cylinder has two far ends.
    """
    i = walls.body[w]
    px, py = bodies.position[i, 0], bodies.position[i, 1]
    if _is_inside(bodies, i, wall_radius):
        _clear(walls, w)
        return
    first = shapes.vertex_start[bodies.shape[i]]
    farthest2, farthest = -1.0, ZERO
    for vertex in range(first, shapes.vertex_start[bodies.shape[i] + 1]):
        corner = vertex_of(shapes, bodies, i, vertex)
        distance2 = (px + corner.x) * (px + corner.x) + (py + corner.y) * (py + corner.y)
        if distance2 > farthest2:
            farthest2, farthest = distance2, corner
    overlap = np.sqrt(farthest2) - wall_radius
    if overlap > 0.0:
        _note_outward(bodies, walls, w, overlap, farthest)
    else:
        _clear(walls, w)


@leaf
def cylinder_patch(shapes, bodies, walls, w, wall_radius):
    """Update the patch of a touching polyhedron: depth-weighted means over its vertices behind the cylinder.

    The normal is such a mean too, because a long grain across the cylinder touches it at both ends.
    """
    i = walls.body[w]
    px, py = bodies.position[i, 0], bodies.position[i, 1]
    first = shapes.vertex_start[bodies.shape[i]]
    m0, mx, my, mz, nx, ny = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    mxx, myy, mzz, mxy, mxz, myz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for vertex in range(first, shapes.vertex_start[bodies.shape[i] + 1]):
        x, y, z = vertex_of(shapes, bodies, i, vertex)
        distance2 = (px + x) * (px + x) + (py + y) * (py + y)
        if distance2 > wall_radius * wall_radius:
            distance = np.sqrt(distance2)
            d = distance - wall_radius
            ux, uy = (px + x) / distance, (py + y) / distance
            # Midway between the surfaces
            x, y = x - 0.5 * d * ux, y - 0.5 * d * uy
            nx, ny = nx - d * ux, ny - d * uy
            m0, mx, my, mz = m0 + d, mx + d * x, my + d * y, mz + d * z
            mxx, myy, mzz = mxx + d * x * x, myy + d * y * y, mzz + d * z * z
            mxy, mxz, myz = mxy + d * x * y, mxz + d * x * z, myz + d * y * z
    cx, cy, cz = mx / m0, my / m0, mz / m0
    length = np.sqrt(nx * nx + ny * ny)
    if not length > ALIKE * m0:
        for k in range(6):  # both ends are equally deep: the contact stays at the deepest vertex, as a point
            walls.spread[w, k] = 0.0
        return
    write(walls.normal, w, Vec(nx / length, ny / length, 0.0))
    write(walls.point, w, Vec(cx, cy, cz))
    walls.spread[w, 0], walls.spread[w, 1], walls.spread[w, 2] = (
        mxx / m0 - cx * cx, myy / m0 - cy * cy, mzz / m0 - cz * cz
    )  # fmt: skip
    walls.spread[w, 3], walls.spread[w, 4], walls.spread[w, 5] = (
        mxy / m0 - cx * cy, mxz / m0 - cx * cz, myz / m0 - cy * cz
    )  # fmt: skip


@leaf
def _is_inside(bodies, i, wall_radius):
    """Return whether the bounding sphere of body i is inside the cylinder."""
    px, py = bodies.position[i, 0], bodies.position[i, 1]
    return np.sqrt(px * px + py * py) + bodies.radius[i] <= wall_radius


@leaf
def _farthest_multiplier(p1, p2, c1, c2):
    """Return λ of cylinder_ellipsoid: the largest root of Σ c_k² p_k / (λ − p_k)² = 1, for p1 >= p2."""
    # Lower bound of λ: each term alone. Upper bound: p1 in both denominators.
    low = max(p1 + abs(c1) * np.sqrt(p1), p2 + abs(c2) * np.sqrt(p2))
    high = p1 + np.sqrt(c1 * c1 * p1 + c2 * c2 * p2)
    root = high
    for _ in range(100):
        d1, d2 = root - p1, root - p2
        if d1 <= 0.0:
            break
        value = c1 * c1 * p1 / (d1 * d1) + c2 * c2 * p2 / (d2 * d2) - 1.0
        if value > 0.0:
            low = max(low, root)
        else:
            high = min(high, root)
        slope = -2.0 * (c1 * c1 * p1 / (d1 * d1 * d1) + c2 * c2 * p2 / (d2 * d2 * d2))
        # Newton's iteration for 1/√(value + 1), which is nearly linear in λ
        step = 2.0 * (value + 1.0) / slope * (1.0 - np.sqrt(value + 1.0))
        trial = root + step if slope < 0.0 else low
        if not (trial >= low and trial <= high):
            trial = 0.5 * (low + high)
        if abs(trial - root) <= 1e-15 * root or high - low <= 1e-15 * high:
            root = trial
            break
        root = trial
    return root


@leaf
def cylinder_ellipsoid(bodies, walls, w, wall_radius):
    """Update row w: an ellipsoid at the cylinder.

    The projection of the ellipsoid to the floor is an ellipse with matrix P about (px, py). With eigenvalues p1 >= p2
    of P and the centre c in their frame, its point farthest from the axis is c + y with y_k = c_k p_k / (λ − p_k),
    where λ >= p1 is the largest root of Σ c_k² p_k / (λ − p_k)² = 1.
    """
    i, m = walls.body[w], bodies.form_matrix
    px, py = bodies.position[i, 0], bodies.position[i, 1]
    if _is_inside(bodies, i, wall_radius):
        _clear(walls, w)
        return
    mean, half = 0.5 * (m[i, 0] + m[i, 1]), 0.5 * (m[i, 0] - m[i, 1])
    spread = np.sqrt(half * half + m[i, 3] * m[i, 3])
    p1, p2 = mean + spread, mean - spread
    angle = 0.5 * np.arctan2(m[i, 3], half)
    cos, sin = np.cos(angle), np.sin(angle)
    c1, c2 = cos * px + sin * py, -sin * px + cos * py
    root = _farthest_multiplier(p1, p2, c1, c2)
    y2 = c2 * p2 / (root - p2) if root > p2 else 0.0
    y2 = min(max(y2, -np.sqrt(p2)), np.sqrt(p2))
    if root - p1 > 1e-3 * p1:
        y1 = c1 * p1 / (root - p1)
    else:
        # If c1 is almost or exactly zero, root − p1 is lost in rounding; y1 follows from the equation of the ellipse.
        # For c1 = 0 both ends of the axis are equally far.
        y1 = np.sqrt(max(p1 * (1.0 - y2 * y2 / p2), 0.0))
        if c1 < 0.0:
            y1 = -y1
    farthest = np.sqrt((c1 + y1) ** 2 + (c2 + y2) ** 2)
    if not farthest > wall_radius:
        _clear(walls, w)
        return
    # The point of the ellipsoid above that of its projection is the support point along the outward direction.
    ux, uy = (cos * (c1 + y1) - sin * (c2 + y2)) / farthest, (sin * (c1 + y1) + cos * (c2 + y2)) / farthest
    x, y, z = m[i, 0] * ux + m[i, 3] * uy, m[i, 3] * ux + m[i, 1] * uy, m[i, 4] * ux + m[i, 5] * uy
    height = np.sqrt(x * ux + y * uy)
    _note_outward(bodies, walls, w, farthest - wall_radius, Vec(x / height, y / height, z / height))
