"""At how many steps per contact time a bed comes to rest, and stays so, with either dashpot.

A small bed is poured and settled with fine steps. From there it is stepped anew, damped and then left alone, without
shaking: what motion is left then, the time step makes.
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
DAMPED, FREE, CHECKS = 0.3, 0.3, 6  # [s], [s], looks at the free bed
SPECIFICATION = {
    "name": "rest",
    "domain": {"width": "27 mm", "height": "0.3 m"},
    "sizes": {"case": "U1", "allow_few_top_grains": True},
    "faces": 60,
    "amount": {"grains": 120},
    "shaking": {"duration": "0.3 s"},
    "numerics": {"contact_time": "1 ms", "progress_interval": "1 h"},
}


def study(shapes=SHAPES, steps=STEPS, specification=SPECIFICATION) -> pd.DataFrame:
    """One row for each shape, dashpot and number of steps per contact time.

    kinetic_energy: the largest of the free bed after damping, in units of its weight times the mean sieve size;
    unbalanced_force, mean_overlap [m], coordination and mean_height [m] at the end; cpu_s [s]. A bed that flies apart
    has an infinite energy. Steps that a grain pinched between two others does not bear have no row.
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
                        {"shape": shape, "dashpot": dashpot, "steps": count} | _leave(setup, settled, dashpot, count)
                    )
    return pd.DataFrame(rows)


def _leave(setup, settled, dashpot, steps):
    scene = setup.scene
    scene = dataclasses.replace(
        scene,
        numerics=dataclasses.replace(scene.numerics, dashpot=dashpot, steps_per_contact_time=steps),
        # So faint that it moves nothing: the composed step stays that of the shaken bed, and need not be compiled.
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
    process.advance(1, DAMPING)  # compiled now
    unit = b.mass.sum() * scene.material.effective_gravity * size
    began, energy = time.process_time(), 0.0
    try:
        process.advance(round(DAMPED / process.dt), DAMPING)
        for _ in range(CHECKS):
            seen = process.advance(round(FREE / CHECKS / process.dt), SHAKING)
            energy = max(energy, seen.kinetic_energy / unit)
    except PackingError:
        return {"kinetic_energy": np.inf}
    kept = {name: getattr(seen, name) for name in ("unbalanced_force", "mean_overlap", "coordination", "mean_height")}
    return {"kinetic_energy": energy, **kept, "cpu_s": time.process_time() - began}
