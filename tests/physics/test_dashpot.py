"""The implicit dashpot: second order, limits of stability, beds at rest; and the limits of both dashpots."""

from dataclasses import replace

import numpy as np
import pytest

from simcore.dem.forces.spring_dashpot import LEVER, contact_law, implicit_law
from simcore.dem.shapes.polyhedra import SPHERE
from simcore.dem.stability import longest_stable_step, minimum_steps_per_contact_time
from simcore.packing.packed import DAMPING, SHAKING
from simcore.packing.process import Process
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve
from tests.helpers.stepped_bodies import SteppedBodies

T_C = 1e-3
NU = 0.22
CLAMPED = {0.1: 0.252729, 0.5: 0.550283, 0.9: 0.902026}  # restitution without attraction: exp(-β t_c)
N_PHASES = 1000


def rebounds(attractive, restitution, n):
    """Return restitutions of N_PHASES impacts, over the phases of first touch, with n steps per contact time."""
    dt = T_C / n
    law = implicit_law(contact_law(restitution, T_C, NU, 0.0), dt)
    position = np.zeros((N_PHASES, 3))
    position[:, 0] = 10.0 * np.arange(N_PHASES)
    position[:, 2] = 1.0 + (np.arange(N_PHASES) + 0.5) / N_PHASES * dt
    thrown = SteppedBodies(SPHERE, law, [1.0] * 3, position, [0, 0, -1.0], attractive=attractive, implicit=True)
    thrown.advance(dt, 3 * n)
    assert not thrown.walls.touching.any()
    return thrown.bodies.velocity[:, 2]


@pytest.mark.parametrize("attractive", [True, False], ids=["attractive", "clamped"])
@pytest.mark.parametrize("nominal", CLAMPED)
def test_restitution_is_of_second_order_on_average_and_of_first_for_one_impact(attractive, nominal):
    """A contact begins and ends within a step, so one impact has a first-order error that the mean does not have."""
    limit = nominal if attractive else CLAMPED[nominal]
    found = [rebounds(attractive, nominal, n) - limit for n in (10, 20, 40)]
    means, largest = np.array([(e.mean(), np.abs(e).max()) for e in found]).T
    # The largest error is of first order; it approaches its leading term from above.
    orders = np.log2(largest[:-1] / largest[1:])
    assert ((orders > 0.9) & (orders < 1.6)).all()
    if (attractive, nominal) == (True, 0.1):  # second-order terms nearly cancel, so higher ones are visible
        assert (np.abs(means) < 2.5e-3 * np.array([1.0, 1 / 4, 1 / 16])).all()
    else:
        # The order is off by 0.35 with attraction, where few of the phases take a step more and dominate the mean.
        np.testing.assert_allclose(np.log2(means[:-1] / means[1:]), 2.0, atol=0.5)


@pytest.mark.parametrize("attractive", [True, False], ids=["attractive", "clamped"])
def test_over_no_step_the_implicit_dashpot_is_the_explicit_one_to_the_bit(attractive):
    """The two variants of the step are compiled separately; the explicit one contains no code of the implicit one."""
    law, dt = contact_law(0.1, T_C, NU, 0.5), T_C / 40
    assert implicit_law(law, 0.0) == law
    thrown = []
    for implicit in (False, True):
        # Three spheres are in a row: the first hits the middle one, which lies on the floor and against the last one.
        position = [[-2.5, 0.0, 1.0], [0.0, 0.1, 0.999], [1.9995, 0.0, 1.0]]
        velocity = [[1.0, 0.3, -0.2], [0.0, 0.0, -0.1], [0.0, 0.0, 0.0]]
        row = SteppedBodies(
            SPHERE, law, [1.0] * 3, position, velocity, attractive=attractive, implicit=implicit, gravity=10.0
        )
        row.advance(dt, 30_000)
        thrown.append(row.bodies)
    assert np.abs(thrown[0].velocity[1]).max() > 1e-3
    for field in ("position", "velocity", "angular_momentum", "net_force"):
        np.testing.assert_array_equal(*(getattr(bodies, field) for bodies in thrown))


def test_a_sphere_at_rest_sinks_in_by_what_the_softer_spring_says():
    """At rest the implicit dashpot divides the stiffness by 1 + γ h / 2, which is the cost of second order."""
    dt, gravity = T_C / 10, 1e4
    continuous = contact_law(0.1, T_C, NU, 0.5)
    overlap = gravity * (1.0 + 0.5 * continuous.damping * dt) / continuous.stiffness
    law = implicit_law(continuous, dt)
    laid = SteppedBodies(SPHERE, law, [1.0] * 3, [0, 0, 1.0 - overlap], [0, 0, 0], gravity=gravity, implicit=True)
    laid.advance(dt, 100)
    # The tolerance is the rounding error of the height 1.
    assert laid.bodies.position[0, 2] == pytest.approx(1.0 - overlap, abs=1e-15)


def test_limits_of_the_explicit_dashpot_are_those_of_the_reference():
    """A sphere is among z fixed ones with tangential springs; the reference was checked with eigenvalues."""
    law = contact_law(0.1, T_C, NU, 0.5)
    for z, moving, turning in ((2, 5.64, 8.49), (6, 14.65, 23.00), (12, 27.95, 44.60)):
        steps = minimum_steps_per_contact_time(law, contacts=z, normal=z / 3, tangential=2 * z / 3)
        assert steps == pytest.approx(moving, abs=5e-3)
        steps = minimum_steps_per_contact_time(law, contacts=z, normal=0.0, tangential=5 * z / 3)
        assert steps == pytest.approx(turning, abs=5e-3)
    for s, steps in ((1, 3.414), (2, 5.893), (12, 29.190), (20, 47.644)):
        assert minimum_steps_per_contact_time(law, contacts=s) == pytest.approx(steps, abs=5e-4)


