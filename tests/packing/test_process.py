"""The packing process with a few grains: it ends at rest, repeats its bits, and fails with a reason."""

import re

import numpy as np
import pytest

from simcore.dem.from_scene import compose
from simcore.packing.insertion.batches import Pouring
from simcore.packing.packed import GENERATING, PackingError
from simcore.packing.process import Process, pack
from simcore.scene.domain import lattice_sites
from tests.helpers.few_spheres import pack_few_spheres, set_up_few_spheres


@pytest.fixture(scope="module")
def packed():
    return pack_few_spheres()


def test_it_converges_and_reports_it(packed):
    observed = packed.observation
    assert len(packed.bodies.mass) == 40
    assert observed.max_speed < 5e-3 and observed.unbalanced_force < 0.02
    assert 3.0 < observed.coordination < 6.0
    assert [phase for _, phase, _ in packed.checks][-1] == "damping"
    assert packed.time == pytest.approx(packed.steps * 1e-3 / 40)
    assert (packed.bodies.position[:, 2] > 0.9 * packed.bodies.radius).all()


def test_the_floor_carries_the_buoyant_weight():
    packed = pack_few_spheres(convergence={"max_unbalanced_force": 1e-3, "max_speed": "0.1 mm/s"})
    bodies = packed.bodies
    weight = bodies.mass.sum() * 9.81 * (1.0 - 1000.0 / 2650.0)
    floor = packed.walls.force[:, 2].sum()
    # Contacts between grains cancel, so the floor carries the weight and the unbalanced force, to rounding.
    assert floor == pytest.approx(weight + bodies.net_force[:, 2].sum(), rel=1e-12)
    # The unbalanced force is 1e-3 of the contact forces, so 1e-3 of the weight times the height of the bed in grains,
    # which is five here.
    assert floor == pytest.approx(weight, rel=5e-3)


def test_net_force_is_that_of_its_contacts(packed):
    bodies, contacts = packed.bodies, packed.contacts
    force = np.zeros((40, 3))
    rows = contacts.touching > 0
    np.add.at(force, contacts.body_b[rows], contacts.force[rows])
    np.subtract.at(force, contacts.body_a[rows], contacts.force[rows])
    np.add.at(force, packed.walls.body, packed.walls.force)
    force[:, 2] -= bodies.mass * 9.81 * (1.0 - 1000.0 / 2650.0)
    np.testing.assert_allclose(bodies.net_force, force, atol=1e-12 * np.abs(contacts.force).max())
    # Only a contact that opens may pull, by its dashpot, and friction is within Coulomb's limit.
    along = (contacts.force * contacts.direction).sum(axis=1)[rows]
    across = np.linalg.norm(contacts.force[rows] - along[:, None] * contacts.direction[rows], axis=1)
    a, b, point = contacts.body_a[rows], contacts.body_b[rows], contacts.point[rows]
    offset = bodies.position[b] - bodies.position[a]
    offset[:, :2] += 0.025 * contacts.image[rows]
    apart = bodies.velocity[b] - bodies.velocity[a]
    apart += np.cross(bodies.angular_velocity[b], point - offset) - np.cross(bodies.angular_velocity[a], point)
    opening = (apart * contacts.direction[rows]).sum(axis=1) > 0.0
    assert ((along > 0.0) | opening).all()
    assert (across <= 0.5 * np.abs(along) * (1.0 + 1e-12)).all()


def test_a_seed_repeats_its_bits_and_another_does_not(packed):
    again, other = pack_few_spheres(), pack_few_spheres(seed=2)
    for field in ("position", "velocity", "angular_momentum", "turned", "net_force"):
        assert (getattr(again.bodies, field) == getattr(packed.bodies, field)).all()
    assert (again.contacts.force == packed.contacts.force).all()
    assert not np.allclose(other.bodies.position, packed.bodies.position, atol=1e-3)


def test_the_skin_of_the_list_changes_no_bit_of_spheres(packed):
    """With another skin, lists are made at other steps. Spheres remember only a spring, so this has no effect.

    Ellipsoids and polyhedra start from the remembered contact, so a pair listed earlier may differ in the last bits.
    """
    for skin in (0.02, 0.6):
        other = pack_few_spheres(numerics={"skin": skin})
        assert (other.bodies.position == packed.bodies.position).all()
        assert other.steps == packed.steps
    implicit = {"dashpot": "implicit", "steps_per_contact_time": 10}
    one, other = (pack_few_spheres(numerics={"skin": skin, **implicit}) for skin in (0.02, 0.6))
    assert (one.bodies.position == other.bodies.position).all()
    assert one.observation.unbalanced_force < 0.02  # at a quarter of the steps


