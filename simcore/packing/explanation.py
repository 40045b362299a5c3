"""What a packing will compute, and what it will cost, said without running it."""

from typing import NamedTuple

import numpy as np

from simcore.dem.contact.patch.workspace import make_workspace
from simcore.dem.forces.sliding import CAPPED
from simcore.dem.shapes.hulls import CONVEX, ELLIPSOID, MIXED, SPHERE, collect_shapes
from simcore.dem.state.bodies import make_bodies
from simcore.dem.state.contacts import bytes_per_pair
from simcore.dem.state.features import Features
from simcore.packing import cost as packing_cost
from simcore.packing.cost import SOLID_FRACTION, births, releases, settling_time, step_cost
from simcore.packing.expectation import Expectation, expect, warnings
from simcore.packing.insertion.batches import extents
from simcore.scene.domain import lattice_sites
from simcore.scene.scene import Scene
from simcore.scene.setup import KINDS as NUMBERS
from simcore.scene.setup import Setup

# By the number of a kind, as the core has it.
WORDS = {number: kind for kind, number in NUMBERS.items()}
NEAR_PAIRS = {NUMBERS[kind]: pairs for kind, pairs in packing_cost.NEAR_PAIRS.items()}
CHUNK = 10_000

# What a scene can have: of Features, what its step does then, and what it does not hold else.
KINDS = {
    SPHERE: ("spheres, contacts in closed form", "spheres in closed form"),
    ELLIPSOID: ("ellipsoids, contacts by Newton from the last normal", "ellipsoids"),
    CONVEX: ("convex polyhedra, contacts from the facet found last", "polyhedra: no mesh, facet or search of one"),
    MIXED: ("ellipsoids beside polyhedra, each pair by its kinds", "kinds side by side"),
}
PARTS = (
    (lambda f: f.kind != SPHERE, "orientations and their rotation", "orientations: spheres look alike from all sides"),
    (lambda f: f.friction, "friction, with the history of each contact's tangential spring", "friction and history"),
    (
        lambda f: f.attractive,
        "contacts that may pull as they end, by their dashpot",
        "contacts that pull: forces are clamped at zero",
    ),
    (
        lambda f: f.hertz,
        "Hertzian contacts with a viscous term",
        "Hertzian contacts: they are linear",
    ),
    (
        lambda f: f.preloaded,
        "tangential springs that start at the limit of friction, as the source study's program has them",
        "springs that start at the limit of friction",
    ),
    (lambda f: f.sliding, "friction against the sliding velocity, without history", "sliding friction"),
    (lambda f: f.implicit, "implicit dashpots, by how firmly a grain is held", "implicit dashpots"),
    (lambda f: f.patch, "patches: polyhedra press at the centroid of their overlap", "patches"),
    (
        lambda f: f.inflated,
        "contacts of polyhedra as the source study's program finds them",
        "the contact search of the source study's program",
    ),
    (
        lambda f: f.potential,
        "potentials: ellipsoids press where each is deepest in the other",
        "potentials of ellipsoids: their contacts have a common normal",
    ),
    (lambda f: f.floor, "a floor", "a floor"),
    (lambda f: f.cylinder, "a cylinder's wall", "a cylinder's wall"),
    (lambda f: f.periodic, "periodic images", "periodic images"),
    (lambda f: f.shaken, "shaking", "shaking"),
)


class Cost(NamedTuple):
    """What a packing is estimated to need."""

    grains: int
    mass: float  # [kg]
    batches: int
    generating: int  # steps until the last grain is born
    shaking: int
    damping: int  # expected
    longest_damping: int  # then it fails
    cpu_seconds: float
    bytes_per_grain: int
    bytes_per_pair: int
    memory: float  # [bytes], of all arrays of the core


def parts(features: Features) -> tuple[list[str], list[str]]:
    """What a step with these features does, and what it leaves out, in words."""
    has = [KINDS[features.kind][0]] + [text for there, text, _ in PARTS if there(features)]
    lacks = [text for kind, (_, text) in KINDS.items() if kind != features.kind]
    return has, lacks + [text for there, _, text in PARTS if not there(features)]


