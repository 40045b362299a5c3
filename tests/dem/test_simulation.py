"""Bodies that are placed by hand: laws of motion, contacts with forces, and what is refused."""

import inspect

import numba
import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

import simcore
from simcore.dem.from_scene import STEPS_FOR_REST
from simcore.scene.specification import resolve
from tests.helpers.few_spheres import specify_few_spheres

BALL = simcore.sphere(5e-3)
# A tetrahedron whose frame is neither at its centre of mass nor along its principal axes.
CORNERS = np.array([[0.0, 0.0, 0.0], [10e-3, 0.0, 0.0], [2e-3, 9e-3, 0.0], [1e-3, 3e-3, 14e-3]]) + 5e-3
TETRAHEDRON = simcore.convex(CORNERS)
BOX = simcore.convex([(x, y, z) for x in (-5e-3, 5e-3) for y in (-4e-3, 4e-3) for z in (-2e-3, 2e-3)])
TURNED = Rotation.from_euler("xyz", [0.3, -0.7, 1.1])
COLLISION = {"gravity": 0.0, "floor": False, "velocity": [(1.0, 0.0, 0.0), (0.0, 0.0, 0.0)]}


def collision(**settings):
    """Return a Simulation of two balls, of which the first one moves towards the second one."""
    return simcore.Simulation([BALL], [0, 0], [(0.0, 0.0, 0.0), (0.012, 0.0, 0.0)], **(COLLISION | settings))


@pytest.mark.parametrize("restitution", [0.5, 1.0])
def test_two_spheres_part_with_their_restitution(restitution):
    """The error of restitution is of first order in the time step, by which the contact begins too late."""
    errors = []
    for steps in (40, 80):
        two = collision(restitution=restitution, steps_per_contact_time=steps)
        momentum = two.mass @ two.velocity
        two.advance(0.01)
        assert two.mass @ two.velocity == pytest.approx(momentum, abs=1e-15 * momentum.max())
        parting = two.velocity[1, 0] - two.velocity[0, 0]
        errors.append(abs(parting - restitution))
        assert not len(two.contacts.body)
    assert errors[0] < 0.02 and errors[1] < 0.01


def test_a_contact_has_equal_overlap_point_and_force_from_both_sides():
    two = collision()
    while not len(two.contacts.body):
        two.advance(steps=1)
    two.advance(steps=5)
    contacts = two.contacts
    centres = two.centre_of_mass
    gap = centres[1] - centres[0]
    assert contacts.body.tolist() == [[0, 1]] and contacts.image.tolist() == [[0, 0]]
    assert contacts.overlap == pytest.approx([0.01 - gap[0]]) and contacts.normal[0] == pytest.approx([1.0, 0.0, 0.0])
    assert contacts.point[0] == pytest.approx(centres.mean(axis=0)) and contacts.force[0, 0] > 0.0
    assert two.energy.springs > 0.0 and two.energy.height == 0.0


def test_reading_and_dividing_the_steps_change_no_bit():
    whole, parts = collision(), collision()
    whole.advance(steps=400)
    for _ in range(40):
        parts.advance(steps=10)
        assert parts.energy.total > 0.0 and len(parts.contacts.body) in (0, 1)
    assert (whole.position == parts.position).all() and (whole.velocity == parts.velocity).all()
    assert whole.steps == parts.steps == 400 and whole.time == pytest.approx(0.01)