def test_grains_are_drawn_by_id():
    made = set_up_few_spheres()
    every, some = made.draw(np.arange(50)), made.draw(np.array([7, 3, 49]))
    for name in every._fields:
        assert (getattr(some, name) == getattr(every, name)[[7, 3, 49]]).all()


def test_amount_by_mass_ends_with_the_grain_that_reaches_it():
    made = set_up_few_spheres(amount={"mass": "12 g", "grains": None}, sizes={"allow_few_top_grains": True})
    packed = pack(made.scene, made.bases, made.draw)
    mass = packed.bodies.mass
    assert mass.sum() >= 0.012 > mass[:-1].sum()


def test_fill_r22_inserts_whole_batches():
    made = set_up_few_spheres(
        amount={"mass": "20 g", "grains": None},
        generation={"fill": "r22", "spacing": "12 mm"},
        sizes={"allow_few_top_grains": True},
        domain={"height": "0.1 m"},
    )
    packed = pack(made.scene, made.bases, made.draw)
    first = len(lattice_sites(made.scene.domain, 0.012, 0.01, 0.1))
    assert packed.bodies.mass.sum() > 0.020
    assert packed.bodies.mass.sum() > 0.020 + packed.bodies.mass.max(), "the last batch was cut"
    assert len(packed.bodies.mass) >= first - 4  # a row at the top may not fit


def test_not_at_rest_names_grain_and_step():
    with pytest.raises(PackingError, match=r"few: not at rest after 0.02 s of damping, step \d+: .*grain \d+ moves at"):
        pack_few_spheres(damping={"max_time": "0.02 s"}, convergence={"max_speed": "1e-9 m/s"})
    with pytest.raises(PackingError, match=r"few: not at rest after 0.03 s of damping"):
        pack_few_spheres(damping={"max_time": "0.021 s"}, convergence={"max_speed": "1e-9 m/s"})
    with pytest.raises(ValueError, match="damping.max_time: 0.001 s are shorter than convergence.interval, 0.01 s"):
        set_up_few_spheres(damping={"max_time": "1 ms"})


def test_the_advised_number_of_steps_is_enough():
    refused = {"law": "hertz", "youngs_modulus": "10 MPa", "restitution": 0.001, "end_of_contact": "clamped"}
    with pytest.raises(ValueError, match=r"at least 3\d\d\.\d+ steps are needed. Set 3\d\d, so") as error:
        compose(set_up_few_spheres(material=refused, numerics={}).scene)
    advised = int(re.search(r"Set (\d+)", str(error.value))[1])
    compose(set_up_few_spheres(material=refused, numerics={"steps_per_contact_time": advised}).scene)


def test_a_domain_that_is_too_low_is_an_error():
    with pytest.raises(PackingError, match=r"few: after \d+ grains the bed reaches \d+ mm, .*domain.height is 40 mm"):
        pack_few_spheres(domain={"height": "40 mm"}, amount={"grains": 120})
    with pytest.raises(PackingError, match=r"no grain can be inserted"):
        pack_few_spheres(domain={"height": "9 mm"}, amount={"grains": 20})


@pytest.mark.parametrize("height", ["0.1925 m", "0.195 m"])
def test_a_cylinder_whose_lowest_layer_has_no_site_is_an_error(height):
    """A cylinder 1.7 spacings wide has sites in the second layer only, which is above the domain here."""
    made = set_up_few_spheres(
        domain={"type": "cylinder", "width": "17 mm", "height": height},
        generation={"spacing": "10 mm", "fill": "bed"},
        amount={"grains": 40},
    )
    pouring = Pouring(made.scene, made.bases, made.draw)
    with pytest.raises(PackingError, match=r"no grain can be inserted between 0\.\d+ m and domain.height"):
        pouring.batch(3, 0.185, None)


def test_a_bed_higher_than_where_batches_begin_gets_the_rest_in_what_room_is_left():
    packed = pack_few_spheres(amount={"grains": 180}, domain={"height": "0.1 m"})
    assert len(packed.bodies.mass) == 180
    assert 0.06 < (packed.bodies.position[:, 2] + packed.bodies.radius).max() < 0.1


def test_grains_that_fill_the_domain_without_a_pore_are_refused():
    with pytest.raises(
        ValueError, match=r"domain.height: 0.1\d+ kg of grains would fill .* 25 mm wide to \d+ mm without"
    ):
        set_up_few_spheres(amount={"grains": 400}, domain={"height": "60 mm"})


