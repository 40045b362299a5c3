"""A step computes nothing for features that a scene lacks: the arrays and numbers of these features are absent or nan.

The features are orientation, friction and its history, floor and wall, shaking, patches, periodic images and polyhedra.
Every packing ends with damping, so every step has it, with a factor of 1 until then.
"""

import numba
import numpy as np
import pytest

from simcore.dem.contact.patch.workspace import make_workspace
from simcore.dem.forces.spring_dashpot import contact_law
from simcore.dem.shapes.polyhedra import ELLIPSOID, POLYHEDRON, SPHERE, collect_shapes, unit_sphere
from simcore.dem.state.bodies import make_bodies
from simcore.dem.state.contacts import Box, State, bytes_per_pair
from simcore.dem.state.features import Features
from simcore.dem.step.candidate_pairs import list_candidates
from simcore.dem.step.step import STAGES, Drive, make_advance
from tests.helpers.polyhedra import make_pebble

LAW = contact_law(0.5, 1e-3, 0.22, 0.0)  # friction 0: the same as none, to the bit
STILL = Drive(
    dt=2.5e-5,
    gravity=0.0,
    shaking=0.0,
    shaking_rate=1.0,
    damping=1.0,
    width=0.0,
    wall_radius=np.inf,
)
BARE = Features(SPHERE, friction=False, floor=False, cylinder=False, periodic=False, shaken=False)
FULL = Features(SPHERE, friction=True)
N = 20


def bodies_of(base, kind, scale):
    """Return a loose group of bodies that fly towards each other."""
    rng = np.random.default_rng(3)
    position = 1.2e-2 * np.stack(np.unravel_index(np.arange(N), (3, 3, 3)), axis=-1) + [0.0, 0.0, 10.0]
    velocity = 30.0 * (position.mean(axis=0) - position) + 0.1 * rng.standard_normal((N, 3))
    upright = np.tile([1.0, 0.0, 0.0, 0.0], (N, 1))
    spin = 5.0 * rng.standard_normal((N, 3))
    shape = np.zeros(N, int)
    return make_bodies(
        [base], shape, np.tile(scale, (N, 1)), position, upright, velocity, spin, 2650.0, features=Features(kind, True)
    )


def run(features, bodies, shapes, room, box, law, drive, steps=800):
    """Step bodies whose pairs are all listed from the start; return their candidate pairs."""
    near = list_candidates(bodies, shapes, box, 1.0, features)
    clock = np.zeros(len(STAGES), np.int64)
    done, _ = make_advance(features)(State(shapes, bodies, *near, room), law, drive, clock, 0, steps)
    assert done == steps
    return near


def poisoned(group):
    """Return a copy without valid numbers: arrays of floats contain nan, arrays of integers the least integer."""
    return type(group)(
        *(np.full_like(array, np.nan if array.dtype.kind == "f" else np.iinfo(array.dtype).min) for array in group)
    )


@pytest.fixture(scope="module")
def bare_and_full():
    """Return the same spheres after a step without features and after a step with all features.

    The first step gets invalid numbers for the missing features, the second one numbers that have no effect.
    """
    base = unit_sphere()
    shapes = collect_shapes([base])
    heaps = [bodies_of(base, SPHERE, np.full(3, 5e-3)) for _ in range(2)]
    law = LAW._replace(friction=np.nan, tangential=np.nan, root_tangential=np.nan, sliding=np.nan)
    drive = STILL._replace(shaking=np.nan, shaking_rate=np.nan, width=np.nan, wall_radius=np.nan)
    room = make_workspace(shapes, numba.get_num_threads())
    bare = run(BARE, heaps[0], poisoned(shapes), room, Box(0.0), law, drive)
    full = run(FULL, heaps[1], shapes, room, Box(100.0), LAW, STILL._replace(width=100.0))
    return heaps, bare, full


