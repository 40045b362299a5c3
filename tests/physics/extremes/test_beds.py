"""Packings at the extremes of what can be specified, and beds that rest for a minute."""

import numpy as np
import pytest
import yaml

from simcore.__main__ import main
from simcore.campaign.studies import merge
from simcore.dem.from_scene import compose
from simcore.dem.shapes.polyhedra import POLYHEDRON
from simcore.packing.packed import PackingError
from simcore.packing.process import pack
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve
from tests.helpers.hand_placed_bodies import UNDAMPED, make_scene, place_bodies, run_watched, total_energy
from tests.helpers.polyhedra import make_box

GRAVITY = 9.81
FEW = {
    "name": "few",
    "domain": {"width": "25 mm", "height": "0.3 m"},
    "shapes": {"kind": "sphere"},
    "sizes": {"bounds": ["5.6 mm", "8 mm"], "mass_fractions": [1.0], "allow_few_top_grains": True},
    "amount": {"grains": 30},
    "material": {"fluid_density": "0 kg/m3"},
    "shaking": {"duration": "0.05 s"},
    "numerics": {"contact_time": "1 ms", "progress_interval": "1000 s"},
}


def packed(*changes):
    made = set_up(resolve(merge(FEW, *changes)), lambda group: [])
    return pack(made.scene, made.bases, made.draw), made.scene


def check_rest(done, scene, deepest=0.05):
    """Assert that nothing overlaps deeply and that the floor carries a packing; return its last observation.

    Weight and floor force differ by the unbalanced forces, which are below 0.02 of a contact force on each grain.
    """
    bodies, seen = done.bodies, done.observation
    weight = scene.material.effective_gravity * bodies.mass.sum()
    forces = np.linalg.norm(np.vstack([done.contacts.force, done.walls.force]), axis=1)
    assert (forces > 0.0).any(), "nothing carries the grains"
    floor = done.walls.force[done.walls.wall == 0][:, 2].sum()
    assert floor == pytest.approx(weight, abs=0.02 * forces[forces > 0].mean() * len(bodies.mass))
    assert seen.max_overlap < deepest * bodies.radius.min()
    assert (bodies.position[:, 2] > (1.0 - deepest) * bodies.radius).all()
    return seen


@pytest.mark.parametrize("gravity", [0.1, 100.0])
def test_a_bed_under_weak_and_strong_gravity_rests(gravity):
    """Overlaps at rest are proportional to g T_c², so the contact time is proportional to 1/√g."""
    pace = float(np.sqrt(GRAVITY / gravity))
    done, scene = packed(
        {"material": {"gravity": f"{gravity} m/s2"}, "numerics": {"contact_time": f"{1e-3 * pace!r} s"}},
        {"generation": {"velocity_z": f"{-1.0 / pace!r} m/s"}, "damping": {"max_time": "30 s"}},
    )
    seen = check_rest(done, scene)
    assert seen.coordination > 2.5


def test_grains_that_have_just_begun_to_fall_are_not_taken_for_a_bed_at_rest():
    """Inserted at rest under 1/200 of gravity, grains move by 2.5e-6 m in the first interval, at 0.5 mm/s.

    Both are below the limits of rest, but nothing carries the grains yet: they must lie on the floor in the end.
    """
    done, scene = packed(
        {"material": {"gravity": "0.05 m/s2"}, "numerics": {"contact_time": "10 ms"}, "damping": {"max_time": "60 s"}},
        {"generation": {"velocity_z": "0 m/s", "velocity_horizontal": "0 m/s"}, "shaking": {"duration": "1 ms"}},
    )
    check_rest(done, scene)


def test_without_gravity_a_packing_is_refused():
    with pytest.raises(ValueError, match=r"material.gravity: 0.0 m/s2 is out of bounds; it must be more than 0"):
        packed({"material": {"gravity": "0 m/s2"}})


def test_without_gravity_momentum_is_kept():
    """When 27 spheres fly into each other, Σ m v is constant to rounding, and the energy only falls."""
    rng = np.random.default_rng(5)
    place = np.stack(np.unravel_index(np.arange(27), (3, 3, 3)), axis=-1) * 0.008 + [0.01, 0.01, 0.1]
    made = make_scene(material={"gravity": 0.0, "restitution": 0.5})
    cloud = place_bodies(made, rng.uniform(2e-3, 3.5e-3, 27), place, velocity=-3.0 * (place - place.mean(axis=0)))
    mass = cloud.bodies.mass[:, None]
    momentum = (mass * cloud.bodies.velocity).sum(axis=0)
    largest = np.abs(mass * cloud.bodies.velocity).sum()
    energies = run_watched(cloud, 0.5)
    assert energies[-1] < 0.8 * energies[0] and (np.diff(energies) < 1e-3 * energies[0]).all()
    np.testing.assert_allclose((mass * cloud.bodies.velocity).sum(axis=0), momentum, atol=1e-12 * largest)


