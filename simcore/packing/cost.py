"""What a packing costs: its phases in steps, its CPU time and its memory. No numba is needed.

A scheduler must estimate cores, memory and time of hundreds of packings before the first of them starts, so that
`estimate` takes the specification alone and reads no grain. `explanation.py` has the grains at hand; both describe the
grains as a `Pour` and compute the cost from it and the Scene in the same way.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from simcore.grains.sampling import sample_grains
from simcore.packing.insertion.random_placement import fall_time, layer_grains, zone_height
from simcore.scene.domain import lattice_sites
from simcore.scene.scene import R22_FIRST_FILL, REFILL_HEIGHT, Scene
from simcore.scene.setup import KINDS, make_scene, shape_choice
from simcore.scene.sizes import size_curve

# CPU time of a grain and step [µs], one thread, at the study's contact time and step: kind of grain, whether patches
# are found. The one table of it. Of patches from the packings of `r22` in results/reference/accuracy.csv (1.1 to 1.7
# on three machines), the others by `python -m benchmarks.speed.throughput --shape ...` (docs/cost.md), where
# ellipsoids had 0.55 and 0.76 on two machines.
STEP_COST = {("sphere", False): 0.14, ("ellipsoid", False): 0.65, ("polyhedron", False): 1.0, ("polyhedron", True): 1.4}
# What searching each contact anew adds, as the study's program does (numerics.polyhedron_contact inflated): 6 to 8 µs a
# search (`python -m benchmarks.studies.inflated`), 4 and 7 µs a grain and step in the first two beds of
# difference_search.
INFLATED_COST = 6.0
# Half of the one and half of the other cost the mean of both, to 2 %.
STEP_COST |= {
    ("mixed", patch): 0.5 * (STEP_COST["ellipsoid", False] + STEP_COST["polyhedron", patch]) for patch in (0, 1)
}
# The dearer, the longer the step (memory of a contact holds for less) and the softer the contacts (patches are wide,
# more pairs touch): powers of both, from the CPU times of results/reference/work_precision/packings.csv, 10 to 80
# steps in 2 ms and 0.25 to 2 ms in 10 steps, pebbles with patches; of other grains
# ASSUME: the same.
R22_TIME_STEP, LONGER = 5e-6, 0.12
R22_CONTACT_TIME, SOFTER = 2e-4, 0.25
# CandidatePairs pairs that a grain at rest brings into the list; measured in the packings of examples/.
CANDIDATE_PAIRS = {"sphere": 5.2, "ellipsoid": 10.0, "polyhedron": 13.4}
CANDIDATE_PAIRS["mixed"] = 0.5 * (CANDIDATE_PAIRS["ellipsoid"] + CANDIDATE_PAIRS["polyhedron"])
# Bytes of a grain with its candidate pairs, as `explain` says them for examples/, rounded up.
GRAIN_MEMORY = {"sphere": 1200, "ellipsoid": 2600, "polyhedron": 4400, "mixed": 4400}
# ASSUME: solid fraction of a poured bed, to tell how high it stands when the next batch is born.
SOLID_FRACTION = 0.6
# ASSUME: time until a shaken bed is at rest; 0.08 to 0.24 s in the packings of examples/.
SETTLING = 0.2
# ASSUME: the same of a bed that creeps, by convergence.rule settled; examples/deposit.yaml takes 1.4 s.
CREEPING = 1.5
# ASSUME: of grains whose form the specification does not say, what the 63 synthetic ones have: the volume of one over
# that of the sphere of its sieve size, and its longest axis over that size, means by number.
SET_VOLUME, SET_LENGTH = 1.5, 1.84
# Hulls are longer than the ellipsoids of the same mass and inertia; measured on the same 63.
HULL_LENGTH = {"sphere": 1.0, "ellipsoid": 1.0, "polyhedron": 1.09, "mixed": 1.05}
SAMPLED = 400  # grains that say what those of a form, or of a distribution of form, are in the mean

# ASSUME: what is asked of a scheduler for a process with numba's compiler; the arrays are there several times while
# lists are rebuilt and the file is written.
PROCESS_MEMORY, COPIES = 1000.0e6, 4.0
# ASSUME: compiling comes first; then the estimate, with a margin for slower machines and for ranks that wait for each
# other. What is not done in this time goes on from its last checkpoint.
START_UP, MARGIN = 900.0, 3.0

WORDS = {number: kind for kind, number in KINDS.items()}  # kind of a specification by the number of a Scene's


class Pour(NamedTuple):
    """The grains of a packing, as far as its cost depends on them."""

    grains: int
    solid: Callable  # solid(n) -> volume [m³] of the first n grains
    height: float  # [m], mean vertical extent of a grain when it is inserted
    reach: np.ndarray  # (k,) [m], bounding radii of some of the grains


class PackingCost(NamedTuple):
    """Estimates for one packing."""

    grains: int
    batches: int
    generating: int  # steps until the last grain is inserted
    shaking: int  # steps after that
    damping: int  # steps until it is expected to rest
    longest_damping: int  # steps after which it fails
    cpu_seconds: float
    array_bytes: float

    @property
    def steps(self) -> int:
        """Steps until the packing is expected to rest."""
        return self.generating + self.shaking + self.damping

    def memory_mb(self, ranks: int) -> int:
        """Memory to ask for [MB]."""
        return int(np.ceil(1e-6 * (ranks * PROCESS_MEMORY + COPIES * self.array_bytes)))

    def minutes(self, cores: int) -> int:
        """Wall-clock time to ask for [min]."""
        return int(np.ceil((START_UP + MARGIN * self.cpu_seconds / cores) / 60.0))

    def ranks(self, most: int, grains_per_rank: int) -> int:
        """Ranks that the packing keeps busy, at most `most`."""
        return max(min(most, self.grains // grains_per_rank), 1)


def estimate(specification: dict) -> PackingCost:
    """Return the PackingCost of a resolved specification. ValueError where its settings exclude each other."""
    curve = size_curve(specification["sizes"])
    scene = make_scene(specification, curve, lambda: _masses_of_spheres(specification, curve))
    return cost_of(scene, typical_pour(specification, curve))


def cost_of(scene: Scene, pour: Pour) -> PackingCost:
    """Return the PackingCost of a scene with these grains."""
    dt = scene.numerics.time_step
    inserted, waits = plan_insertion(scene, pour)
    shaking = round(scene.shaking.duration / dt)
    longest = round(scene.damping.max_time / dt)
    damping = min(round(settling_time(scene.convergence.rule) / dt), longest)
    # Grains wait for the next batch: those that are there are stepped until it comes.
    waiting = sum(count * steps for count, steps in zip(inserted, waits, strict=True))
    grain_steps = waiting + pour.grains * (shaking + damping)
    return PackingCost(
        grains=pour.grains,
        batches=len(inserted),
        generating=sum(waits),
        shaking=shaking,
        damping=damping,
        longest_damping=longest,
        cpu_seconds=1e-6 * scene_step_cost(scene) * grain_steps,
        array_bytes=float(pour.grains) * GRAIN_MEMORY[WORDS[scene.kind]],
    )


def typical_pour(specification: dict, curve) -> Pour:
    """Return the Pour of grains that are all equal to the mean one of a resolved specification with that curve."""
    bulkier, longer = _form_factors(specification, curve)
    volume = bulkier * np.pi / 6.0 * curve.mean(3)
    height = longer * curve.mean(1)  # grains are inserted upright
    grains = specification["amount"]["grains"]
    if grains is None:
        grains = int(np.ceil(specification["amount"]["mass"] / (specification["material"]["density"] * volume)))
    return Pour(grains, lambda n: n * volume, height, np.array([0.5 * height]))


def _masses_of_spheres(specification, curve) -> tuple[float, float]:
    """Return mean and least mass [kg] of spheres of the curve's sizes."""
    fractions = curve.number_fractions()
    masses = specification["material"]["density"] * np.pi / 6.0 * curve.class_means(3)
    return float(fractions @ masses), float(masses[fractions > 0.0].min())


