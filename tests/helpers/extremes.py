"""Fixture `extreme`: a few bodies placed by hand in a Process, watched over as a packing is."""

import dataclasses
import functools

import numpy as np
import trimesh

from simcore.dem.from_scene import compose
from simcore.dem.shapes.hulls import SPHERE, Base, unit_sphere
from simcore.dem.state.bodies import FLOOR, make_bodies
from simcore.packing.energy import mechanical_energy
from simcore.packing.packed import DAMPING, SHAKING
from simcore.packing.process import Process
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve

# Grains in air, under whole gravity. Shaken by 6e-296 m/s², which nothing can see, so that the step is the one
# that is compiled for the other tests.
DEFAULT = {
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
def _default():
    return set_up(resolve(DEFAULT), lambda group: []).scene


def scene(kind=SPHERE, **groups):
    """The scene of DEFAULT with SI numbers laid over its groups: scene(material={"gravity": 100.0})."""
    made = _default()
    changed = {name: dataclasses.replace(getattr(made, name), **values) for name, values in groups.items()}
    return dataclasses.replace(made, kind=kind, **changed)


def place(
    made, scale, position, velocity=(0.0, 0.0, 0.0), spin=(0.0, 0.0, 0.0), orientation=(1.0, 0.0, 0.0, 0.0),
    bases=None, shape=None,
):  # fmt: skip
    """Process of scene `made` with bodies at `position` (n, 3); the others are (n, ...) or the same for all; SI."""
    bases = [unit_sphere()] if bases is None else bases
    position = np.atleast_2d(np.asarray(position, float))
    n = len(position)
    scale = np.asarray(scale, float)
    scale = np.broadcast_to(scale[:, None] if scale.shape == (n,) else scale, (n, 3))
    process = Process(made, bases, draw=None, report=lambda line: None)
    bodies = make_bodies(
        bases, np.zeros(n, int) if shape is None else shape, scale, position, np.broadcast_to(orientation, (n, 4)),
        np.broadcast_to(velocity, (n, 3)), np.broadcast_to(spin, (n, 3)), made.material.density,
        features=process.stepper.features,
    )  # fmt: skip
    process.place(bodies, 2.0 * float(scale.mean()))
    return process


FREE = SHAKING  # the phase without damping; see DEFAULT


def run(process, duration, damped=False):
    """Step for `duration` [s], watched at every convergence interval as a packing is; (energy [J] at each)."""
    left = round(duration / process.dt)
    energies = []
    while left > 0:
        steps = min(left, process.interval_steps)
        process.advance(steps, DAMPING if damped else FREE)
        left -= steps
        energies.append(energy(process))
    return np.array(energies)


def energy(process):
    """Energy of motion, height and normal springs [J], velocities brought up to the positions."""
    process.evaluate()
    made = process.scene
    return mechanical_energy(
        process.bodies, process.candidates, compose(made).law, made.material.effective_gravity, process.dt
    ).total


def floor_force(process):
    """Upward force of the floor [N]; forces are those of the last evaluation."""
    walls = process.walls
    return walls.force[(walls.wall == FLOOR) & (walls.touching > 0), 2].sum()


def overlap(process, a, b):
    """Overlap [m] of bodies a < b, 0 where apart."""
    contacts = process.contacts
    rows = (contacts.body_a == a) & (contacts.body_b == b) & (contacts.touching > 0)
    return float(contacts.overlap[rows].max(initial=0.0))


def hull(points, name="hull"):
    """Base of the convex hull of points (n, 3) that is about its centre of mass and principal axes already."""
    mesh = trimesh.Trimesh(points).convex_hull
    if mesh.volume < 0.0:
        mesh.invert()
    inertia = np.diag(mesh.moment_inertia) / mesh.volume
    moments = 0.5 * inertia.sum() - inertia
    return Base(name, np.array(mesh.vertices), np.array(mesh.faces, np.int64), float(mesh.volume), moments)


def box():
    """Cube of edge 1; with three scales, any brick, plate or needle."""
    mesh = trimesh.creation.box((1.0, 1.0, 1.0))
    return Base("box", np.array(mesh.vertices), np.array(mesh.faces, np.int64), 1.0, np.full(3, 1.0 / 12.0))
