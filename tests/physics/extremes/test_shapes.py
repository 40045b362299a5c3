"""Extreme forms and spins: plates and needles of 1:100, eight and five thousand faces, up to a radian per step."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from simcore.dem.from_scene import compose
from simcore.dem.shapes.polyhedra import ELLIPSOID, POLYHEDRON
from simcore.packing.packed import PackingError
from tests.helpers.hand_placed_bodies import (
    UNDAMPED,
    floor_force,
    make_scene,
    pair_overlap,
    place_bodies,
    run_watched,
    total_energy,
)
from tests.helpers.polyhedra import make_box, make_symmetric_polyhedron

GRAVITY = 9.81
LONG = 0.02
THIN = LONG / 100.0
CONTACT_TIME = 1e-3
FORMS = {"needle": [LONG, THIN, THIN], "plate": [LONG, LONG, THIN]}


def setting(kind, **groups):
    groups = {"numerics": {"contact_time": CONTACT_TIME}, "domain": {"width": 0.1}, **groups}
    return make_scene(POLYHEDRON if kind == "hull" else ELLIPSOID, **groups)


def thrown(kind, form, tilt, **groups):
    """Return a process of one grain of 1:100, tilted and just above the floor."""
    edges = np.array(FORMS[form])
    reach = 0.5 * (LONG * np.sin(tilt) + THIN * np.cos(tilt))
    return place_bodies(
        setting(kind, **groups), [edges if kind == "hull" else 0.5 * edges], [0, 0, reach + 1e-3],
        orientation=Rotation.from_rotvec([0.0, tilt, 0.0]).as_quat(scalar_first=True),
        bases=[make_box()] if kind == "hull" else None,
    )  # fmt: skip


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("kind", ["hull", pytest.param("ellipsoid", marks=pytest.mark.extremes)])
def test_a_thin_grain_falls_flat(kind, form):
    """Dropped at 40° a grain only loses energy and ends flat: the height of its centre is half its thickness.

    The static overlap is g / k; a rocking ellipsoid is held up to the same height by its curvature.
    """
    grain = thrown(kind, form, np.radians(40.0))
    energies = run_watched(grain, 1.0, damped=True)
    assert (np.diff(energies) < 1e-6 * energies[0]).all()
    gives = GRAVITY / compose(grain.scene).law.stiffness
    assert grain.bodies.position[0, 2] == pytest.approx(0.5 * THIN - gives, abs=0.5 * gives + 1e-3 * THIN)
    assert np.abs(grain.bodies.velocity).max() < 1e-4


@pytest.mark.parametrize("form", FORMS)
def test_thin_grains_lie_on_each_other(form):
    """In a stack of three plates or crossed needles of 1:100, overlaps follow from the weight above, n m g.

    Contacts are stiffer than usual, so that overlaps of 1e-8 m are small compared with the thickness of 2e-4 m.
    """
    contact_time, n = 1e-4, 3
    edges = np.tile(FORMS[form], (n, 1))
    height = THIN * (np.arange(n) + 0.5)
    turn = Rotation.from_rotvec(np.outer(np.arange(n) % 2, [0.0, 0.0, np.pi / 2])).as_quat(scalar_first=True)
    made = setting("hull", numerics={"contact_time": contact_time})
    pile = place_bodies(
        made, edges, np.column_stack([0 * height, 0 * height, height]), orientation=turn, bases=[make_box()]
    )
    run_watched(pile, 0.1, damped=True)
    mass, stiffness = pile.bodies.mass[0], compose(made).law.stiffness
    found = [pair_overlap(pile, k, k + 1) for k in range(n - 1)]
    np.testing.assert_allclose(found, [2 * GRAVITY / (0.5 * stiffness), GRAVITY / (0.5 * stiffness)], rtol=0.02)
    assert floor_force(pile) == pytest.approx(n * mass * GRAVITY, rel=1e-3)


def octahedron():
    return make_symmetric_polyhedron(np.vstack([np.eye(3), -np.eye(3)]), "8 faces")


def ball(faces=5000):
    """Return the hull of faces / 2 + 2 points spread evenly over the unit sphere (a Fibonacci lattice)."""
    n = faces // 2 + 2
    k = np.arange(n) + 0.5
    z, turn = 1.0 - 2.0 * k / n, np.pi * (1.0 + np.sqrt(5.0)) * k
    ring = np.sqrt(1.0 - z * z)
    return make_symmetric_polyhedron(np.column_stack([ring * np.cos(turn), ring * np.sin(turn), z]), f"{faces} faces")


def test_grains_of_8_and_of_5000_faces():
    """Three grains of each kind fall into a narrow box, only lose energy, come to rest, and the floor carries them.

    The energy of tangential springs is not counted; when it is returned, it is seen as a gain of 1e-6.
    """
    bases = [octahedron(), ball()]
    assert [len(base.faces) for base in bases] == [8, 5000]
    size = 3e-3
    position = np.array([[3.5, 3.5, 4.0 + 7.0 * k] for k in range(6)]) * 1e-3 + 1e-4 * np.arange(6)[:, None] % 3e-4
    made = setting("hull", domain={"width": 0.007})
    bed = place_bodies(made, size, position, bases=bases, shape=[0, 1, 0, 1, 1, 0])
    energies = run_watched(bed, 0.7, damped=True)
    assert (np.diff(energies) < 1e-5 * energies[0]).all()
    assert np.abs(bed.bodies.velocity).max() < 5e-3
    assert floor_force(bed) == pytest.approx(GRAVITY * bed.bodies.mass.sum(), rel=0.02)
    assert bed.contacts.overlap.max() < 0.02 * size


def test_a_ball_of_5000_faces_is_a_sphere_to_its_contacts():
    """Two stacked balls are as high as spheres, apart from the sagitta of a face and static overlaps.

    Faces of area 4 π / 5000 of a unit ball have circumradii of 0.04, at most twice that, so the sagitta is below
    0.0032.
    """
    size = 3e-3
    made = setting("hull")
    pair = place_bodies(made, size, [[0, 0, size], [0, 0, 3.0 * size]], bases=[ball()])
    run_watched(pair, 0.02, damped=True)
    gives = GRAVITY / compose(made).law.stiffness
    low, high = pair.bodies.position[:, 2]
    assert size * (1.0 - 0.0032) - 3 * gives < low < size
    assert size * (2.0 - 0.0064) - 3 * gives < high - low < 2.0 * size


@pytest.mark.parametrize("contact_time", [2e-4, 1e-2])
@pytest.mark.parametrize("share", [0.5, 1.0])
def test_cubes_that_start_within_each_other_separate(contact_time, share):
    """Cubes separate that overlap by half an edge, or are concentric."""
    edge = 6e-3
    made = setting("hull", numerics={"contact_time": contact_time})
    away = np.array([0.8, 0.6, 0.0]) * edge * (1.0 - share) / 0.8
    pair = place_bodies(made, edge, [[0, 0, 0.5 * edge], [0, 0, 0.5 * edge] + away], bases=[make_box()])
    energies = run_watched(pair, 100 * contact_time + 0.3, damped=True)
    assert np.isfinite(pair.bodies.position).all()
    assert pair_overlap(pair, 0, 1) < 1e-2 * edge
    assert np.linalg.norm(pair.bodies.position[1] - pair.bodies.position[0]) > 0.98 * edge
    assert energies[-1] < energies[0]


SPINS = [*((form, per_step) for form in FORMS for per_step in (1e-3, 0.1)), ("plate", 1.0)]


def free_spin(form, per_step):
    """Return a grain that spins freely by per_step [rad] per time step, mostly about the axis of its largest moment."""
    made = setting("hull", material={"gravity": 0.0})
    rate = per_step / made.numerics.time_step
    axis = np.array([0.1, 0.02, 1.0])
    return place_bodies(made, [FORMS[form]], [0, 0, 0.5], spin=rate * axis, bases=[make_box()])


@pytest.mark.parametrize("form, per_step", SPINS)
def test_a_free_spinning_grain_keeps_spin_and_energy(form, per_step):
    """At up to a radian per step, angular momentum is constant to the bit and the energy error is bounded.

    The splitting is symmetric, so its energy error does not drift and is at most (ω dt)² / 12.
    """
    grain = free_spin(form, per_step)
    momentum = grain.bodies.angular_momentum.copy()
    start = total_energy(grain)
    energies = run_watched(grain, 4000 * grain.dt)
    assert (grain.bodies.angular_momentum == momentum).all()
    assert abs(np.linalg.norm(grain.bodies.orientation) - 1.0) < 1e-14
    assert np.abs(energies / start - 1.0).max() < per_step**2 / 12.0 + 1e-12


def test_a_needle_that_spins_by_a_radian_per_step_is_stopped():
    """Its moments of inertia differ by a factor of 5000, and the small one would gain the energy."""
    grain = free_spin("needle", 1.0)
    with pytest.raises(PackingError, match="the energy grew by .* grain 0 has the most energy"):
        run_watched(grain, 4000 * grain.dt)


def test_a_grain_that_spins_fast_meets_its_neighbour():
    """The tip of a needle at 200 turns per second touches a cube in the step that its rotation gives.

    The centres are at rest, so a neighbour list that ignored rotation would miss the contact.
    """
    # A step of the tip is 0.03 mm, a seventh of its thickness.
    made = setting("hull", material={"gravity": 0.0}, numerics={"contact_time": 1e-4})
    rate = 2.0 * np.pi * 200.0
    # The other body, a cube, is where the tip passes after a quarter of a turn.
    tip = 0.5 * LONG
    pair = place_bodies(
        made, [FORMS["needle"], [0.002] * 3], [[0, 0, 0.5], [0, 0.9 * tip + 0.001, 0.5]],
        spin=[[0, 0, rate], [0, 0, 0]], bases=[make_box()],
    )  # fmt: skip
    # The tip meets its corner at x = 1 mm at the angle acos(0.001 / r), r being the distance of the corner.
    corner = np.array([0.001, 0.9 * tip])
    angle = np.arctan2(corner[1], corner[0])
    met = angle / rate / pair.dt
    first = None
    for step in range(round(1.2 * met)):
        pair.advance(1, UNDAMPED)
        if pair.contacts.touching.any():
            first = step
            break
    thickness = 0.5 * THIN / np.linalg.norm(corner) / rate / pair.dt
    assert first == pytest.approx(met - thickness, abs=3.0)


@pytest.mark.parametrize("rate", [100.0, 1000.0])
def test_a_sphere_set_down_spinning_ends_rolling(rate):
    """Angular momentum about the contact is constant: u = 2/7 R ω, up to 160 turns per second."""
    radius, contact_time = 3e-3, 1e-4
    made = make_scene(numerics={"contact_time": contact_time}, material={"friction": 0.5})
    sunk = GRAVITY / compose(made).law.stiffness
    ball = place_bodies(made, radius, [0, 0, radius - sunk], spin=[0, rate, 0])
    ends = 2.0 / 7.0 * radius * rate / (0.5 * GRAVITY)
    run_watched(ball, 1.2 * ends)
    assert ball.bodies.velocity[0, 0] == pytest.approx(2.0 / 7.0 * radius * rate, rel=1e-3)
    assert ball.bodies.angular_velocity[0, 1] == pytest.approx(2.0 / 7.0 * rate, rel=1e-3)