def _form_factors(specification, curve) -> tuple[float, float]:
    """Means by number over the grains: volume over that of the sphere of the curve's size, length over that size."""
    shapes = specification["shapes"]
    kind = shapes["kind"]
    if kind != "sphere" and shapes["choice"] in ("one", "random"):
        return SET_VOLUME, SET_LENGTH * HULL_LENGTH[kind]
    smooth = replace(shape_choice(shapes), kind="sphere" if kind == "sphere" else "ellipsoid", ellipsoid_share=None)
    sample = sample_grains(np.arange(SAMPLED), specification["seed"], curve, smooth, [])
    size = np.cbrt(6.0 / np.pi * sample.volume) if curve.of_volume else sample.D
    bulkier = (6.0 / np.pi * sample.volume / size**3).mean()
    return float(bulkier), float((sample.L / size).mean()) * HULL_LENGTH[kind]


def scene_step_cost(scene: Scene) -> float:
    """Return the CPU time of a grain and step of the scene [µs], one thread."""
    numerics = scene.numerics
    return step_cost(WORDS[scene.kind], numerics.polyhedron_contact, numerics.contact_time, numerics.time_step)


def step_cost(kind: str, region: str, contact_time: float, time_step: float) -> float:
    """CPU time of a grain and step [µs], one thread, at this contact time and step [s].

    region: where polyhedra press, numerics.polyhedron_contact.
    """
    patch = kind in ("polyhedron", "mixed") and region == "patch"
    searched = INFLATED_COST if region == "inflated" else 0.0
    slower = (time_step / R22_TIME_STEP) ** LONGER * (contact_time / R22_CONTACT_TIME) ** SOFTER
    return STEP_COST[kind, patch] * slower + searched


