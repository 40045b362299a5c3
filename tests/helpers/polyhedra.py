"""Convex polyhedra for tests: corners, faces, and base shapes made from points."""

import numpy as np
import trimesh
from scipy.spatial import ConvexHull

from simcore.dem.shapes.polyhedra import Base

CUBE = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])  # edge 1
TETRAHEDRON = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1.0]]) / np.sqrt(8.0)  # edge 1


def hull_faces(vertices):
    """Return the outward triangles (m, 3) of the convex hull of points (n, 3)."""
    hull = ConvexHull(vertices)
    corners = vertices[hull.simplices]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.sum(normals * hull.equations[:, :3], axis=1) < 0.0
    return np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)


def make_polyhedron(points, name="hull"):
    """Return the base shape of the convex hull of points (n, 3), moved to its centre of mass.

    The axes keep their directions. The moments of inertia are wrong unless the axes are principal axes, which does not
    matter to contacts.
    """
    mesh = trimesh.Trimesh(points, hull_faces(points), process=False).convex_hull
    mesh.vertices -= mesh.center_mass
    moments = np.full(3, 0.2) * mesh.volume ** (2.0 / 3.0)
    return Base(name, np.array(mesh.vertices), np.array(mesh.faces, np.int64), float(mesh.volume), moments)


def make_symmetric_polyhedron(points, name="hull"):
    """Return the base shape of the convex hull of points (n, 3).

    Its centre of mass and principal axes must be those of the frame.
    """
    mesh = trimesh.Trimesh(points).convex_hull
    if mesh.volume < 0.0:
        mesh.invert()
    return _base_of(mesh, name)


def make_pebble(seed, n=24, axes=(1.0, 0.75, 0.5)):
    """Return the hull of n random points on an ellipsoid with semi-axes a, b, c, of volume 4/3 π abc.

    It is centred on its centre of mass and aligned with its principal axes.
    """
    rng = np.random.default_rng(seed)
    directions = rng.standard_normal((n, 3))
    points = directions / np.linalg.norm(directions, axis=1, keepdims=True) * axes
    mesh = trimesh.Trimesh(points, hull_faces(points), process=False).convex_hull
    mesh.apply_translation(-mesh.center_mass)
    mesh.apply_transform(mesh.principal_inertia_transform)
    mesh.apply_translation(-mesh.center_mass)
    mesh.apply_scale((4.0 / 3.0 * np.pi * np.prod(axes) / mesh.volume) ** (1.0 / 3.0))
    return _base_of(mesh, f"P{seed}")


def make_box(edges=(1.0, 1.0, 1.0)):
    """Return a box, by default the cube of edge 1, which three scales turn into any brick, plate or needle."""
    mesh = trimesh.creation.box(edges)
    moments = np.array(edges) ** 2 / 12.0
    return Base("box", np.array(mesh.vertices), np.array(mesh.faces, np.int64), float(np.prod(edges)), moments)


def _base_of(mesh, name):
    inertia = np.diag(mesh.moment_inertia) / mesh.volume
    moments = 0.5 * inertia.sum() - inertia
    return Base(name, np.array(mesh.vertices), np.array(mesh.faces, np.int64), float(mesh.volume), moments)
