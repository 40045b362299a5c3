"""Scenes of mixed kinds: polyhedra and ellipsoids collide by the law, and one kind alone moves as in its own scene."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from simcore.dem.forces.spring_dashpot import contact_law
from simcore.dem.shapes.polyhedra import ELLIPSOID, MIXED, POLYHEDRON, unit_sphere
from tests.helpers.polyhedra import make_box
from tests.helpers.stepped_bodies import SteppedBodies

T_C = 5e-3
NU, FRICTION = 0.22, 0.5
AXES = np.array([[1.0, 1.0, 1.0], [1.0, 0.75, 0.5], [1.6, 0.4, 0.4], [1.2, 1.2, 0.3]])
TOUCHED = {"face": [0, 0, 1], "edge": [1, 0, 1], "corner": [1, 1, 1]}


@pytest.mark.parametrize("first", ["hull", "sphere"])
@pytest.mark.parametrize("touched", TOUCHED)
@pytest.mark.parametrize("restitution", [0.1, 0.9])
def test_a_sphere_rebounds_from_a_cube(touched, first, restitution):
    """After a central impact on face, edge or corner the speed is −e times that before, to first order of the step."""
    along = np.array(TOUCHED[touched]) / np.linalg.norm(TOUCHED[touched])
    to_z = Rotation.align_vectors([[0, 0, 1.0]], [along])[0].as_quat(scalar_first=True)
    height = 0.5 * np.abs(along).sum()  # support of the unit cube
    start = height + 1.0 + 1e-3
    hull_first = first == "hull"
    pair = [[0, 0, 10.0], [0, 0, 10.0 + start if hull_first else 10.0 - start]]
    speed = np.array([[0, 0, 0.0], [0, 0, -1.0 if hull_first else 1.0]])
    bases = [make_box([1.0, 1.0, 1.0]), unit_sphere()]
    thrown = SteppedBodies(
        MIXED, contact_law(restitution, T_C, NU, FRICTION), [[1.0] * 3] * 2, pair, speed, bases=bases,
        shape=[0, 1] if hull_first else [1, 0], orientation=[to_z] * 2, patch=True,
    )  # fmt: skip
    steps = 800
    thrown.advance(T_C / steps, 3 * steps)
    velocity = thrown.bodies.velocity
    # The phase of a step at touch and release changes the speed by about 2 π / steps.
    assert velocity[1, 2] - velocity[0, 2] == pytest.approx(-restitution * speed[1, 2], abs=2.0 * np.pi / steps)
    assert thrown.bodies.mass @ velocity[:, 2] == pytest.approx(thrown.bodies.mass[1] * speed[1, 2], rel=1e-13)
    assert np.abs(velocity[:, :2]).max() < 1e-9
    assert np.abs(thrown.bodies.angular_velocity).max() < 1e-9


def test_momentum_and_angular_momentum_are_kept():
    """Boxes and ellipsoids that fly together keep both to rounding in each step."""
    rng = np.random.default_rng(1)
    bases = [make_box([1.8, 1.3, 1.0]), make_box([0.4, 0.4, 3.0]), unit_sphere()]
    n = 16
    shape = rng.integers(0, 3, n)
    scale = np.where((shape == 2)[:, None], AXES[rng.integers(0, 4, n)], 1.0)
    position = 3.3 * (np.stack(np.unravel_index(np.arange(n), (4, 2, 2)), axis=-1) - [1.5, 0.5, 0.5])
    velocity = -20.0 * position + rng.uniform(-5.0, 5.0, (n, 3))
    turns = Rotation.random(n, rng=rng).as_quat(scalar_first=True)
    cloud = SteppedBodies(
        MIXED, contact_law(0.5, T_C, NU, FRICTION), scale, position + [0, 0, 50.0], velocity,
        rng.uniform(-5.0, 5.0, (n, 3)), bases=bases, shape=shape, orientation=turns, patch=True,
    )  # fmt: skip

    def momenta():
        b = cloud.bodies
        linear = b.mass[:, None] * b.velocity
        about = np.cross(b.position - [0, 0, 50.0], linear) + b.angular_momentum
        return linear, about

    linear, about = momenta()
    kinds = np.zeros(3, int)
    for _ in range(40):
        cloud.advance(T_C / 40, 20)
        c = cloud.contacts
        smooth = (shape == 2).astype(int)
        kinds += np.bincount((smooth[c.body_a] + smooth[c.body_b])[c.touching > 0], minlength=3)
    assert (kinds > 10).all()
    after, turned = momenta()
    # Each of 800 steps rounds every body's share once or twice.
    assert np.abs((after - linear).sum(axis=0)).max() < 1e-12 * np.abs(linear).sum()
    assert np.abs((turned - about).sum(axis=0)).max() < 1e-12 * np.abs(about).sum()
    assert np.abs(after - linear).max() > 0.1 * np.abs(linear).max()


@pytest.mark.parametrize("kind", ["ellipsoids", "hulls"])
def test_one_kind_alone_steps_to_the_same_bits_as_in_its_own_scene(kind):
    rng = np.random.default_rng(2)
    n = 8
    ellipsoids = kind == "ellipsoids"
    bases = [unit_sphere()] if ellipsoids else [make_box([1.8, 1.3, 1.0]), make_box([0.4, 0.4, 3.0])]
    shape = np.zeros(n, int) if ellipsoids else rng.integers(0, 2, n)
    scale = AXES[rng.integers(0, 4, n)] if ellipsoids else np.ones((n, 3))
    position = np.column_stack([0.4 * rng.standard_normal((n, 2)), 2.0 + 3.5 * np.arange(n)])
    turns = Rotation.random(n, rng=rng).as_quat(scalar_first=True)
    ends = []
    for scene in (ELLIPSOID if ellipsoids else POLYHEDRON, MIXED):
        pile = SteppedBodies(
            scene, contact_law(0.3, T_C, NU, FRICTION), scale, position, [0, 0, -5.0], bases=bases, shape=shape,
            orientation=turns, gravity=20.0, width=4.0, patch=True,
        )  # fmt: skip
        pile.advance(T_C / 40, 20000)
        ends.append(pile.bodies)
        # They start without spin, so each has been hit.
        assert (np.abs(pile.bodies.angular_momentum).max(axis=1) > 0.0).all() and pile.on_floor().any()
    for name in ("position", "orientation", "velocity", "angular_momentum"):
        np.testing.assert_array_equal(getattr(ends[0], name), getattr(ends[1], name))
