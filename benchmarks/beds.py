"""Beds to measure in: poured once, stored in a file, tiled, and exported for other programs.

A file has the shapes, positions and motion of the grains, but no neighbour list and no remembered contacts, so that
versions of the code can be compared in the same bed. Its name has a digest of everything that determines the bed.
"""

import dataclasses
import hashlib
import json
import os
from pathlib import Path
from typing import NamedTuple

import numpy as np
import yaml

from simcore.campaign.studies import merge
from simcore.compilation import source_digest
from simcore.dem.from_scene import compose
from simcore.dem.state.bodies import make_bodies
from simcore.grains.sources import load_grains
from simcore.packing.packed import SHAKING
from simcore.packing.process import Process
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve

FORMAT = 1  # version of the file; files of other versions are not read
SPHERE_DIAMETER = 6.7e-3  # [m], geometric mean of the bounds of U1
# Volume of a grain over π/6 D³: that of the ellipsoids. Pebbles have nearly the same, which is enough for the width.
FILLING = {"sphere": 1.0, "ellipsoid": 1.45, "polyhedron": 1.45}
SOLID_FRACTION, ASPECT = 0.6, 2.0  # expected solid fraction; height of the bed over its width
LEAST_WIDTH = 2.5  # in largest sieve sizes
POURING_CONTACT_TIME = 1e-3  # [s]: a fifth of the steps; the beds differ only in their overlaps
POURING_SHAKEN = 0.3  # [s] of shaking after the last grain has fallen
# Contacts that become 25 times stiffer push the grains apart and fluidise the bed for five periods. Therefore all
# velocities are first set to 0 after every HELD_STEPS steps, HOLDS times.
HELD_STEPS, HOLDS = 20, 50
RELAXING = 0.1  # [s] of shaking at the default contact time: four periods


class Bed(NamedTuple):
    """Grains of a shaken bed in the order of their ids, in SI units.

    shape and sieve_size are (n,), orientation (n, 4) are quaternions, all others are (n, 3).
    """

    shape: np.ndarray
    scale: np.ndarray
    sieve_size: np.ndarray
    position: np.ndarray
    orientation: np.ndarray
    velocity: np.ndarray
    angular_velocity: np.ndarray


def bed_settings(shape, grains, faces=300, seed=1, overrides=None):
    """Return the raw specification of a bed about twice as high as wide.

    Spheres have one size, because other programs have one stiffness for all pairs; the other shapes have the sieve
    curve U1. Ellipsoids have the axes 1 : 0.75 : 0.5. Polyhedra are random synthetic pebbles with this number of faces,
    or with all faces ("original"). overrides: nested dict of settings that override these.
    """
    largest = 8e-3
    volume = grains * FILLING[shape] * np.pi / 6 * SPHERE_DIAMETER**3 / SOLID_FRACTION
    width = max(round(float(np.cbrt(volume / ASPECT)), 4), LEAST_WIDTH * largest)
    settings = {
        "name": f"{shape}-{grains}",
        "seed": seed,
        "domain": {"width": f"{width!r} m", "height": f"{6 * volume / width**2 + 10 * largest:.3f} m"},
        "shapes": {"kind": shape},
        "sizes": {"case": "U1"},
        "amount": {"grains": grains},
        "numerics": {"progress_interval": "30 s"},
    }
    if shape == "sphere":  # a sieve class must have a width
        equal = [f"{SPHERE_DIAMETER!r} m", f"{SPHERE_DIAMETER * (1 + 1e-9)!r} m"]
        settings["sizes"] = {"bounds": equal, "mass_fractions": [1.0], "allow_few_top_grains": True}
    elif shape == "ellipsoid":
        settings["shapes"] |= {"choice": "form", "flatness": 0.5 / 0.75, "elongation": 0.75}
    else:
        settings["shapes"] |= {"choice": "random"}
        settings["faces"] = faces
    return merge(settings, overrides or {})


def read_overrides(assignments):
    """Return the nested dict of assignments "group.key=value" with YAML values; ValueError if one has another form."""
    overrides = {}
    for assignment in assignments:
        path, equals, value = assignment.partition("=")
        if not equals or not all(path.split(".")):
            raise ValueError(f"--set {assignment}: write group.key=value, such as material.friction=0.3")
        value = yaml.safe_load(value)
        for key in reversed(path.split(".")):
            value = {key: value}
        overrides = merge(overrides, value)
    return overrides


def prepare(settings):
    """Return the Setup of a raw specification."""
    return set_up(resolve(settings), load_grains)


def settled_bed(settings, cache, report=lambda line: None):
    """Return the Bed of a raw specification: from the folder `cache`, or poured now and stored there.

    `numerics` has no effect on the bed. It is poured with a contact time of 1 ms and then shaken with 0.2 ms for whole
    periods, so that shaking continues from phase 0.
    """
    pouring = {"contact_time": f"{POURING_CONTACT_TIME!r} s", "progress_interval": "30 s"}
    settings = {**settings, "numerics": pouring}
    setup = prepare(settings)
    path = Path(cache) / f"bed-{_key(settings, setup.bases)}.npz"
    if path.exists():
        with np.load(path) as file:
            return Bed(*(file[name] for name in Bed._fields))
    bed = _pour(setup, report)
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(f".{os.getpid()}.npz")
    np.savez(part, settings=json.dumps(settings), poured_by=source_digest(), **bed._asdict())
    os.replace(part, path)
    return bed


