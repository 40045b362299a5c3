"""A run that goes wrong stops with one message that names the grain; a sound run is not stopped."""

import re
from dataclasses import replace

import numpy as np
import pytest

from simcore.dem.energy import spring_energy
from simcore.dem.from_scene import compose
from simcore.dem.shapes.polyhedra import unit_sphere
from simcore.dem.stability import contact_load, stiffest_body
from simcore.dem.state.bodies import make_bodies
from simcore.packing.expectation import backing, depth_of_impact
from simcore.packing.messages import describe_tolerated
from simcore.packing.packed import DAMPING, SHAKING, PackingError
from simcore.packing.process import Process, pack
from simcore.packing.run_checks import deepest_overlap, half_thickness
from simcore.packing.state import WatchState
from tests.helpers.few_spheres import set_up_few_spheres


def process(**changes):
    made = set_up_few_spheres(**changes)
    return Process(made.scene, made.bases, made.draw, lambda line: None)


@pytest.fixture(scope="module")
def settled():
    running = process()
    running.generate()
    running.shake(running.shaking_steps)
    running.settle()
    return running


def told_by(**changes):
    made, lines = set_up_few_spheres(**changes), []
    try:
        return pack(made.scene, made.bases, made.draw, lines.append), lines
    except PackingError as error:
        return str(error), lines


def test_a_sound_packing_is_not_stopped_and_its_margin_is_kept():
    packed, lines = told_by()
    assert not [line for line in lines if "warning" in line]
    found = packed.stability
    assert found.steps == 40.0 and found.expected.expected < 40.0 < found.expected.cautious
    # The stiffest grain alone needs more steps than a pinched one, and fewer than a grain among twelve walls.
    assert 5.893 < found.needed < found.expected.cautious
    assert 3 <= found.contacts <= 14 and 0 <= found.grain < 40
    assert 0.0 < found.deepest < 0.5


@pytest.mark.parametrize(
    "changes",
    [
        {"domain": {"height": "10 m"}, "generation": {"fill": "r22", "spacing": "9 mm"}},
        {"material": {"restitution": 1.0}, "damping": {"factor": 1e-9, "max_time": "20 s"}},
        {"material": {"restitution": 0.01, "friction": 10.0}, "numerics": {"steps_per_contact_time": 80}},
        {"material": {"gravity": "100 m/s2"}},
        {"domain": {"type": "cylinder", "width": "32 mm"}},
        {"shaking": {"amplitude": "2 mm", "duration": "0.2 s"}},
    ],
    ids=["falls 10 m", "elastic", "sticky", "heavy", "cylinder", "shaken hard"],
)
def test_extreme_but_sound_packings_are_not_stopped(changes):
    packed, _ = told_by(**changes)
    assert not isinstance(packed, str), packed


def test_too_few_steps_are_warned_of_before_and_while_running_and_stop_the_run():
    """At seven steps per contact time a pinched grain is stable, but a grain with five contacts is not."""
    error, lines = told_by(numerics={"steps_per_contact_time": 7})
    warned = [line for line in lines if "warning" in line]
    assert "7 steps per contact time are fewer than the 33.8 that a bed" in warned[0]
    assert "contacts alone needs" in warned[1] and len(warned) == 2
    assert isinstance(error, str), "it came to rest"
    assert "the energy grew by" in error and "steps_per_contact_time (now 7)" in error
    assert "contacts alone needs" in error


def test_forty_steps_are_too_few_for_contacts_damped_more():
    """At a restitution of 0.01 a bed is expected to need 66 steps: it gains energy at 40, and not at 80 (above)."""
    error, lines = told_by(material={"restitution": 0.01, "friction": 10.0})
    assert "fewer than the 66.2 that a bed" in lines[0]
    assert isinstance(error, str) and "the energy grew by" in error and "alone needs" in error


