"""The list of candidate pairs, compared with all pairs in all images."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from simcore.dem.shapes.polyhedra import ELLIPSOID, MIXED, POLYHEDRON, collect_shapes, unit_sphere
from simcore.dem.state.bodies import make_bodies
from simcore.dem.state.contacts import Box
from simcore.dem.state.features import Features
from simcore.dem.step.candidate_pairs import find_pairs, list_candidates
from tests.helpers.contact_pairs import ALL_FIELDS, UNIT_SPHERE, update_ellipsoids, update_mixed, update_polyhedra
from tests.helpers.polyhedra import make_pebble
from tests.helpers.rotations import random_orientations

SHAPES = collect_shapes([unit_sphere()])


def all_pairs(position, radius, width):
    """Return the set of (a, b, image x, image y) by brute force, with a < b, or a = b and a positive image."""
    near = set()
    n = len(radius)
    if width > 0.0:
        span = np.ptp(position[:, :2]) + 2.0 * radius.max()
        reach = int(np.ceil(span / width)) + 1
        images = [(i, j) for i in range(-reach, reach + 1) for j in range(-reach, reach + 1)]
    else:
        images = [(0, 0)]
    for image in images:
        offset = position[None] - position[:, None] + np.array([*image, 0]) * width
        close = (offset**2).sum(axis=-1) < (radius[:, None] + radius[None]) ** 2
        for a, b in zip(*np.nonzero(close), strict=True):
            if a < b or (a == b and image > (0, 0)):
                near.add((int(a), int(b), *image))
    assert n
    return near


def found_pairs(position, radius, width):
    pairs = find_pairs(position, radius, Box(width))
    keys = [tuple(int(value) for value in row) for row in pairs]
    assert len(set(keys)) == len(keys), "a pair is listed twice"
    assert keys == sorted(keys), "not in the order of the key"
    return set(keys)


@pytest.mark.parametrize(
    "width, largest, n",
    [
        (0.0, 0.02, 300),  # open
        (0.0, 0.12, 300),  # open, sizes 1 : 12
        (0.3, 0.02, 300),
        (0.3, 0.12, 300),  # a pair may touch through several images
        (0.05, 0.06, 40),  # far narrower than the largest
        (1.0, 0.12, 300),
    ],
)
def test_the_list_holds_every_near_pair_once(width, largest, n):
    rng = np.random.default_rng(1)
    radius = np.exp(rng.uniform(np.log(0.01), np.log(largest), n))
    radius[0], radius[1] = 0.01, largest
    extent = width if width > 0.0 else 0.4
    # Positions are not wrapped: they are up to two widths away from the box.
    position = rng.uniform([-2 * extent, -2 * extent, 0.0], [3 * extent, 3 * extent, 0.5], (n, 3))
    if width == 0.0:
        position = rng.uniform(0.0, 0.4, (n, 3))
    found = found_pairs(position, radius, width)
    assert found == all_pairs(position, radius, width)
    assert len(found) > n / 8


def test_a_grain_meets_its_own_images_once_each():
    found = found_pairs(np.array([[0.05, 0.02, 0.1]]), np.array([0.06]), 0.1)
    assert found == {(0, 0, 0, 1), (0, 0, 1, 0)}
    wider = found_pairs(np.array([[0.05, 0.02, 0.1]]), np.array([0.08]), 0.1)
    assert wider == {(0, 0, 0, 1), (0, 0, 1, -1), (0, 0, 1, 0), (0, 0, 1, 1)}


def test_places_on_the_border_of_box_and_cell():
    position = np.array([[0.0, 0.0, 0.0], [0.2, 0.2, 0.0], [0.4, 0.0, 0.0], [-1e-18, 0.1, 0.0], [0.1, 0.3999999, 0.1]])
    radius = np.full(5, 0.15)
    assert found_pairs(position, radius, 0.4) == all_pairs(position, radius, 0.4)


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