def test_a_polyhedron_moves_about_its_centre_of_mass_and_principal_axes():
    """The expected mass, centre and inertia are those of trimesh."""
    spin = np.array([3.0, 20.0, 5.0])
    start = np.array([0.1, 0.2, 0.5])
    one = simcore.Simulation(
        [TETRAHEDRON],
        [0],
        [start],
        orientation=TURNED.as_quat(scalar_first=True),
        angular_velocity=spin,
        density=2000.0,
    )
    hull = trimesh.Trimesh(TURNED.apply(CORNERS) + start, trimesh.convex.convex_hull(CORNERS).faces).convex_hull
    hull.density = 2000.0
    assert one.mass == pytest.approx([hull.mass]) and one.centre_of_mass[0] == pytest.approx(hull.center_mass)
    assert one.position[0] == pytest.approx(start) and one.orientation[0] == pytest.approx(
        TURNED.as_quat(scalar_first=True)
    )
    angular_momentum = hull.moment_inertia @ spin
    fallen = 0.5 * hull.mass * (0.5 * one.time_step * 9.81) ** 2  # of the half step by which velocities are advanced
    assert one.energy.motion == pytest.approx(0.5 * spin @ angular_momentum + fallen)
    total = one.energy.total
    one.advance(0.05)
    assert one.energy.total == pytest.approx(total, rel=1e-9)
    assert one.centre_of_mass[0] == pytest.approx(hull.center_mass - [0.0, 0.0, 0.5 * 9.81 * 0.05**2], abs=1e-5)
    turned = Rotation.from_quat(one.orientation[0], scalar_first=True) * TURNED.inv()
    inertia = turned.as_matrix() @ hull.moment_inertia @ turned.as_matrix().T
    assert inertia @ one.angular_velocity[0] == pytest.approx(angular_momentum, rel=1e-9)


def test_boxes_come_to_rest_on_the_floor_and_on_each_other():
    two = simcore.Simulation([BOX], [0, 0], [(0.0, 0.0, 2.2e-3), (1e-3, 0.0, 6.6e-3)], contact_time=2e-4)
    two.advance(0.2)
    contacts = two.contacts
    assert two.energy.motion < 1e-12 and np.abs(two.orientation[:, 0]) == pytest.approx(1.0, abs=1e-4)
    on_floor = contacts.body[:, 1] == -1
    assert -contacts.force[on_floor, 2].sum() == pytest.approx(9.81 * two.mass.sum(), rel=1e-3)
    between = (contacts.body == [0, 1]).all(axis=1)
    assert contacts.force[between, 2].sum() == pytest.approx(9.81 * two.mass[1], rel=1e-3)


def test_a_position_that_becomes_infinite_is_an_error():
    fast = simcore.Simulation([BALL], [0], [(0.0, 0.0, 0.1)], velocity=(1.7e308, 0.0, 0.0), contact_time=1e3)
    with pytest.raises(FloatingPointError, match="position of body 0 is not finite, or beyond 1e.09 m, after step"):
        fast.advance(1e4)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"shapes": [BALL.base]}, r"shapes\[0\] is a Base; make shapes with simcore.sphere"),
        ({"shapes": []}, "shapes is empty"),
        ({"shapes": None}, "shapes is None; give a list"),
        ({"shape": [[0], [0, 0]]}, "shape has rows of different length"),
        ({"contact_time": 1e-300}, r"contact_time is 1e-300; give a number in \[1e-12, 1e\+09\]"),
        ({"contact_time": 1e200}, r"contact_time is 1e\+200; give a number in"),
        ({"steps_per_contact_time": 1e300}, r"steps_per_contact_time is 1e\+300; give a number in"),
        ({"floor": "no"}, "floor is 'no'; give True or False"),
        ({"position": [(0.0, 0.0, 1.0), (0.0, 2e9, 2.0)]}, r"position of body 1 is .* within 1e\+09 m of the origin"),
        ({"position": [(3e7, 0.0, 1.0), (0.0, 0.0, 2.0)], "width": 0.02}, r"position of body 0 is .* within 2e\+07 m"),
        (
            {"width": 1e-6},
            r"body 0 overlaps its own periodic image, because width is only 1e-06 m, but the body is 0\.01",
        ),
        ({"shape": [0, -1]}, "shape of body 1 is -1; give an index from 0 to 0"),
        ({"shape": [0.0, 0.7]}, r"shape has the form \(2,\) and the type float64"),
        ({"shape": []}, r"shape has the form \(0,\)"),
        ({"position": (0.0, 0.0, 1.0)}, r"position has the form \(3,\); give \(2, 3\)\."),
        ({"position": [(0.0, 0.0, 1.0), (0.0, np.nan, 2.0)]}, "position of body 1 is .*nan.*; give finite numbers"),
        ({"position": [(0.0, 0.0, 1.0), ("a", 0.0, 2.0)]}, "position is .*; give numbers"),
        ({"velocity": [(0.0, 0.0)]}, r"velocity has the form \(1, 2\); give \(2, 3\), or \(3,\) for all bodies"),
        ({"orientation": (0.0, 0.0, 0.0, 0.0)}, "orientation of body 0 is zero"),
        ({"density": -2650.0}, r"density is -2650.0; give a number in \(0, inf\), in SI units"),
        ({"density": "2650 kg/m3"}, "density is '2650 kg/m3'"),
        ({"restitution": 0.0}, r"restitution is 0.0; give a number in \(0, 1\]"),
        ({"contact_time": -1e-3}, "contact_time is -0.001"),
        ({"steps_per_contact_time": 1}, "steps_per_contact_time = 1 is unstable .* give at least"),
        ({"width": 0.0}, "width is 0.0"),
        ({"width": 0.1, "cylinder_radius": 0.1}, "width and cylinder_radius are both given"),
        ({"polyhedron_contact": "corner"}, "give 'patch' or 'point'"),
    ],
)
def test_wrong_input_names_the_argument_and_the_body(changed, message):
    given = {"shapes": [BALL], "shape": [0, 0], "position": [(0.0, 0.0, 1.0), (0.0, 0.0, 2.0)]} | changed
    with pytest.raises(ValueError, match=message):
        simcore.Simulation(given.pop("shapes"), given.pop("shape"), given.pop("position"), **given)