def test_limit_of_the_implicit_dashpot_is_the_root_of_its_cubic():
    """For one contact, h = 2 / ω at any damping; for more, it is the root that longest_stable_step documents."""
    for restitution in (0.01, 0.1, 0.9):
        law = contact_law(restitution, T_C, NU, 0.5)
        omega, gamma = np.sqrt(law.stiffness), law.damping
        assert longest_stable_step(law, True, contacts=1) == pytest.approx(2.0 / omega, rel=1e-9)
        for s in (2, 4, 12):
            h = longest_stable_step(law, True, contacts=s)
            left = (4.0 + 2.0 * (s - 1) * gamma * h) * (1.0 + 0.5 * gamma * h)
            assert left == pytest.approx(s * (omega * h) ** 2 * (1.0 + (s - 0.5) * gamma * h), rel=1e-9)
        # A tangential spring on one sphere has the limit of central differences, 2 / ω_t.
        steps = longest_stable_step(law, True, contacts=1, normal=0.0, tangential=LEVER)
        assert steps == pytest.approx(2.0 / np.sqrt(LEVER * law.tangential * law.stiffness), rel=1e-9)


def growth(neighbours, law, implicit, dt, turning, n_steps=60):
    """Return the growth per step of a small motion along x, or rotation about x, of a sphere held by fixed ones.

    All other motions are suppressed, because they have limits of their own and would grow from rounding.
    """
    overlap = 1e-3
    position = np.vstack([np.zeros(3), (2.0 - overlap) * np.asarray(neighbours)]) + [0.0, 0.0, 50.0]
    law = implicit_law(law, dt) if implicit else law
    held = SteppedBodies(SPHERE, law, [1.0] * 3, position, np.zeros(3), implicit=implicit)
    bodies = held.bodies
    bodies.mass[1:] *= 1e15
    bodies.inertia[1:] *= 1e15
    if not turning:
        bodies.inertia[0] *= 1e15
    held.advance(dt, 1)  # whether a contact sticks follows from the step before
    bodies.velocity[:] = 0.0
    bodies.angular_momentum[:] = 0.0
    bodies.angular_velocity[:] = 0.0
    motion = bodies.angular_velocity if turning else bodies.velocity
    motion[0, 0] = 1e-10
    bodies.angular_momentum[0, 0] = bodies.inertia[0, 0] * bodies.angular_velocity[0, 0]
    largest = []
    for _ in range(2):
        largest.append(0.0)
        for _ in range(n_steps):
            held.advance(dt, 1)
            largest[-1] = max(largest[-1], abs(motion[0, 0]))
    assert dt * largest[1] < 1e-3 * overlap  # still small
    return (largest[1] / largest[0]) ** (1.0 / n_steps)


POLES = [[1.0, 0, 0], [-1.0, 0, 0]]
OCTAHEDRON = [*POLES, [0, 1.0, 0], [0, -1.0, 0], [0, 0, 1.0], [0, 0, -1.0]]
MODES = {
    "pinched": (POLES, 0.0, False, {"normal": 2.0}),
    "six, moving": (OCTAHEDRON, 1e3, False, {"normal": 2.0, "tangential": 4.0}),
    "six, turning": (OCTAHEDRON, 1e3, True, {"normal": 0.0, "tangential": 10.0}),
}


@pytest.mark.parametrize("implicit", [False, True], ids=["explicit", "implicit"])
@pytest.mark.parametrize("name", MODES)
def test_a_held_sphere_at_the_limit(name, implicit):
    """At 0.99 of the limit a small motion decays, and at 1.01 it grows; with friction 1e3 all contacts stick."""
    neighbours, friction, turning, mode = MODES[name]
    law = contact_law(0.1, T_C, NU, friction)
    # Radii are equal but masses differ, so a contact counts as 2 on the light sphere (count_effective_contacts).
    limit = longest_stable_step(law, implicit, contacts=2.0 * len(neighbours), **mode)
    below, above = (growth(neighbours, law, implicit, factor * limit, turning) for factor in (0.99, 1.01))
    assert below < 1.0 < above


BED = {
    "name": "held",
    "seed": 3,
    "domain": {"width": "25 mm", "height": "0.2 m"},
    "shapes": {"kind": "sphere"},
    "sizes": {"bounds": ["5.6 mm", "8 mm"], "mass_fractions": [1.0]},
    "amount": {"grains": 60},
    "shaking": {"duration": "0.1 s"},
}


def rest(dashpot, steps):
    """Return kinetic energy of a bed 0.2 s after damping, over that of a fall by a grain, and unbalanced force."""
    numerics = {"contact_time": "1 ms", "dashpot": dashpot, "steps_per_contact_time": steps}
    made = set_up(resolve({**BED, "numerics": numerics}), lambda group: [])
    process = Process(made.scene, made.bases, made.draw, lambda line: None)
    process.shake(process.generate() + process.shaking_steps)
    process.advance(round(0.5 / process.dt), DAMPING)
    process.stepper.scene = replace(made.scene, shaking=replace(made.scene.shaking, amplitude=0.0))
    observed = process.advance(round(0.2 / process.dt), SHAKING)
    weight = process.bodies.mass.sum() * made.scene.material.effective_gravity
    return observed.kinetic_energy / (weight * 7e-3), observed.unbalanced_force


def test_a_bed_rests_at_ten_steps_with_the_implicit_dashpot_only():
    """The explicit limit of a sphere that sticks to six others is 23 steps, the implicit one 4."""
    energy, unbalanced = rest("implicit", 10)
    assert energy < 1e-5 and unbalanced < 0.02
    energy, unbalanced = rest("explicit", 10)
    assert energy > 1e-4 and unbalanced > 0.1
