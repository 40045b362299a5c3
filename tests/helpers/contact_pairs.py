"""Pairs of bodies far from each other, the contact search on all of them, and the exact distance of polyhedra."""

import numba
import numpy as np
import trimesh
from scipy.spatial import ConvexHull

from simcore.dem.contact.find_contact import (
    check_ellipsoids,
    check_mixed,
    check_polyhedra,
    search_ellipsoids,
    search_mixed,
    search_polyhedra,
)
from simcore.dem.shapes.polyhedra import POLYHEDRON, collect_shapes, unit_sphere
from simcore.dem.state.bodies import make_bodies
from simcore.dem.state.contacts import Box
from simcore.dem.state.features import Features
from simcore.dem.step.candidate_pairs import list_candidates

UNIT_SPHERE = unit_sphere()
ALL_FIELDS = Features(POLYHEDRON, True, patch=True)  # contacts of this kind of scene have all fields


def place_pairs(bases, scale, orientation, offsets, size=1.0, common=0.0):
    """Return bodies, shapes and contacts, with bodies 2k and 2k + 1 as pair k.

    Every pair is listed, and no contact is remembered. bases: one per body. scale, orientation: of the 2 n bodies.
    offsets (n, 3): from a to b, in units of `size`, like the scales. Pairs are placed on a grid far from each other;
    `common` moves all of them in z.
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
    contacts = list_candidates(bodies, shapes, Box(0.0), 0.5 * skin, ALL_FIELDS).contacts
    assert (contacts.body_a == np.arange(0, 2 * n, 2)).all() and (contacts.body_b == contacts.body_a + 1).all()
    return bodies, shapes, contacts


def make_update(check, search):
    """Compile a function that checks every contact and searches those that are pending.

    update(shapes, bodies, contacts, width) returns how many contacts it searched. It is not cached: a function that
    captures compiled functions never is.
    """

    @numba.njit(error_model="numpy")
    def update(shapes, bodies, contacts, width):
        searched = 0
        for p in range(len(contacts.body_a)):
            check(shapes, bodies, contacts, p, width, True)
            if contacts.pending[p] != 0:
                search(shapes, bodies, contacts, p, width, True)
                searched += 1
        return searched

    return update


update_polyhedra = make_update(check_polyhedra, search_polyhedra)
update_ellipsoids = make_update(check_ellipsoids, search_ellipsoids)
update_mixed = make_update(check_mixed, search_mixed)


def certain_gap(contacts, k):
    """Return the lower bound of the gap of pair k that its contact records; only for bodies that have never turned."""
    return contacts.safe_until[k] / 0.999


def signed_distance(points):
    """Return the exact signed distance of two polyhedra from all points (n, 3) of their Minkowski difference.

    The depth of an overlap is the distance of the nearest facet plane. Where Qhull merges nearly coplanar facets its
    plane is inexact, so each plane's offset is the support value along its normal, an upper bound of the depth for any
    normal. A gap is the distance of the nearest point of all facets.
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
