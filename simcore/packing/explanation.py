"""Report of `explain`: what a packing computes and what it costs, without running it."""

from typing import NamedTuple

import numpy as np

from simcore.dem.contact.patch.workspace import make_workspace
from simcore.dem.forces.viscous_friction import CAPPED
from simcore.dem.from_scene import compose
from simcore.dem.shapes.polyhedra import collect_shapes
from simcore.dem.spread_contacts import CAUTIOUS_CONTACTS, EXPECTED_CONTACTS
from simcore.dem.state.bodies import make_bodies
from simcore.dem.state.contacts import bytes_per_pair
from simcore.dem.state.features import PARTS, Features
from simcore.grains.sampling import GrainSample
from simcore.packing.cost import CANDIDATE_PAIRS, KIND_NAMES, PackingCost, Pour, cost_of, scene_step_cost
from simcore.packing.expectation import Expectation, expect, warnings
from simcore.packing.forecast import draw_packing
from simcore.packing.forecast_text import bed_lines, grain_lines, setup_warnings
from simcore.packing.insertion.batches import extents
from simcore.scene.scene import GRAINS, Scene
from simcore.scene.setup import Setup
from simcore.scene.shapes import ELLIPSOID, MIXED, POLYHEDRON, SPHERE

# For each kind of scene: what its step includes, and what the steps of the other kinds leave out.
PARTS_BY_KIND = {
    SPHERE: ("spheres, contacts in closed form", "spheres in closed form"),
    ELLIPSOID: ("ellipsoids, contacts by Newton iteration from the last normal", "ellipsoids"),
    POLYHEDRON: ("convex polyhedra, contacts from the facet found last", "polyhedra and their contact search"),
    MIXED: ("ellipsoids and polyhedra, contacts by the kinds of the pair", "mixtures of kinds"),
}


class Cost(NamedTuple):
    """Estimated needs of a packing, computed from its grains."""

    packing: PackingCost
    mass: float  # [kg]
    bytes_per_grain: int
    bytes_per_pair: int
    memory: float  # [bytes], all arrays of simcore.dem


def parts(features: Features) -> tuple[list[str], list[str]]:
    """Return what a step with these features includes, and what it leaves out, in words."""
    has = [PARTS_BY_KIND[features.kind][0]] + [text for included, text, _ in PARTS if included(features)]
    lacks = [text for kind, (_, text) in PARTS_BY_KIND.items() if kind != features.kind]
    return has, lacks + [text for included, _, text in PARTS if not included(features)]


def draw_batches(setup: Setup) -> tuple[GrainSample, PackingCost]:
    """Return all grains of a packing, with those of its last batch beyond the specified mass, and its PackingCost."""
    sample = draw_packing(setup)
    packing = cost_of(setup.scene, _pour(setup, sample.volume))
    if packing.grains > len(sample.volume):
        sample = setup.sample(np.arange(packing.grains))
    return sample, packing


def estimate_cost(setup: Setup, drawn=None) -> Cost:
    """Return the Cost of a packing. drawn: what `draw_batches` returned, if the grains have been drawn already."""
    scene = setup.scene
    sample, packing = draw_batches(setup) if drawn is None else drawn
    per_grain, per_pair = _bytes_per_grain(setup), bytes_per_pair(compose(scene).features)
    shapes = collect_shapes(setup.bases)
    fixed = sum(array.nbytes for group in (shapes, make_workspace(shapes, 1)) for array in group)
    return Cost(
        packing=packing,
        mass=scene.material.density * float(sample.volume.sum()),
        bytes_per_grain=per_grain,
        bytes_per_pair=per_pair,
        memory=fixed + packing.grains * (per_grain + CANDIDATE_PAIRS[KIND_NAMES[scene.kind]] * per_pair),
    )


def _pour(setup: Setup, volumes) -> Pour:
    """Return the Pour of the grains of these volumes (n,) [m³]."""
    drawn = setup.draw(np.arange(min(len(volumes), GRAINS)))
    generation = setup.scene.generation
    height = 2.0 * extents(setup.bases, drawn, generation.orientation == "random")[1].mean()
    reach = extents(setup.bases, drawn, True)[0]
    up_to = np.concatenate([[0.0], np.cumsum(volumes)])
    return Pour(len(volumes), lambda n: float(up_to[n]), height, reach)