def test_bodies_that_overlap_or_lie_below_the_floor_are_refused():
    with pytest.raises(ValueError, match=r"body 0 overlaps body 1 by 0\.002 m at the start"):
        simcore.Simulation([BALL], [0, 0], [(0, 0, 0), (8e-3, 0, 0)], gravity=0, floor=False)
    with pytest.raises(ValueError, match=r"body 0 overlaps the floor by 0\.0019 m"):
        simcore.Simulation([BOX], [0], [(0.0, 0.0, 1e-4)])
    with pytest.raises(ValueError, match=r"centre of mass of body 1 is at z = -0\.001 m"):
        simcore.Simulation([BOX], [0, 0], [(0.0, 0.0, 5e-3), (0.0, 0.0, -1e-3)])
    rod = simcore.convex([(x, y, z) for x in (0, 0.02) for y in (0, 2e-3) for z in (0, 2e-3)])
    with pytest.raises(ValueError, match=r"body 0 overlaps its own periodic image by .* width is only 0\.008 m\. Give"):
        simcore.Simulation([rod], [0], [(0.0, 0.0, 0.1)], width=8e-3)
    with pytest.raises(ValueError, match=r"body 0 is 0\.05 m from the z axis, but cylinder_radius is 0\.04 m\. Place"):
        simcore.Simulation([BALL], [0], [(0.05, 0.0, 0.1)], cylinder_radius=0.04)
    with pytest.raises(ValueError, match=r"overlaps the cylinder by .* wider than the cylinder needs a larger"):
        simcore.Simulation([BALL], [0], [(0.0, 0.0, 0.1)], cylinder_radius=0.004)
    plate = simcore.convex([(x, y, z) for x in (0, 0.02) for y in (0, 0.02) for z in (0, 0.5e-3)])
    with pytest.raises(ValueError, match=r"body 0 overlaps body 1 by 0\.0005 m at the start"):
        simcore.Simulation([plate], [0, 0], [(0.0, 0.0, 0.05)] * 2, gravity=0.0)


def test_a_contact_that_is_too_soft_for_a_weight_or_a_speed_is_an_error():
    """A ball presses three small ones of 1/8000 of its mass flat; at 100 m/s two balls pass through each other."""
    ring = [(4e-3 * np.cos(t), 4e-3 * np.sin(t), 1e-3) for t in 2 * np.pi * np.arange(3) / 3]
    balls, places = [simcore.sphere(20e-3), simcore.sphere(1e-3)], [(0, 0, 0.0216257), *ring]
    with pytest.raises(FloatingPointError, match=r"only 0\.002 m thick.*Give a contact_time that is . times shorter"):
        simcore.Simulation(balls, [0, 1, 1, 1], places).advance(0.1)
    stiff = simcore.Simulation(balls, [0, 1, 1, 1], places, contact_time=1e-4)
    stiff.advance(0.02)
    assert stiff.position[0, 2] > 0.0215
    with pytest.raises(FloatingPointError, match="body 0 overlaps body 1 by"):
        collision(velocity=[(100.0, 0.0, 0.0), (0.0, 0.0, 0.0)]).advance(0.01)


