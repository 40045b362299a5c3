"""Ellipsoid contacts, compared with known pairs, many directions and the conditions of a common normal."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from simcore.dem.contact.pairs.ellipsoids import TOLERANCE
from simcore.dem.contact.query import query
from simcore.dem.shapes.polyhedra import ellipsoid
from tests.helpers.contact_pairs import UNIT_SPHERE, certain_gap, place_pairs, update_ellipsoids
from tests.helpers.ellipsoid_pairs import KNOWN_PAIRS, random_pairs, search_pairs
from tests.helpers.rotations import IDENTITY

PLACED = (0.0, 0.0, 0.0), IDENTITY


def support_points(bodies, rows, normals):
    """Return the points (n, 3) of bodies farthest along normals, relative to the centres."""
    r = bodies.rotation[rows]
    matrix = np.einsum("nij,nj,nkj->nik", r, bodies.scale[rows] ** 2, r)
    image = np.einsum("nij,nj->ni", matrix, normals)
    return image / np.sqrt((image * normals).sum(axis=1, keepdims=True))


def residual(bodies, contacts):
    """Return the distance of the line between surface points of touching pairs from the normal, and the depth (n,)."""
    rows = np.flatnonzero(contacts.touching)
    a, b, n = 2 * rows, 2 * rows + 1, contacts.direction[rows]
    # The surface point of b along −n is minus that along n.
    across = bodies.position[b] - bodies.position[a] - support_points(bodies, a, n) - support_points(bodies, b, n)
    along = (across * n).sum(axis=1)
    return np.linalg.norm(across - along[:, None] * n, axis=1), -along


@pytest.mark.parametrize("name", KNOWN_PAIRS)
@pytest.mark.parametrize("size", [1.0, 1e-6, 1e3])
def test_known_pairs(name, size):
    semi_a, semi_b, turn, centre, distance = KNOWN_PAIRS[name]
    bodies, contacts = search_pairs(semi_a, semi_b, IDENTITY, turn, centre, size)
    extent = (bodies.radius.sum()) / size
    if distance >= 0.0 and contacts.touching[0] == 0:
        # For a gap wider than 2 % of the size, the search needs only a lower bound.
        gap = certain_gap(contacts, 0) / size
        assert gap <= distance + 1e-12 * extent
        assert gap >= min(distance - 1e-12 * extent, 0.02 * extent)
    else:
        assert contacts.touching[0] == 1
        # The references have 12 digits.
        assert contacts.overlap[0] / size == pytest.approx(-distance, abs=1e-12 * max(extent, 1.0) + 1e-12)
    if name == "golden, tangent":
        np.testing.assert_allclose(contacts.direction[0], (0.135045, 0.353553, 0.925615), atol=1e-6)


@pytest.mark.parametrize("flattest", [0.3, 0.02])
def test_no_direction_shows_less_overlap_and_the_normal_is_common(flattest):
    """The distance is the maximum of f(n): 3000 directions and as many surface normals of each body stay below."""
    rng = np.random.default_rng(1)
    n = 250
    semi, turns, offsets = random_pairs(rng, n, flattest)
    bodies, contacts = search_pairs(semi[0], semi[1], turns[0], turns[1], offsets)
    size = bodies.radius[0::2] + bodies.radius[1::2]
    rows = np.flatnonzero(contacts.touching)
    assert 0.2 * n < len(rows) < 0.9 * n
    off, depth = residual(bodies, contacts)
    assert (off <= 2.0 * TOLERANCE * size[rows] + 1e-14).all()
    np.testing.assert_allclose(depth, contacts.overlap[rows], atol=1e-14)

    u = rng.standard_normal((3000, 3))
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    missed = 0
    for k in range(n):
        if not contacts.touching[k]:
            # The recorded gap is at most the gap along its own direction, which is at most the true gap.
            n_k, gap = contacts.direction[k], certain_gap(contacts, k)
            along = [np.linalg.norm(n_k @ (bodies.rotation[i] * bodies.scale[i])) for i in (2 * k, 2 * k + 1)]
            assert 0.0 < gap <= n_k @ offsets[k] - sum(along) + 1e-14
            continue
        matrices = [bodies.rotation[i] * bodies.scale[i] for i in (2 * k, 2 * k + 1)]  # columns are semi-axes
        normals = [u] + [(u / bodies.scale[i]) @ bodies.rotation[i].T for i in (2 * k, 2 * k + 1)]
        normals = np.concatenate(normals)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        f = normals @ offsets[k] - sum(np.linalg.norm(normals @ matrix, axis=1) for matrix in matrices)
        missed += f.max() > -contacts.overlap[k] + 1e-12
    assert missed == 0


def test_a_sphere_beside_an_ellipsoid_and_two_spheres_are_special_cases():
    rng = np.random.default_rng(2)
    n = 100
    radii = rng.uniform(0.5, 1.5, (2, n))
    offsets = rng.standard_normal((n, 3))
    turns = Rotation.random(2 * n, rng=rng).as_quat(scalar_first=True).reshape(2, n, 4)
    semi = np.repeat(radii[:, :, None], 3, axis=2)
    bodies, contacts = search_pairs(semi[0], semi[1], turns[0], turns[1], offsets)
    distance = np.linalg.norm(offsets, axis=1)
    overlap = radii.sum(axis=0) - distance
    assert ((overlap > 0.0) == (contacts.touching > 0)).all()
    rows = overlap > 0.0
    np.testing.assert_allclose(contacts.overlap[rows], overlap[rows], atol=1e-14)
    np.testing.assert_allclose(contacts.direction[rows], (offsets / distance[:, None])[rows], atol=1e-10)
    middle = (radii[0] - 0.5 * overlap)[:, None] * offsets / distance[:, None]
    np.testing.assert_allclose(contacts.point[rows], middle[rows], atol=1e-10)


def test_a_pair_seen_from_the_other_body_and_from_elsewhere():
    rng = np.random.default_rng(3)
    n = 200
    semi, turns, offsets = random_pairs(rng, n, 0.3)
    offsets *= 0.5 + 0.5 / np.maximum(np.linalg.norm(offsets, axis=1, keepdims=True), 0.5)  # not too deep
    _, one = search_pairs(semi[0], semi[1], turns[0], turns[1], offsets)
    _, other = search_pairs(semi[1], semi[0], turns[1], turns[0], -offsets)
    turn = Rotation.random(rng=rng)
    moved = [(turn * Rotation.from_quat(q, scalar_first=True)).as_quat(scalar_first=True) for q in turns]
    _, there = search_pairs(semi[0], semi[1], *moved, turn.apply(offsets), common=100.0)
    rows = one.touching > 0
    assert rows.sum() > 0.3 * n
    for observed in (other, there):
        assert (observed.touching == one.touching).all()
        # The depth is stationary in the normal, so its error is rounding; the common offset adds 100 eps.
        np.testing.assert_allclose(observed.overlap[rows], one.overlap[rows], atol=1e-12)
    # The error of the normal is TOLERANCE over the radius of curvature, which is at least 0.09 here.
    np.testing.assert_allclose(other.direction[rows], -one.direction[rows], atol=1e-8)
    np.testing.assert_allclose(other.point[rows] + offsets[rows], one.point[rows], atol=1e-8)
    np.testing.assert_allclose(there.direction[rows], turn.apply(one.direction[rows]), atol=1e-8)


def test_the_last_normal_answers_as_a_search_does():
    """For pairs that approach from a gap, the climb from the last normal finds what a new search finds."""
    rng = np.random.default_rng(4)
    n = 200
    semi, turns, offsets = random_pairs(rng, n, 0.3)
    unit = offsets / np.linalg.norm(offsets, axis=1, keepdims=True)
    offsets = 1.7 * unit
    scale = np.stack([semi[0], semi[1]], axis=1).reshape(-1, 3)
    bases = [UNIT_SPHERE] * (2 * n)
    bodies, _, contacts = place_pairs(bases, scale, np.stack(turns, axis=1).reshape(-1, 4), offsets)
    searched, compared = 0, 0
    for _ in range(200):
        size = bodies.radius[0::2] + bodies.radius[1::2]
        deep = (contacts.touching > 0) & (contacts.overlap > 5e-3 * size)
        step = np.where(deep[:, None], 0.0, -1e-2 * unit) + 1e-3 * rng.standard_normal((n, 3))
        bodies.position[1::2] += step
        searched += update_ellipsoids(None, bodies, contacts, 0.0)
        offsets = bodies.position[1::2] - bodies.position[0::2]
        _, fresh = search_pairs(semi[0], semi[1], turns[0], turns[1], offsets)
        differ = contacts.touching != fresh.touching
        overlap = np.where(contacts.touching > 0, contacts.overlap, fresh.overlap)
        assert (overlap[differ] <= 1e-14).all()
        rows = (contacts.touching > 0) & (fresh.touching > 0)
        np.testing.assert_allclose(contacts.overlap[rows], fresh.overlap[rows], atol=1e-12)
        np.testing.assert_allclose(contacts.direction[rows], fresh.direction[rows], atol=1e-8)
        compared += rows.sum()
    assert compared > 50 * n
    assert searched < 2 * n


@pytest.mark.parametrize("other", [(1.0, 1.0, 0.05), (0.1, 0.1, 0.1)], ids=["its twin", "a sphere"])
def test_a_body_that_is_pressed_through_a_plate_leaves_it_on_the_far_side(other):
    """A remembered normal must not outlive the contact: past the middle the far side shows less overlap."""
    plate = (1.0, 1.0, 0.05)
    bodies, shapes, contacts = place_pairs([UNIT_SPHERE] * 2, [plate, other], [IDENTITY] * 2, [(0.1, 0.0, 3.0)])
    thickness, touched = plate[2] + other[2], 0
    for z in np.linspace(1.01, -3.0, 2001) * thickness:
        bodies.position[1] = bodies.position[0] + [0.1, 0.0, z]
        update_ellipsoids(shapes, bodies, contacts, 0.0)
        exact = query(ellipsoid(*plate), PLACED, ellipsoid(*other), ((0.1, 0.0, z), IDENTITY)).signed_distance
        assert contacts.touching[0] == (exact < 0.0) or abs(exact) < 1e-9
        if contacts.touching[0]:
            assert contacts.overlap[0] == pytest.approx(-exact, abs=1e-8)
            touched += 1
    assert touched > 500 and not contacts.touching[0]