def estimate_cost(setup: Setup) -> Cost:
    """Cost of a packing, from its grains, its phases and the tables above."""
    scene = setup.scene
    features, dt = scene.features, scene.numerics.time_step
    volumes = _volumes(setup)
    n = len(volumes)
    born, birth_steps = _births(setup, volumes)
    shaking = round(scene.shaking.duration / dt)
    longest = round(scene.damping.max_time / dt)
    damping = min(round(settling_time(scene.convergence.rule) / dt), longest)
    # Grains wait for the next batch: what has been born is stepped until it comes.
    grain_steps = sum(count * steps for count, steps in zip(born, birth_steps, strict=True)) + n * (shaking + damping)
    per_grain = _bytes_per_grain(setup)
    per_pair = bytes_per_pair(features)
    shapes = collect_shapes(setup.bases)
    fixed = sum(array.nbytes for group in (shapes, make_workspace(shapes, 1)) for array in group)
    return Cost(
        grains=n,
        mass=scene.material.density * float(volumes.sum()),
        batches=len(born),
        generating=sum(birth_steps),
        shaking=shaking,
        damping=damping,
        longest_damping=longest,
        cpu_seconds=1e-6 * _step_cost(scene) * grain_steps,
        bytes_per_grain=per_grain,
        bytes_per_pair=per_pair,
        memory=fixed + n * (per_grain + NEAR_PAIRS[scene.kind] * per_pair),
    )


def _step_cost(scene: Scene) -> float:
    region = scene.numerics.contact_region
    return step_cost(WORDS[scene.kind], region, scene.numerics.contact_time, scene.numerics.time_step)


def explain(setup: Setup) -> str:
    """Lines on what the packing of `setup` computes, costs, and how far it is from its limits."""
    scene, cost = setup.scene, estimate_cost(setup)
    expected = expect(scene, setup.bases, setup.draw)
    has, lacks = parts(scene.features)
    dt, domain = scene.numerics.time_step, scene.domain
    place = "periodic box, width" if domain.periodic else "cylinder, diameter"
    batches = "one batch" if cost.batches == 1 else f"about {cost.batches} batches"
    lines = [
        f"{scene.name}: {cost.grains} grains, {cost.mass:.4g} kg, {place} {domain.width * 1e3:g} mm, height "
        f"{domain.height * 1e3:g} mm",
        "The step has",
        *(f"  {text}" for text in has),
        "It leaves out",
        *(f"  {text}" for text in lacks),
        f"Steps of {dt:.3g} s",
        f"  generating  {_about(cost.generating)}, in {batches}",
        f"  shaking     {cost.shaking}, {scene.shaking.duration:g} s after the last birth",
        f"  damping     about {cost.damping}, until the grains rest; at most {cost.longest_damping}",
        f"Time        {_duration(cost.cpu_seconds)} on one core ({cost.cpu_seconds / 3600:.2g} CPU hours): "
        f"{_step_cost(scene):.3g} µs a grain and step; where it is the first of its kind, "
        f"compiling comes on top",
        f"Memory      {_size(cost.memory)} of arrays: {cost.bytes_per_grain} bytes a grain, {cost.bytes_per_pair} a "
        f"near pair, about {NEAR_PAIRS[scene.kind]:g} of them a grain",
        *_stability_lines(scene, expected),
        *(f"Warning     {text}" for text in warnings(scene, expected)),
    ]
    return "\n".join(lines)


def _stability_lines(scene: Scene, expected: Expectation) -> list[str]:
    steps, needed = scene.numerics.steps_per_contact_time, expected.stability
    verdict = "more than needed in the worst case"
    if steps < needed.cautious:
        verdict = "enough as expected, not in the worst case"
    if steps < needed.expected:
        verdict = "fewer than expected to do"
    return [
        *_hertz_lines(scene),
        *_sliding_lines(scene),
        f"Stability   {steps:g} steps a contact time: {verdict}. Fewer than {scene.least_steps:.2f} are refused, "
        f"{needed.expected:.1f} are expected to do (margin {steps / needed.expected:.2f}), {needed.cautious:.1f} do "
        f"whatever the grains do (margin {steps / needed.cautious:.2f})",
    ]


