"""Hertzian scenes: the law at an overlap, the limits of the time step, and rejected combinations of keys."""

import re

import numpy as np
import pytest

from simcore.dem.energy import spring_energy
from simcore.dem.forces.hertz import STORED, law_at, linear_law, local_law
from simcore.dem.forces.spring_dashpot import normal_force
from simcore.dem.forces.viscous_friction import CAPPED, NONE, VISCOUS
from simcore.dem.from_scene import compose
from simcore.dem.stability import body_steps, contact_load, longest_stable_step, stiffest_body
from simcore.packing.expectation import depth_of_impact, expect, overlap_at_rest
from simcore.packing.explanation import explain
from simcore.packing.packed import DAMPING
from simcore.packing.process import Process
from simcore.scene.impact import sphere_radius
from tests.helpers.few_spheres import set_up_few_spheres

HERTZ = {"law": "hertz", "youngs_modulus": "2 MPa", "end_of_contact": "clamped"}
# It is shaken, so that it uses the compiled step of tests/physics/test_hertz.py.
DEPOSIT = {
    "material": {**HERTZ, "friction_law": "dynamic"},
    "generation": {"placement": "random", "batch_grains": 12, "drop_height": "4 mm"},
    "convergence": {"rule": "settled"},
    "damping": {"factor": 1},
}


def scene(**material):
    return set_up_few_spheres(material={**HERTZ, **material}).scene


def test_the_linear_law_at_an_overlap_gives_the_hertzian_force():
    law, masses, overlap, speed = compose(scene()).law, (3e-4, 1e-4), 2e-5, -0.3
    radii = sphere_radius(np.array(masses), 2650.0)
    for partner, mass, radius in (
        (masses[1], np.prod(masses) / sum(masses), np.prod(radii) / sum(radii)),
        (np.inf, masses[0], radii[0]),
    ):
        at = law_at.py_func(law, masses[0], partner, overlap)
        k = law.modulus * np.sqrt(radius)
        push = normal_force.py_func(at, at.damping, mass, overlap, speed, False)
        assert push == pytest.approx(k * (overlap**1.5 - law.damping_time * np.sqrt(overlap) * speed), rel=1e-12)
        # The stiffness for small motions is the slope of this force; the tangential one is Mindlin's share of it.
        small, step = linear_law(law, masses[0], partner, overlap), 1e-6 * overlap
        slope = (k * (overlap + step) ** 1.5 - k * (overlap - step) ** 1.5) / (2.0 * step)
        assert small.stiffness * mass == pytest.approx(slope, rel=1e-6)
        kappa = 2.0 * (1.0 - 0.22) / (2.0 - 0.22)
        assert at.tangential * at.stiffness == pytest.approx(kappa * small.stiffness, rel=1e-12)
        assert small.tangential * small.stiffness == pytest.approx(kappa * small.stiffness, rel=1e-12)
        at, share = local_law(law, masses[0], partner, overlap)
        assert share == STORED
        assert share * 0.5 * at.stiffness * mass * overlap**2 == pytest.approx(0.4 * k * overlap**2.5, rel=1e-12)


def test_the_linear_law_is_its_own():
    law = compose(set_up_few_spheres().scene).law
    assert local_law(law, 1.0, 2.0, 1e-5) == (law, 1.0)


def test_a_scene_has_the_friction_that_its_material_names():
    def features(**material):
        found = compose(set_up_few_spheres(material=material).scene).features
        return found.hertz, found.friction, found.sliding

    def preloaded(**changes):
        found = compose(set_up_few_spheres(**changes).scene).features
        return found.friction, found.preloaded

    assert features() == (False, True, NONE)
    assert features(**HERTZ) == (True, True, NONE)
    assert features(**HERTZ, friction_law="dynamic") == (True, False, CAPPED)
    assert features(friction_law="viscous", friction=0) == (False, False, VISCOUS)
    assert features(friction_law="dynamic", friction=0) == (False, False, NONE)
    law = {"friction_law": "preloaded"}
    assert preloaded() == (True, False)
    assert preloaded(material=law) == (True, True)
    assert preloaded(material=law, numerics={"dashpot": "implicit"}) == (True, True)
    assert preloaded(material={**law, "friction": 0}) == (False, False)
    assert compose(scene(friction_law="dynamic", sliding_time="2 ms")).law.sliding == 500.0
    assert compose(scene()).law.sliding == 0.0