@pytest.mark.parametrize(("radius", "speed"), [(5e-3, 250.0), (5e-5, 4.0), (5e-5, 8.0)])
@pytest.mark.parametrize("phase", np.linspace(0.0, 1.0, 5))
def test_fast_bodies_do_not_pass_through_each_other_unnoticed(radius, speed, phase):
    """In a step of 25 µs the balls move by 0.6, 1 and 2 diameters, so that few steps or none have an overlap."""
    start = [(0.0, 0.0, 0.0), (0.0, 0.0, 4.0 * radius + phase * 25e-6 * speed)]
    with pytest.raises(FloatingPointError, match="may pass through each other unnoticed|body 0 overlaps body 1 by"):
        simcore.Simulation(
            [simcore.sphere(radius)], [0, 0], start, velocity=[(0, 0, 0), (0, 0, -speed)], gravity=0.0, floor=False
        ).advance(1e-3)


@pytest.mark.parametrize("share", [0.1, 0.3, 0.5, 0.7, 0.9, 1.5])
@pytest.mark.parametrize("gap", [1.0, 1.007, 1.013, 1.019])
def test_bodies_that_meet_head_on_do_not_pass_through_each_other_unnoticed(share, gap):
    """share: of the speed at which each moves by its diameter in a step of 25 µs."""
    speed = share * 0.02 / 25e-6
    with pytest.raises(FloatingPointError, match="may pass through each other unnoticed|body 0 overlaps body 1 by"):
        simcore.Simulation(
            [simcore.sphere(0.01)], [0, 0], [(-0.5 * gap, 0, 0), (0.5 * gap, 0, 0)],
            velocity=[(speed, 0, 0), (-speed, 0, 0)], gravity=0.0, floor=False,
        ).advance(2.0 * gap / speed)  # fmt: skip


def test_a_thin_plate_that_flies_past_the_reach_of_its_list_is_not_missed():
    """Candidate pairs are listed for a tenth of a radius, which is a hundred times the thickness of these plates."""
    plate = simcore.convex([(x, y, z) for x in (-0.1, 0.1) for y in (-0.1, 0.1) for z in (-5e-5, 5e-5)])
    start, velocity = [(0.0, 0.0, 0.0), (0.0, 0.0, 4e-3)], [(0.0, 0.0, 0.0), (0.0, 0.0, -1.5)]
    with pytest.raises(FloatingPointError, match="body . overlaps body . by"):
        simcore.Simulation([plate], [0, 0], start, velocity=velocity, gravity=0.0, floor=False).advance(0.01)


def test_one_body_alone_may_be_as_fast_as_it_is():
    ball = simcore.Simulation([BALL], [0], [(0, 0, 0)], velocity=(500.0, 0, 0), gravity=0.0, floor=False)
    ball.advance(0.01)
    assert ball.position[0, 0] == pytest.approx(5.0)


def test_bodies_that_gain_energy_are_an_error():
    """Plates with corners far from their centre need more steps than two bodies that pinch a third one."""
    plate = simcore.convex([(x, y, z) for x in (-3e-3, 3e-3) for y in (-3e-3, 3e-3) for z in (-1e-3, 1e-3)])
    pile = [(0.0, 0.0, 1e-3 + 2e-3 * k) for k in range(4)]
    with pytest.raises(FloatingPointError, match="have gained .* J of energy.*Give more steps_per_contact_time"):
        simcore.Simulation([plate], [0] * 4, pile, steps_per_contact_time=6).advance(0.5)
    at_rest = simcore.Simulation([plate], [0] * 4, pile, steps_per_contact_time=14)
    at_rest.advance(0.1)
    assert at_rest.position[:, 2] == pytest.approx([z for _, _, z in pile], abs=2e-5)