def _hertz_lines(scene: Scene) -> list[str]:
    """What follows from the stiffness that was asked for."""
    found = scene.hertzian
    if found is None:
        return []
    material = scene.material
    return [
        f"Contacts    (4/3) E* = {found.modulus:.3g} Pa, damping time {found.damping_time:.3g} s: restitution "
        f"{material.restitution:g} of two mean grains at {material.restitution_speed:g} m/s, higher below",
        f"            contact time {found.duration:.3g} s, of the smallest grains after a fall through the domain, "
        f"{1e3 * found.deepest:.2g} mm deep; gentler ones last longer",
    ]


def _sliding_lines(scene: Scene) -> list[str]:
    """What friction without history does."""
    if not scene.features.sliding:
        return []
    material = scene.material
    limit = f"at most {material.friction:g} F_n" if scene.features.sliding == CAPPED else "without limit"
    return [f"Friction    sliding dies out in {material.sliding_time:g} s, {limit}; nothing is held, beds creep"]


def _volumes(setup: Setup) -> np.ndarray:
    """Volumes (n,) [m³] of the grains of the packing, whole batches of the study not rounded up."""
    scene = setup.scene
    base = np.array([each.volume for each in setup.bases])

    def volumes(ids):
        drawn = setup.draw(ids)
        return base[drawn.shape] * drawn.scale.prod(axis=1)

    if scene.amount_grains is not None:
        return volumes(np.arange(scene.amount_grains))
    found, poured = [], 0.0
    while poured < scene.amount_mass:
        some = volumes(np.arange(CHUNK) + CHUNK * len(found))
        found.append(some)
        poured += scene.material.density * float(some.sum())
    all_of_them = np.concatenate(found)
    enough = np.searchsorted(scene.material.density * np.cumsum(all_of_them), scene.amount_mass)
    return all_of_them[: enough + 1]


def _births(setup: Setup, volumes) -> tuple[list[int], list[int]]:
    """Grains there are after each batch, and steps until the next; none after the last: see packing_cost.births.

    Where grains stand taller than a layer, a batch fills each second, third layer of its lattice.
    """
    scene = setup.scene
    generation, domain, n = scene.generation, scene.domain, len(volumes)
    some = setup.draw(np.arange(min(n, CHUNK // 10)))
    if generation.placement == "random":
        return releases(
            n,
            generation.batch_grains,
            generation.batch_interval,
            extents(setup.bases, some, True)[0],
            float(np.mean(volumes)),
            area=domain.area,
            drop_height=generation.drop_height,
            velocity=-generation.velocity_z,
            gravity=scene.material.effective_gravity,
            time_step=scene.numerics.time_step,
        )
    height = 2.0 * extents(setup.bases, some, generation.orientation == "random")[1].mean()
    stride = int(np.ceil(height / (generation.spacing * np.sqrt(6.0) / 3.0)))
    return births(
        n,
        lambda done: float(volumes[:done].sum()) / (SOLID_FRACTION * domain.area),
        lambda low, high: len(lattice_sites(domain, generation.spacing, low, high)) // stride,
        study=generation.fill == "study",
        height=domain.height,
        spacing=generation.spacing,
        drop_height=generation.drop_height,
        velocity=-generation.velocity_z,
        gravity=scene.material.effective_gravity,
        time_step=scene.numerics.time_step,
    )


def _bytes_per_grain(setup: Setup) -> int:
    """Of the arrays of Bodies in a scene of this kind."""
    drawn = setup.draw(np.arange(1))
    zero = np.zeros((1, 3))
    bodies = make_bodies(
        setup.bases,
        drawn.shape,
        drawn.scale,
        zero,
        [[1.0, 0.0, 0.0, 0.0]],
        zero,
        zero,
        1.0,
        features=setup.scene.features,
    )
    return sum(array.nbytes for array in bodies)


def _about(steps):
    return f"about {steps}" if steps else "0"


def _duration(seconds):
    for unit, length in (("hours", 3600.0), ("minutes", 60.0)):
        if seconds >= 2.0 * length:
            return f"about {seconds / length:.2g} {unit}"
    return f"about {seconds:.2g} s"


def _size(number):
    for unit, factor in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if number >= factor:
            return f"{number / factor:.2g} {unit}"
    return f"{number:.0f} bytes"
