"""What a packing costs, from its specification alone: no grain is read or drawn, and no numba is needed.

For a scheduler, which must know cores, memory and time of hundreds of packings before the first of them starts.
`explanation.py` says it of one packing with its grains at hand, from the same tables.
"""

from dataclasses import replace
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np

from simcore.grains.sampling import sample_grains
from simcore.grains.spread import shape_choice
from simcore.packing.insertion.random_placement import fall_time, layer_grains, zone_height
from simcore.scene.domain import Domain, lattice_sites
from simcore.scene.impact import derive_hertzian, fall_speed
from simcore.scene.sizes import lattice_spacing, size_curve

# CPU time of a grain and step [µs], one thread, at the study's contact time and step: kind of grain, whether patches
# are found. The one table of it. Of patches from the packings of `paper` in results/reference/accuracy.csv (1.1 to 1.7
# on three machines), the others by `python -m benchmarks.speed.throughput --shape ...` (docs/cost.md), where
# ellipsoids had 0.55 and 0.76 on two machines.
STEP_COST = {("sphere", False): 0.14, ("ellipsoid", False): 0.65, ("mesh", False): 1.0, ("mesh", True): 1.4}
# What searching each contact anew adds, as the study's program does (numerics.contact_region inflated): 6 to 8 µs a
# search (`python -m benchmarks.studies.inflated`), 4 and 7 µs a grain and step in the first two beds of
# difference_search.
INFLATED_COST = 6.0
# Half of the one and half of the other cost the mean of both, to 2 %.
STEP_COST |= {("mixed", patch): 0.5 * (STEP_COST["ellipsoid", False] + STEP_COST["mesh", patch]) for patch in (0, 1)}
# The dearer, the longer the step (memory of a contact holds for less) and the softer the contacts (patches are wide,
# more pairs touch): powers of both, from the CPU times of results/reference/work_precision/packings.csv, 10 to 80
# steps in 2 ms and 0.25 to 2 ms in 10 steps, pebbles with patches; of other grains
# ASSUME: the same.
STUDY_STEP, LONGER = 5e-6, 0.12
STUDY_CONTACT_TIME, SOFTER = 2e-4, 0.25
# Near pairs that a grain at rest brings into the list; measured in the packings of examples/.
NEAR_PAIRS = {"sphere": 5.2, "ellipsoid": 10.0, "mesh": 13.4}
NEAR_PAIRS["mixed"] = 0.5 * (NEAR_PAIRS["ellipsoid"] + NEAR_PAIRS["mesh"])
# Bytes of a grain with its near pairs, as `explain` says them for examples/, rounded up.
GRAIN_MEMORY = {"sphere": 1200, "ellipsoid": 2600, "mesh": 4400, "mixed": 4400}
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
HULL_LENGTH = {"sphere": 1.0, "ellipsoid": 1.0, "mesh": 1.09, "mixed": 1.05}
SAMPLED = 400  # grains that say what those of a form, or of a distribution of form, are in the mean
# Of simcore.packing.insertion.batches, where the study's batches begin, relative to the height of the domain.
STUDY_FIRST_FILL, REFILL_HEIGHT = 0.1, 0.6

# ASSUME: what is asked of a scheduler for a process with numba's compiler; the arrays are there several times while
# lists are rebuilt and the file is written.
PROCESS_MEMORY, COPIES = 1000.0e6, 4.0
# ASSUME: compiling comes first; then the estimate, with a margin for slower machines and for ranks that wait for each
# other. What is not done in this time goes on from its last checkpoint.
START_UP, MARGIN = 900.0, 3.0


class PackingCost(NamedTuple):
    """Estimates for one packing."""

    grains: int
    steps: int  # until it is expected to rest
    cpu_seconds: float
    array_bytes: float

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
    """PackingCost of a resolved specification."""
    kind, numerics = specification["shapes"]["kind"], specification["numerics"]
    curve = size_curve(specification["sizes"])
    bulkier, longer = _form_factors(specification, curve)
    volume = bulkier * np.pi / 6.0 * curve.mean(3)
    height = longer * curve.mean(1)  # as they are born, upright
    grains = specification["amount"]["grains"]
    if grains is None:
        grains = int(np.ceil(specification["amount"]["mass"] / (specification["material"]["density"] * volume)))
    domain, generation = Domain(**specification["domain"]), specification["generation"]
    spacing = lattice_spacing(specification, curve)
    layer = spacing * np.sqrt(6.0) / 3.0
    stride = int(np.ceil(height / layer))
    gravity = effective_gravity(specification["material"])
    drop_height = spacing if generation["drop_height"] is None else generation["drop_height"]
    dt = contact_time(specification, curve) / numerics["steps_per_contact_time"]
    if generation["placement"] == "random":
        born, waits = releases(
            grains,
            generation["batch_grains"],
            generation["batch_interval"],
            np.array([0.5 * height]),
            volume,
            area=domain.area,
            drop_height=drop_height,
            velocity=-generation["velocity_z"],
            gravity=gravity,
            time_step=dt,
        )
    else:
        born, waits = births(
            grains,
            lambda done: done * volume / (SOLID_FRACTION * domain.area),
            lambda low, high: len(lattice_sites(domain, spacing, low, high)) // stride,
            study=generation["fill"] == "study",
            height=domain.height,
            spacing=spacing,
            drop_height=drop_height,
            velocity=-generation["velocity_z"],
            gravity=gravity,
            time_step=dt,
        )
    after = round((specification["shaking"]["duration"] + settling_time(specification["convergence"]["rule"])) / dt)
    grain_steps = sum(count * steps for count, steps in zip(born, waits, strict=True)) + grains * after
    cost = step_cost(kind, numerics["contact_region"], contact_time(specification, curve), dt)
    return PackingCost(
        grains=grains,
        steps=sum(waits) + after,
        cpu_seconds=1e-6 * cost * grain_steps,
        array_bytes=float(grains) * GRAIN_MEMORY[kind],
    )


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