def test_energy_from_nowhere_names_its_grain(settled):
    """The highest grain is lifted by two centimetres between two checks; it is still falling at the second."""
    running = settled
    running.watch.begin_anew(running.state, running.bodies)
    running.advance(running.interval_steps, DAMPING)
    highest = int(np.argmax(running.bodies.position[:, 2]))
    kept = running.bodies.position.copy()
    running.bodies.position[highest, 2] += 0.02
    step = running.step + running.interval_steps
    energy = running.bodies.mass[highest] * running.scene.material.effective_gravity * 0.02
    said = (
        rf"few: the energy grew by (\S+) J within 0.01 s before step {step}, .*; grain {highest} has the most energy\."
    )
    with pytest.raises(PackingError, match=said) as error:
        running.advance(running.interval_steps, DAMPING)
    # Damping reduces the speed of its fall, 6 cm/s at the end, by 7 %.
    assert float(re.search(said, str(error.value))[1]) == pytest.approx(energy, rel=0.1)
    running.bodies.position[:] = kept
    running.bodies.velocity[:] = 0.0
    running.watch.begin_anew(running.state, running.bodies)


def test_the_energy_seen_falls_while_a_bed_is_damped():
    """Just after shaking, only the error of the step may add energy, here less than 1e-2 of the kinetic energy."""
    running = process()
    running.generate()
    running.shake(running.shaking_steps)
    law, seen = compose(running.scene).law, []
    running.watch.begin_anew(running.state, running.bodies)
    for _ in range(10):
        running.advance(running.interval_steps, DAMPING)
        seen.append(running.state.watch.energy)
    for before, after in zip(seen[:-1], seen[1:], strict=True):
        gained = after.moving + after.height - before.moving - before.height
        assert gained < 1e-2 * before.moving
    assert spring_energy(running.bodies, running.candidates, law).sum() > 0.0


def test_springs_hold_half_k_times_the_squares(settled):
    """Tangential springs count up to the limit of friction: slipping stretches them further, but returns no energy."""
    bodies, (contacts, walls), law = settled.bodies, settled.candidates, compose(settled.scene).law

    def squares(rows, normal, p, k):
        held = law.friction * abs(rows.force[p] @ normal[p]) / (law.tangential * k)
        return rows.overlap[p] ** 2 + law.tangential * min((rows.spring[p] ** 2).sum(), held**2)

    total = 0.0
    for p in np.flatnonzero(contacts.touching):
        a, b = contacts.body_a[p], contacts.body_b[p]
        k = law.stiffness * bodies.mass[a] * bodies.mass[b] / (bodies.mass[a] + bodies.mass[b])
        total += 0.5 * k * squares(contacts, contacts.direction, p, k)
    for w in np.flatnonzero(walls.touching):
        k = law.stiffness * bodies.mass[walls.body[w]]
        total += 0.5 * k * squares(walls, walls.normal, w, k)
    assert spring_energy(bodies, settled.candidates, law).sum() == pytest.approx(total, rel=1e-12)


def test_a_sliding_grain_gains_no_energy_in_the_eyes_of_the_watch(settled):
    """A spring that slipping has stretched a thousand times beyond friction's limit counts only up to this limit."""
    bodies, near, law = settled.bodies, settled.candidates, compose(settled.scene).law
    before = spring_energy(bodies, near, law).sum()
    kept = near.walls.spring.copy()
    near.walls.spring[near.walls.touching > 0] *= 1e3
    assert spring_energy(bodies, near, law).sum() < 2.0 * before
    near.walls.spring[:] = kept


def test_an_overlap_of_half_a_grain_names_both(settled):
    """The check is given grains ten thousand times thinner than those of the bed at rest."""
    thin = 1e-4 * half_thickness(settled.bodies)
    with pytest.raises(PackingError, match=r"grain \d+ and (grain \d+|the wall) overlap by \S+ mm at step") as caught:
        settled.watch._check_overlap(settled.state, settled.bodies, settled.candidates, thin, falling=False)
    assert "numerics.contact_time, which is 0.001 s" in str(caught.value)


