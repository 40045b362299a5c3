"""Ellipsoid contacts by potentials, compared with slow minimisation, known pairs and the roots of det(λA + B)."""

import dataclasses

import numba
import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from simcore.dem.contact.find_contact import check_potentials, search_potentials
from simcore.dem.contact.pair import Pair
from simcore.dem.contact.pairs import ellipsoid_potentials as potential
from simcore.dem.contact.search.deep_overlap import start_normal
from simcore.dem.from_scene import compose
from simcore.dem.shapes.polyhedra import ELLIPSOID, MIXED
from simcore.dem.vectors import Vec, read
from simcore.scene.specification import resolve
from tests.helpers.contact_pairs import UNIT_SPHERE, certain_gap, make_update, place_pairs
from tests.helpers.ellipsoid_pairs import KNOWN_PAIRS, random_pairs, search_pairs
from tests.helpers.few_spheres import set_up_few_spheres, specify_few_spheres
from tests.helpers.rotations import IDENTITY, random_orientations

EPS = np.finfo(float).eps
meeting_of, separation, characteristic = potential.meeting_of, potential.separation, potential.characteristic
MANY = potential.MANY

update_by_potentials = make_update(check_potentials, search_potentials)


@numba.njit(error_model="numpy")
def points_between(m, rotation, i, j, r, out):
    """Write rows (reached, overlapping, contact vector, normal, middle) of pairs i, j of form matrices m, r apart."""
    for k in range(len(i)):
        pair = Pair(i[k], j[k], read(r, k), 1.0)
        meeting = meeting_of(m, pair, start_normal(m, pair), MANY)
        out[k, 0], out[k, 1] = meeting.reached, meeting.overlapping
        out[k, 2], out[k, 3], out[k, 4] = meeting.vector
        out[k, 5], out[k, 6], out[k, 7] = meeting.normal
        out[k, 8], out[k, 9], out[k, 10] = meeting.middle


@numba.njit(error_model="numpy")
def separations(m, r, out):
    for k in range(len(r)):
        apart, normal = separation(m, Pair(2 * k, 2 * k + 1, read(r, k), 1.0), Vec(1.0, 0.0, 0.0))
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = apart, normal.x, normal.y, normal.z


@numba.njit(error_model="numpy")
def characteristic_values(m, r, factors, out):
    for k in range(len(factors)):
        out[k] = characteristic(m, Pair(0, 1, Vec(r[0], r[1], r[2]), 1.0), factors[k]).value


def forms(semi, turns):
    """Return rotations (n, 3, 3) and form matrices, packed (n, 6) and full (n, 3, 3), of semi-axes and quaternions."""
    rotation = Rotation.from_quat(turns, scalar_first=True).as_matrix()
    whole = np.einsum("nij,nj,nkj->nik", rotation, semi**2, rotation)
    return rotation, np.ascontiguousarray(whole[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]), whole


