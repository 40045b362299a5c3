"""A few bodies placed by hand in a Process, whose checks run as for a packing."""

import dataclasses
import functools

import numpy as np

from simcore.dem.shapes.polyhedra import SPHERE, unit_sphere
from simcore.dem.state.bodies import FLOOR, make_bodies
from simcore.packing.packed import DAMPING, SHAKING
from simcore.packing.process import Process
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve
from simcore.verification.outside.elastic import total_energy

# The grains are in air, under full gravity. The shaking of 6e-296 m/s² has no effect; with it the step is the one that
# is compiled for the other tests.
SPECIFICATION = {
    "name": "extreme",
    "domain": {"width": "64 mm", "height": "1 m"},
    "shapes": {"kind": "sphere"},
    "sizes": {"bounds": ["6 mm", "6.001 mm"], "mass_fractions": [1.0], "allow_few_top_grains": True},
    "amount": {"grains": 1},
    "material": {"fluid_density": "0 kg/m3"},
    "shaking": {"amplitude": "1e-300 m", "duration": "1 s"},
    "numerics": {"contact_time": "1 ms", "progress_interval": "1000 s"},
}


@functools.cache
def _default_scene():
    return set_up(resolve(SPECIFICATION), lambda group: []).scene


def make_scene(kind=SPHERE, **groups):
    """Return the scene of SPECIFICATION with some values changed, in SI: make_scene(material={"gravity": 100.0})."""
    scene = _default_scene()
    changed = {name: dataclasses.replace(getattr(scene, name), **values) for name, values in groups.items()}
    return dataclasses.replace(scene, kind=kind, **changed)


def place_bodies(
    scene, scale, position, velocity=(0.0, 0.0, 0.0), spin=(0.0, 0.0, 0.0), orientation=(1.0, 0.0, 0.0, 0.0),
    bases=None, shape=None,
):  # fmt: skip
    """Return a process with bodies at `position` (n, 3). The other arrays are (n, ...) or one value for all; SI."""
    bases = [unit_sphere()] if bases is None else bases
    position = np.atleast_2d(np.asarray(position, float))
    n = len(position)
    scale = np.asarray(scale, float)
    scale = np.broadcast_to(scale[:, None] if scale.shape == (n,) else scale, (n, 3))
    process = Process(scene, bases, draw=None, report=lambda line: None)
    bodies = make_bodies(
        bases, np.zeros(n, int) if shape is None else shape, scale, position, np.broadcast_to(orientation, (n, 4)),
        np.broadcast_to(velocity, (n, 3)), np.broadcast_to(spin, (n, 3)), scene.material.density,
        features=process.stepper.features,
    )  # fmt: skip
    process.place(bodies, 2.0 * float(scale.mean()))
    return process


UNDAMPED = SHAKING  # the phase without damping; the shaking of SPECIFICATION has no effect


def run_watched(process, duration, damped=False):
    """Step for `duration` [s] with the checks of a packing; returns the energy [J] at every convergence interval."""
    left = round(duration / process.dt)
    energies = []
    while left > 0:
        steps = min(left, process.interval_steps)
        process.advance(steps, DAMPING if damped else UNDAMPED)
        left -= steps
        energies.append(total_energy(process))
    return np.array(energies)


def floor_force(process):
    """Return the upward force of the floor [N] in the last evaluation of the forces."""
    walls = process.walls
    return walls.force[(walls.wall == FLOOR) & (walls.touching > 0), 2].sum()


def pair_overlap(process, a, b):
    """Return the overlap [m] of bodies a < b, 0 if they are apart."""
    contacts = process.contacts
    rows = (contacts.body_a == a) & (contacts.body_b == b) & (contacts.touching > 0)
    return float(contacts.overlap[rows].max(initial=0.0))
