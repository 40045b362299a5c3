"""The cylinder's axis and its edge with the floor, and periodic boxes narrower than their grains."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from simcore.campaign.studies import merge
from simcore.dem.from_scene import compose
from simcore.dem.shapes.polyhedra import ELLIPSOID, POLYHEDRON, SPHERE
from simcore.packing.process import pack
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve
from tests.helpers.hand_placed_bodies import SPECIFICATION, floor_force, make_scene, place_bodies, run_watched
from tests.helpers.polyhedra import make_box

GRAVITY = 9.81
R = 3e-3
CONTACT_TIME = 5e-4


def tube(width, kind=None, **groups):
    return make_scene(
        SPHERE if kind is None else kind, domain={"type": "cylinder", "width": width},
        numerics={"contact_time": CONTACT_TIME}, **groups,
    )  # fmt: skip


def test_a_sphere_on_the_axis_of_a_cylinder_stays_there():
    """By symmetry it stays there to the bit, also if it nearly fills the cylinder and is near the wall all round."""
    for width in (2.000001 * R, 10 * R):
        ball = place_bodies(tube(width), R, [0, 0, 3 * R])
        run_watched(ball, 0.3, damped=True)
        assert not ball.bodies.position[0, :2].any()
        assert R - ball.bodies.position[0, 2] == pytest.approx(GRAVITY / compose(ball.scene).law.stiffness, rel=1e-4)


def test_a_sphere_too_wide_for_its_cylinder_is_squeezed_but_finite():
    """It overlaps the wall all round. On the axis no direction is special, and its position must stay finite."""
    ball = place_bodies(tube(1.99 * R), R, [0, 0, R])
    run_watched(ball, 0.05, damped=True)
    assert np.isfinite(ball.bodies.position).all()
    assert np.hypot(*ball.bodies.position[0, :2]) < 0.02 * R


@pytest.mark.parametrize("ratio", [1.2, 1.6, 2.0])
def test_a_cylinder_narrower_than_two_grains_is_filled(ratio):
    """No lattice site is inside; grains are inserted on the axis and form a column or a zigzag."""
    raw = {
        "name": "tube",
        "domain": {"type": "cylinder", "width": f"{7.0 * ratio} mm", "height": "0.3 m"},
        "shapes": {"kind": "sphere"},
        "sizes": {"bounds": ["7 mm", "7.001 mm"], "mass_fractions": [1.0]},
        "amount": {"grains": 12},
        "shaking": {"duration": "0.05 s"},
        "numerics": {"contact_time": "1 ms"},
    }
    made = set_up(resolve(raw), None)
    packed = pack(made.scene, made.bases, made.draw)
    position = packed.bodies.position
    assert len(position) == 12
    # Friction wedges grains between the walls, so that some of the overlap from their fall remains.
    pressed = packed.walls.overlap[packed.walls.touching > 0].max()
    assert pressed < 0.02 * 3.5e-3
    assert np.hypot(*position[:, :2].T).max() < 3.5e-3 * (ratio - 1.0) + pressed + 1e-6  # sizes are up to 7.001 mm
    # Neighbours along the column touch: their rise follows from the width if they lean on opposite sides.
    rise = np.diff(np.sort(position[:, 2]))
    across = 7e-3 * (ratio - 1.0)
    assert rise.max() < 7.01e-3 and rise.min() > 0.99 * np.sqrt(7e-3**2 - min(across, 7e-3) ** 2) - 1e-4


@pytest.mark.parametrize("angle", [0.0, 1.0, 2.5])
def test_a_sphere_thrown_into_the_edge_of_a_cylinder_comes_to_rest_beside_it(angle):
    """It hits wall and floor at once, only loses energy, and ends inside the cylinder, for any direction."""
    radius = 5 * R
    out = np.array([np.cos(angle), np.sin(angle), 0.0])
    ball = place_bodies(tube(2 * radius), R, (radius - 1.2 * R) * out + [0, 0, 1.2 * R], velocity=out - [0, 0, 1])
    energies = run_watched(ball, 1.5, damped=True)
    assert (np.diff(energies) < 1e-6 * energies[0]).all()
    assert np.hypot(*ball.bodies.position[0, :2]) < radius - R * (1.0 - 1e-3)
    assert R - ball.bodies.position[0, 2] == pytest.approx(GRAVITY / compose(ball.scene).law.stiffness, rel=1e-3)


def test_a_ring_of_spheres_leans_on_the_cylinder():
    """Six spheres on the floor touch the wall, and two fall on their middle: all stay inside, carried by the floor."""
    radius = 3.05 * R
    turn = np.arange(6) * np.pi / 3.0
    low = np.column_stack([(radius - R) * np.cos(turn), (radius - R) * np.sin(turn), np.full(6, R)])
    made = tube(2.0 * radius)
    bed = place_bodies(made, R, np.vstack([low, [[0, 0, 3.0 * R]], [[0.3 * R, 0, 6.0 * R]]]))
    energies = run_watched(bed, 1.0, damped=True)
    assert (np.diff(energies) < 1e-6 * energies[0]).all()
    assert np.hypot(*bed.bodies.position[:, :2].T).max() < radius - R * (1.0 - 1e-3)
    assert floor_force(bed) == pytest.approx(GRAVITY * bed.bodies.mass.sum(), rel=1e-2)


@pytest.mark.extremes
@pytest.mark.parametrize("kind", ["hull", "ellipsoid"])
def test_a_needle_falls_across_a_cylinder_shorter_than_it(kind):
    """A needle of 1.2 diameters leans between floor and wall or both walls: it comes to rest inside the cylinder."""
    width, length, thick = 0.02, 0.024, 0.002
    tilt = np.radians(50.0)
    edges = np.array([length, thick, thick])
    made = tube(width, POLYHEDRON if kind == "hull" else ELLIPSOID)
    reach = 0.5 * length * np.sin(tilt) + thick
    grain = place_bodies(
        made, [edges if kind == "hull" else 0.5 * edges], [0, 0, reach + 1e-3],
        orientation=Rotation.from_rotvec([0.0, tilt, 0.0]).as_quat(scalar_first=True),
        bases=[make_box()] if kind == "hull" else None,
    )  # fmt: skip
    energies = run_watched(grain, 2.0, damped=True)
    assert (np.diff(energies) < 1e-6 * energies[0]).all()
    assert np.abs(grain.bodies.velocity).max() < 5e-3
    long_axis = Rotation.from_quat(grain.bodies.orientation[0], scalar_first=True).apply([1.0, 0.0, 0.0])
    for end in (-0.5, 0.5):
        tip = grain.bodies.position[0] + end * (length - thick) * long_axis
        assert np.hypot(tip[0], tip[1]) < 0.5 * width
        assert tip[2] > -0.1 * thick


def test_a_sphere_wider_than_its_box_presses_on_its_own_images():
    """The forces from its images along x and y cancel, so it falls and rests like a single sphere."""
    width = 2.0 * R * (1.0 - 2.0**-10)
    ball = place_bodies(
        make_scene(domain={"width": width}, numerics={"contact_time": CONTACT_TIME}), R, [0, 0, 1.5 * R]
    )
    run_watched(ball, 0.3, damped=True)
    assert sorted(map(tuple, ball.contacts.image[ball.contacts.touching > 0])) == [(0, 1), (1, 0)]
    np.testing.assert_allclose(ball.contacts.overlap[ball.contacts.touching > 0], 2.0 * R - width, rtol=1e-12)
    assert not ball.bodies.position[0, :2].any() and not ball.bodies.angular_momentum.any()
    assert R - ball.bodies.position[0, 2] == pytest.approx(GRAVITY / compose(ball.scene).law.stiffness, rel=1e-4)


def test_a_pair_touches_through_two_images():
    """Two spheres fill the period in x: each touches the other on both sides, with equal forces."""
    width = 4.0 * R * (1.0 - 2.0**-10)
    made = make_scene(domain={"width": width}, numerics={"contact_time": CONTACT_TIME})
    pair = place_bodies(made, R, [[0, 0, R], [0.5 * width, 0, R]])
    run_watched(pair, 0.2, damped=True)
    contacts = pair.contacts
    touching = contacts.touching > 0
    assert sorted(map(tuple, contacts.image[touching])) == [(-1, 0), (0, 0)]
    np.testing.assert_allclose(contacts.overlap[touching], 2.0 * R - 0.5 * width, rtol=1e-9)
    np.testing.assert_allclose(contacts.force[touching][:, 0].sum(), 0.0, atol=1e-9 * np.abs(contacts.force).max())
    np.testing.assert_allclose(pair.bodies.position[:, 0], [0.0, 0.5 * width], atol=1e-12)


def test_needles_longer_than_their_box_are_packed_in_it():
    """Needles of 22 mm are inserted upright into a box of 16 mm and fall over; one touches its own image.

    The floor carries them at rest, and no overlap is more than a hundredth of a needle's thickness.
    """
    changes = {
        "domain": {"width": "16 mm"},
        "shapes": {"kind": "ellipsoid", "choice": "form", "flatness": 0.9, "elongation": 0.25},
        "amount": {"grains": 8},
    }
    made = set_up(resolve(merge(SPECIFICATION, changes)), lambda group: [])
    done = pack(made.scene, made.bases, made.draw)
    length, thickness = 2.0 * done.bodies.scale.max(), 2.0 * done.bodies.scale.min()
    assert length > 0.02
    assert done.observation.max_overlap < 0.01 * thickness
    floor = done.walls.force[done.walls.touching > 0, 2].sum()
    assert floor == pytest.approx(GRAVITY * done.bodies.mass.sum(), rel=0.02)
    bodies = np.column_stack([done.contacts.body_a, done.contacts.body_b])[done.contacts.touching > 0]
    print(f"{len(bodies)} contacts, {(bodies[:, 0] == bodies[:, 1]).sum()} with an own image")
    assert len(bodies) > len(np.unique(bodies, axis=0)) or (bodies[:, 0] == bodies[:, 1]).any()


@pytest.mark.parametrize("kind", ["sphere", "hull", "ellipsoid"])
def test_a_narrow_box_is_what_many_copies_side_by_side_are(kind):
    """Three grains wider than their periodic box have the forces and torques of 7 × 7 copies in a wide box.

    Grains are up to 2.5 periods long. The contacts are the same pairs at other places, so results agree to rounding.
    """
    width, copies = 4e-3, 7
    rng = np.random.default_rng(3)
    if kind == "sphere":
        scale = np.array([[2.3e-3] * 3, [2.1e-3] * 3, [1.2e-3] * 3])
    else:
        scale = np.array([[10e-3, 0.8e-3, 0.6e-3], [6e-3, 2e-3, 1e-3], [2e-3, 2e-3, 2e-3]])
        scale = scale if kind == "hull" else scale * [[0.5], [0.8], [0.8]]
    turns = Rotation.random(3, rng=rng).as_quat(scalar_first=True)
    # One needle is turned along (3, 1) of the lattice, so that it passes its own images at a small gap.
    turns[0] = Rotation.from_rotvec([0.0, 0.0, np.arctan(1.0 / 3.0)]).as_quat(scalar_first=True)
    position = np.column_stack([rng.uniform(0.0, width, (3, 2)), [2.2e-3, 3.4e-3, 5.0e-3]])
    velocity, spin = 0.01 * rng.standard_normal((3, 3)), rng.standard_normal((3, 3))
    which = {"sphere": SPHERE, "hull": POLYHEDRON, "ellipsoid": ELLIPSOID}[kind]
    bases = [make_box()] if kind == "hull" else None

    def put(width, position, repeats):
        made = make_scene(which, domain={"width": width}, numerics={"contact_time": CONTACT_TIME})
        process = place_bodies(
            made, np.tile(scale, (repeats, 1)), position, np.tile(velocity, (repeats, 1)), np.tile(spin, (repeats, 1)),
            np.tile(turns, (repeats, 1)), bases,
        )  # fmt: skip
        process.evaluate()
        torque = np.zeros((3 * repeats, 3))
        np.add.at(torque, process.contacts.body_a, process.contacts.torque_a)
        np.add.at(torque, process.contacts.body_b, process.contacts.torque_b)
        return process, process.bodies.net_force, torque

    shifts = [(0, 0)] + [
        (x, y) for x in range(-(copies // 2), copies // 2 + 1) for y in range(-(copies // 2), copies // 2 + 1) if x or y
    ]
    narrow, force, torque = put(width, position, 1)
    spread = np.concatenate([position + width * np.array([x, y, 0.0]) for x, y in shifts])
    _, all_force, all_torque = put(100.0, spread, len(shifts))
    touching = narrow.contacts.touching > 0
    keys = list(zip(narrow.contacts.body_a[touching], narrow.contacts.body_b[touching], strict=True))
    assert len(keys) > len(set(keys)), "no pair touches through two images: the case shows nothing"
    largest = np.abs(narrow.contacts.force).max()
    np.testing.assert_allclose(force, all_force[:3], atol=1e-9 * largest)
    np.testing.assert_allclose(torque, all_torque[:3], atol=1e-9 * largest * 5e-3)
