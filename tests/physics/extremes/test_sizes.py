"""Large ratios of mass and size, places far from the origin, very small and very large grains."""

import numpy as np
import pytest

from simcore.dem.from_scene import compose
from simcore.dem.shapes.polyhedra import POLYHEDRON, SPHERE
from simcore.packing.packed import PackingError
from tests.helpers.hand_placed_bodies import UNDAMPED, floor_force, make_scene, pair_overlap, place_bodies, run_watched
from tests.helpers.polyhedra import make_box

GRAVITY = 9.81
STUDY = 2e-4  # [s], contact time


def column(radii, contact_time=STUDY):
    """Return a process of stacked spheres, the weight on each contact [N] and its static overlap [m], floor first."""
    radii = np.asarray(radii, float)
    height = np.cumsum(2.0 * radii) - radii
    made = make_scene(
        domain={"width": 16.0 * radii.max()}, numerics={"contact_time": contact_time}, convergence={"interval": 0.02}
    )
    stood = place_bodies(made, radii, np.column_stack([0 * radii, 0 * radii, height]))
    mass = stood.bodies.mass
    above = GRAVITY * np.cumsum(mass[::-1])[::-1]
    effective = mass.copy()
    effective[1:] = mass[1:] * mass[:-1] / (mass[1:] + mass[:-1])
    return stood, above, above / (compose(made).law.stiffness * effective)


@pytest.mark.parametrize("ratio", [1, 10, 100, 1000])
def test_a_light_grain_carries_a_heavy_one(ratio):
    """Static overlaps have a closed form: the spring of a pair follows the lighter mass, so it gives M/m times more.

    The dashpot is as weak as the spring: the heavy grain comes to rest at a rate of 2.3 m / (M T_c), 12/s at 1:1000.
    """
    light = 5e-4
    stood, above, expected = column([light, light * ratio ** (1.0 / 3.0), light])
    run_watched(stood, 2.0, damped=True)
    found = [light - stood.bodies.position[0, 2], pair_overlap(stood, 0, 1), pair_overlap(stood, 1, 2)]
    np.testing.assert_allclose(found, expected, rtol=1e-4)
    assert floor_force(stood) == pytest.approx(above[0], rel=1e-4)


@pytest.mark.parametrize("ratio", [1e5, 1e6])
def test_a_light_grain_crushed_by_a_heavy_one_is_refused(ratio):
    """The static overlap would be 1 and 10 times the diameter of the light grain, so an error names a grain."""
    light = 5e-4
    stood, _, expected = column([light, light * ratio ** (1.0 / 3.0)])
    assert expected[0] > 2.0 * light
    with pytest.raises(PackingError, match=r"grain [01]"):
        run_watched(stood, 0.5, damped=True)


def test_a_million_to_one_in_mass_and_a_hundred_to_one_in_size_in_one_bed():
    """A boulder and 120 grains of a hundredth of its size come to rest, and the floor carries all of them.

    The grains meet only the boulder: they fall round it and on it, and none ends inside.
    """
    big, small = 0.05, 5e-4
    rng = np.random.default_rng(1)
    angle, reach = rng.uniform(0.0, 2.0 * np.pi, 120), np.concatenate([np.full(60, 0.3 * big), np.full(60, 1.2 * big)])
    position = np.column_stack([reach * np.cos(angle), reach * np.sin(angle), np.zeros(120)])
    order = np.argsort(angle)
    position[:60, 2] = 2.02 * big + 3.0 * small * np.argsort(order[order < 60])
    position[60:, 2] = 2.0 * small + 3.0 * small * np.argsort(order[order >= 60])
    made = make_scene(domain={"width": 0.2}, numerics={"contact_time": STUDY})
    radius = np.concatenate([[big], np.full(120, small)])
    bed = place_bodies(made, radius, np.vstack([[0, 0, big], position]))
    assert bed.bodies.mass[0] / bed.bodies.mass[1] == pytest.approx(1e6)
    energies = run_watched(bed, 2.0, damped=True)
    assert (np.diff(energies) < 1e-9 * energies[0]).all()
    offset = bed.bodies.position[1:] - bed.bodies.position[0]
    assert (np.linalg.norm(offset, axis=1) > (big + small) - 0.01 * small).all()
    assert (bed.bodies.position[1:, 2] > 0.99 * small).all()
    rests = bed.bodies.position[1:, 2] < 1.5 * small
    assert rests.sum() > 60 and np.linalg.norm(bed.bodies.velocity[1:][rests], axis=1).max() < 0.05
    assert floor_force(bed) == pytest.approx(GRAVITY * bed.bodies.mass.sum(), rel=1e-4)


