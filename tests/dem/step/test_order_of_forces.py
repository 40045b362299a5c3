"""Forces added by contact or by body, and in blocks or in separate loops, give the same bits.

By default, one thread adds each force to both bodies as soon as it is computed. The alternative stores all forces first
and adds them body by body. Several threads use it, and so does one thread if a pair is listed through two images.
"""

import numpy as np
import pytest

from simcore.dem.contact.patch.workspace import make_workspace
from simcore.dem.forces.hertz import hertz_law
from simcore.dem.forces.spring_dashpot import contact_law, implicit_law
from simcore.dem.shapes.polyhedra import ELLIPSOID, POLYHEDRON, SPHERE, collect_shapes, unit_sphere
from simcore.dem.state.bodies import make_bodies
from simcore.dem.state.contacts import Box, State
from simcore.dem.state.features import Features
from simcore.dem.step.candidate_pairs import list_contacts, list_pairs
from simcore.dem.step.step import BLOCK, STAGES, Drive, make_advance, pairs_repeat
from simcore.scene.impact import Hertzian
from tests.helpers.polyhedra import make_pebble

DT, STEPS, WIDTH = 2.5e-5, 40, 0.5
LINEAR = contact_law(0.3, 1e-3, 0.22, 0.5)
LAWS = {
    "spheres": (Features(SPHERE, True), LINEAR),
    "spheres, timed": (Features(SPHERE, True, timed=True), LINEAR),
    "hertzian spheres": (
        Features(SPHERE, True, hertz=True),
        hertz_law(Hertzian(2e5, 1e-4, 1e-3, 1e-3, 1e-4), 0.22, 0.5, 2650.0),
    ),
    "ellipsoids": (Features(ELLIPSOID, True, implicit=True), implicit_law(LINEAR, DT)),
    "polyhedra": (Features(POLYHEDRON, True, patch=True), LINEAR),
}
SPACING = {SPHERE: 1.9, ELLIPSOID: 1.6, POLYHEDRON: 1.4}  # in units of the largest half-axis
CLOSE = 48  # bodies that fly together and fall onto the floor; two more rest far above them


def heap(base, features):
    """Return a heap that contracts onto the floor, across the border of the box, and two bodies far above it."""
    rng = np.random.default_rng(5)
    scale = np.array([5e-3, 5e-3, 5e-3] if features.kind == SPHERE else [5.5e-3, 5e-3, 4.5e-3])
    reach = np.abs(base.vertices * scale).max() if len(base.vertices) else scale.max()
    place = np.stack(np.unravel_index(np.arange(CLOSE), (4, 4, 3)), axis=-1)
    position = SPACING[features.kind] * reach * place + [0.48, 0.48, 0.95 * reach]
    velocity = 5.0 * (position.mean(axis=0) - position) + 0.1 * rng.standard_normal((CLOSE, 3))
    position = np.concatenate([position, [[0.2, 0.2, 0.4], [0.3, 0.2, 0.4]]])
    velocity = np.concatenate([velocity, np.zeros((2, 3))])
    n = len(position)
    spin = 5.0 * rng.standard_normal((n, 3))
    orientation = rng.standard_normal((n, 4))
    return make_bodies(
        [base], np.zeros(n, int), np.tile(scale, (n, 1)), position, orientation, velocity, spin, 2650.0,
        features=features,
    )  # fmt: skip


def stepped(features, law, by_body):
    """Return bodies and contacts after STEPS; by_body: list the two bodies far above once more, through an image."""
    base = make_pebble(1) if features.kind == POLYHEDRON else unit_sphere()
    shapes, bodies, box = collect_shapes([base]), heap(base, features), Box(WIDTH)
    bodies.margin[:] = 0.06
    pairs = list_pairs(bodies, shapes, box, features, None)
    n = len(bodies.mass)
    far = np.array([[n - 2, n - 1, 0, 0], [n - 2, n - 1, 1, 0]])
    pairs = np.concatenate([pairs[pairs[:, 1] < CLOSE], far[: 1 + by_body]])
    candidates = list_contacts(pairs, bodies, shapes, box, features, None)
    assert len(pairs) > BLOCK and pairs_repeat.py_func(candidates.contacts) == by_body
    drive = Drive(DT, 9.81, 5.0, 200.0, 1.0, WIDTH, np.inf)
    state, clock = State(shapes, bodies, *candidates, make_workspace(shapes, 1)), np.zeros(len(STAGES), np.int64)
    done, _ = make_advance(features)(state, law, drive, clock, 0, STEPS)
    assert done == STEPS
    return bodies, candidates.contacts


@pytest.fixture(params=LAWS, scope="module")
def both(request):
    """Return bodies and contacts with the forces added by contact, and with the forces added by body."""
    return stepped(*LAWS[request.param], by_body=False), stepped(*LAWS[request.param], by_body=True)


def test_bodies_have_the_same_bits(both):
    (first, _), (second, _) = both
    for name, field in first._asdict().items():
        assert field.tobytes() == getattr(second, name).tobytes(), name


def test_contacts_have_the_same_bits(both):
    """Pairs that are apart are compared too; some of them touched before.

    The last row is listed only where forces are added by body.
    """
    (_, first), (_, second) = both
    rows = np.flatnonzero(first.touching)
    assert len(rows) > 20 and np.ptp(rows) > BLOCK // 2
    for name, field in first._asdict().items():
        if name not in ("incident_start", "incident") and len(field):
            np.testing.assert_array_equal(field, getattr(second, name)[: len(field)], err_msg=name)


def test_timed_spheres_are_stepped_in_separate_loops_with_the_same_bits():
    (one, contacts), (other, timed) = (stepped(*LAWS[name], by_body=False) for name in ("spheres", "spheres, timed"))
    assert one.position.tobytes() == other.position.tobytes() and one.net_force.tobytes() == other.net_force.tobytes()
    np.testing.assert_array_equal(contacts.spring, timed.spring)