def touching_pairs(rng, n, flattest, depth):
    """Return semi-axes and quaternions (2 n, ...), offsets and common normals (n, 3) of pairs that overlap by depth."""
    semi = np.exp(rng.uniform(np.log(flattest), 0.0, (2 * n, 3)))
    turns = Rotation.random(2 * n, rng=rng).as_quat(scalar_first=True)
    _, _, whole = forms(semi, turns)
    normal = rng.standard_normal((n, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    reach = np.einsum("nij,nj->ni", whole, np.repeat(normal, 2, axis=0))
    reach /= np.sqrt((reach * np.repeat(normal, 2, axis=0)).sum(axis=1, keepdims=True))
    return semi, turns, reach[0::2] + reach[1::2] - depth * normal, normal


def find_points(semi, turns, offsets, swapped=False):
    rotation, m, whole = forms(semi, turns)
    a = np.arange(0, len(semi), 2)
    out = np.empty((len(a), 11))
    if swapped:
        points_between(m, rotation, a + 1, a, -offsets, out)
    else:
        points_between(m, rotation, a, a + 1, offsets, out)
    return out, whole


def least_potential(of, on, centre):
    """Return the minimum of xᵀ of⁻¹ x over the surface of `on` about `centre`, and its point.

    The surface is sampled densely, and a descent starts from each of the three best points.
    """
    root, form = np.linalg.cholesky(on), np.linalg.inv(of)

    def value(u):
        x = centre + root @ (u / np.linalg.norm(u))
        return x @ form @ x

    u = np.random.default_rng(0).standard_normal((4000, 3))
    x = centre + (u / np.linalg.norm(u, axis=1, keepdims=True)) @ root.T
    values = np.einsum("ni,ij,nj->n", x, form, x)
    ends = [minimize(value, u[k] / np.linalg.norm(u[k]), method="BFGS", tol=1e-12).x for k in np.argsort(values)[:3]]
    best = min(ends, key=value)
    return value(best), centre + root @ (best / np.linalg.norm(best))


@pytest.mark.parametrize("flattest", [0.3, 0.05])
def test_no_point_of_the_surface_has_less_potential(flattest):
    rng = np.random.default_rng(1)
    semi, turns, offsets, _ = touching_pairs(rng, 25, flattest, 0.02 * flattest)
    found, whole = find_points(semi, turns, offsets)
    assert found[:, 0].all() and found[:, 1].all()
    for k, r in enumerate(offsets):
        a, b = whole[2 * k], whole[2 * k + 1]
        vector, middle = found[k, 2:5], found[k, 8:11]
        of_a, of_b = middle + 0.5 * vector, middle - 0.5 * vector  # a's point, inside b; b's point, inside a
        condition = np.linalg.cond(a) + np.linalg.cond(b)
        here = np.zeros(3)
        for x, form, centre, other, origin in ((of_a, a, here, b, r), (of_b, b, r, a, here)):
            # The point is on the surface of its own body and deepest in the other one.
            assert (x - centre) @ np.linalg.solve(form, x - centre) == pytest.approx(1.0, abs=20 * EPS * condition)
            least, where = least_potential(other, form, centre - origin)
            potential_there = (x - origin) @ np.linalg.solve(other, x - origin)
            assert potential_there <= least + 20 * EPS * condition and potential_there < 1.0
            # The slow minimum has an error of about √(eps condition) of the size, because the potential is flat there.
            assert np.linalg.norm(x - origin - where) < 20 * np.sqrt(EPS * condition) * np.abs(semi).max()


# CLOSED: pairs symmetric about the line of centres. WITHIN: a centre is in the other body, so the common normal is
# used.
CLOSED = {"spheres", "triaxial", "needles crossed", "sphere on the flat side", "disc on rim"}
WITHIN = {"concentric", "sphere at the tip", "sphere beside"}


@pytest.mark.parametrize("name", KNOWN_PAIRS)
@pytest.mark.parametrize("size", [1.0, 1e-6, 1e3])
def test_known_pairs(name, size):
    """Pairs overlap as stated, and their depth is right where the contact vector is the common normal."""
    semi_a, semi_b, turn, centre, distance = KNOWN_PAIRS[name]
    bodies, _, contacts = place_pairs(
        [UNIT_SPHERE] * 2, [semi_a, semi_b], [IDENTITY, turn], np.atleast_2d(centre), size
    )
    update_by_potentials(None, bodies, contacts, 0.0)
    assert contacts.pending[0] == 0
    extent = bodies.radius.sum() / size
    assert np.linalg.norm(contacts.direction[0]) == pytest.approx(1.0, abs=4 * EPS)
    if name == "golden, tangent":
        assert abs(contacts.overlap[0]) / size < 1e-12 * extent
        np.testing.assert_allclose(contacts.direction[0], (0.135045, 0.353553, 0.925615), atol=1e-6)
    elif distance > 0.0:
        assert contacts.touching[0] == 0
        assert 0.0 < certain_gap(contacts, 0) / size <= distance + 1e-12 * extent
    else:
        assert contacts.touching[0] == 1
        if name in CLOSED | WITHIN:
            assert contacts.overlap[0] / size == pytest.approx(-distance, abs=1e-12 * extent)
        elif name in ("parallel", "disc rims"):
            # Equal and parallel ellipsoids are stretched spheres, so the contact vector is along the line of centres.
            stretched = np.linalg.norm(np.array(centre) / semi_a)
            overlap = np.linalg.norm(centre) * (2.0 / stretched - 1.0)
            assert contacts.overlap[0] / size == pytest.approx(overlap, abs=1e-12 * extent)
            normal = np.array(centre) / np.square(semi_a)
            np.testing.assert_allclose(contacts.direction[0], normal / np.linalg.norm(normal), atol=1e-8)


ROOTS = {
    "spheres apart": (0.25, 4.0),
    "triaxial apart": (1.455174, 6.184826),
    "parallel apart": (0.236787, 4.223213),
    "needles crossed, apart": (0.818799, 1.221301),
    "needles far": (0.651164, 2880.11),
}


@pytest.mark.parametrize("name", ROOTS)
def test_the_known_roots_are_roots(name):
    semi_a, semi_b, turn, centre, _ = KNOWN_PAIRS[name]
    _, m, _ = forms(np.array([semi_a, semi_b], float), np.array([IDENTITY, turn], float))
    low, high = np.array(ROOTS[name])
    # The roots are given with six digits: the polynomial changes sign within 3e-6 of them and is positive between them.
    factors = np.array([low * (1 - 3e-6), low * (1 + 3e-6), np.sqrt(low * high), high * (1 - 3e-6), high * (1 + 3e-6)])
    values = np.empty(5)
    characteristic_values(m, np.array(centre, float), factors, values)
    assert (np.sign(values) == [-1, 1, 1, 1, -1]).all(), values


def positive_roots(whole_a, whole_b, r):
    """Return the real positive roots of det(λA + B) of the 4 × 4 forms, which are eigenvalues of −A⁻¹ B."""
    forms = []
    for whole, centre in ((whole_a, np.zeros(3)), (whole_b, r)):
        inverse = np.linalg.inv(whole)
        corner = -inverse @ centre
        last = np.array([[centre @ inverse @ centre - 1.0]])
        forms.append(np.block([[inverse, corner[:, None]], [corner[None], last]]))
    roots = np.linalg.eigvals(-np.linalg.solve(*forms))
    real = roots.real[np.abs(roots.imag) <= 1e-7 * np.abs(roots)]
    return np.sort(real[real > 0.0])


def test_two_positive_roots_or_none_decide():
    """The decision agrees with all four roots, and the plane of a separated pair separates it."""
    rng = np.random.default_rng(5)
    n = 1000
    semi, turns, offsets = random_pairs(rng, n, 0.2)
    semi, turns = np.stack(semi, axis=1).reshape(-1, 3), np.stack(turns, axis=1).reshape(-1, 4)
    _, m, whole = forms(semi, turns)
    out = np.empty((n, 4))
    separations(m, offsets, out)
    apart = out[:, 0] > 0.0
    assert 0.2 * n < apart.sum() < 0.8 * n
    for k, r in enumerate(offsets):
        roots = positive_roots(whole[2 * k], whole[2 * k + 1], r)
        assert len(roots) == (2 if apart[k] else 0), roots
        if apart[k]:
            q = out[k, 1:]
            assert q @ r > np.sqrt(q @ whole[2 * k] @ q) + np.sqrt(q @ whole[2 * k + 1] @ q)


@pytest.mark.parametrize("flattest", [0.3, 0.01])
def test_both_constructions_agree_on_who_touches(flattest):
    rng = np.random.default_rng(6)
    n = 400
    semi, turns, offsets = random_pairs(rng, n, flattest)
    bodies, by_normal = search_pairs(semi[0], semi[1], turns[0], turns[1], offsets)
    scale, both = np.stack(semi, axis=1).reshape(-1, 3), np.stack(turns, axis=1).reshape(-1, 4)
    _, _, contacts = place_pairs([UNIT_SPHERE] * (2 * n), scale, both, offsets)
    update_by_potentials(None, bodies, contacts, 0.0)
    assert (contacts.touching == by_normal.touching).all() and not contacts.pending.any()
    rows = contacts.touching > 0
    assert 0.05 * n < rows.sum() < 0.95 * n
    assert (contacts.overlap[rows] > 0.0).all()
    np.testing.assert_allclose(np.linalg.norm(contacts.direction, axis=1), 1.0, atol=8 * EPS)
    # The recorded gap is that along the direction that was found, which is at most the true gap.
    gaps = np.array([certain_gap(contacts, k) for k in np.flatnonzero(~rows)])
    a, b = bodies.rotation[0::2] * bodies.scale[0::2, None], bodies.rotation[1::2] * bodies.scale[1::2, None]
    n_k = contacts.direction
    shown = (n_k * offsets).sum(axis=1) - sum(np.linalg.norm(np.einsum("nij,ni->nj", x, n_k), axis=1) for x in (a, b))
    np.testing.assert_allclose(gaps, np.maximum(shown[~rows], 0.0), rtol=1e-9, atol=1e-13)


def test_spheres_are_in_closed_form_as_by_the_common_normal():
    rng = np.random.default_rng(2)
    n = 200
    radii = rng.uniform(0.5, 1.5, (2, n))
    offsets = rng.standard_normal((n, 3))
    offsets /= np.linalg.norm(offsets, axis=1, keepdims=True)
    offsets *= (radii.sum(axis=0) * rng.uniform(0.8, 1.1, n))[:, None]
    turns = random_orientations(2 * n, rng).reshape(2, n, 4)
    scale = np.repeat(radii.T.reshape(-1, 1), 3, axis=1)
    _, by_normal = search_pairs(scale[0::2], scale[1::2], turns[0], turns[1], offsets)
    bodies, _, contacts = place_pairs([UNIT_SPHERE] * (2 * n), scale, np.stack(turns, axis=1).reshape(-1, 4), offsets)
    update_by_potentials(None, bodies, contacts, 0.0)
    distance = np.linalg.norm(offsets, axis=1)
    overlap = radii.sum(axis=0) - distance
    rows = overlap > 0.0
    assert (rows == (contacts.touching > 0)).all() and 0.3 * n < rows.sum() < 0.9 * n
    # The error is about ten roundings of numbers of order 3; offsets are differences of positions up to 100.
    np.testing.assert_allclose(contacts.overlap[rows], overlap[rows], atol=200 * EPS)
    np.testing.assert_allclose(contacts.overlap[rows], by_normal.overlap[rows], atol=200 * EPS)
    np.testing.assert_allclose(contacts.direction[rows], (offsets / distance[:, None])[rows], atol=200 * EPS)
    middle = (radii[0] - 0.5 * overlap)[:, None] * offsets / distance[:, None]
    np.testing.assert_allclose(contacts.point[rows], middle[rows], atol=200 * EPS)


@pytest.mark.parametrize("flattest", [1.0, 0.3, 0.01])
def test_exchanged_grains_give_the_same_bits(flattest):
    rng = np.random.default_rng(3)
    pairs = touching_pairs(rng, 300, flattest, 0.02 * flattest)[:3]
    one, _ = find_points(*pairs)
    other, _ = find_points(*pairs, swapped=True)
    assert one[:, :2].all()
    np.testing.assert_array_equal(one[:, :2], other[:, :2])
    np.testing.assert_array_equal(one[:, 2:8], -other[:, 2:8])
    # The middle is relative to the other centre, which adds one rounding.
    np.testing.assert_allclose(one[:, 8:] - pairs[2], other[:, 8:], atol=8 * EPS)


def test_seen_from_elsewhere_and_in_other_units():
    rng = np.random.default_rng(4)
    flattest = 0.1
    semi, turns, offsets, _ = touching_pairs(rng, 200, flattest, 0.02 * flattest)
    one, _ = find_points(semi, turns, offsets)
    turn = Rotation.random(rng=rng)
    moved = (turn * Rotation.from_quat(turns, scalar_first=True)).as_quat(scalar_first=True)
    for size in (1.0, 1e-6, 1e3):
        there, _ = find_points(size * semi, moved, size * turn.apply(offsets))
        # The condition number of a form is at most 1 / flattest².
        tolerance = 100 * EPS / flattest**2
        assert there[:, :2].all()
        np.testing.assert_allclose(there[:, 2:5] / size, turn.apply(one[:, 2:5]), atol=tolerance)
        np.testing.assert_allclose(there[:, 5:8], turn.apply(one[:, 5:8]), atol=tolerance / flattest)


def test_the_normal_is_common_as_the_depth_goes_to_zero_and_the_contact_vector_is_not():
    """The angle between the normal of a contact and the common normal is of first order in the depth."""
    angles = []
    for depth in (1e-3, 1e-4, 1e-5):
        semi, turns, offsets, normal = touching_pairs(np.random.default_rng(7), 300, 0.4, depth)
        found, _ = find_points(semi, turns, offsets)
        vector = found[:, 2:5] / np.linalg.norm(found[:, 2:5], axis=1, keepdims=True)
        angles.append([np.linalg.norm(np.cross(x, normal), axis=1) for x in (found[:, 5:8], vector)])
        # Along the normal, the contact vector is as long as the depth.
        along = (found[:, 2:5] * normal).sum(axis=1)
        np.testing.assert_allclose(along / depth, 1.0, atol=200.0 * depth)
    gradients, vectors = np.median(angles, axis=2).T
    np.testing.assert_allclose(gradients[:-1] / gradients[1:], 10.0, rtol=0.1)
    assert (vectors > 0.05).all()
    np.testing.assert_allclose(vectors[:-1] / vectors[1:], 1.0, rtol=0.05)


def test_the_last_normal_answers_as_a_search_does():
    """For pairs that approach from a gap, the remembered normal gives the contact that a new search finds."""
    rng = np.random.default_rng(8)
    n = 200
    semi, turns, offsets = random_pairs(rng, n, 0.3)
    unit = offsets / np.linalg.norm(offsets, axis=1, keepdims=True)
    scale, both = np.stack(semi, axis=1).reshape(-1, 3), np.stack(turns, axis=1).reshape(-1, 4)
    bodies, _, contacts = place_pairs([UNIT_SPHERE] * (2 * n), scale, both, 1.7 * unit)
    fresh = contacts._replace(**{name: getattr(contacts, name).copy() for name in contacts._fields})
    searched = compared = 0
    for _ in range(200):
        size = bodies.radius[0::2] + bodies.radius[1::2]
        deep = (contacts.touching > 0) & (contacts.overlap > 5e-3 * size)
        bodies.position[1::2] += np.where(deep[:, None], 0.0, -1e-2 * unit) + 1e-3 * rng.standard_normal((n, 3))
        searched += update_by_potentials(None, bodies, contacts, 0.0)
        fresh.touching[:], fresh.direction[:], fresh.overlap[:], fresh.safe_until[:] = 0, 0.0, 0.0, -np.inf
        assert update_by_potentials(None, bodies, fresh, 0.0) == n
        differ = contacts.touching != fresh.touching
        assert (np.maximum(contacts.overlap, fresh.overlap)[differ] <= 1e-12).all()
        rows = (contacts.touching > 0) & (fresh.touching > 0)
        np.testing.assert_allclose(contacts.overlap[rows], fresh.overlap[rows], atol=1e-12)
        np.testing.assert_allclose(contacts.direction[rows], fresh.direction[rows], atol=1e-11)
        np.testing.assert_allclose(contacts.point[rows], fresh.point[rows], atol=1e-12)
        compared += rows.sum()
    assert compared > 50 * n
    assert searched < 12 * n  # of 200 n updates


def test_what_has_no_least_potential_still_has_a_contact():
    """Concentric, aligned and nested pairs with axes of 1 : 100 get a contact with a unit normal."""
    needle, disc = (1.0, 0.01, 0.01), (1.0, 1.0, 0.01)
    cases = [(a, b, r) for a in (needle, disc) for b in (needle, disc, (0.5, 0.5, 0.5)) for r in (0.0, 1e-9, 1e-3)]
    scale = np.array([axes for a, b, _ in cases for axes in (a, b)])
    offsets = np.array([[r, 0.0, 0.0] for _, _, r in cases])
    for size in (1e-6, 1.0, 1e3):
        bodies, _, contacts = place_pairs(
            [UNIT_SPHERE] * len(scale), scale, np.tile(IDENTITY, (len(scale), 1)), offsets, size
        )
        update_by_potentials(None, bodies, contacts, 0.0)
        assert contacts.touching.all() and not contacts.pending.any()
        assert (contacts.overlap > 0.0).all() and (contacts.overlap <= 2.0 * size).all()
        np.testing.assert_allclose(np.linalg.norm(contacts.direction, axis=1), 1.0, atol=8 * EPS)
        assert np.isfinite(contacts.point).all()
        again = contacts.overlap.copy()
        update_by_potentials(None, bodies, contacts, 0.0)
        np.testing.assert_allclose(contacts.overlap, again, atol=1e-9 * size)


def test_it_is_a_choice_of_scenes_of_ellipsoids():
    choice = {"ellipsoid_contact": "potential"}
    shapes = {"kind": "ellipsoid", "choice": "form", "flatness": 0.5, "elongation": 0.5}
    scene = set_up_few_spheres(shapes=shapes, numerics=choice).scene
    assert compose(scene).features.potential and scene.kind == ELLIPSOID
    assert not compose(set_up_few_spheres(shapes=shapes).scene).features.potential
    assert not compose(set_up_few_spheres(numerics=choice).scene).features.potential  # spheres are in closed form
    with pytest.raises(
        ValueError, match="numerics.ellipsoid_contact: potential works only if all grains are ellipsoids"
    ):
        dataclasses.replace(scene, kind=MIXED)
    with pytest.raises(ValueError, match="numerics.ellipsoid_contact: 'gradient' is not a choice"):
        resolve(specify_few_spheres(numerics={"ellipsoid_contact": "gradient"}))