def explain(setup: Setup) -> str:
    """Return the text of `explain`: what the packing of `setup` computes and costs, and its margins to the limits."""
    scene, drawn = setup.scene, draw_batches(setup)
    sample, estimated = drawn[0], estimate_cost(setup, drawn)
    cost = estimated.packing
    expected = expect(scene, setup.bases, setup.draw)
    has, lacks = parts(compose(scene).features)
    dt, domain = scene.numerics.time_step, scene.domain
    place = "periodic box, width" if domain.periodic else "cylinder, diameter"
    batches = "one batch" if cost.batches == 1 else f"about {cost.batches} batches"
    lines = [
        f"{scene.name}: {cost.grains} grains, {estimated.mass:.4g} kg, {place} {domain.width * 1e3:g} mm, height "
        f"{domain.height * 1e3:g} mm",
        *_amount_lines(scene),
        *grain_lines(setup, sample),
        *bed_lines(setup, sample),
        "The step has",
        *(f"  {text}" for text in has),
        "It leaves out",
        *(f"  {text}" for text in lacks),
        f"Steps of {dt:.3g} s",
        f"  generating  {_about(cost.generating)}, in {batches}",
        f"  shaking     {cost.shaking}, {scene.shaking.duration:g} s after the last insertion",
        f"  damping     about {cost.damping}, until the grains rest; at most {cost.longest_damping}",
        f"Time        {describe_duration(cost.cpu_seconds)} on one core "
        f"({_two_digits(cost.cpu_seconds / 3600)} CPU hours), at {scene_step_cost(scene):.3g} µs per grain and step",
        "            Compiling takes a minute or two more where a step of this kind has not run before",
        f"Memory      {_size(estimated.memory)} of arrays: {estimated.bytes_per_grain} bytes per grain, and "
        f"{estimated.bytes_per_pair} per candidate pair; a grain has about "
        f"{CANDIDATE_PAIRS[KIND_NAMES[scene.kind]]:g} candidate pairs",
        *_stability_lines(scene, expected),
        *(f"Warning     {text}" for text in warnings(scene, expected)),
        *(f"Warning     {text}" for text in setup_warnings(setup, sample)),
    ]
    return "\n".join(lines)


def _amount_lines(scene: Scene) -> list[str]:
    if scene.generation.fill != "r22" or scene.amount_grains is not None:
        return []
    return [
        f"Amount      {scene.amount_mass:.4g} kg is specified, but generation.fill: r22 inserts the last batch whole",
        "            The grains and the mass above contain the whole batch",
    ]


def _stability_lines(scene: Scene, expected: Expectation) -> list[str]:
    steps, needed = scene.numerics.steps_per_contact_time, expected.stability
    least = compose(scene).least_steps
    verdict = "more than the cautious estimate"
    of_expected = f"{EXPECTED_CONTACTS} contacts spread over the stiffest grain"
    of_cautious = f"{CAUTIOUS_CONTACTS} such contacts"
    if scene.implicit:
        of_expected = "the stiffest grain in random contacts"
        of_cautious = "neighbours that move against it"
    if steps < needed.cautious:
        verdict = "at least as many as a bed is expected to need, and fewer than the cautious estimate"
    if steps < needed.expected:
        verdict = "fewer than a bed of such grains is expected to need"
    return [
        *_hertz_lines(scene),
        *_sliding_lines(scene),
        f"Stability   {steps:g} steps per contact time are {verdict}",
        f"            refused   below {least:.2f}",
        f"            expected  {needed.expected:.1f}, for {of_expected} (margin {steps / needed.expected:.2f})",
        f"            cautious  {needed.cautious:.1f}, for {of_cautious} (margin {steps / needed.cautious:.2f})",
        "            No number is certain before a run; the run reports the grain that needs the most steps",
    ]


def _hertz_lines(scene: Scene) -> list[str]:
    """Return lines on the Hertzian contacts that follow from the specified stiffness."""
    hertzian = scene.hertzian
    if hertzian is None:
        return []
    material = scene.material
    return [
        f"Contacts    The stiffness (4/3) E* is {hertzian.modulus:.3g} Pa, the damping time "
        f"{hertzian.damping_time:.3g} s",
        f"            Two mean grains that meet at {material.restitution_speed:g} m/s have a restitution of "
        f"{material.restitution:g}, slower ones a higher one",
        f"            The contact time of {hertzian.duration:.3g} s is that of the smallest grains after a fall "
        f"through the domain,",
        f"            which sink {1e3 * hertzian.deepest:.2g} mm into each other; gentler contacts last longer",
    ]


def _sliding_lines(scene: Scene) -> list[str]:
    """Return lines on friction without history."""
    sliding = compose(scene).features.sliding
    if not sliding:
        return []
    material = scene.material
    limit = f"of at most {material.friction:g} times the normal force" if sliding == CAPPED else "without limit"
    return [
        f"Friction    Sliding dies out in {material.sliding_time:g} s, by a force {limit}",
        "            No force keeps grains at rest, so that beds creep",
    ]


def _bytes_per_grain(setup: Setup) -> int:
    """Return the bytes per grain of the arrays of Bodies in a scene of this kind."""
    drawn = setup.draw(np.arange(1))
    zero = np.zeros((1, 3))
    upright = [[1.0, 0.0, 0.0, 0.0]]
    features = compose(setup.scene).features
    bodies = make_bodies(setup.bases, drawn.shape, drawn.scale, zero, upright, zero, zero, 1.0, features=features)
    return sum(array.nbytes for array in bodies)


def _about(steps):
    return f"about {steps}" if steps else "0"


def describe_duration(seconds):
    """Return a duration [s] in hours, minutes or seconds, with two digits."""
    for unit, length in (("hours", 3600.0), ("minutes", 60.0)):
        if seconds >= 2.0 * length:
            return f"about {_two_digits(seconds / length)} {unit}"
    return f"about {_two_digits(seconds)} s"


def _two_digits(value):
    """Return a number rounded to two digits, without an exponent from 0.0001 to 1 million."""
    return f"{float(f'{value:.2g}'):g}"


def _size(number):
    for unit, factor in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if number >= factor:
            return f"{_two_digits(number / factor)} {unit}"
    return f"{number:.0f} bytes"
