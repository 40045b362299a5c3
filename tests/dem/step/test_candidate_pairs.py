"""The list of candidate pairs: what it remembers, its order, and that no pair is missing."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from simcore.dem.shapes.polyhedra import ELLIPSOID, MIXED, POLYHEDRON, collect_shapes, unit_sphere
from simcore.dem.state.bodies import make_bodies
from simcore.dem.state.contacts import Box, list_incident
from simcore.dem.state.features import Features
from simcore.dem.step import candidate_pairs
from simcore.dem.step.candidate_pairs import list_candidates, list_pairs
from simcore.dem.step.close_spheres import find_pairs
from tests.helpers.contact_pairs import ALL_FIELDS, UNIT_SPHERE, update_ellipsoids, update_mixed, update_polyhedra
from tests.helpers.polyhedra import make_pebble
from tests.helpers.rotations import random_orientations

SHAPES = collect_shapes([unit_sphere()])


def test_memory_is_carried_to_the_new_list_and_dropped_with_the_pair():
    rng = np.random.default_rng(2)
    n = 60
    position = rng.uniform(0.0, 0.3, (n, 3))
    still = np.zeros((n, 3))
    upright = np.tile([1.0, 0, 0, 0], (n, 1))
    bodies = make_bodies([unit_sphere()], np.zeros(n, int), np.full((n, 3), 0.03), position, upright, still, still, 1.0)
    bodies.position[:, 2] += 0.01  # some near the floor, some not
    features = ALL_FIELDS._replace(preloaded=True)
    first = list_candidates(bodies, SHAPES, Box(0.3), 0.005, features)
    old = first.contacts
    first.walls.spring[:] = 1.0 + first.walls.body[:, None]
    first.walls.stuck[:] = 1 + first.walls.body
    old.stuck[:] = rng.integers(0, 2, len(old.body_a))
    m = len(old.body_a)
    old.touching[:] = rng.integers(0, 2, m)
    old.safe_until[:] = -rng.uniform(size=m)  # no gap is certain, so that none is dropped for it
    old.facet[:] = rng.integers(0, 9, (m, 6))
    for field in (old.spring, old.direction, old.apart_at, old.point, old.force, old.torque_a, old.torque_b):
        field[:] = rng.standard_normal((m, 3))
    key = lambda c, p: (c.body_a[p], c.body_b[p], *c.image[p])  # noqa: E731
    remembered = {key(old, p): p for p in range(m)}
    bodies.position[:] += 0.02 * rng.standard_normal((n, 3))
    second = list_candidates(bodies, SHAPES, Box(0.3), 0.01, features, first)
    new = second.contacts
    was_near = np.isin(second.walls.body, first.walls.body)
    assert was_near.any() and not was_near.all()
    assert (second.walls.spring == np.where(was_near, 1.0 + second.walls.body, 0.0)[:, None]).all()
    assert (second.walls.stuck == np.where(was_near, 1 + second.walls.body, 0)).all()
    kept = 0
    for p in range(len(new.body_a)):
        q = remembered.get(key(new, p))
        for name in (
            "touching",
            "spring",
            "stuck",
            "direction",
            "facet",
            "safe_until",
            "apart_at",
            "overlap",
            "point",
            "force",
        ):
            value = getattr(new, name)[p]
            if q is not None:
                assert (value == getattr(old, name)[q]).all(), name
            elif name in ("touching", "spring", "stuck", "direction", "force"):
                assert not np.any(value), f"a new pair has a {name}"
        if q is None:
            assert new.safe_until[p] == -np.inf and (new.facet[p] == -1).all()
        kept += q is not None
    assert 0 < kept < min(m, len(new.body_a))
    assert (bodies.listed_position == bodies.position).all()


def test_contacts_of_bodies_are_those_that_sorting_gives():
    """The order of (partner, image) is found without sorting; bodies meet images of themselves here."""
    rng = np.random.default_rng(6)
    n = 40
    pairs = find_pairs(rng.uniform(0.0, 0.1, (n, 3)), rng.uniform(0.03, 0.08, n), Box(0.1))
    a, b, image = pairs[:, 0].astype(np.int32), pairs[:, 1].astype(np.int32), pairs[:, 2:]
    assert (a == b).any() and ((a[1:] == a[:-1]) & (b[1:] == b[:-1])).any()
    owner, partner, signed = np.concatenate([a, b]), np.concatenate([b, a]), np.concatenate([image, -image])
    order = np.lexsort((signed[:, 1], signed[:, 0], partner, owner))
    code = np.concatenate([2 * np.arange(len(a)), 2 * np.arange(len(a)) + 1])
    start, incident = list_incident(a, b, n)
    np.testing.assert_array_equal(incident, code[order])
    np.testing.assert_array_equal(start, np.searchsorted(owner[order], np.arange(n + 1)))


def test_every_body_lists_its_contacts_in_order_of_partner_and_image():
    rng = np.random.default_rng(3)
    n = 30
    position, still = rng.uniform(0.0, 0.1, (n, 3)), np.zeros((n, 3))
    upright = np.tile([1.0, 0, 0, 0], (n, 1))
    bodies = make_bodies([unit_sphere()], np.zeros(n, int), np.full((n, 3), 0.04), position, upright, still, still, 1.0)
    contacts = list_candidates(bodies, SHAPES, Box(0.1), 0.0, ALL_FIELDS).contacts
    observed = 0
    for i in range(n):
        sides = contacts.incident[contacts.incident_start[i] : contacts.incident_start[i + 1]]
        order = []
        for code in sides:
            p, is_b = code >> 1, code & 1
            assert (contacts.body_b if is_b else contacts.body_a)[p] == i
            partner = (contacts.body_a if is_b else contacts.body_b)[p]
            order.append((partner, *(contacts.image[p] * (-1 if is_b else 1))))
        assert order == sorted(order)
        observed += len(sides)
    assert observed == 2 * len(contacts.body_a)


@pytest.mark.parametrize("kind", ["convex", "ellipsoid", "mixed"])
def test_no_pair_that_is_left_out_can_touch_before_the_next_list(kind):
    """If points move by less than the margins, all pairs that touch then were listed, though many were left out."""
    rng = np.random.default_rng(4)
    n, width = 150, 5.0
    margin = rng.choice([0.02, 0.125, 0.3], n)
    hulls = [make_pebble(k, 20) for k in range(5)]
    bases = {"convex": hulls, "ellipsoid": [UNIT_SPHERE], "mixed": [*hulls[:3], UNIT_SPHERE, UNIT_SPHERE]}[kind]
    shapes = collect_shapes(bases)
    features = Features({"convex": POLYHEDRON, "ellipsoid": ELLIPSOID, "mixed": MIXED}[kind], True)
    position, turns, still = rng.uniform(0.0, width, (n, 3)), random_orientations(n, rng), np.zeros((n, 3))
    shape = rng.integers(0, len(bases), n)
    scale = np.array([[0.8] * 3 if len(base.vertices) else [0.8, 0.5, 0.3] for base in bases])[shape]
    bodies = make_bodies(bases, shape, scale, position, turns, still, still, 1.0)
    look = {
        "convex": lambda b, c: update_polyhedra(shapes, b, c, width),
        "ellipsoid": lambda b, c: update_ellipsoids(None, b, c, width),
        "mixed": lambda b, c: update_mixed(shapes, b, c, width),
    }[kind]
    near = list_candidates(bodies, shapes, Box(width), margin, features)
    assert len(near.contacts.body_a) < 0.7 * len(find_pairs(position, bodies.radius + margin, Box(width)))
    key = lambda c: set(zip(c.body_a, c.body_b, *c.image.T, strict=True))  # noqa: E731
    touched = 0
    for trial in range(20):
        if trial == 10:  # list again with remembered contacts
            look(bodies, near.contacts)
            near = list_candidates(bodies, shapes, Box(width), margin, features, near)
        share = rng.uniform(0.0, 1.0, (n, 1))  # of the margin, used for translation; the rest for rotation
        unit = rng.standard_normal((n, 3))
        way = 0.998 * margin[:, None]
        move = way * share * unit / np.linalg.norm(unit, axis=1, keepdims=True)
        spin = rng.standard_normal((n, 3))
        angle = 2.0 * np.arcsin(np.minimum(way * (1.0 - share) / (2.0 * bodies.radius[:, None]), 1.0))
        turn = Rotation.from_rotvec(angle * spin / np.linalg.norm(spin, axis=1, keepdims=True))
        moved_turns = (turn * Rotation.from_quat(bodies.orientation, scalar_first=True)).as_quat(scalar_first=True)
        moved = make_bodies(bases, shape, scale, bodies.position + move, moved_turns, still, still, 1.0)
        every = list_candidates(moved, shapes, Box(width), 1.25, features).contacts
        look(moved, every)
        touching = every._replace(
            body_a=every.body_a[every.touching > 0],
            body_b=every.body_b[every.touching > 0],
            image=every.image[every.touching > 0],
        )
        assert key(touching) <= key(near.contacts)
        touched += int(every.touching.sum())
    assert touched > 20 * n


def test_several_threads_and_any_blocks_leave_out_the_same_pairs(monkeypatch):
    """Each block starts within the old list, of which some pairs touched and others were apart."""
    monkeypatch.setattr(candidate_pairs, "BLOCK", 10**6)
    rng = np.random.default_rng(7)
    n, width = 300, 5.0
    bases = [make_pebble(k, 20) for k in range(5)]
    shapes, features, still = collect_shapes(bases), Features(POLYHEDRON, True), np.zeros((n, 3))
    bodies = make_bodies(
        bases, rng.integers(0, 5, n), np.full((n, 3), 0.6), rng.uniform(0.0, width, (n, 3)),
        random_orientations(n, rng), still, still, 1.0,
    )  # fmt: skip
    old = list_candidates(bodies, shapes, Box(width), 0.1, features)
    update_polyhedra(shapes, bodies, old.contacts, width)
    bodies.position[:] += 0.1 * rng.standard_normal((n, 3))
    bodies.margin[:] = rng.choice([0.02, 0.2], n)
    alone = list_pairs(bodies, shapes, Box(width), features, old)
    monkeypatch.setattr(candidate_pairs, "get_num_threads", lambda: 3)
    monkeypatch.setattr(candidate_pairs, "BLOCK", 1)
    np.testing.assert_array_equal(list_pairs(bodies, shapes, Box(width), features, old), alone)
    every = find_pairs(bodies.position, bodies.radius + bodies.margin, Box(width))
    assert 300 < len(alone) < 0.9 * len(every)
