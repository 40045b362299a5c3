"""Floor and cylinder: the deepest point of a body, found exactly.

Every function leaves overlap [m] and deepest point, relative to the centre, in bodies.wall_overlap and
bodies.wall_point. The body is clear of the wall where the overlap is not positive; then the point means nothing.
The axis of the cylinder is x = y = 0, the floor is z = 0.
"""

import numpy as np

from simcore.compilation import leaf
from simcore.dem.shapes import support_vertex, vertex_offset

FLOOR, CYLINDER = 0, 1  # walls, as they stand in bodies.wall_*


@leaf
def _note(bodies, i, wall, overlap, x, y, z):
    bodies.wall_overlap[i, wall] = overlap
    bodies.wall_point[i, wall, 0], bodies.wall_point[i, wall, 1], bodies.wall_point[i, wall, 2] = x, y, z


@leaf
def floor_sphere(bodies, i):
    radius = bodies.scale[i, 0]
    _note(bodies, i, FLOOR, radius - bodies.position[i, 2], 0.0, 0.0, -radius)


@leaf
def floor_ellipsoid(bodies, i):
    m = bodies.form_matrix
    height = np.sqrt(m[i, 2])
    _note(bodies, i, FLOOR, height - bodies.position[i, 2], -m[i, 4] / height, -m[i, 5] / height, -height)


@leaf
def floor_convex(shapes, bodies, i):
    """Climbs from the vertex that was lowest last, and remembers the new one."""
    if bodies.position[i, 2] >= bodies.radius[i]:
        bodies.wall_overlap[i, FLOOR] = 0.0
        return
    vertex = support_vertex(shapes, bodies, i, bodies.wall_vertex[i], 0.0, 0.0, -1.0)
    bodies.wall_vertex[i] = vertex
    x, y, z = vertex_offset(shapes, bodies, i, vertex)
    _note(bodies, i, FLOOR, -z - bodies.position[i, 2], x, y, z)


@leaf
def cylinder_sphere(bodies, i, wall_radius):
    px, py = bodies.position[i, 0], bodies.position[i, 1]
    distance = np.sqrt(px * px + py * py)
    radius = bodies.scale[i, 0]
    if distance == 0.0:
        _note(bodies, i, CYLINDER, radius - wall_radius, radius, 0.0, 0.0)
    else:
        overlap = distance + radius - wall_radius
        _note(bodies, i, CYLINDER, overlap, radius * px / distance, radius * py / distance, 0.0)


@leaf
def cylinder_convex(shapes, bodies, i, wall_radius):
    """Distance from the axis is convex, so a vertex is the farthest point; all are looked at.

    Climbing is no way here: a long grain across the cylinder has two far ends.
    """
    px, py = bodies.position[i, 0], bodies.position[i, 1]
    if _is_clear(bodies, i, wall_radius):
        return
    first = shapes.vertex_start[bodies.shape[i]]
    farthest2, fx, fy, fz = -1.0, 0.0, 0.0, 0.0
    for vertex in range(first, shapes.vertex_start[bodies.shape[i] + 1]):
        x, y, z = vertex_offset(shapes, bodies, i, vertex)
        distance2 = (px + x) * (px + x) + (py + y) * (py + y)
        if distance2 > farthest2:
            farthest2, fx, fy, fz = distance2, x, y, z
    _note(bodies, i, CYLINDER, np.sqrt(farthest2) - wall_radius, fx, fy, fz)


@leaf
def _is_clear(bodies, i, wall_radius):
    """Whether the bounding sphere is inside the cylinder; then noted so."""
    px, py = bodies.position[i, 0], bodies.position[i, 1]
    clear = np.sqrt(px * px + py * py) + bodies.radius[i] <= wall_radius
    if clear:
        bodies.wall_overlap[i, CYLINDER] = 0.0
    return clear


@leaf
def cylinder_ellipsoid(bodies, i, wall_radius):
    """Farthest point from the axis of the ellipsoid's shadow, an ellipse with matrix P about (px, py).

    With eigenvalues p1 >= p2 of P and the centre c in their frame, the farthest point c + y has
    y_k = c_k p_k / (λ − p_k), and λ >= p1 is the largest root of Σ c_k² p_k / (λ − p_k)² = 1.
    """
    m = bodies.form_matrix
    px, py = bodies.position[i, 0], bodies.position[i, 1]
    if _is_clear(bodies, i, wall_radius):
        return
    mean, half = 0.5 * (m[i, 0] + m[i, 1]), 0.5 * (m[i, 0] - m[i, 1])
    spread = np.sqrt(half * half + m[i, 3] * m[i, 3])
    p1, p2 = mean + spread, mean - spread
    angle = 0.5 * np.arctan2(m[i, 3], half)
    cos, sin = np.cos(angle), np.sin(angle)
    c1, c2 = cos * px + sin * py, -sin * px + cos * py
    # Both brackets of λ: one term alone, and all of |c|² under the larger or the smaller eigenvalue
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
        # Newton on 1/√(value + 1), nearly linear in λ
        step = 2.0 * (value + 1.0) / slope * (1.0 - np.sqrt(value + 1.0))
        trial = root + step if slope < 0.0 else low
        if not (trial >= low and trial <= high):
            trial = 0.5 * (low + high)
        if abs(trial - root) <= 1e-15 * root or high - low <= 1e-15 * high:
            root = trial
            break
        root = trial
    y2 = c2 * p2 / (root - p2) if root > p2 else 0.0
    y2 = min(max(y2, -np.sqrt(p2)), np.sqrt(p2))
    if root - p1 > 1e-3 * p1:
        y1 = c1 * p1 / (root - p1)
    else:
        # Little or nothing along the longer axis (the hard case): root − p1 is lost in rounding, but the point lies
        # on the ellipse. With nothing at all both ends of the axis are alike.
        y1 = np.sqrt(max(p1 * (1.0 - y2 * y2 / p2), 0.0))
        if c1 < 0.0:
            y1 = -y1
    farthest = np.sqrt((c1 + y1) ** 2 + (c2 + y2) ** 2)
    if farthest == 0.0:
        bodies.wall_overlap[i, CYLINDER] = 0.0  # a point on the axis
        return
    # The body's point above the shadow's: support along the outward direction there
    ux, uy = (cos * (c1 + y1) - sin * (c2 + y2)) / farthest, (sin * (c1 + y1) + cos * (c2 + y2)) / farthest
    x, y, z = m[i, 0] * ux + m[i, 3] * uy, m[i, 3] * ux + m[i, 1] * uy, m[i, 4] * ux + m[i, 5] * uy
    height = np.sqrt(x * ux + y * uy)
    _note(bodies, i, CYLINDER, farthest - wall_radius, x / height, y / height, z / height)
