"""Number of steps per contact time at which a bed comes to rest and remains at rest, with either dashpot.

A small bed is poured and settled with fine steps. From this state, it is stepped with other steps, first with damping
and then free, without shaking. The motion that remains is caused by the time step.
"""

import dataclasses
import time

import numpy as np
import pandas as pd

from simcore.dem.from_scene import compose
from simcore.dem.stability import minimum_steps_per_contact_time
from simcore.dem.state.bodies import make_bodies
from simcore.grains.sources import load_grains
from simcore.packing.packed import DAMPING, SHAKING, PackingError
from simcore.packing.process import Process
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve

STEPS = (40, 20, 14, 10, 8, 6)
SHAPES = ("sphere", "polyhedron")
DAMPED, FREE, CHECKS = 0.3, 0.3, 6  # [s], [s], number of measurements of the free bed
SPECIFICATION = {
    "name": "rest",
    "domain": {"width": "27 mm", "height": "0.3 m"},
    "sizes": {"case": "U1", "allow_few_top_grains": True},
    "faces": 60,
    "amount": {"grains": 120},
    "shaking": {"duration": "0.3 s"},
    "numerics": {"contact_time": "1 ms", "progress_interval": "1 h"},
}


def rest_table(shapes=SHAPES, steps=STEPS, specification=SPECIFICATION) -> pd.DataFrame:
    """Return one row per shape, dashpot and number of steps per contact time.

    Columns: kinetic_energy, the largest value of the free bed after damping, in units of its weight times the mean
    sieve size; unbalanced_force, mean_overlap [m], coordination and mean_height [m] at the end; cpu_s [s]. A bed that
    flies apart has infinite energy. Numbers of steps at which a grain pinched between two others is unstable have no
    row.
    """
    rows = []
    for shape in shapes:
        setup = set_up(resolve({**specification, "shapes": {"kind": shape}}), load_grains)
        settled = Process(setup.scene, setup.bases, setup.draw, lambda line: None)
        settled.run()
        for dashpot in ("explicit", "implicit"):
            for count in steps:
                law = compose(setup.scene).continuous_law
                if count >= minimum_steps_per_contact_time(law, dashpot == "implicit"):
                    rows.append(
                        {"shape": shape, "dashpot": dashpot, "steps": count} | _step_bed(setup, settled, dashpot, count)
                    )
    return pd.DataFrame(rows)


def _step_bed(setup, settled, dashpot, steps):
    """Step the settled bed with damping and then free; return the measured columns of a row as a dict."""
    scene = setup.scene
    scene = dataclasses.replace(
        scene,
        numerics=dataclasses.replace(scene.numerics, dashpot=dashpot, steps_per_contact_time=steps),
        # The amplitude is too small to move anything; with it the step of the shaken bed is reused without compiling.
        shaking=dataclasses.replace(scene.shaking, amplitude=1e-30),
    )
    process = Process(scene, setup.bases, setup.draw, lambda line: None)
    drawn = setup.draw(np.arange(len(settled.bodies.mass)))
    size = float(np.mean(drawn.sieve_size))
    b = settled.bodies
    upright = np.tile([1.0, 0.0, 0.0, 0.0], (len(b.mass), 1))  # spheres carry no orientation
    orientation = b.orientation if len(b.orientation) else upright
    still = np.zeros_like(b.position)
    process.place(
        make_bodies(
            setup.bases,
            b.shape,
            b.scale,
            b.position,
            orientation,
            still,
            still,
            scene.material.density,
            features=process.stepper.features,
        ),
        size,
    )
    process.advance(1, DAMPING)  # compile before the measurement
    unit = b.mass.sum() * scene.material.effective_gravity * size
    began, energy = time.process_time(), 0.0
    try:
        process.advance(round(DAMPED / process.dt), DAMPING)
        for _ in range(CHECKS):
            measured = process.advance(round(FREE / CHECKS / process.dt), SHAKING)
            energy = max(energy, measured.kinetic_energy / unit)
    except PackingError:
        return {"kinetic_energy": np.inf}
    names = ("unbalanced_force", "mean_overlap", "coordination", "mean_height")
    kept = {name: getattr(measured, name) for name in names}
    return {"kinetic_energy": energy, **kept, "cpu_s": time.process_time() - began}
