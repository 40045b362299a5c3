"""Geometry of closed triangle meshes: convex hull, exact moments, flat facets."""

import numpy as np
from scipy.spatial import ConvexHull, QhullError, cKDTree

# Options with which Qhull merges facets that are in one plane to 1e-10 of the extent, and drops their inner points.
MERGING = "Qt C1e-10"
BESIDE = 1e-10  # share of the extent; of points that are nearer to each other, one is kept


def convex_hull(points):
    """Return the vertices (v, 3) and outward triangles (2v - 4, 3) of the convex hull of points (n, 3).

    Points inside the hull are dropped, and points that are within 1e-10 of its extent in a face or on an edge, or
    beside another point. ValueError if there are fewer than four points, if one is not finite, or if all
    are in one plane.
    """
    points = np.asarray(points, float)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) < 4:
        raise ValueError(
            f"a hull needs at least 4 points with 3 coordinates, but the array has the shape {points.shape}"
        )
    if not np.isfinite(points).all():
        raise ValueError("some points have NaN or infinite coordinates; correct or remove them")
    # Qhull's tolerances are absolute, so its points are scaled to size one about the origin.
    origin, size = points.mean(0), np.ptp(points, axis=0).max()
    scaled = (points - origin) / (size or 1.0)
    beside = cKDTree(scaled).query_pairs(BESIDE, output_type="ndarray")
    # Qhull drops equal points itself. They remain, because the order of its triangles depends on them.
    beside = beside[(scaled[beside[:, 0]] != scaled[beside[:, 1]]).any(1)]
    if len(beside):
        alone = np.setdiff1d(np.arange(len(points)), beside[:, 1])
        points, scaled = points[alone], scaled[alone]
    try:
        # Rounding of points in a plane or on an edge leaves slivers, whose normals have any direction. The hull with
        # merged facets has other triangles, which may fold over each other, so only its choice of points is used.
        kept = np.sort(ConvexHull(scaled, qhull_options=MERGING).vertices)
        hull = _hull_with(scaled, len(kept))
        if hull is None:
            points, scaled = points[kept], scaled[kept]
            hull = ConvexHull(scaled)
    except QhullError:
        raise ValueError("all points are in one plane, so their hull has no volume; add points outside it") from None
    corners = points[hull.simplices]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.einsum("ij,ij->i", normals, hull.equations[:, :3]) < 0
    faces = np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)
    used, faces = np.unique(faces, return_inverse=True)
    faces = faces.reshape(-1, 3)
    # The order of the faces must not depend on Qhull, because decimation depends on it.
    faces = np.take_along_axis(faces, (faces.argmin(axis=1)[:, None] + np.arange(3)) % 3, axis=1)
    return points[used], faces[np.lexsort(faces.T[::-1])]


def _hull_with(points, number):
    """Return the ConvexHull of points if it has this number of vertices, and None otherwise."""
    try:
        hull = ConvexHull(points)
    except QhullError:
        return None
    return hull if len(hull.vertices) == number else None


def volume_moments(vertices, faces):
    """Return the exact volume [m³], centre of mass (3,) [m], and mean <x_i x_j> about it (3, 3) [m²] of a closed mesh.

    vertices (n, 3) [m], faces (m, 3) outward. The moments are sums over the tetrahedra between the mean vertex and each
    face.
    """
    origin = vertices.mean(0)  # a point close to the mesh avoids cancellation if the mesh is far from the origin
    corners = (vertices - origin)[faces]
    six_volumes = np.linalg.det(corners)
    volume = six_volumes.sum() / 6
    sums = corners.sum(axis=1)
    centre = six_volumes @ sums / (24 * volume)
    products = np.einsum("t,tki,tkj->ij", six_volumes, corners, corners)
    products += np.einsum("t,ti,tj->ij", six_volumes, sums, sums)
    return volume, origin + centre, products / (120 * volume) - np.outer(centre, centre)


def third_moments(vertices, faces):
    """Return the mean <x_i³> about the origin over the volume of a closed mesh (3,) [m³]; its sign is the tail's."""
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    six_volumes = np.einsum("ij,ij->i", a, np.cross(b, c))
    # The integral of x³ over a tetrahedron with a corner at the origin is the complete homogeneous polynomial of degree
    # three of the other corners, times its volume over 20.
    cubic = a**3 + b**3 + c**3 + a**2 * (b + c) + b**2 * (a + c) + c**2 * (a + b) + a * b * c
    return six_volumes @ cubic / 20 / six_volumes.sum()


def face_areas(vertices, faces):
    """Return area (m,) [m²] and unit outward normal (m, 3) of each triangle; the normal is zero if the area is zero."""
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    doubled = np.linalg.norm(normals, axis=1)
    return doubled / 2, normals / np.where(doubled > 0, doubled, 1.0)[:, None]


def facet_areas(vertices, faces, angle=5.0):
    """Return the areas [m²] of the flat facets of a closed mesh, largest first.

    Each facet grows from a seed, the largest triangle that belongs to no facet yet. It includes all other such
    triangles that are connected to the seed over edges and whose normals are within `angle` [degrees] of the seed's.
    """
    areas, normals = face_areas(vertices, faces)
    edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    order = np.lexsort(edges.T)  # after sorting, the two triangles of an edge are adjacent
    neighbours = [[] for _ in faces]
    for face_a, face_b in (order.reshape(-1, 2) // 3).tolist():
        neighbours[face_a].append(face_b)
        neighbours[face_b].append(face_a)
    free = np.ones(len(faces), bool)
    facets = []
    for seed in np.argsort(-areas, kind="stable"):
        if not free[seed]:
            continue
        alike = free & (normals @ normals[seed] >= np.cos(np.radians(angle)))
        alike[seed] = False
        front, members = [seed], []
        while front:
            face = front.pop()
            members.append(face)
            for other in neighbours[face]:
                if alike[other]:
                    alike[other] = False
                    front.append(other)
        free[members] = False
        facets.append(areas[members].sum())
    return np.sort(facets)[::-1]