def settling_time(rule: str) -> float:
    """Time [s] until a bed is expected to be at rest by a rule of `convergence`."""
    return CREEPING if rule == "settled" else SETTLING


def plan_insertion(scene: Scene, pour: Pour) -> tuple[list[int], list[int]]:
    """Return the number of grains after each batch, and the steps until the next; 0 after the last."""
    if scene.generation.placement == "random":
        return _strewn_batches(scene, pour)
    return _lattice_batches(scene, pour)


def _strewn_batches(scene, pour):
    """Batches strewn at random: one every batch_interval, or, where that is None, when the one before has fallen."""
    generation, area = scene.generation, scene.domain.area
    batch = layer_grains(pour.reach, area) if generation.batch_grains is None else generation.batch_grains
    interval = generation.batch_interval
    if interval is None:
        volume = pour.solid(pour.grains) / pour.grains
        zone = zone_height(pour.reach, np.full(min(batch, pour.grains), volume), area)
        interval = _fall_time(scene, generation.drop_height + zone)
    inserted = [*range(batch, pour.grains, batch), pour.grains]
    return inserted, [round(interval / scene.numerics.time_step)] * (len(inserted) - 1) + [0]


def _lattice_batches(scene, pour):
    """Batches that fill a lattice; the next waits until the last grain has fallen below where new ones are inserted.

    Where stones throw pebbles high it waits longer, which is not counted: in the study's cylinder U1 took 1.1 to 1.3
    times as many grain-steps, U7 about twice as many. Where grains stand taller than a layer, a batch fills each second
    or third layer of its lattice.
    """
    generation, domain = scene.generation, scene.domain
    height, spacing, study = domain.height, generation.spacing, generation.fill == "r22"
    stride = int(np.ceil(pour.height / (spacing * np.sqrt(6.0) / 3.0)))
    wait = round(
        _fall_time(scene, (1.0 - REFILL_HEIGHT) * height + (0.0 if study else generation.drop_height))
        / scene.numerics.time_step
    )
    inserted, steps = [], []
    done = 0
    while True:
        low = (R22_FIRST_FILL if done == 0 else REFILL_HEIGHT) * height
        if not study:
            # The batch before has just fallen below the height where this one may begin.
            bed = pour.solid(done) / (SOLID_FRACTION * domain.area)
            low = 0.0 if done == 0 else max(bed + generation.drop_height, REFILL_HEIGHT * height)
        # Half a spacing at either end is the grains' own. On a bed that is high there is always room for a layer.
        room = done == 0 or low <= REFILL_HEIGHT * height or (not study and low < height)
        high = max(height - spacing, low if study or done == 0 else low + 0.5 * spacing)
        sites = len(lattice_sites(domain, spacing, low, high)) // stride if room else 0
        count = min(sites, pour.grains - done)
        if count == 0:  # `pack` will say that the domain is too small, or squeeze the rest in
            return inserted + [pour.grains], steps + [0]
        done += count
        inserted.append(done)
        if done == pour.grains:
            return inserted, steps + [0]
        steps.append(wait)


def _fall_time(scene, height):
    return fall_time(height, -scene.generation.velocity_z, scene.material.effective_gravity)