@pytest.mark.parametrize("friction", [pytest.param(0.0, marks=pytest.mark.extremes), 10.0])
def test_smooth_and_rough_beds_rest(friction):
    """Beds with µ = 0, a compiled step of its own without springs, and with µ = 10 come to rest.

    The isostatic coordination numbers are 6 and 4. Contacts with the floor are not counted, so the mean is lower.
    """
    done, scene = packed({"material": {"friction": friction}, "amount": {"grains": 60}})
    seen = check_rest(done, scene)
    print(f"friction {friction}: coordination {seen.coordination:.2f}, mean height {seen.mean_height:.4f}")
    assert (3.5 if friction == 0.0 else 2.0) < seen.coordination < 6.0


@pytest.mark.parametrize("restitution, steps", [(0.01, 120), (1.0, 40)])
def test_dead_and_elastic_beds_rest(restitution, steps):
    """Elastic beds lose energy only by friction and damping. With e = 0.01 more steps are needed, see below."""
    done, scene = packed(
        {"material": {"restitution": restitution}, "numerics": {"steps_per_contact_time": steps}},
        {"damping": {"max_time": "30 s"}},
    )
    check_rest(done, scene)


def test_a_dead_bed_at_forty_steps_is_not_taken_for_one_at_rest():
    """With e = 0.01 forty steps are too few: an error names a grain or the number of steps, before or during the run.

    A grain between two others needs 11.7 steps, twice as many as with e = 0.1, and a grain among six others needs 40.
    """
    with pytest.raises((PackingError, ValueError), match=r"grain \d|steps_per_contact_time"):
        packed({"material": {"restitution": 0.01}, "damping": {"max_time": "2 s"}})


@pytest.mark.extremes
@pytest.mark.parametrize("contact_time", ["2e-6 s", "2e-3 s"])
def test_beds_of_very_stiff_and_soft_grains_rest(contact_time):
    """The contact times are 1/100 and ten times that of Rettinger et al.; the stiff grains need 8 million steps."""
    done, scene = packed(
        {"numerics": {"contact_time": contact_time}, "amount": {"grains": 12}, "domain": {"width": "16 mm"}}
    )
    check_rest(done, scene)


FALL = {
    "domain": {"height": "20 m"},
    "generation": {"drop_height": "10 m"},
    "amount": {"grains": 8},
    "shaking": {"duration": "2 s"},
}


def test_a_packing_dropped_from_ten_metres_rests():
    """Grains are shaken while they fall and half a second more: damping would slow the fall to 1.4 m/s."""
    done, scene = packed(FALL, {"numerics": {"contact_time": "0.2 ms"}})
    check_rest(done, scene)


def test_a_drop_from_ten_metres_on_soft_springs_is_refused():
    """At a contact time of 10 ms a grain of 7 mm would sink in by 0.129 v T_c = 18 mm, so an error names a grain."""
    with pytest.raises((PackingError, ValueError), match=r"grain \d|contact_time"):
        packed(FALL, {"numerics": {"contact_time": "10 ms"}})


def test_micrometres_with_the_default_contact_time_are_refused():
    """Inserted at 1 m/s, grains of 6 µm sink in by 0.129 v T_c = 26 µm: they may pass through each other as they fall.

    The error names a grain, and the contact time that must be shorter.
    """
    with pytest.raises((PackingError, ValueError), match=r"grain \d+ .*Shorten numerics\.contact_time"):
        packed(
            {"domain": {"width": "25 um", "height": "300 um"}, "numerics": {"contact_time": "0.2 ms"}},
            {"sizes": {"bounds": ["5.6 um", "8 um"]}},
        )


def test_one_grain_lies_on_the_floor():
    done, scene = packed({"amount": {"grains": 1}})
    assert len(done.bodies.mass) == 1 and len(done.contacts.body_a) == 0
    assert done.observation.coordination == 0.0 and done.observation.max_speed < 5e-3
    check_rest(done, scene)


def test_no_grain_is_refused():
    with pytest.raises(ValueError, match=r"amount.grains: 0 is out of bounds; it must be at least 1"):
        packed({"amount": {"grains": 0}})


def test_a_mass_below_one_grain_is_one_grain():
    """The grain that reaches the mass is the last one, and the first grain reaches it here."""
    done, _ = packed({"amount": {"grains": None, "mass": "1 mg"}})
    assert len(done.bodies.mass) == 1


@pytest.mark.parametrize("domain", [{"width": "5 mm"}, {"type": "cylinder", "width": "5 mm"}, {"height": "6 mm"}])
def test_a_grain_too_large_for_its_domain_is_refused(domain):
    """Narrower or lower than the grain: the error gives both sizes and what to change."""
    with pytest.raises(PackingError, match=r"few: no grain can be inserted .*Grains are up to 0.00\d+ m wide"):
        packed({"domain": domain, "amount": {"grains": 1}})


