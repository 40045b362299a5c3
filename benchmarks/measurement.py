"""CPU time of steps in a shaken bed, and what goes with the figure: contacts, solid fraction, memory, machine."""

import os
import platform
import time

import numba
import numpy as np

from benchmarks.beds import Bed, start
from simcore.compilation import source_digest
from simcore.evaluation.porosity import porosity_profile
from simcore.packing.file import packing_dataset
from simcore.packing.packed import SHAKING, Packed

FIRST_STEPS = 3
REMEMBERING = 0.005  # [s] of steps before the measurement, in which contacts find their springs and facets
STRETCHES = 10
LEAST_SOLID_FRACTION = 0.55


class LooseBed(RuntimeError):
    """The bed is too loose for its figure to mean anything."""


def compile_steps(setup):
    """Compile all that steps the setup's scene, on a dozen grains that touch nothing; dict of the seconds it took.

    Call it before anything of that scene has run. What numba's cache on disk holds is only loaded.
    """
    ids = np.arange(12)
    drawn = setup.draw(ids)
    position = np.zeros((len(ids), 3))
    position[:, 2] = 10.0 * setup.curve.largest * (1 + ids)
    upright, still = np.tile([1.0, 0.0, 0.0, 0.0], (len(ids), 1)), np.zeros((len(ids), 3))
    bed = Bed(drawn.shape, drawn.scale, drawn.sieve_size, position, upright, still, still)
    began = time.perf_counter()
    process = start(setup, bed)
    process.advance(FIRST_STEPS, SHAKING)
    compile_s = time.perf_counter() - began
    stats = process.stepper.advance_steps.stats
    return {"compile_s": compile_s, "compiled_anew": bool(sum(stats.cache_misses.values()))}


def measure(setup, bed, duration, warm_up=REMEMBERING, phase=SHAKING, **options):
    """Figures (dict) of `duration` [s] of a phase after `warm_up` [s], list rebuilds included; and the Process.

    options: of Process.
    """
    process = start(setup, bed, **options)
    n = len(bed.shape)
    process.advance(max(round(warm_up / process.dt), FIRST_STEPS), phase)
    stretch = max(round(duration / process.dt / STRETCHES), 1)
    checks, cpu = len(process.checks), []
    began = time.perf_counter()
    for _ in range(STRETCHES):
        cpu_began = time.process_time()
        process.advance(stretch, phase)
        cpu.append((time.process_time() - cpu_began) / stretch / n * 1e6)
    wall = (time.perf_counter() - began) / (STRETCHES * stretch) / n * 1e6
    seen = [check[2] for check in process.checks[checks:]]
    contacts = 0.5 * float(np.mean([each.coordination for each in seen]))  # each counts for both grains
    cpu_us = float(np.mean(cpu))
    pairs = len(process.contacts.body_a)
    figures = {
        "cpu_us_per_grain_step": cpu_us,
        "cpu_us_least": min(cpu),
        "cpu_us_most": max(cpu),
        "wall_us_per_grain_step": wall,
        "cpu_us_per_contact_step": cpu_us / contacts if contacts else None,
        "wall_us_per_contact_step": wall / contacts if contacts else None,
        "contacts_per_grain": contacts,
        "near_pairs_per_grain": pairs / n,
        "kinetic_energy_per_grain": float(np.mean([each.kinetic_energy for each in seen])) / n,
        "mean_overlap": float(np.mean([each.mean_overlap for each in seen])),
        "bytes_per_grain": _bytes(process.bodies) / n,
        "bytes_per_contact_pair": _bytes(process.contacts) / pairs if pairs else None,
        "steps": STRETCHES * stretch,
    }
    return figures, process


def measure_shares(setup, bed, duration):
    """Shares of a step's parts, from a run of its own with clocks in it."""
    process = start(setup, bed, timed=True)
    process.advance(max(round(REMEMBERING / process.dt), 1), SHAKING)
    before = dict(process.stepper.seconds)
    process.advance(max(round(duration / process.dt), 1), SHAKING)
    spent = {name: seconds - before[name] for name, seconds in process.stepper.seconds.items()}
    total = sum(spent.values())
    return {name: seconds / total for name, seconds in spent.items()}


def solid_fraction(setup, process, specification):
    """Solid fraction of the middle of the bed, slices of 1 mm between the quartiles of the grains' heights.

    Grains are sliced exactly. Unlike simcore.evaluation.porosity.bulk_porosity it asks for no surface, which a shaken
    or a narrow bed may not have.
    """
    process.evaluate()
    packed = Packed(
        process.bodies, process.candidates, process.checks[-1][2], process.step, process.step * process.dt, 0.0, []
    )
    sample = setup.sample(range(len(process.bodies.mass)))
    packing = packing_dataset(
        setup.scene, setup.bases, packed, sample, specification, largest_sieve_size=setup.curve.largest
    )
    profile = porosity_profile(packing, method="exact")
    low, high = np.quantile(process.bodies.position[:, 2], [0.25, 0.75])
    inside = (profile["z"].values > low) & (profile["z"].values < high)
    return float(1.0 - profile["porosity"].values[inside].mean())


def check_solid_fraction(name, fraction, least=LEAST_SOLID_FRACTION):
    """LooseBed where the fraction is below the least."""
    if fraction < least:
        raise LooseBed(
            f"{name}: the middle of the bed is {fraction:.3f} solid, less than {least:g}: it has not settled, or is "
            f"shaken loose; the cost of a step in it says nothing about a packing"
        )


def machine():
    """What ran it, (dict)."""
    return {
        "cpu": _cpu_name(),
        "cores": os.cpu_count(),
        "load_average": os.getloadavg()[0],
        "system": platform.platform(terse=True),
        "python": platform.python_version(),
        "numba": numba.__version__,
        "threading_layer": _threading_layer(),
        "digest": source_digest(),
    }


def _cpu_name():
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            names = [line.partition(":")[2].strip() for line in file if line.startswith("model name")]
        return names[0]
    except (OSError, IndexError):
        return platform.processor() or platform.machine()


def _threading_layer():
    try:
        return numba.threading_layer()
    except ValueError:  # no parallel kernel has run
        return None


def _bytes(arrays):
    return sum(array.nbytes for array in arrays)
