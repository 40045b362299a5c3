"""Shaken beds of polyhedra, and of polyhedra and ellipsoids: remembered contacts equal those of a new search."""

import os
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest

from simcore.dem.contact.patch.workspace import make_workspace
from simcore.dem.contact.query import query_many
from simcore.dem.forces.spring_dashpot import contact_law
from simcore.dem.shapes.polyhedra import MIXED, POLYHEDRON, collect_shapes, convex, ellipsoid, sphere
from simcore.dem.state.bodies import make_bodies
from simcore.dem.state.contacts import Box, State
from simcore.dem.state.features import Features
from simcore.dem.step.candidate_pairs import list_candidates
from simcore.dem.step.step import Drive, make_advance
from tests.helpers.contact_pairs import UNIT_SPHERE, update_polyhedra
from tests.helpers.polyhedra import CUBE, make_pebble, make_polyhedron
from tests.helpers.rotations import random_orientations

ROOT = Path(__file__).parents[3]
WIDTH = 0.030
BETWEEN_BOUNDS = 3e-9  # of the size, more than deep_overlap.CERTAIN: error of the overlap of deep ellipsoids


NEEDLE, PLATE = (1.6, 0.3, 0.3), (1.2, 1.2, 0.2)
SMOOTH = [(1.0, 1.0, 1.0), (1.0, 0.75, 0.5), NEEDLE, PLATE]  # axes of ellipsoids


def make_hulls():
    """Return pebbles of 8 to 40 points, a needle, a plate, and a cube, whose contacts are all degenerate."""
    bases = [make_pebble(k, n) for k, n in enumerate((8, 16, 24, 40))]
    return bases + [make_pebble(4, 24, NEEDLE), make_pebble(5, 32, PLATE), make_polyhedron(1.6 * CUBE)]


def make_bed(kind=POLYHEDRON):
    """Return 48 grains, 5 to 9 mm across, above the floor of a periodic box: polyhedra, or ellipsoids as well."""
    rng = np.random.default_rng(1)
    bases, axes = make_hulls(), np.ones((7, 3))
    if kind == MIXED:
        bases, axes = bases + [UNIT_SPHERE] * 4, np.concatenate([axes, SMOOTH])
    n = 48
    cell = np.stack(np.unravel_index(np.arange(n), (12, 2, 2)), axis=-1)[:, [1, 2, 0]]
    position = (cell + 0.5) * [WIDTH / 2, WIDTH / 2, 0.012]
    scale = np.repeat(rng.uniform(2.8e-3, 4.5e-3, (n, 1)), 3, axis=1)
    velocity = rng.uniform(-0.1, 0.1, (n, 3)) - [0.0, 0.0, 1.0]
    spin = rng.uniform(-10.0, 10.0, (n, 3))
    shape = rng.integers(0, len(bases), n)
    turns, scale = random_orientations(n, rng), scale * axes[shape]
    return bases, make_bodies(bases, shape, scale, position, turns, velocity, spin, density=2650.0)


def search_hulls(bases):
    """Return a function that fills contacts by the search of a step, without remembered contacts."""
    shapes = collect_shapes(bases)
    return lambda bodies, contacts: update_polyhedra(shapes, bodies, contacts, WIDTH)


def query_bodies(bases):
    """Return a function that fills contacts by the stand-alone query, for which every body is a shape of its own."""
    known = []

    def shape_of(base, scale):
        if len(base.vertices):
            return convex(base.vertices * scale)
        return sphere(scale[0]) if (scale == scale[0]).all() else ellipsoid(*scale)

    def look(bodies, contacts):
        if not known:
            known[:] = [shape_of(bases[k], scale) for k, scale in zip(bodies.shape, bodies.scale, strict=True)]
        a, b = contacts.body_a, contacts.body_b
        place = bodies.position[b] + WIDTH * np.pad(contacts.image, ((0, 0), (0, 1)))
        found = query_many(known, a, (bodies.position[a], bodies.orientation[a]), b, (place, bodies.orientation[b]))
        contacts.touching[:] = found.signed_distance < 0.0
        contacts.overlap[:], contacts.direction[:] = -found.signed_distance, found.normal

    return look


