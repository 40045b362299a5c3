"""Piles of cubes and bricks, which stand or fall as statics requires."""

import numpy as np
import pytest

from simcore.dem.from_scene import compose
from simcore.dem.shapes.polyhedra import POLYHEDRON
from tests.helpers.hand_placed_bodies import floor_force, make_scene, place_bodies, run_watched
from tests.helpers.polyhedra import make_box

GRAVITY = 9.81
EDGE = 0.01
CONTACT_TIME = 1e-3


def pile(position, edges, contact_time=CONTACT_TIME, friction=0.5):
    """Return a process of bricks of edges (3,) or (n, 3) with centres at `position` (n, 3), where faces just touch."""
    made = make_scene(
        POLYHEDRON,
        domain={"width": 0.4},
        material={"friction": friction},
        numerics={"contact_time": contact_time},
    )
    position = np.asarray(position, float)
    edges = np.broadcast_to(edges, position.shape)
    return place_bodies(made, edges, position, bases=[make_box()])


def moved(process, start):
    """Return how far the centres have moved from `start` (n, 3), horizontally and down [m]."""
    way = process.bodies.position - start
    return np.abs(way[:, :2]).max(), (-way[:, 2]).max()


def check_it_stands(stack, start, compliance):
    """Assert that a pile has moved by less than its contacts give, is at rest, and is carried by the floor."""
    sideways, down = moved(stack, start)
    print(f"moved {sideways:.1e} m, sunk {down:.1e} m, contacts give {compliance:.1e} m")
    assert sideways < compliance and down < compliance
    assert np.abs(stack.bodies.velocity).max() < 1e-6
    assert floor_force(stack) == pytest.approx(GRAVITY * stack.bodies.mass.sum(), rel=1e-3)


def gives(made, weights):
    """Return twice the sum of static overlaps [m] of stacked contacts that carry `weights` [equal grains]."""
    return 2.0 * sum(weights) * GRAVITY / (0.5 * compose(made).law.stiffness)


@pytest.mark.parametrize("n", [2, 12])
def test_a_column_of_cubes_stands(n):
    """The lowest contact carries all cubes; in 1 s they have sunk by no more than the static overlaps."""
    start = np.column_stack([np.zeros(n), np.zeros(n), EDGE * (np.arange(n) + 0.5)])
    stack = pile(start, EDGE)
    run_watched(stack, 1.0)
    check_it_stands(stack, start, gives(stack.scene, range(1, n + 1)))


def pyramid(rows):
    """Return the centres of bricks 2 × 1 × 1 of a wall: each row has one brick less, and each brick lies on two."""
    return EDGE * np.array([[2.0 * k + row, 0.0, row + 0.5] for row in range(rows) for k in range(rows - row)])


@pytest.mark.parametrize("rows", [2, 4])
def test_a_pyramid_of_bricks_stands(rows):
    """Every centre is over the joint of two bricks below, so it stands for 1 s. Bricks of a row do not touch."""
    start = pyramid(rows)
    stack = pile(start * [1.001, 1.0, 1.0], EDGE * np.array([2.0, 1.0, 1.0]))
    start = stack.bodies.position.copy()
    run_watched(stack, 1.0)
    check_it_stands(stack, start, gives(stack.scene, range(1, 2 * rows)))


def test_a_pyramid_of_cubes_stands():
    """In layers of 3 × 3 cubes, 2 × 2 cubes and one cube, each cube lies on the corners of four."""
    start = (
        EDGE
        * 1.001
        * np.array(
            [[i + 0.5 * row, j + 0.5 * row, 0.0] for row in range(3) for i in range(3 - row) for j in range(3 - row)]
        )
    )
    start[:, 2] = EDGE * (np.repeat([0, 1, 2], [9, 4, 1]) + 0.5)
    stack = pile(start, EDGE)
    run_watched(stack, 1.0)
    check_it_stands(stack, start, gives(stack.scene, range(1, 6)))


