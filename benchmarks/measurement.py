"""CPU time of steps in a shaken bed, with contacts, solid fraction, memory and machine."""

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
REMEMBERING = 0.005  # [s] of steps before the measurement, after which contacts are remembered ones
STRETCHES = 10
LEAST_SOLID_FRACTION = 0.55


class LooseBed(RuntimeError):
    """The bed is too loose for its cost to represent that of a packing."""


def compile_steps(setup):
    """Compile the step of the setup's scene with twelve grains that do not touch; return a dict with the time [s].

    Call this before anything of the scene has run. `compiled_anew` is False if numba loaded the step from its cache.
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
    """Return the figures (dict) of `duration` [s] of a phase after `warm_up` [s], and the Process.

    The CPU time includes that of new neighbour lists. options: those of Process.
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
    observed = [check[2] for check in process.checks[checks:]]
    contacts = 0.5 * float(np.mean([item.coordination for item in observed]))  # each contact counts for both grains
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
        "kinetic_energy_per_grain": float(np.mean([item.kinetic_energy for item in observed])) / n,
        "mean_overlap": float(np.mean([item.mean_overlap for item in observed])),
        "bytes_per_grain": _bytes(process.bodies) / n,
        "bytes_per_contact_pair": _bytes(process.contacts) / pairs if pairs else None,
        "steps": STRETCHES * stretch,
    }
    return figures, process


def measure_shares(setup, bed, duration):
    """Return the share of each part of a step in its time (dict), from a separate run with timers."""
    process = start(setup, bed, timed=True)
    process.advance(max(round(REMEMBERING / process.dt), 1), SHAKING)
    before = dict(process.stepper.seconds)
    process.advance(max(round(duration / process.dt), 1), SHAKING)
    spent = {name: seconds - before[name] for name, seconds in process.stepper.seconds.items()}
    total = sum(spent.values())
    return {name: seconds / total for name, seconds in spent.items()}


def solid_fraction(setup, process, specification):
    """Return the solid fraction of the middle of the bed: slices of 1 mm between the quartiles of the grains' heights.

    The slices are exact. Unlike simcore.evaluation.porosity.bulk_porosity, this requires no surface, which a shaken or
    a narrow bed may lack.
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
    """Raise LooseBed if the solid fraction is smaller than `least`."""
    if fraction < least:
        raise LooseBed(
            f"{name}: the solid fraction in the middle of the bed is {fraction:.3f}, less than {least:g}. The bed has "
            "not settled, or shaking loosens it; the cost of its steps does not represent that of a packing."
        )


def machine():
    """Return a dict that describes the machine, the software and the version of the code."""
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