def follow(end, kind=POLYHEDRON, searching=search_hulls):
    """Step the bed to step `end` and compare remembered contacts with new ones.

    It returns the number of touching pairs of each kind (two ellipsoids, an ellipsoid and a polyhedron, two polyhedra),
    the number of pairs of polyhedra in another local minimum, and their excess overlaps.
    """
    bases, bodies = make_bed(kind)
    shapes, search = collect_shapes(bases), searching(bases)
    hull = np.array([len(base.vertices) > 0 for base in bases])[bodies.shape]
    contact_time = 5e-4
    dt = contact_time / 40
    law = contact_law(0.1, contact_time, 0.22, 0.5)
    skin = 1e-3
    drive = Drive(dt, 6.108, 18.95, 251.3, 1.0, WIDTH, np.inf)
    still = drive._replace(dt=0.0)
    features = Features(kind, True, patch=True)
    advance, clock = make_advance(features), np.zeros(3, np.int64)
    room = make_workspace(shapes, numba.get_num_threads())
    near = list_candidates(bodies, shapes, Box(WIDTH), 0.5 * skin, features)
    step, touches, others, excess_others = 0, np.zeros(3, int), 0, []
    while step < end:
        # The number of steps is odd, so that comparisons are made anywhere between two listings.
        done, stale = advance(State(shapes, bodies, *near, room), law, drive, clock, step, 37)
        step += done
        if stale:
            near = list_candidates(bodies, shapes, Box(WIDTH), 0.5 * skin, features, near)
        if step % 10 and step < end - 1000:
            continue
        advance(State(shapes, bodies, *near, room), law, still, clock, step, 1)
        contacts = near.contacts
        listed, turned, margin = (
            field.copy() for field in (bodies.listed_position, bodies.listed_turned, bodies.margin)
        )
        fresh = list_candidates(bodies, shapes, Box(WIDTH), 0.0, features).contacts
        bodies.listed_position[:], bodies.listed_turned[:], bodies.margin[:] = listed, turned, margin
        search(bodies, fresh)
        remembered = {
            (contacts.body_a[p], contacts.body_b[p], *contacts.image[p]): p for p in range(len(contacts.body_a))
        }
        for q in range(len(fresh.body_a)):
            key = (fresh.body_a[q], fresh.body_b[q], *fresh.image[q])
            if key not in remembered:  # it was found to be apart when the list was made
                assert not fresh.touching[q], "an overlapping pair is not listed"
                continue
            p = remembered[key]
            size = bodies.radius[fresh.body_a[q]] + bodies.radius[fresh.body_b[q]]
            if not fresh.touching[q]:
                assert not contacts.touching[p] or contacts.overlap[p] < 1e-12 * size
                continue
            if not contacts.touching[p]:
                assert fresh.overlap[q] < 1e-12 * size, "an overlapping pair was taken for apart"
                continue
            hulls = int(hull[fresh.body_a[q]]) + int(hull[fresh.body_b[q]])
            touches[hulls] += 1
            excess = (contacts.overlap[p] - fresh.overlap[q]) / size
            assert excess > -1e-12, "the overlap is less than the minimum"
            if hulls < 2:
                assert excess < BETWEEN_BOUNDS
            elif excess > 1e-9:
                others += 1  # another local minimum, with a larger depth and a normal of its own
                excess_others.append(excess)
                continue
            # The minimum is unique, or two facets are equally near within rounding.
            if excess < 1e-9:
                assert contacts.direction[p] @ fresh.direction[q] > 1.0 - 1e-9
    return touches, others, excess_others


def test_the_memory_of_a_shaken_bed_is_right():
    touches, others, excess_others = follow(20000)
    touches = touches.sum()
    assert touches > 3000
    # The overlaps are small compared with the facets, so the local minimum is nearly always the global one.
    assert others <= 0.002 * touches, (others, max(excess_others))


def test_the_memory_of_a_bed_of_mixed_kinds_is_right():
    touches, others, excess_others = follow(30000, MIXED, query_bodies)
    assert (touches > 200).all() and touches[1] > 1000, touches
    assert others <= 0.002 * touches[2], (others, max(excess_others))


BREAK = """
import sys
sys.path.insert(0, {root!r})
from simcore.dem.contact.pairs import polyhedra as polyhedron
polyhedron.{constant} = {value}  # read when the check is compiled
from tests.dem.contact import test_remembered_contacts
test_remembered_contacts.follow(3000)
"""


@pytest.mark.extremes
def test_a_broken_check_is_noticed(tmp_path):
    """The comparison above fails with a check that accepts any remembered facet."""
    script = BREAK.format(root=str(ROOT), constant="CHECK_TOLERANCE", value=1.0)
    environment = os.environ | {"SCREE_CACHE": str(tmp_path)}
    output = subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True)
    assert output.returncode != 0
    assert "AssertionError" in output.stderr, output.stderr