@pytest.mark.parametrize("share, stands", [(0.9, True), (1.1, False)])
def test_the_leaning_tower_of_bricks(share, stands):
    """Bricks that overhang by 1/2, 1/4, 1/6, ... of their length, from the top, just balance.

    With nine tenths of that the tower stands, with eleven tenths it must fall. Contacts are stiff, so that overlaps do
    not tip the top brick, which rests on a tenth of its half length.
    """
    contact_time, n, length = 2e-4, 4, 2.0 * EDGE
    steps = share * 0.5 * length / np.arange(n - 1, 0, -1.0)  # from the bottom: 1/3, 1/2, 1 of the half length
    over = np.concatenate([[0.0], np.cumsum(steps)])
    start = np.column_stack([over, np.zeros(n), EDGE * (np.arange(n) + 0.5)])
    tower = pile(start, [length, EDGE, EDGE], contact_time)
    run_watched(tower, 0.4)
    sideways, down = moved(tower, start)
    print(f"moved {sideways:.1e} m, sunk {down:.1e} m")
    if stands:
        assert max(sideways, down) < 0.01 * EDGE  # it sways on its contacts, less and less
    else:
        assert down > 0.5 * EDGE


def test_bricks_set_down_exactly_touching_carry_each_other():
    """Their overlap is zero to the last digits, and in the first steps it can be rounded to 0.0 again.

    Such a contact must not be lost for millimetres: otherwise the bricks sink into each other by 0.5 mm in 0.01 s.
    """
    steps = 0.9 * EDGE / np.arange(3.0, 0.0, -1.0)
    start = np.column_stack([np.concatenate([[0.0], np.cumsum(steps)]), np.zeros(4), EDGE * (np.arange(4) + 0.5)])
    tower = pile(start, [2.0 * EDGE, EDGE, EDGE], 2e-4)
    run_watched(tower, 0.01)
    assert moved(tower, start)[1] < 1e-5


def test_a_pyramid_on_its_tip_falls():
    """With one brick, two on it and three on those, the outer bricks have nothing below their centres."""
    start = EDGE * np.array([[2.002 * k - 1.001 * row, 0.0, row + 0.5] for row in range(3) for k in range(row + 1)])
    stack = pile(start, EDGE * np.array([2.0, 1.0, 1.0]))
    run_watched(stack, 0.5)
    assert moved(stack, start)[1] > 0.5 * EDGE
    assert np.isfinite(stack.bodies.position).all()


@pytest.mark.parametrize("friction, stands", [(0.5, False), (0.65, True)])
def test_a_house_of_two_cards_stands_where_friction_holds_it(friction, stands):
    """Two plates that lean on each other at 30° to the vertical stand for µ > tan 30° = 0.577.

    By symmetry they push each other horizontally, with H = m g tan 30° / 2, which the feet hold for µ > 0.289. But the
    edge of one lies on the face of the other, whose normal is 30° off the horizontal.
    """
    length, thick, angle = 0.04, 0.001, np.pi / 6.0
    # The upper inner edges meet in the plane x = 0, and the lower outer edges are on the floor.
    reach = 0.5 * (length * np.sin(angle) + thick * np.cos(angle))
    height = 0.5 * (length * np.cos(angle) + thick * np.sin(angle))
    made = make_scene(
        POLYHEDRON, domain={"width": 0.4}, material={"friction": friction}, numerics={"contact_time": 2e-4}
    )
    turn = np.array([[np.cos(angle / 2), 0, s * np.sin(angle / 2), 0] for s in (1, -1)])
    house = place_bodies(
        made, [thick, 0.02, length], [[-reach, 0, height], [reach, 0, height]], orientation=turn, bases=[make_box()]
    )
    run_watched(house, 0.3)
    fell = house.bodies.position[:, 2].min() < 0.9 * height
    assert fell != stands