def test_the_contact_time_is_that_of_the_smallest_grains():
    made = set_up_few_spheres(material=HERTZ)
    found = made.scene.hertzian
    assert made.scene.numerics.contact_time == found.duration
    # The smallest grain that the sieve curve allows, whatever is drawn.
    assert found.least_mass == pytest.approx(2650.0 * np.pi / 6.0 * made.curve.least**3, rel=1e-12)
    # Two grains have half the mass and half the radius of a grain at a wall, and the depth scales as (m / √R)^0.4, so
    # it is smaller by 0.5^0.2.
    against_wall = depth_of_impact(made.scene, expect(made.scene, made.bases, made.draw).fall_speed, found.least_mass)
    assert found.deepest == pytest.approx(against_wall * 0.5**0.2, rel=1e-12)


def test_stiffer_and_faster_scenes_take_shorter_steps():
    """The contact time scales as (m² / k²)^(1/5) v^(-1/5)."""
    soft, stiff = scene(), scene(youngs_modulus="20 MPa")
    assert stiff.numerics.time_step / soft.numerics.time_step == pytest.approx(10.0**-0.4, rel=1e-9)
    tall = set_up_few_spheres(
        material=HERTZ, domain={"height": "2 m"}, generation={"velocity_z": "0 m/s", "velocity_horizontal": "0 m/s"}
    )
    low = set_up_few_spheres(material=HERTZ, generation={"velocity_z": "0 m/s", "velocity_horizontal": "0 m/s"})
    assert tall.scene.numerics.time_step / low.scene.numerics.time_step == pytest.approx(10.0**-0.1, rel=1e-9)


def test_a_pinched_grain_sets_the_least_steps_and_fewer_are_refused():
    made = scene()
    law = linear_law(compose(made).law, made.hertzian.least_mass, made.hertzian.least_mass, made.hertzian.deepest)
    assert compose(made).continuous_law == law
    needed = made.numerics.contact_time / longest_stable_step(law, False)
    assert compose(made).least_steps == needed
    # This is Jury's condition for semi-implicit Euler; two contacts double the matrix.
    h = made.numerics.contact_time / needed
    assert 2.0 * (h**2 * law.stiffness + 2.0 * h * law.damping) == pytest.approx(4.0, rel=1e-9)
    with pytest.raises(ValueError, match=rf"at least {needed:.2f} steps are needed"):
        compose(set_up_few_spheres(material=HERTZ, numerics={"steps_per_contact_time": 0.99 * needed}).scene)


def test_a_bed_is_expected_to_need_what_its_weight_calls_for():
    made = set_up_few_spheres(material={**HERTZ, "restitution": 1})
    scene_, drawn = made.scene, made.draw(np.arange(40))
    rest = overlap_at_rest(scene_, made.bases, drawn)
    assert 0.0 < rest < scene_.hertzian.deepest
    heavy = set_up_few_spheres(material={**HERTZ, "restitution": 1}, amount={"grains": 40 * 8})
    assert overlap_at_rest(heavy.scene, heavy.bases, heavy.draw(np.arange(40))) > 3.0 * rest  # 8^(2/3) of other grains
    stability = expect(scene_, made.bases, made.draw).stability
    assert compose(scene_).least_steps <= stability.expected < stability.cautious


@pytest.fixture(scope="module")
def deposit():
    """Return a process of randomly inserted, shaken grains some time after the last insertion, and its insertions."""
    made = set_up_few_spheres(**DEPOSIT)
    running = Process(made.scene, made.bases, made.draw, lambda line: None)
    births = []
    place = running.place

    def note(bodies, mean_size):
        births.append((running.step, len(bodies.mass)))
        place(bodies, mean_size)

    running.place = note
    running.generate()
    running.shake(running.step + running.shaking_steps)
    for _ in range(5):
        running.advance(running.interval_steps, DAMPING)
    return running, births


def test_batches_are_inserted_as_specified(deposit):
    running, births = deposit
    assert [count for _, count in births] == [12, 24, 36, 40]
    steps = np.diff([step for step, _ in births])
    assert (steps > 0).all() and len(running.bodies.mass) == 40


def test_its_contacts_remember_nothing_and_push_within_coulombs_limit(deposit):
    running, _ = deposit
    contacts, walls = running.candidates
    assert len(contacts.spring) == len(walls.spring) == 0
    rows = contacts.touching > 0
    assert rows.sum() > 40
    along = (contacts.force * contacts.direction).sum(axis=1)[rows]
    across = np.linalg.norm(contacts.force[rows] - along[:, None] * contacts.direction[rows], axis=1)
    assert (along >= 0.0).all() and (across <= 0.5 * along + 1e-12 * along.max()).all() and across.max() > 0.0