def test_the_bare_step_needs_none_of_the_numbers_left_out(bare_and_full):
    (first, second), bare, full = bare_and_full
    for name in ("position", "velocity", "angular_momentum", "net_force"):
        np.testing.assert_array_equal(getattr(first, name), getattr(second, name))
    np.testing.assert_array_equal(bare.contacts.force, full.contacts.force)
    # The spheres have collided: without contacts they would have their initial velocities.
    base = bodies_of(unit_sphere(), SPHERE, np.full(3, 5e-3))
    assert np.abs(first.velocity - base.velocity).max() > 0.1


def test_the_bare_scene_has_no_arrays_for_what_it_leaves_out(bare_and_full):
    (bodies, _), (contacts, walls), (rich, _) = bare_and_full
    for name in ("orientation", "turned", "listed_turned", "rotation", "form_matrix"):
        assert len(getattr(bodies, name)) == 0, name
    for name in ("image", "pending", "facet", "apart_at", "safe_until", "spring", "twist", "stuck", "spread"):
        assert len(getattr(contacts, name)) == 0, name
    assert len(walls.body) == 0
    assert len(rich.image) == len(rich.spring) == len(rich.body_a) > 0


def test_ellipsoids_read_no_hull():
    """The base of an ellipsoid has no vertices, so the arrays of vertices may contain anything."""
    base, features = unit_sphere(), Features(ELLIPSOID, True)
    shapes = collect_shapes([base])
    results = []
    for some in (shapes, poisoned(shapes)):
        bodies = bodies_of(base, ELLIPSOID, np.array([4e-3, 5e-3, 6e-3]))
        near = list_candidates(bodies, shapes, Box(100.0), 1.0, features)
        workspace, drive, clock = make_workspace(shapes, 1), STILL._replace(width=100.0), np.zeros(3, np.int64)
        state = State(some, bodies, *near, workspace)
        make_advance(features)(state, LAW, drive, clock, 0, 800)
        results.append((bodies, near))
    (first, near), (second, other) = results
    np.testing.assert_array_equal(first.position, second.position)
    np.testing.assert_array_equal(near.contacts.force, other.contacts.force)
    assert len(near.contacts.facet) == len(near.contacts.spread) == len(near.contacts.twist) == 0
    straight = bodies_of(base, ELLIPSOID, np.array([4e-3, 5e-3, 6e-3])).velocity
    assert np.abs(first.velocity - straight).max() > 0.1


def test_polyhedra_at_their_deepest_point_find_no_patch():
    """There is no workspace for polygons, and no second moment is written."""
    base, features = make_pebble(1), Features(POLYHEDRON, True)
    shapes = collect_shapes([base])
    results = []
    for room in (make_workspace(shapes, 1), poisoned(make_workspace(shapes, 0))):
        bodies = bodies_of(base, POLYHEDRON, np.full(3, 5e-3))
        near = run(features, bodies, shapes, room, Box(100.0), LAW, STILL._replace(width=100.0))
        results.append((bodies, near))
    np.testing.assert_array_equal(results[0][0].position, results[1][0].position)
    contacts = results[0][1].contacts
    assert len(contacts.spread) == len(contacts.twist) == 0 and len(contacts.facet) == len(contacts.body_a)
    assert len(contacts.stuck) == 0  # without preloaded friction
    assert len(results[0][0].form_matrix) == 0


@pytest.mark.parametrize("features", [BARE, FULL, Features(ELLIPSOID, True), Features(POLYHEDRON, True, patch=True)])
def test_the_memory_of_a_pair_is_that_of_its_row(features):
    base = make_pebble(1) if features.kind == POLYHEDRON else unit_sphere()
    bodies = bodies_of(base, features.kind, [5e-3, 5e-3, 5e-3])
    contacts = list_candidates(bodies, collect_shapes([base]), Box(1.0 * features.periodic), 0.01, features).contacts
    rows = sum(array.nbytes for array in contacts) - contacts.incident_start.nbytes
    assert rows == bytes_per_pair(features) * len(contacts.body_a) > 0