def _key(settings, bases):
    """Return a digest (16 hexadecimal digits) of everything that determines a bed."""
    resolved = {key: value for key, value in resolve(settings).items() if key not in ("name", "numerics")}
    recipe = [FORMAT, POURING_CONTACT_TIME, POURING_SHAKEN, HELD_STEPS, HOLDS, RELAXING]
    digest = hashlib.sha256(json.dumps([recipe, resolved], sort_keys=True).encode())
    for base in bases:
        # Rounding makes the digest independent of the round-off of the machine.
        digest.update(np.round(base.vertices / np.cbrt(base.volume), 6).tobytes())
    return digest.hexdigest()[:16]


def _pour(setup, report):
    process = Process(setup.scene, setup.bases, setup.draw, report)
    process.generate()
    scene = setup.scene
    falling = np.sqrt(2.0 * scene.domain.height / scene.material.effective_gravity)
    process.shake(process.step + round((falling + POURING_SHAKEN) / process.dt))
    poured = bed_of(process, setup.draw(np.arange(len(process.bodies.mass))).sieve_size)
    fine = dataclasses.replace(
        scene, numerics=dataclasses.replace(scene.numerics, contact_time=2e-4, steps_per_contact_time=40)
    )
    process = start(setup._replace(scene=fine), poured, report)
    for _ in range(HOLDS):
        process.advance(HELD_STEPS, SHAKING)
        process.bodies.velocity[:] = 0.0
        process.bodies.angular_momentum[:] = 0.0
        process.bodies.angular_velocity[:] = 0.0
    process.state.step = 0
    process.shake(round(RELAXING / process.dt))
    report(f"{scene.name}: bed made, {process.checks[-1][2]}")
    return bed_of(process, poured.sieve_size)


def bed_of(process, sieve_size):
    """Return the current Bed of a Process; sieve_size (n,) [m]."""
    b = process.bodies
    upright = np.tile([1.0, 0.0, 0.0, 0.0], (len(b.shape), 1))  # spheres have no orientation
    orientation = b.orientation if len(b.orientation) else upright
    fields = (b.shape, b.scale, sieve_size, b.position, orientation, b.velocity, b.angular_velocity)
    return Bed(*(field.copy() for field in fields))


def start(setup, bed, report=lambda line: None, **options):
    """Return a Process of the setup's scene with this bed and no remembered contacts; options go to Process."""
    process = Process(setup.scene, setup.bases, setup.draw, report, **options)
    bodies = make_bodies(
        setup.bases,
        bed.shape,
        bed.scale,
        bed.position,
        bed.orientation,
        bed.velocity,
        bed.angular_velocity,
        density=setup.scene.material.density,
        features=process.stepper.features,
    )
    process.place(process.ranks.insert(None, bodies, process.stepper.box), float(np.mean(bed.sieve_size)))
    return process


def tile(setup, bed, times):
    """Return the Setup and Bed of times × times copies side by side, in a periodic box that many times as wide."""
    domain = setup.scene.domain
    wide = dataclasses.replace(domain, width=times * domain.width)
    fields = {name: np.concatenate([field] * times**2) for name, field in bed._asdict().items()}
    position = bed.position.copy()
    position[:, :2] %= domain.width
    place = domain.width * np.array([(i, j, 0) for i in range(times) for j in range(times)])
    fields["position"] = (place[:, None] + position).reshape(-1, 3)
    return setup._replace(scene=dataclasses.replace(setup.scene, domain=wide)), Bed(**fields)


def export_bed(path, setup, bed, steps):
    """Write the bed, all that determines its motion, and the number of steps, as .npz for benchmarks/speed/others.

    The file has the arrays of Bed, with centres wrapped into a periodic box; scalars in SI units; and the vertices and
    faces of all base shapes, with the index where those of each shape start. stiffness [1/s²] and damping [1/s] are per
    effective mass; tangential and root_tangential are the ratios of tangential to normal stiffness and damping.
    """
    scene = setup.scene
    fields = bed._asdict()
    fields["position"] = bed.position.copy()
    if scene.domain.periodic:
        fields["position"][:, :2] %= scene.domain.width
    vertices, faces = [base.vertices for base in setup.bases], [base.faces for base in setup.bases]
    np.savez(
        path,
        **fields,
        vertices=np.concatenate(vertices),
        vertex_start=np.cumsum([0, *map(len, vertices)]),
        faces=np.concatenate(faces).reshape(-1, 3),
        face_start=np.cumsum([0, *map(len, faces)]),
        polyhedra=bool(len(vertices[0])),
        width=scene.domain.width,
        density=scene.material.density,
        gravity=scene.material.effective_gravity,
        contact_time=scene.numerics.contact_time,
        time_step=scene.numerics.time_step,
        steps=steps,
        shaking=scene.shaking.acceleration,
        shaking_rate=scene.shaking.rate,
        **compose(scene).law._asdict(),
    )
