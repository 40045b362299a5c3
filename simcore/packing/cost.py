"""Estimate the cost of a packing: the steps of its phases, its CPU time and its memory. This module needs no numba.

Snakemake needs cores, memory and time of hundreds of packings before the first of them starts. `estimate` therefore
uses the specification alone and reads no grain. `explanation.py` uses the grains themselves. Both describe the grains
as a `Pour` and compute the cost from the `Pour` and the Scene in the same way.
"""

import functools
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from simcore.grains.form import equal_volume_diameter
from simcore.grains.sampling import sample_grains
from simcore.packing.insertion.random_placement import fall_time, layer_grains, zone_height
from simcore.packing.insertion.waiting import check_steps, steps_of_wait
from simcore.scene.domain import lattice_sites
from simcore.scene.scene import R22_FIRST_FILL, REFILL_HEIGHT, Scene
from simcore.scene.setup import KIND_NUMBERS, make_scene, shape_choice
from simcore.scene.sizes import size_curve

# CPU time per grain and step [µs] on one thread, at the contact time and time step of Rettinger et al. (2022), by kind
# of grain and by whether contacts are patches. Measurements: docs/explanation/constants_packing.md, "Estimated cost".
STEP_COST = {("sphere", False): 0.14, ("ellipsoid", False): 0.65, ("polyhedron", False): 1.0, ("polyhedron", True): 1.4}
# CPU time per grain and step [µs] that is added if each contact is searched anew, as in the program of Rettinger et al.
# (numerics.polyhedron_contact: inflated).
INFLATED_COST = 6.0
# A packing of half ellipsoids, half polyhedra costs the mean of both.
STEP_COST |= {
    ("mixed", patch): 0.5 * (STEP_COST["ellipsoid", False] + STEP_COST["polyhedron", patch]) for patch in (0, 1)
}
# A step costs more the longer it is (remembered contacts are reused less often) and the softer the contacts are
# (patches are wider and more pairs touch). ASSUME: other grains have the exponents of pebbles with patch contacts.
R22_TIME_STEP, LONGER = 5e-6, 0.12
R22_CONTACT_TIME, SOFTER = 2e-4, 0.25
# Candidate pairs per grain at rest, measured in the packings of examples/.
CANDIDATE_PAIRS = {"sphere": 5.2, "ellipsoid": 10.0, "polyhedron": 13.4}
CANDIDATE_PAIRS["mixed"] = 0.5 * (CANDIDATE_PAIRS["ellipsoid"] + CANDIDATE_PAIRS["polyhedron"])
# Bytes per grain with its candidate pairs, as `explain` prints them for examples/, rounded up.
GRAIN_MEMORY = {"sphere": 1200, "ellipsoid": 2600, "polyhedron": 4400, "mixed": 4400}
# ASSUME: solid fraction of a poured bed, which gives its height when the next batch is inserted.
SOLID_FRACTION = 0.6
# ASSUME: time [s] until a shaken bed is at rest.
SETTLING = 0.2
# ASSUME: the same time for a bed that creeps, judged by convergence.rule `settled`; examples/deposit.yaml takes 1.4 s.
CREEPING = 1.5
# ASSUME: grains whose form is not in the specification are like the 63 synthetic ones: means by number of a grain's
# volume over that of a sphere of its sieve size, and of its longest axis over its sieve size.
SET_VOLUME, SET_LENGTH = 1.5, 1.84
# A polyhedron is longer than the ellipsoid of the same mass and inertia; the ratio is measured on the same 63 grains.
HULL_LENGTH = {"sphere": 1.0, "ellipsoid": 1.0, "polyhedron": 1.09, "mixed": 1.05}
SAMPLED = 400  # grains drawn to compute the means of volume and length of a form or a distribution of form