def test_the_command_line_ends_with_one_line(tmp_path, capsys):
    """Each failure gives an exit status and one line without a traceback; a warning may come before it.

    One grain can be packed but has no porosity. No grain, and one that is too large, cannot be packed.
    """

    def command(*arguments):
        status = main([str(argument) for argument in arguments])
        lines = capsys.readouterr().err.strip().splitlines()
        assert not any("Traceback" in line for line in lines)
        return status, [line for line in lines if "warning: " not in line]

    def specify(*changes):
        path = tmp_path / "spec.yaml"
        path.write_text(yaml.safe_dump(merge(FEW, *changes)))
        return path

    bed = tmp_path / "one.nc"
    assert command("pack", specify({"amount": {"grains": 1}}), bed, "--force")[0] == 0
    status, lines = command("porosity", bed)
    assert status == 2 and len(lines) == 1 and "use more grains" in lines[0]
    status, lines = command("pack", specify({"amount": {"grains": 0}}), tmp_path / "none.nc")
    assert status == 2 and len(lines) == 1
    status, lines = command("pack", specify({"domain": {"width": "5 mm"}}), tmp_path / "wide.nc")
    assert status == 1 and len(lines) == 1 and "few: no grain can be inserted" in lines[0]
    assert not (tmp_path / "none.nc").exists() and not (tmp_path / "wide.nc").exists()


def still(process, duration):
    """Return the largest displacement [m], change of energy [J] and largest speed [m/s] in `duration` [s]."""
    before, start = process.bodies.position.copy(), total_energy(process)
    fastest = 0.0
    for _ in range(20):
        process.advance(round(duration / 20 / process.dt), UNDAMPED)
        fastest = max(fastest, np.abs(process.bodies.velocity).max())
    return np.abs(process.bodies.position - before).max(), total_energy(process) - start, fastest


def test_a_bed_of_spheres_rests_for_a_minute():
    """After settling for 3 s, the bed neither creeps nor gains energy for 60 s, damped only by its contacts.

    Rounding of coordinates gives speeds of 1e-14 m/s, with which a sphere without neighbours rolls for ever. The limit
    of the speed is 1e-9 m/s. The displacement must be below a hundredth of the static overlap, and the change of energy
    below 1e-6 of the work of the weight over this overlap.
    """
    rng = np.random.default_rng(2)
    place = np.stack(np.unravel_index(np.arange(18), (2, 3, 3)), axis=-1)[:, ::-1] * 0.0085 + [0.004, 0.004, 0.005]
    made = make_scene(domain={"width": 0.0255}, numerics={"contact_time": 4e-3}, convergence={"interval": 0.5})
    bed = place_bodies(made, rng.uniform(2.8e-3, 4.2e-3, 18), place + rng.uniform(-1e-4, 1e-4, (18, 3)))
    run_watched(bed, 3.0, damped=True)
    crept, warmed, fastest = still(bed, 60.0)
    overlap = GRAVITY / compose(made).law.stiffness
    print(f"60 s: crept {crept:.1e} m, energy {warmed:+.1e} J, speed {fastest:.1e} m/s; overlap {overlap:.1e} m")
    assert crept < 1e-2 * overlap
    assert abs(warmed) < 1e-6 * GRAVITY * bed.bodies.mass.sum() * overlap
    assert fastest < 1e-9


@pytest.mark.extremes
def test_a_bed_of_bricks_rests_for_a_minute():
    """Twelve settled bricks of three forms neither creep nor gain energy for 60 s, as in the test of spheres."""
    rng = np.random.default_rng(3)
    place = np.stack(np.unravel_index(np.arange(12), (3, 2, 2)), axis=-1)[:, ::-1] * 0.0105 + [0.006, 0.006, 0.006]
    made = make_scene(
        POLYHEDRON, domain={"width": 0.021}, numerics={"contact_time": 4e-3}, convergence={"interval": 0.5}
    )
    edges = rng.permutation(np.repeat([[6e-3] * 3, [8e-3, 6e-3, 3e-3], [9e-3, 3e-3, 3e-3]], 4, axis=0))
    bed = place_bodies(made, edges, place, orientation=rng.standard_normal((12, 4)), bases=[make_box()])
    run_watched(bed, 5.0, damped=True)
    crept, warmed, fastest = still(bed, 60.0)
    overlap = GRAVITY / compose(made).law.stiffness
    print(f"60 s: crept {crept:.1e} m, energy {warmed:+.1e} J, speed {fastest:.1e} m/s; overlap {overlap:.1e} m")
    assert crept < 1e-2 * overlap
    assert abs(warmed) < 1e-6 * GRAVITY * bed.bodies.mass.sum() * overlap
    assert fastest < 1e-7
