"""Fixtures of the core: hulls, pairs in a grid, and an oracle for the signed distance of polyhedra."""

from types import SimpleNamespace

import numba
import numpy as np
import trimesh
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from simcore.dem.contact.find_contact import (
    check_ellipsoids,
    check_mixed,
    check_polyhedra,
    search_ellipsoids,
    search_mixed,
    search_polyhedra,
)
from simcore.dem.shapes.hulls import POLYHEDRON, Base, collect_shapes, unit_sphere
from simcore.dem.state.bodies import make_bodies, rotation_matrix
from simcore.dem.state.contacts import Box
from simcore.dem.state.features import Features
from simcore.dem.step.candidate_pairs import list_candidates

EVERYTHING = Features(POLYHEDRON, True, patch=True)  # all fields of contacts are there


def make_hull(points, name="hull"):
    """Base shape of the convex hull of points (n, 3), about its centre of mass. Axes stay where they are.

    Moments of a hull whose axes are not principal are wrong, which matters to no contact.
    """
    mesh = trimesh.Trimesh(points, _outward(points), process=False).convex_hull
    mesh.vertices -= mesh.center_mass
    moments = np.full(3, 0.2) * mesh.volume ** (2.0 / 3.0)
    return Base(name, np.array(mesh.vertices), np.array(mesh.faces, np.int64), float(mesh.volume), moments)


def make_pebble(seed, n=24, axes=(1.0, 0.75, 0.5)):
    """Hull of random points on an ellipsoid, about its centre of mass and principal axes, of volume 4/3 π abc."""
    rng = np.random.default_rng(seed)
    directions = rng.standard_normal((n, 3))
    points = directions / np.linalg.norm(directions, axis=1, keepdims=True) * axes
    mesh = trimesh.Trimesh(points, _outward(points), process=False).convex_hull
    mesh.apply_translation(-mesh.center_mass)
    mesh.apply_transform(mesh.principal_inertia_transform)
    mesh.apply_translation(-mesh.center_mass)
    mesh.apply_scale((4.0 / 3.0 * np.pi * np.prod(axes) / mesh.volume) ** (1.0 / 3.0))
    inertia = np.diag(mesh.moment_inertia) / mesh.volume
    moments = 0.5 * inertia.sum() - inertia
    return Base(f"P{seed}", np.array(mesh.vertices), np.array(mesh.faces, np.int64), float(mesh.volume), moments)


def _outward(points):
    hull = ConvexHull(points)
    corners = points[hull.simplices]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.sum(normals * hull.equations[:, :3], axis=1) < 0.0
    return np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)


def random_orientations(n, rng):
    return Rotation.random(n, rng=rng).as_quat(scalar_first=True)


def place_pairs(bases, scale, orientation, offsets, size=1.0, common=0.0):
    """Bodies 2k and 2k + 1 as pair k: (bodies, shapes, contacts), every pair listed and nothing remembered.

    bases: one per body. scale, orientation of the 2 n bodies; offsets (n, 3) from a to b, in units of `size`, like
    the scales. Pairs stand on a grid far from each other, all of it moved by `common` in z.
    """
    offsets = np.asarray(offsets, float) * size
    scale = np.asarray(scale, float) * size
    n = len(offsets)
    shapes = {id(base): base for base in bases}
    index = {key: k for k, key in enumerate(shapes)}
    shape = [index[id(base)] for base in bases]
    still = np.zeros((2 * n, 3))
    bodies = make_bodies(list(shapes.values()), shape, scale, still, orientation, still, still, density=1.0)
    reach = 4.0 * (bodies.radius[0::2] + bodies.radius[1::2] + np.linalg.norm(offsets, axis=1)).max()
    side = int(np.ceil(n ** (1.0 / 3.0)))
    cell = np.stack(np.unravel_index(np.arange(n), (side, side, side)), axis=-1)
    bodies.position[0::2] = reach * cell + [0.0, 0.0, common]
    bodies.position[1::2] = bodies.position[0::2] + offsets
    distance = np.linalg.norm(bodies.position[1::2] - bodies.position[0::2], axis=1)
    skin = 1.001 * distance.max() + 1e-3 * size  # no gap is wider than the distance of the centres
    shapes = collect_shapes(list(shapes.values()))
    contacts = list_candidates(bodies, shapes, Box(0.0), 0.5 * skin, EVERYTHING).contacts
    assert (contacts.body_a == np.arange(0, 2 * n, 2)).all() and (contacts.body_b == contacts.body_a + 1).all()
    return bodies, shapes, contacts


# Not cached: pytest imports this file under a name that another process need not know.
@numba.njit(error_model="numpy")
def look_at_polyhedra(shapes, bodies, contacts, width):
    """Check every contact, search what is pending; returns how many were searched."""
    searched = 0
    for p in range(len(contacts.body_a)):
        check_polyhedra(shapes, bodies, contacts, p, width, True)
        if contacts.pending[p] != 0:
            search_polyhedra(shapes, bodies, contacts, p, width, True)
            searched += 1
    return searched


@numba.njit(error_model="numpy")
def look_at_ellipsoids(bodies, contacts, width):
    searched = 0
    for p in range(len(contacts.body_a)):
        check_ellipsoids(None, bodies, contacts, p, width, True)
        if contacts.pending[p] != 0:
            search_ellipsoids(None, bodies, contacts, p, width, True)
            searched += 1
    return searched


@numba.njit(error_model="numpy")
def look_at_mixed(shapes, bodies, contacts, width):
    searched = 0
    for p in range(len(contacts.body_a)):
        check_mixed(shapes, bodies, contacts, p, width, True)
        if contacts.pending[p] != 0:
            search_mixed(shapes, bodies, contacts, p, width, True)
            searched += 1
    return searched


def certain_gap(contacts, k):
    """The gap that pair k, of bodies that never turned, was told to have."""
    return contacts.safe_until[k] / 0.999


def world_vertices(bases, bodies, i):
    return (bases[bodies.shape[i]].vertices * bodies.scale[i]) @ rotation_matrix(bodies.orientation[[i]])[0].T


def minkowski_difference(vertices_a, vertices_b, r):
    """Points of A − (B + r), (n, 3)."""
    return (vertices_a[:, None] - vertices_b[None] - r).reshape(-1, 3)


def signed_distance(points):
    """Exact signed distance of two hulls from all points (n, 3) of their Minkowski difference.

    Overlap: the facet planes of the hull. Where Qhull merges nearly coplanar facets its plane is off, so each plane's
    offset is taken as the support value along its normal: an upper bound of the depth whatever the normal. Apart:
    the nearest point of all facets.
    """
    points = np.asarray(points)
    size = np.abs(points).max()
    hull = ConvexHull(points / size)
    normals = hull.equations[:, :3]
    reach = (hull.points @ normals.T).max(axis=0)
    if (hull.equations[:, 3] <= 0.0).all():
        return -reach.min() * size
    triangles = hull.points[hull.simplices]
    nearest = trimesh.triangles.closest_point(triangles, np.zeros((len(triangles), 3)))
    return np.linalg.norm(nearest, axis=1).min() * size


def shared():
    return SimpleNamespace(
        make_hull=make_hull,
        make_pebble=make_pebble,
        orientations=random_orientations,
        place_pairs=place_pairs,
        features=EVERYTHING,
        look_at_polyhedra=look_at_polyhedra,
        look_at_ellipsoids=look_at_ellipsoids,
        look_at_mixed=look_at_mixed,
        minkowski_difference=minkowski_difference,
        signed_distance=signed_distance,
        gap=certain_gap,
        sphere=unit_sphere(),
    )
