"""How much a bed is compressed by its own weight because its contacts are soft, and the warnings about it."""

import numpy as np

from simcore.dem.from_scene import compose, stiffening_advice
from simcore.grains.form import equal_volume_diameter
from simcore.packing.forecast import Grains, expected_solid_fraction
from simcore.scene.scene import Scene

# Decrease of the porosity over the mean overlap in diameters: docs/explanation/constants_packing.md.
DECREASE = 2.0
SOFT, GOOD = 0.01, 0.005  # decrease of the porosity that causes a warning, and that the advice leads to


def mean_overlap(bodies, contacts, density: float) -> float:
    """Return the mean overlap of the contacts between grains over the mean diameter of their two grains; 0 without any.

    bodies, contacts: of the whole packing; density [kg/m³]. Diameters are those of spheres of the same volume.
    """
    touching = contacts.touching > 0
    diameter = equal_volume_diameter(bodies.mass / density)
    mean = 0.5 * (diameter[contacts.body_a] + diameter[contacts.body_b])
    return float((contacts.overlap[touching] / mean[touching]).mean()) if touching.any() else 0.0


def expected_overlap(scene: Scene, grains: Grains) -> float:
    """Return the `mean_overlap` that the weight of a bed is expected to cause, right within a factor of two.

    With law hertz it is 0: that law has no stiffness before grains touch.
    """
    if scene.hertzian is not None:
        return 0.0
    solid = expected_solid_fraction(grains.sieve_size, grains.share)
    height = grains.total / (solid * scene.domain.area)
    square = grains.share @ equal_volume_diameter(grains.volume) ** -2.0
    return float(scene.material.effective_gravity * height * square / compose(scene).continuous_law.stiffness)


def expected_warnings(scene: Scene, grains: Grains) -> list[str]:
    """Return a warning if the contacts are too soft for the weight of the bed that these grains will form."""
    overlap = expected_overlap(scene, grains)
    return _warnings(scene, overlap, f"The weight of the bed will press grains into each other by about {overlap:.1%}")


def measured_warnings(scene: Scene, overlap: float) -> list[str]:
    """Return a warning if the contacts of a packing were too soft for its weight. overlap: its `mean_overlap`."""
    return _warnings(scene, overlap, f"At rest grains overlap by {overlap:.1%}")


def _warnings(scene, overlap, what):
    decrease = DECREASE * overlap
    if decrease <= SOFT:
        return []
    advice = stiffening_advice(scene, float(np.sqrt(GOOD / decrease)))
    return [f"{what} of their diameter on average, which lowers the porosity by about {decrease:.2g}. {advice}"]
