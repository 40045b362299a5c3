"""Energy over time of elastic spheres without friction."""

import time

import xarray as xr

from simcore.dem.energy import mechanical_energy
from simcore.dem.from_scene import compose
from simcore.packing.packed import SHAKING
from simcore.packing.process import Process
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve

DURATION = 2.5  # [s]; 10^5 steps
MEASUREMENTS = 250


def jump(specification: dict, duration: float = DURATION, measurements: int = MEASUREMENTS) -> xr.Dataset:
    """Return the energy [J] over time [s] of the grains of a specification, beginning after the last insertion.

    specification: as read from YAML; its shaking and damping are left out. measurements: their number. Attribute:
    cpu_seconds, without compilation.
    """
    setup = set_up(resolve(specification), lambda group: [])
    process = Process(setup.scene, setup.bases, setup.draw, lambda line: None)
    process.generate()
    process.advance(1, SHAKING)  # compile before the measurement
    began = time.process_time()
    every = max(round(duration / process.dt / measurements), 1)
    times, energies = [process.step * process.dt], [total_energy(process)]
    for _ in range(measurements):
        process.advance(every, SHAKING)
        times.append(process.step * process.dt)
        energies.append(total_energy(process))
    return xr.Dataset(
        {"energy": ("time", energies, {"units": "J", "long_name": "energy of motion, height and springs"})},
        {"time": ("time", times, {"units": "s"})},
        {"cpu_seconds": time.process_time() - began},
    )


def total_energy(process):
    """Return the total energy [J], with velocities at the time of the positions."""
    process.evaluate()
    scene = process.scene
    return mechanical_energy(
        process.bodies, process.candidates, compose(scene).law, scene.material.effective_gravity, process.dt
    ).total