@pytest.mark.parametrize("tilt", [0.003, 0.03, 0.1, 0.3])
def test_an_elastic_box_that_lands_on_the_floor_nearly_keeps_its_energy(tilt):
    """The error is that of the patch, which is the same with shorter steps; the check of the energy stays silent."""
    turn = Rotation.from_rotvec([tilt, 0.4 * tilt, 0.0]).as_quat(scalar_first=True)
    cube = simcore.convex([(x, y, z) for x in (-5e-3, 5e-3) for y in (-5e-3, 5e-3) for z in (-5e-3, 5e-3)])
    still = {"gravity": 0.0, "restitution": 1.0, "friction": 0.0, "velocity": (0.0, 0.0, -1.0)}
    box = simcore.Simulation([cube], [0], [(0.0, 0.0, 12e-3)], orientation=turn, **still)
    before = box.energy.total
    box.advance(0.02)
    assert not len(box.contacts.body) and box.energy.total == pytest.approx(before, rel=0.1)


def test_values_are_read_only_and_times_may_differ_by_rounding():
    ball = simcore.Simulation([BALL], [0], [(0.0, 0.0, 0.1)], orientation=(1e-200, 0.0, 0.0, 1e-200))
    for name in ("position", "orientation", "centre_of_mass", "velocity", "angular_velocity", "mass"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(ball, name)[0] = 1.0
    assert not ball.contacts.force.flags.writeable
    ball.advance(-1e-9 * ball.time_step)
    assert ball.steps == 0
    with pytest.raises(ValueError, match="duration is -0.001"):
        ball.advance(-1e-3)


def test_one_body_may_touch_the_cylinder():
    ball = simcore.Simulation([simcore.sphere(5e-3)], [0], [(45.1e-3, 0.0, 0.1)], cylinder_radius=0.05, gravity=0.0)
    assert ball.contacts.body.tolist() == [[0, -2]]
    np.testing.assert_allclose(ball.contacts.overlap, 0.1e-3, rtol=1e-9)


def test_the_defaults_are_those_of_a_packing():
    specification = resolve(specify_few_spheres())
    material = specification["material"]
    defaults = {name: value.default for name, value in inspect.signature(simcore.Simulation).parameters.items()}
    for name in ("density", "restitution", "friction", "poisson_ratio", "gravity"):
        assert defaults[name] == material[name], name
    assert defaults["steps_per_contact_time"] == STEPS_FOR_REST["explicit"]
    assert defaults["polyhedron_contact"] == specification["numerics"]["polyhedron_contact"]


def test_more_threads_than_at_its_start_have_working_memory(monkeypatch):
    """`pack` sets the number of threads of the whole process."""
    monkeypatch.setattr(numba.config, "NUMBA_NUM_THREADS", 3)
    simulation = simcore.Simulation([TETRAHEDRON], [0], [[0.0, 0.0, 0.1]])
    assert simulation._workspace.mark.shape[0] == 3


def test_threads_have_working_memory_if_their_number_is_changed_after_numba_is_imported(monkeypatch):
    """numba then launches the former number, and would write beyond the memory of the new one."""
    monkeypatch.setattr(numba.config, "NUMBA_NUM_THREADS", 1)
    monkeypatch.setattr(numba, "get_num_threads", lambda: 3)
    simulation = simcore.Simulation([TETRAHEDRON], [0], [[0.0, 0.0, 0.1]])
    assert simulation._workspace.mark.shape[0] == 3


def test_advance_takes_a_duration_or_steps():
    two = collision()
    two.advance(0.0)
    two.advance(steps=np.int64(0))
    assert two.steps == 0
    for wrong in ({}, {"duration": 1.0, "steps": 3}, {"steps": 2.5}, {"steps": -1}, {"duration": -1.0}):
        with pytest.raises(ValueError, match="advance: |duration is -1"):
            two.advance(**wrong)
    two.advance(1.01 * two.time_step)
    assert two.steps == 2
