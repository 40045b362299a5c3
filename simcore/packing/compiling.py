"""Compile the steps of packings ahead of time, so that packings which start together do not compile the same step."""

import numpy as np

from simcore.dem.from_scene import compose
from simcore.dem.state.bodies import make_bodies
from simcore.grains.mesh import make_grain
from simcore.packing.process import Process
from simcore.scene.setup import set_up


def compile_steps(specifications, report) -> int:
    """Compile each step that the packings of these resolved specifications need; return the number of steps.

    A step that the cache on disk has is not compiled again. report(text): called before a step is compiled. No grain
    file is read: the compiled code does not depend on the grains, so a cuboid takes their place.
    """
    compiled = set()
    for specification in specifications:
        setup = set_up(_with_any_grain(specification), lambda group: [_cuboid()])
        features = compose(setup.scene).features
        if features not in compiled:
            compiled.add(features)
            compile_step(setup, report)
    return len(compiled)


def compile_step(setup, report) -> None:
    """Compile all functions that the steps of a packing call, by stepping two grains that touch nothing."""
    process = Process(setup.scene, setup.bases, setup.draw, report)
    drawn = setup.draw(np.zeros(2, np.int64))
    position = np.zeros((2, 3))
    position[:, 2] = 10.0 * drawn.sieve_size.max() * np.arange(1, 3)
    upright, still = np.tile([1.0, 0.0, 0.0, 0.0], (2, 1)), np.zeros((2, 3))
    density = setup.scene.material.density
    process.place(
        make_bodies(
            setup.bases,
            drawn.shape,
            drawn.scale,
            position,
            upright,
            still,
            still,
            density,
            features=process.stepper.features,
        ),
        float(drawn.sieve_size.mean()),
    )
    process.list_candidates()  # only a second listing compiles the code that takes over remembered contacts
    process.evaluate()


def _with_any_grain(specification):
    """Return the specification with a random choice of grains instead of one grain chosen by its name."""
    shapes = specification["shapes"]
    if shapes["choice"] != "one":
        return specification
    return {**specification, "shapes": {**shapes, "choice": "random", "grain": None}}


def _cuboid():
    corners = np.array(np.meshgrid([-1.0, 1.0], [-1.0, 1.0], [-1.0, 1.0])).reshape(3, 8).T
    return make_grain("cuboid", 1e-3 * corners * [4.0, 3.0, 2.0])