def test_an_impact_too_deep_stops_the_run_before_it_is_over():
    """At 4 m/s and a contact time of 10 ms, grains with radii of 2.8 to 4 mm would sink in by 5 to 7 mm.

    Few checks coincide with an impact, so the depth is predicted from the speed.
    """
    error, _ = told_by(numerics={"contact_time": "10 ms"}, generation={"velocity_z": "-4 m/s"})
    assert isinstance(error, str)
    assert "would overlap what it hits by" in error and "Shorten numerics.contact_time, which is 0.01 s, to" in error
    grain, speed, depth = re.search(r"grain (\d+) moves at (\S+) m/s .* what it hits by (\S+) mm", error).groups()
    # The largest overlap is that of tests/physics/test_contact_law.py, times 1.33 on a grain that lies on the floor;
    # the last test of this file simulates this.
    assert float(depth) / float(speed) == pytest.approx(1e3 * 1.33177 * 0.1290665 * 0.01, rel=0.01)


def test_the_deepest_overlap_is_against_the_thinner_grain(settled):
    thickness = half_thickness(settled.bodies)
    np.testing.assert_allclose(thickness, settled.bodies.radius, rtol=1e-12)
    overlap, (thin, other), ratio = deepest_overlap(settled.candidates, thickness, settled.bodies.id)
    assert ratio == overlap / thickness[thin]
    assert other == -1 or thickness[thin] <= thickness[other]
    contacts = settled.contacts
    rows = contacts.touching > 0
    least = np.minimum(thickness[contacts.body_a[rows]], thickness[contacts.body_b[rows]])
    assert ratio >= (contacts.overlap[rows] / least).max()


def test_a_deep_impact_is_foreseen():
    made, lines = set_up_few_spheres(numerics={"contact_time": "10 ms"}, domain={"height": "5 m"}), []
    Process(made.scene, made.bases, made.draw, lines.append).expect()
    (line,) = lines
    assert "overlaps another by" in line and re.search(
        r"Shorten numerics.contact_time, which is 0.01 s, to at most (\S+) s\.", line
    )


def test_the_stiffest_grain_of_a_bed_is_among_those_examined(settled):
    """The result is the same with all forty grains instead of the 32 with the largest sums."""
    from simcore.dem import stability

    load = contact_load(compose(settled.scene).law, settled.dt)
    found = stiffest_body(settled.bodies, settled.candidates, settled.stepper.box.width, load)
    examined, stability.BODIES_EXAMINED = stability.BODIES_EXAMINED, 1000
    try:
        assert stiffest_body(settled.bodies, settled.candidates, settled.stepper.box.width, load) == found
    finally:
        stability.BODIES_EXAMINED = examined


def pressed(radii, overlaps):
    """Return a process of a column of spheres of these radii [m], each overlapping the one below [m], and its log."""
    made, lines = set_up_few_spheres(shapes={"kind": "sphere"}), []
    running = Process(made.scene, made.bases, made.draw, lines.append)
    size, n = np.array(radii), len(radii)
    place = np.zeros((n, 3))
    place[:, 2] = 2.0 * np.cumsum(size) - size - np.cumsum([0.0, *overlaps])
    upright, still = np.tile([1.0, 0.0, 0.0, 0.0], (n, 1)), np.zeros((n, 3))
    scale, density = np.outer(size, np.ones(3)), running.scene.material.density
    bodies = make_bodies(
        [unit_sphere()],
        np.zeros(n, int),
        scale,
        place,
        upright,
        still,
        still,
        density,
        features=compose(running.scene).features,
    )
    running.place(bodies, 6e-3)
    return running, lines


