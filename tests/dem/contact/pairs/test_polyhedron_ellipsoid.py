"""Contacts of a polyhedron and an ellipsoid in a step, new and remembered, compared with the stand-alone query."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from simcore.dem.contact.query import query_many
from simcore.dem.shapes.polyhedra import convex, ellipsoid
from tests.helpers.contact_pairs import UNIT_SPHERE, place_pairs, update_mixed
from tests.helpers.polyhedra import CUBE, make_pebble, make_polyhedron
from tests.helpers.rotations import random_orientations

AXES = [(1.0, 1.0, 1.0), (1.0, 0.75, 0.5), (1.6, 0.3, 0.3), (1.2, 1.2, 0.2), (1.0, 0.9, 0.9)]
# The search for a deep overlap ends when its bounds are within `deep_overlap.CERTAIN` = 2e-9 of the size.
DEEP = 3e-9


def bases_of():
    return [
        make_pebble(1, 16),
        make_pebble(2, 40),
        make_pebble(3, 24, (1.6, 0.3, 0.3)),
        make_polyhedron(1.6 * CUBE),
    ]


class Pairs:
    """Pairs of a hull and an ellipsoid, every other one with the ellipsoid as its first body."""

    def __init__(self, n, farthest, seed, size=1.0):
        rng = np.random.default_rng(seed)
        hulls = bases_of()
        kind = rng.integers(0, len(hulls), n), rng.integers(0, len(AXES), n)
        self.rng, self.n = rng, n
        self.first = np.arange(n) % 2 == 0  # the hull is body a
        ones = np.ones((n, 3))
        axes = np.array(AXES)[kind[1]]
        self.scale = np.where(self.first[:, None], [ones, axes], [axes, ones]).transpose(1, 0, 2).reshape(-1, 3)
        sphere = [UNIT_SPHERE] * n
        hull = [hulls[k] for k in kind[0]]
        self.bases = [
            base for k in range(n) for base in ((hull[k], sphere[k]) if self.first[k] else (sphere[k], hull[k]))
        ]
        self.turns = random_orientations(2 * n, rng)
        unit = rng.standard_normal((n, 3))
        self.unit = unit / np.linalg.norm(unit, axis=1, keepdims=True)
        self.size = size
        offsets = self.unit * rng.uniform(0.0, farthest, (n, 1))
        self.bodies, self.shapes, self.contacts = place_pairs(self.bases, self.scale, self.turns, offsets, size)
        self.query_shapes = [convex(size * base.vertices) for base in hulls] + [
            ellipsoid(*(size * np.array(a))) for a in AXES
        ]
        other = len(hulls) + kind[1]
        self.index = np.where(self.first, kind[0], other), np.where(self.first, other, kind[0])
        self.extent = self.bodies.radius[0::2] + self.bodies.radius[1::2]

    def query(self):
        b = self.bodies
        poses = [(b.position[k::2], b.orientation[k::2]) for k in (0, 1)]
        return query_many(self.query_shapes, self.index[0], poses[0], self.index[1], poses[1])

    def compare(self, found):
        """Compare the contacts with the result of a query; return the rows in which both overlap."""
        contacts, extent = self.contacts, self.extent
        touching = contacts.touching > 0
        deep = found.signed_distance < 0.0
        differ = touching != deep
        assert (np.abs(found.signed_distance[differ]) <= 1e-12 * extent[differ]).all()
        rows = touching & deep
        excess = (contacts.overlap + found.signed_distance) / extent
        assert np.abs(excess[rows]).max(initial=0.0) <= DEEP
        # Where both find the same overlap, normal and point agree too: the overlap grows with the square of the error
        # of the normal.
        same = rows & (np.abs(excess) < 1e-13)
        assert same.sum() >= 0.9 * rows.sum()
        np.testing.assert_allclose(contacts.direction[same], found.normal[same], atol=1e-6)
        middle = 0.5 * (found.point_a + found.point_b) - self.bodies.position[0::2]
        assert (np.abs(contacts.point[same] - middle[same]).max(axis=1) <= 1e-6 * extent[same]).all()
        for k in np.flatnonzero(~touching & ~deep):
            # The remembered gap is a lower bound.
            reach = self.bodies.position[2 * k + 1] - self.bodies.position[2 * k] - contacts.apart_at[k]
            left = contacts.safe_until[k] - self.bodies.turned[2 * k : 2 * k + 2].sum() - np.linalg.norm(reach)
            assert left <= found.signed_distance[k] + 1e-12 * extent[k]
        return rows


@pytest.mark.parametrize("size", [1.0, 1e-3])
def test_a_pair_without_memory_is_what_the_query_says(size):
    pairs = Pairs(600, 2.0, 1, size)
    searched = update_mixed(pairs.shapes, pairs.bodies, pairs.contacts, 0.0)
    assert searched == pairs.n
    rows = pairs.compare(pairs.query())
    assert 0.4 * pairs.n < rows.sum() < 0.95 * pairs.n
    # Both orders of polyhedron and ellipsoid occur.
    assert rows[pairs.first].sum() > 0.2 * rows.sum() < rows[~pairs.first].sum()


def test_no_direction_shows_less_overlap():
    """The overlap is the least over 4000 directions and all face normals, which are tried without any search."""
    pairs = Pairs(150, 1.4, 2)
    update_mixed(pairs.shapes, pairs.bodies, pairs.contacts, 0.0)
    rng = np.random.default_rng(3)
    sphere = rng.standard_normal((4000, 3))
    sphere /= np.linalg.norm(sphere, axis=1, keepdims=True)
    b, compared = pairs.bodies, 0
    for k in np.flatnonzero(pairs.contacts.touching):
        hull, ball = (2 * k, 2 * k + 1) if pairs.first[k] else (2 * k + 1, 2 * k)
        base = pairs.bases[hull]
        corners = base.vertices[base.faces]
        faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        faces = faces / np.linalg.norm(faces, axis=1, keepdims=True) @ b.rotation[hull].T
        n = np.concatenate([sphere, faces])
        h_hull = (n @ (base.vertices @ b.rotation[hull].T).T).max(axis=1)
        h_ball = np.linalg.norm(n @ (b.rotation[ball] * b.scale[ball]), axis=1)
        f = n @ (b.position[ball] - b.position[hull]) - h_hull - h_ball
        assert f.max() <= -pairs.contacts.overlap[k] + DEEP * pairs.extent[k]
        compared += 1
    assert compared > 75


def test_a_pair_is_the_same_from_its_other_body():
    pairs, other = Pairs(200, 1.6, 4), Pairs(200, 1.6, 4)
    for field in ("shape", "scale", "radius", "rotation", "form_matrix", "orientation"):
        values = getattr(other.bodies, field)
        values[:] = values.reshape(-1, 2, *values.shape[1:])[:, ::-1].reshape(values.shape)
    offset = pairs.bodies.position[1::2] - pairs.bodies.position[0::2]
    other.bodies.position[0::2], other.bodies.position[1::2] = 0.0, -offset
    pairs.bodies.position[0::2], pairs.bodies.position[1::2] = 0.0, offset
    for observed in (pairs, other):
        update_mixed(observed.shapes, observed.bodies, observed.contacts, 0.0)
    one, two = pairs.contacts, other.contacts
    # Both searches start from the polyhedron, so only the sum that gives the point is rounded differently.
    np.testing.assert_array_equal(one.touching, two.touching)
    np.testing.assert_array_equal(one.overlap, two.overlap)
    np.testing.assert_array_equal(one.direction, -two.direction)
    rows = one.touching > 0
    np.testing.assert_allclose((two.point + offset)[rows], one.point[rows], atol=1e-14)
    assert rows.sum() > 60


def test_what_is_remembered_answers_as_the_query_does():
    """Pairs approach, turn, slide and separate again: no contact is missed, and few searches are needed."""
    pairs = Pairs(120, 2.0, 5)
    b = pairs.bodies
    size = pairs.extent[:, None]
    for _ in range(3):  # move all pairs to a narrow gap
        found = pairs.query()
        b.position[1::2] += (0.02 * pairs.extent - found.signed_distance)[:, None] * found.normal
    unit = found.normal
    searched, touched = 0, 0
    for step in range(400):
        depth = np.where(pairs.contacts.touching > 0, pairs.contacts.overlap, 0.0)[:, None] / size
        way = np.where(depth > 1e-3, 0.0, -3e-4) * unit if step < 300 else 1e-3 * unit
        b.position[1::2] += way * size + 2e-4 * size * pairs.rng.standard_normal((pairs.n, 3))
        spin = Rotation.from_rotvec(5e-4 * pairs.rng.standard_normal((2 * pairs.n, 3)))
        turned = (spin * Rotation.from_quat(b.orientation, scalar_first=True)).as_quat(scalar_first=True)
        b.orientation[:] = turned
        b.rotation[:] = Rotation.from_quat(turned, scalar_first=True).as_matrix()
        b.turned[:] += 2.0 * b.radius * np.sin(0.5 * spin.magnitude())
        full = np.einsum("nij,nj,nkj->nik", b.rotation, b.scale**2, b.rotation)
        b.form_matrix[:] = full[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
        searched += update_mixed(pairs.shapes, b, pairs.contacts, 0.0)
        touched += pairs.compare(pairs.query()).sum()
    assert touched > 100 * pairs.n
    # Each pair is searched once at first and rarely later, because most overlaps are below the smallest rolling radius,
    # 0.017 of the size.
    assert searched < pairs.n + 0.01 * touched