def heap(kind, scale=1.0, place=(0.0, 0.0), duration=0.2):
    """Return a process of twelve grains that fell together in a box with a corner at `place` [m].

    Lengths are multiplied by `scale` and times by √scale.
    """
    size, time = 6e-3 * scale, np.sqrt(scale)
    made = make_scene(
        SPHERE if kind == "sphere" else POLYHEDRON,
        domain={"width": 0.02 * scale, "height": 1.0 * scale},
        numerics={"contact_time": 1e-3 * time},
        convergence={"interval": 0.01 * time},
        shaking={"amplitude": 1e-300 * scale, "duration": 1.0 * time, "period": 0.025 * time},
    )
    rng = np.random.default_rng(7)
    grid = np.stack(np.unravel_index(np.arange(12), (3, 2, 2)), axis=-1)[:, ::-1]
    position = (grid * 0.0095 + rng.uniform(-5e-4, 5e-4, (12, 3)) + [0.005, 0.005, 0.006]) * scale + [*place, 0.0]
    across = rng.uniform(0.7, 1.0, (12, 3)) * size
    if kind == "sphere":
        across = 0.7 * across[:, :1] * np.ones(3)
    fell = place_bodies(
        made, across, position, velocity=[0.0, 0.0, -0.5 * time], orientation=rng.standard_normal((12, 4)),
        bases=None if kind == "sphere" else [make_box()],
    )  # fmt: skip
    fell.advance(round(duration * time / fell.dt), UNDAMPED)
    return fell


@pytest.mark.parametrize("kind", ["sphere", "brick"])
@pytest.mark.parametrize("scale", [4.0**-5, 4.0**4])
def test_micrometres_and_metres_give_the_bits_of_millimetres(kind, scale):
    """Grains of 6 µm and of 1.5 m move as those of 6 mm to the last bit; an absolute tolerance would be noticed.

    The only length is that of the grains: with times as √scale the motion is the same, and powers of four are exact.
    """
    usual, scaled = heap(kind), heap(kind, scale)
    assert usual.contacts.touching.sum() + usual.walls.touching.sum() > 10
    assert (scaled.bodies.position == usual.bodies.position * scale).all()
    assert (scaled.bodies.velocity == usual.bodies.velocity * np.sqrt(scale)).all()
    assert (scaled.contacts.overlap == usual.contacts.overlap * scale).all()


@pytest.mark.parametrize("kind", ["sphere", "brick"])
@pytest.mark.parametrize("widths", [64, 50_000])
def test_far_from_the_origin_grains_fall_as_they_do_there(kind, widths):
    """At 1.3 m and 1 km from the origin, in whole widths of the box, only the rounding of coordinates differs.

    A coordinate x has an error of eps x / 2. In a contact an error δ of the overlap becomes a speed of π δ / T_c, and
    within a time t a displacement of (π t / T_c) δ, which the next contact multiplies in the same way. The limit allows
    two successive impacts and a lever of up to four at a corner, in 0.01 s. Later the difference grows as that of any
    two packings.
    """
    shift, duration = 0.02 * widths, 0.01
    usual = heap(kind, duration=duration)
    far = heap(kind, place=(shift, -shift), duration=duration)
    assert usual.contacts.touching.any() or usual.walls.touching.any()
    error = np.abs(far.bodies.position - [shift, -shift, 0.0] - usual.bodies.position).max()
    print(f"{kind}, {shift:g} m out: {error:.1e} m")
    assert error < 4.0 * (np.pi * duration / 1e-3) ** 2 * 2.2e-16 * shift