def step_cost(kind: str, region: str, contact_time: float, time_step: float) -> float:
    """CPU time of a grain and step [µs], one thread, at this contact time and step [s].

    region: where polyhedra press, numerics.contact_region.
    """
    patch = kind in ("mesh", "mixed") and region == "patch"
    searched = INFLATED_COST if region == "inflated" else 0.0
    slower = (time_step / STUDY_STEP) ** LONGER * (contact_time / STUDY_CONTACT_TIME) ** SOFTER
    return STEP_COST[kind, patch] * slower + searched


def effective_gravity(material: dict) -> float:
    """Gravity less buoyancy [m/s²]."""
    return material["gravity"] * (1.0 - material["fluid_density"] / material["density"])


def settling_time(rule: str) -> float:
    """Time [s] until a bed is expected to be at rest by a rule of `convergence`."""
    return CREEPING if rule == "settled" else SETTLING


def contact_time(specification: dict, curve) -> float:
    """Contact time [s] of a resolved specification; of law hertz as derived from spheres of the curve's sizes."""
    material, generation = specification["material"], specification["generation"]
    if material["law"] == "spring_dashpot":
        return specification["numerics"]["contact_time"]
    fractions = curve.number_fractions()
    masses = material["density"] * np.pi / 6.0 * curve.class_means(3)
    gravity = effective_gravity(material)
    speed = fall_speed(SimpleNamespace(**generation), specification["domain"]["height"], gravity)
    known = SimpleNamespace(**material, effective_gravity=gravity)
    return derive_hertzian(known, float(fractions @ masses), float(masses[fractions > 0.0].min()), speed).duration


def releases(
    grains, batch, interval, reach, volume, *, area, drop_height, velocity, gravity, time_step
) -> tuple[list[int], list[int]]:
    """As births, of batches strewn at random: every `interval` [s], or, where that is None, when one has fallen.

    batch: grains, None as simcore.packing.insertion.random_placement has it. reach (k,) [m]: bounding radii of some
    grains; volume [m³]: of a mean one. area: [m²].
    """
    batch = layer_grains(reach, area) if batch is None else batch
    if interval is None:
        zone = zone_height(reach, np.full(min(batch, grains), volume), area)
        interval = fall_time(drop_height + zone, velocity, gravity)
    born = [*range(batch, grains, batch), grains]
    return born, [round(interval / time_step)] * (len(born) - 1) + [0]


def births(
    grains, bed_height, sites, *, study, height, spacing, drop_height, velocity, gravity, time_step
) -> tuple[list[int], list[int]]:
    """Grains there are after each batch, and steps until the next; none after the last.

    A batch fills its lattice; the next waits until the last grain of it has fallen below where new ones are born. Where
    stones throw pebbles high it waits longer, which is not counted: in the study's cylinder U1 took 1.1 to 1.3 times
    as many grain-steps, U7 about twice as many.
    bed_height(done) [m] of so many grains; sites(low, high): grains that find room between these heights. study: fill
    as the study does. height: of the domain [m]; velocity: downward at birth [m/s]; gravity: effective [m/s²].
    """
    born, steps = [], []
    done = 0
    while True:
        low = (STUDY_FIRST_FILL if done == 0 else REFILL_HEIGHT) * height
        if not study:
            # The batch before has just fallen below the height where this one may begin.
            low = 0.0 if done == 0 else max(bed_height(done) + drop_height, REFILL_HEIGHT * height)
        # Half a spacing at either end is the grains' own. On a bed that is high there is always room for a layer.
        room = done == 0 or low <= REFILL_HEIGHT * height or (not study and low < height)
        high = max(height - spacing, low if study or done == 0 else low + 0.5 * spacing)
        count = min(sites(low, high), grains - done) if room else 0
        if count == 0:  # `pack` will say that the domain is too small, or squeeze the rest in
            return born + [grains], steps + [0]
        done += count
        born.append(done)
        if done == grains:
            return born, steps + [0]
        fall = (1.0 - REFILL_HEIGHT) * height + (0.0 if study else drop_height)
        steps.append(round((np.sqrt(velocity**2 + 2.0 * gravity * fall) - velocity) / gravity / time_step))