def thrown(speed, **changes):
    """Return a process that throws up the highest grain of its first batch [m/s], and the size of this batch.

    A fall through the domain takes 0.14 s.
    """
    made = set_up_few_spheres(amount={"grains": 120}, **changes)
    running = Process(made.scene, made.bases, made.draw, lambda line: None)
    first = []

    def insert_batch():
        Process.insert_batch(running)
        if not first:
            first.append(running.state.inserted)
            running.advance(3 * running.interval_steps, GENERATING)
            running.bodies.velocity[running.bodies.position[:, 2].argmax(), 2] = speed
            running.watch.begin_anew(running.state, running.bodies)

    running.insert_batch = insert_batch
    return running, first


CYLINDER = {"domain": {"type": "cylinder", "width": "28 mm", "height": "0.2 m"}}


@pytest.mark.parametrize("fill", ["bed", "r22"])
@pytest.mark.parametrize("changes, speed", [({}, 3.0), (CYLINDER, 2.0)], ids=["periodic", "cylinder"])
def test_a_batch_waits_for_a_grain_in_flight(monkeypatch, fill, changes, speed):
    """At 3 m/s the grain is in flight for 0.98 s, while a batch usually waits for space for at most 0.28 s.

    In the cylinder it flies along the wall.
    """
    changes = {"generation": {"fill": fill}, **changes}
    running, first = thrown(speed, **changes)
    running.generate()
    assert first[0] < running.state.inserted == 120
    monkeypatch.setattr("simcore.packing.insertion.insertion.LONG_FLIGHT", 0.0)
    with pytest.raises(
        PackingError, match=r"one is \d{3} mm above the floor, .*it was thrown.*raise numerics.steps_per_contact_time"
    ):
        thrown(speed, **changes)[0].generate()


def test_a_bed_that_lies_too_high_is_not_waited_for():
    made = set_up_few_spheres(amount={"grains": 300}, domain={"height": "0.1 m"})
    running = Process(made.scene, made.bases, made.draw, lambda line: None)
    with pytest.raises(PackingError, match=r"the bed reaches \d+ mm, and a batch needs \d+ mm above it"):
        running.generate()
    assert (running.step - running.state.space_deadline) * running.dt < 5.0 * running.insertion.fall_time()


def test_an_unstable_time_step_is_refused():
    with pytest.raises(ValueError, match=r"numerics.steps_per_contact_time: 5.5 is unstable .* at least 5.89 steps"):
        compose(set_up_few_spheres(numerics={"steps_per_contact_time": 5.5}).scene)


def test_grains_that_float_are_refused():
    with pytest.raises(ValueError, match=r"material.fluid_density: 2700 kg/m3 is not below"):
        set_up_few_spheres(material={"fluid_density": "2700 kg/m3"})


def spoilt(made, grain, value):
    """Return the draw of `made` with one random number of a grain, that of its horizontal velocity, set to a value."""

    def draw(ids):
        drawn = made.draw(ids)
        drawn.uniforms[ids == grain, 0] = value
        return drawn

    return draw


def test_a_number_that_is_not_finite_names_grain_and_step():
    made = set_up_few_spheres()
    with pytest.raises(PackingError, match=r"few: the position of grain 5 is not finite at step 1\. .*time step"):
        pack(made.scene, made.bases, spoilt(made, 5, np.nan))


def test_a_grain_that_is_shot_away_names_grain_and_step():
    made = set_up_few_spheres()
    with pytest.raises(PackingError, match=r"grain 7 moves at .* m/s at step \d+, more than fall and shaking"):
        pack(made.scene, made.bases, spoilt(made, 7, 1000.0))


@pytest.mark.parametrize("placement", ["filled", "random"])
def test_a_grain_wider_than_the_domain_is_refused_before_the_first_step(placement):
    """Only the last of 60 grains is too long; without this check it was found when its batch came."""
    long = {"kind": "ellipsoid", "choice": "form", "flatness": 0.5, "elongation": 0.3}
    made = set_up_few_spheres(
        shapes=long,
        generation={"placement": placement, "fill": "bed"},
        amount={"grains": 60},
        domain={"width": "40 mm"},
    )
    few = np.arange(59)

    def draw(ids):
        drawn = made.draw(np.asarray(ids))
        scale = np.where(np.isin(ids, few)[:, None], 0.3 * drawn.scale, 3.0 * drawn.scale)
        return drawn._replace(scale=scale)

    process = Process(made.scene, made.bases, draw, lambda line: None)
    with pytest.raises(PackingError, match=r"few: a grain is 85.1 mm wide and does not fit into a domain 40 mm wide"):
        process.run()
    assert process.step == 0 and process.bodies is None
