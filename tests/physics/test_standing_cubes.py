"""Faces on faces: a cube and a column of five stand still, and an overhanging cube falls if it is not supported."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from simcore.dem.forces.spring_dashpot import contact_law
from simcore.dem.shapes.polyhedra import POLYHEDRON
from tests.helpers.polyhedra import make_box
from tests.helpers.stepped_bodies import SteppedBodies

T_C = 5e-3
GRAVITY = 9.81
EDGE = 0.01
EQUILIBRIUM = GRAVITY * (T_C / np.pi) ** 2  # scale of a static overlap, g / k per mass


def column(n, shift=0.0, turn=0.0, patch=True, contact_time=T_C):
    """Return n cubes stacked slightly above rest, each shifted and turned against the one below."""
    k = np.arange(n)
    position = np.column_stack([shift * EDGE * k, 0.0 * k, EDGE * (k + 0.5) + 1e-6 * (k + 1)])
    orientation = Rotation.from_rotvec(np.column_stack([0.0 * k, 0.0 * k, turn * k])).as_quat(scalar_first=True)
    return SteppedBodies(
        POLYHEDRON, contact_law(0.1, contact_time, 0.22, 0.5), [EDGE] * 3, position, np.zeros(3), bases=[make_box()],
        orientation=orientation, gravity=GRAVITY, density=2650.0, patch=patch,
    )  # fmt: skip


@pytest.mark.parametrize("n, turn", [(1, 0.0), (5, 0.0), (5, 0.3)])
def test_cubes_stand_for_ten_seconds(n, turn):
    """Settled after 1 s, they stay in place to rounding for 9 s more.

    What is left of the speed decays as exp(-t / T_c) or not at all; positions are rounded to eps of 0.05 m in each
    step.
    """
    stand = column(n, turn=turn)
    dt = T_C / 40.0
    stand.advance(dt, round(1.0 / dt))
    before, turned = stand.bodies.position.copy(), stand.bodies.orientation.copy()
    stand.advance(dt, round(9.0 / dt))
    crept = np.abs(stand.bodies.position - before).max()
    tilted = np.abs(stand.bodies.orientation - turned).max()
    print(f"{n} cubes: crept {crept:.1e} m, tilted {tilted:.1e}, static overlap {EQUILIBRIUM:.1e} m")
    assert crept < 1e-3 * EQUILIBRIUM
    assert tilted < 1e-3 * EQUILIBRIUM / EDGE
    assert np.abs(stand.bodies.velocity).max() < 1e-9
    # The lowest cube carries the weight of all.
    weight = GRAVITY * stand.bodies.mass.sum()
    assert stand.floor_force()[0] == pytest.approx(weight, rel=1e-6)


def test_with_the_deepest_point_alone_a_cube_does_not_come_to_rest():
    """The point contact of Rettinger et al. jumps from corner to corner; the cube comes to rest only with a patch."""
    speed = []
    for patch in (False, True):
        stand = column(1, patch=patch)
        stand.advance(T_C / 40.0, 40000)
        speed.append(np.abs(stand.bodies.angular_velocity).max())
    assert speed[1] < 1e-3 * speed[0]


@pytest.mark.parametrize("shift, stands", [(0.45, True), (0.55, False)])
def test_an_overhanging_cube_stands_while_its_centre_is_supported(shift, stands):
    # Contacts are stiff, because the upper cube rests on a twentieth of its edge and an overlap must not tip it.
    stand = column(2, shift=shift, contact_time=0.2 * T_C)
    stand.advance(0.2 * T_C / 40.0, 16000)
    fell = stand.bodies.position[1, 2] < 1.4 * EDGE
    assert fell != stands


def test_a_spinning_cube_is_stopped_by_friction_of_its_face():
    """With a point contact it would spin for ever. With the limit µ F ρ it stops after I ω / (µ F ρ).

    The patch on the floor is the face, so ρ = e / √6, and I = m e² / 6.
    """
    stand = column(1)
    dt = T_C / 40.0
    stand.advance(dt, 20000)
    rate = 20.0
    stand.bodies.angular_momentum[0] += stand.bodies.inertia[0] * [0.0, 0.0, rate]
    stand.derive()
    expected = (EDGE**2 / 6.0) * rate / (0.5 * GRAVITY * EDGE / np.sqrt(6.0))
    stand.advance(dt, round(0.5 * expected / dt))
    assert stand.bodies.angular_velocity[0, 2] == pytest.approx(0.5 * rate, rel=0.05)
    # The torsional spring of the face then turns it back and forth, which its dashpot damps.
    stand.advance(dt, round(1.5 * expected / dt))
    assert abs(stand.bodies.angular_velocity[0, 2]) < 1e-2 * rate