# ASSUME: memory [bytes] to request for a rank that compiles its step (1093 MB at its peak), for one that finds it
# compiled (317 MB), and for the Snakemake and the launcher of a job (235 MB); docs/how_to/cluster.md.
COMPILING_MEMORY, COMPILED_MEMORY, JOB_MEMORY = 1300.0e6, 500.0e6, 300.0e6
# ASSUME: number of copies of the arrays that exist while neighbour lists are rebuilt and the file is written.
COPIES = 4.0
# ASSUME: time [s] to request for compiling, and factor on the estimated time for slower machines and for ranks that
# wait for each other. A packing that takes longer continues from its last checkpoint.
START_UP, MARGIN = 900.0, 3.0

# Name of the kind in a specification, by Scene.kind.
KIND_NAMES = {number: kind for kind, number in KIND_NUMBERS.items()}


class Pour(NamedTuple):
    """The grains of a packing, as far as its cost depends on them."""

    grains: int
    solid: Callable  # solid(n) -> volume [m³] of the first n grains
    height: float  # [m], mean vertical extent of a grain when it is inserted
    reach: np.ndarray  # (k,) [m], bounding radii of a sample of the grains


class PackingCost(NamedTuple):
    """Estimated cost of one packing."""

    grains: int
    batches: int
    generating: int  # steps until the last grain is inserted
    shaking: int  # steps after that
    damping: int  # steps until it is expected to rest
    longest_damping: int  # steps after which it fails
    cpu_seconds: float
    array_bytes: float
    time_step: float  # [s]

    @property
    def steps(self) -> int:
        """Steps until the packing is expected to rest."""
        return self.generating + self.shaking + self.damping

    def memory_mb(self, ranks: int, compiled: bool = False, copies: float = COPIES) -> int:
        """Return the memory to request from the scheduler for the node of the first rank [MB].

        ranks: on this node. compiled: whether the step is compiled before the packing starts. copies: of all arrays.
        The first rank gathers the whole packing, so that no other node needs more.
        """
        process = COMPILED_MEMORY if compiled else COMPILING_MEMORY
        return int(np.ceil(1e-6 * (JOB_MEMORY + ranks * process + copies * self.array_bytes)))

    def minutes(self, cores: int) -> int:
        """Return the wall-clock time to request from the scheduler [min]."""
        return int(np.ceil((START_UP + MARGIN * self.cpu_seconds / cores) / 60.0))

    def ranks(self, max_ranks: int, grains_per_rank: int) -> int:
        """Return the number of ranks that the packing can use, between 1 and `max_ranks`."""
        return max(min(max_ranks, self.grains // grains_per_rank), 1)


def estimate(specification: dict) -> PackingCost:
    """Return the PackingCost of a resolved specification. ValueError if its settings exclude each other."""
    curve = size_curve(specification["sizes"])
    pour = typical_pour(specification, curve)
    number = pour.grains if specification["sizes"]["draw"] == "quota" else None
    scene = make_scene(specification, curve, lambda: _masses_of_spheres(specification, curve), number)
    return cost_of(scene, pour)


def cost_of(scene: Scene, pour: Pour) -> PackingCost:
    """Return the PackingCost of a scene with these grains."""
    dt = scene.numerics.time_step
    inserted, waits = plan_insertion(scene, pour)
    shaking = round(scene.shaking.duration / dt)
    longest = round(scene.damping.max_time / dt)
    damping = min(round(settling_time(scene.convergence.rule) / dt), longest)
    # The inserted grains are stepped until the next batch is inserted.
    waiting = sum(count * steps for count, steps in zip(inserted, waits, strict=True))
    grains = inserted[-1]
    grain_steps = waiting + grains * (shaking + damping)
    return PackingCost(
        grains=grains,
        batches=len(inserted),
        generating=sum(waits),
        shaking=shaking,
        damping=damping,
        longest_damping=longest,
        cpu_seconds=1e-6 * scene_step_cost(scene) * grain_steps,
        array_bytes=float(grains) * GRAIN_MEMORY[KIND_NAMES[scene.kind]],
        time_step=dt,
    )


def typical_pour(specification: dict, curve) -> Pour:
    """Return the Pour of a resolved specification with this curve; all grains are equal to the mean grain."""
    volume_factor, length_factor = _form_factors(specification, curve)
    volume = volume_factor * np.pi / 6.0 * curve.mean(3)
    height = length_factor * curve.mean(1)  # grains are inserted upright
    grains = specification["amount"]["grains"]
    if grains is None:
        grains = int(np.ceil(specification["amount"]["mass"] / (specification["material"]["density"] * volume)))
    return Pour(grains, lambda n: n * volume, height, np.array([0.5 * height]))


def _masses_of_spheres(specification, curve) -> tuple[float, float]:
    """Return the mean and the smallest mass [kg] of spheres of the curve's sizes."""
    fractions = curve.number_fractions()
    masses = specification["material"]["density"] * np.pi / 6.0 * curve.class_means(3)
    return float(fractions @ masses), float(masses[fractions > 0.0].min())


def _form_factors(specification, curve) -> tuple[float, float]:
    """Return two means by number: volume over that of a sphere of the grain's size, and length over that size."""
    shapes = specification["shapes"]
    kind = shapes["kind"]
    if kind != "sphere" and shapes["choice"] in ("one", "random"):
        return 1.0 if curve.of_volume else SET_VOLUME, SET_LENGTH * HULL_LENGTH[kind]
    smooth = replace(shape_choice(shapes), kind="sphere" if kind == "sphere" else "ellipsoid", ellipsoid_share=None)
    sample = sample_grains(np.arange(SAMPLED), specification["seed"], curve, smooth, [])
    size = equal_volume_diameter(sample.volume) if curve.of_volume else sample.D
    volume_factor = (6.0 / np.pi * sample.volume / size**3).mean()
    return float(volume_factor), float((sample.L / size).mean()) * HULL_LENGTH[kind]


def scene_step_cost(scene: Scene) -> float:
    """Return the CPU time per grain and step of the scene [µs] on one thread."""
    numerics = scene.numerics
    return step_cost(KIND_NAMES[scene.kind], numerics.polyhedron_contact, numerics.contact_time, numerics.time_step)


def step_cost(kind: str, region: str, contact_time: float, time_step: float) -> float:
    """Return the CPU time per grain and step [µs] on one thread, for this contact time and time step [s].

    region: `numerics.polyhedron_contact`, which selects point or patch contacts.
    """
    patch = kind in ("polyhedron", "mixed") and region == "patch"
    searched = INFLATED_COST if region == "inflated" else 0.0
    slower = (time_step / R22_TIME_STEP) ** LONGER * (contact_time / R22_CONTACT_TIME) ** SOFTER
    return STEP_COST[kind, patch] * slower + searched


def settling_time(rule: str) -> float:
    """Return the time [s] after which a bed is expected to be at rest by this rule of `convergence`."""
    return CREEPING if rule == "settled" else SETTLING


def plan_insertion(scene: Scene, pour: Pour) -> tuple[list[int], list[int]]:
    """Return the number of grains after each batch, and the steps until the next batch; 0 after the last."""
    if scene.generation.placement == "random":
        return _random_batches(scene, pour)
    if scene.generation.placement == "filled":
        return _filled_batches(scene, pour)
    return _lattice_batches(scene, pour)


def _random_batches(scene, pour):
    """Plan batches at random places, one every batch_interval or, if that is None, when the previous one has fallen."""
    generation, area = scene.generation, scene.domain.area
    batch = layer_grains(pour.reach, area) if generation.batch_grains is None else generation.batch_grains
    interval = generation.batch_interval
    if interval is None:
        volume = pour.solid(pour.grains) / pour.grains
        zone = zone_height(pour.reach, np.full(min(batch, pour.grains), volume), area)
        interval = _fall_time(scene, generation.drop_height + zone)
    inserted = [*range(batch, pour.grains, batch), pour.grains]
    check, dt = scene.convergence.interval, scene.numerics.time_step
    wait = max(steps_of_wait(interval, check, dt), check_steps(check, dt))
    return inserted, [wait] * (len(inserted) - 1) + [0]


def _filled_batches(scene, pour):
    """Plan batches that fill a zone above the bed; the next one is inserted when the previous one has fallen."""
    domain, generation, inserted, waits = scene.domain, scene.generation, [], []
    ends, density = 2.0 * float(np.max(pour.reach)), generation.solid_fraction * domain.area
    done, whole = 0, pour.solid(pour.grains)
    while done < pour.grains:
        bed = pour.solid(done) / (SOLID_FRACTION * domain.area) if done else 0.0
        available = domain.height - bed - generation.drop_height
        if done and available < ends:  # `pack` reports that the domain is too low, or fits the rest in
            return inserted + [pour.grains], waits + [0]
        needed = ends + (whole - pour.solid(done)) / density
        zone = max(min(needed, available), ends)
        count = pour.grains - done
        if needed > available:
            count = min(max(round(count * (zone - ends) / (needed - ends)), 1), count)
        done += count
        inserted.append(done)
        wait = _fall_time(scene, generation.drop_height + zone) / scene.numerics.time_step
        waits.append(round(wait) if done < pour.grains else 0)
    return inserted, waits


def _lattice_batches(scene, pour):
    """Plan batches that fill a lattice; each waits until all grains have fallen below the insertion height.

    Heavy stones can throw pebbles high; the longer wait is not counted. In the cylinder of Rettinger et al. (2022) U1
    took 0.9 times as many grain-steps as planned, U7 1.1 to 1.2 times and B30 1.5 times as many. If grains are taller
    than a layer of the lattice, a batch fills only every second or third layer. The last batch of Rettinger et al. is
    whole unless a number of grains is given or sizes are drawn by quota.
    """
    generation, domain = scene.generation, scene.domain
    height, spacing, r22 = domain.height, generation.spacing, generation.fill == "r22"
    whole = last_batch_is_whole(scene)
    stretch = generation.stretch_x, generation.stretch_z
    stride = int(np.ceil(pour.height / (generation.stretch_z * spacing * np.sqrt(6.0) / 3.0)))
    wait = round(
        _fall_time(scene, (1.0 - REFILL_HEIGHT) * height + (0.0 if r22 else generation.drop_height))
        / scene.numerics.time_step
    )
    inserted, steps = [], []
    done = 0
    while True:
        low = (R22_FIRST_FILL if done == 0 else REFILL_HEIGHT) * height
        if not r22:
            # The previous batch has just fallen below the height where this one may begin.
            bed = pour.solid(done) / (SOLID_FRACTION * domain.area)
            low = 0.0 if done == 0 else max(bed + generation.drop_height, REFILL_HEIGHT * height)
        # Grains take half a spacing at either end. Above a high bed there is always space for one layer.
        has_space = done == 0 or low <= REFILL_HEIGHT * height or (not r22 and low < height)
        high = max(height - spacing, low if r22 or done == 0 else low + 0.5 * spacing)
        sites = _count_sites(domain, spacing, low, high, *stretch) // stride if has_space else 0
        count = sites if whole else min(sites, pour.grains - done)
        if count == 0:  # `pack` reports that the domain is too small, or fits the rest in
            return inserted + [pour.grains], steps + [0]
        done += count
        inserted.append(done)
        if done >= pour.grains:
            return inserted, steps + [0]
        steps.append(wait)


@functools.lru_cache(maxsize=4096)
def _count_sites(domain, spacing, low, high, stretch_x, stretch_z):
    """Return the number of sites of a lattice; the batches of a packing, and packings of a study, share lattices."""
    return len(lattice_sites(domain, spacing, low, high, stretch_x, stretch_z))


def last_batch_is_whole(scene) -> bool:
    """Return whether the last batch is inserted whole, as in Rettinger et al. (2022), also beyond the mass."""
    generation = scene.generation
    return generation.placement == "lattice" and generation.fill == "r22" and scene.amount_grains is None


def _fall_time(scene, height):
    return fall_time(height, -scene.generation.velocity_z, scene.material.effective_gravity)