def test_a_pebble_under_a_stone_is_let_pass_while_grains_fall():
    running, lines = pressed([1e-3, 6e-3], [1.5e-3])
    running.state.space_deadline = 3
    running.advance(1, SHAKING)
    running.advance(1, SHAKING)
    (line,) = [line for line in lines if "tolerated" in line]
    assert "grain 0 and grain 1 overlap by 1.5 mm at step 1, more than half" in line
    assert running.state.watch.deepest == pytest.approx(1.5, rel=0.01)
    with pytest.raises(PackingError, match=r"grain 0 and grain 1 overlap by 1.\d+ mm at step 3"):
        running.advance(1, SHAKING)


def test_a_pebble_under_a_pebble_under_a_stone_is_let_pass_too():
    """The pebble between them passes the stone's weight on; without the stone the run stops."""
    running, lines = pressed([1e-3, 1e-3, 6e-3], [1.5e-3, 0.1e-3])
    running.state.space_deadline = 3
    running.advance(1, SHAKING)
    (line,) = [line for line in lines if "tolerated" in line]
    assert "grain 0 and grain 1 overlap by 1.5 mm at step 1" in line and "20 times lighter" in line
    running, _ = pressed([1e-3, 1e-3], [1.5e-3])
    with pytest.raises(PackingError, match="grain 0 and grain 1 overlap by 1.5 mm at step 1"):
        running.advance(1, SHAKING)


@pytest.mark.parametrize("phase, radius", [(DAMPING, 6e-3), (SHAKING, 2.5e-3)])
def test_it_is_not_once_beds_are_damped_nor_under_one_of_a_few_times_its_mass(phase, radius):
    running, lines = pressed([1e-3, radius], [1.5e-3])
    running.state.space_deadline = 3
    with pytest.raises(PackingError, match=r"grain 0 and grain 1 overlap by 1.\d+ mm at step 1"):
        running.advance(1, phase)
    assert not [line for line in lines if "tolerated" in line]


@pytest.mark.parametrize("restitution", [0.1, 0.6, 1.0])
def test_an_impact_on_a_grain_that_lies_on_the_floor_goes_as_deep_as_expected(restitution):
    """The upper of two spheres of 6 mm hits the lower one at 0.5 m/s; its overlap is measured at every step."""
    changes = {"shapes": {"kind": "sphere"}, "numerics": {"contact_time": "0.2 ms", "steps_per_contact_time": 1000}}
    running = process(**changes, material={"restitution": restitution}, shaking={"amplitude": "0 m", "duration": "0 s"})
    radius, place = np.full(2, 3e-3), np.array([[0.0, 0.0, 3e-3], [0.0, 0.0, 9e-3]])
    speed, still = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, -0.5]]), np.zeros((2, 3))
    upright, scale = np.tile([1.0, 0.0, 0.0, 0.0], (2, 1)), np.outer(radius, np.ones(3))
    features, density = compose(running.scene).features, running.scene.material.density
    running.place(
        make_bodies([unit_sphere()], np.zeros(2, int), scale, place, upright, speed, still, density, features=features),
        6e-3,
    )
    deepest = 0.0
    for _ in range(2000):
        running.advance(1, SHAKING)
        contacts = running.contacts
        deepest = max(deepest, np.where(contacts.touching > 0, contacts.overlap, 0.0).max(initial=0.0))
    alone = depth_of_impact(running.scene, 0.5, None)
    assert deepest == pytest.approx(backing(running.scene) * alone, rel=3e-3)
    assert deepest > 1.03 * alone


@pytest.mark.parametrize("rule, effect", [("still", "so that it is valid"), ("settled", "compare it with a packing")])
def test_a_tolerated_vibration_is_valid_only_if_grains_must_be_at_rest(rule, effect):
    scene = set_up_few_spheres().scene
    scene = replace(scene, convergence=replace(scene.convergence, rule=rule))
    (line,) = describe_tolerated(scene, WatchState(needed=50.0, stiffest=3, contacts=4, warned_of_steps=True))
    assert "grain 3 with 4 contacts alone needs 50.0 steps" in line and effect in line