def test_the_watch_samples_the_stiffness_there_is(deposit):
    """The load is less than if all contacts were as stiff as the deepest expected one."""
    running, _ = deposit
    made, composition = running.scene, compose(running.scene)
    law, stiffness_factor = composition.continuous_law, composition.stiffness_factor
    load = contact_load(law, running.dt, False)
    width = running.stepper.box.width
    found = stiffest_body(running.bodies, running.candidates, width, load, stiffness_factor=stiffness_factor)
    alike = stiffest_body(running.bodies, running.candidates, width, load)
    assert 0.0 < found.load < alike.load
    # Half the factor on springs and dashpots gives half the load, without the load of sliding contacts.
    held = load._replace(sliding=0.0)
    whole, half = (
        stiffest_body(
            running.bodies, running.candidates, width, held, stiffness_factor=lambda m, *_, share=share: share + 0.0 * m
        )
        for share in (1.0, 0.5)
    )
    assert half.load == pytest.approx(0.5 * whole.load, rel=1e-9)
    assert half.body == whole.body
    time = made.numerics.contact_time
    steps = body_steps(
        running.bodies,
        running.candidates,
        width,
        law,
        False,
        found.body,
        stiffness_factor=stiffness_factor,
        time=time,
    )
    assert 0.0 < steps < made.numerics.steps_per_contact_time
    assert running.state.watch.needed > 0.0 and running.state.watch.stiffest >= 0


def test_its_springs_hold_two_fifths_k_times_the_overlap_to_five_halves(deposit):
    running, _ = deposit
    bodies, (contacts, walls), law = running.bodies, running.candidates, compose(running.scene).law
    radius, total = sphere_radius(bodies.mass, 2650.0), 0.0
    for p in np.flatnonzero(contacts.touching):
        a, b = contacts.body_a[p], contacts.body_b[p]
        k = law.modulus * np.sqrt(radius[a] * radius[b] / (radius[a] + radius[b]))
        total += 0.4 * k * contacts.overlap[p] ** 2.5
    for w in np.flatnonzero(walls.touching):
        total += 0.4 * law.modulus * np.sqrt(radius[walls.body[w]]) * walls.overlap[w] ** 2.5
    assert spring_energy(bodies, running.candidates, law).sum() == pytest.approx(total, rel=1e-12)


def test_explain_gives_what_follows_from_the_stiffness():
    text = explain(set_up_few_spheres(**DEPOSIT))
    assert "Hertzian contacts with a viscous term" in text and "friction against the sliding velocity" in text
    time = float(re.search(r"contact time of (\S+) s", text)[1])
    assert time == pytest.approx(set_up_few_spheres(**DEPOSIT).scene.numerics.contact_time, rel=1e-2)
    assert "Sliding dies out in 0.01 s, by a force of at most 0.5 times the normal force" in text


@pytest.mark.parametrize(
    "changes, said",
    [
        ({"material": {"law": "hertz"}}, "material: law hertz needs either youngs_modulus, such as 5 MPa"),
        ({"material": {**HERTZ, "overlap_at_rest": 1e-4}}, "needs either youngs_modulus"),
        (
            {"material": {"youngs_modulus": "5 MPa"}},
            "material.youngs_modulus: it has no effect with law spring_dashpot",
        ),
        ({"material": {**HERTZ, "youngs_modulus": "5 m"}}, "'5 m' is a length; a pressure is needed, such as '10 MPa'"),
        (
            {"material": HERTZ, "numerics": {"dashpot": "implicit"}},
            "implicit works only with material.law spring_dashpot",
        ),
        (
            {"material": {"friction_law": "viscous"}, "numerics": {"dashpot": "implicit"}},
            "implicit works only with material.friction_law static",
        ),
        ({"generation": {"batch_grains": 5}}, 'it has no effect unless placement is "random"'),
        (
            {"generation": {"placement": "random", "fill": "r22"}},
            'placement "random" and "filled" work only with fill "bed"',
        ),
        ({"sizes": {"beta": {"radius": "3 mm", "spread": 0.2}}}, "give either a case, such as U1, or both bounds"),
        ({"shapes": {"kind": "ellipsoid", "choice": "ratios", "eta": 1.6}}, 'choice "ratios" needs a number'),
    ],
)
def test_what_does_not_go_together_is_refused(changes, said):
    with pytest.raises(ValueError, match=re.escape(said)):
        set_up_few_spheres(**changes)
