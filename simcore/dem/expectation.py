"""What can be said of a packing before its first step: how long a step its grains bear, how deep impacts go."""

from typing import NamedTuple

import numpy as np

from simcore.dem.force_laws import ContactLaw
from simcore.dem.scene import Scene
from simcore.dem.shapes import Base
from simcore.dem.stability import Estimate, contact_time, estimate_steps

GRAINS = 1000  # of the packing, whose forms stand for all
DEEP_IMPACT = 0.5  # of the thinnest grain's half thickness: a second grain that falls on the first doubles it


class Expectation(NamedTuple):
    """Of a scene with its grains."""

    stability: Estimate
    fall_speed: float  # [m/s], of a grain through the whole domain
    impact_depth: float  # [m], overlap of a grain of that speed
    half_thickness: float  # [m], of the thinnest grain


def expect(scene: Scene, bases: list[Base], draw) -> Expectation:
    """Expectation from the first GRAINS grains of the packing; draw as `pack` takes it."""
    drawn = draw(np.arange(min(GRAINS, scene.amount_grains or GRAINS)))
    stability = estimate_steps(
        scene.continuous_law, scene.features.friction, bases, drawn.shape, drawn.scale, scene.implicit
    )
    moments = np.array([base.second_moments for base in bases])[drawn.shape] * drawn.scale**2
    speed = fall_speed(scene)
    return Expectation(
        stability, speed, relative_depth(scene.continuous_law) * speed, float(np.sqrt(5.0 * moments.min()))
    )


def fall_speed(scene: Scene) -> float:
    """Speed [m/s] of a grain that has fallen through the domain from its birth."""
    birth = scene.generation.velocity_z**2 + 2.0 * scene.generation.velocity_horizontal**2
    return float(np.sqrt(birth + 2.0 * scene.material.effective_gravity * scene.domain.height))


def relative_depth(law: ContactLaw) -> float:
    """Largest overlap of an impact over its speed [s]: exp(-β t) sin(ω t) / ω at tan(ω t) = ω / β."""
    rate, beta = np.pi / contact_time(law), 0.5 * law.damping
    phase = np.arctan2(rate, beta)
    return float(np.exp(-beta / rate * phase) * np.sin(phase) / rate)


def warnings(scene: Scene, expected: Expectation) -> list[str]:
    """One line for each thing that may go wrong."""
    lines = []
    steps, needed = scene.numerics.steps_per_contact_time, expected.stability
    if needed.expected > steps:
        lines.append(
            f"{steps:g} steps per contact time are fewer than the {needed.expected:.1f} that a bed of such grains is "
            f"expected to need: grains with many contacts would jitter in them and take up energy until they slip or "
            f"part, and the bed may not come to rest. Raise numerics.steps_per_contact_time"
        )
    if expected.impact_depth > DEEP_IMPACT * expected.half_thickness:
        lines.append(
            f"a grain that falls through the domain arrives at {expected.fall_speed:.2g} m/s and sinks "
            f"{expected.impact_depth * 1e3:.2g} mm into another, where the thinnest grain is "
            f"{2e3 * expected.half_thickness:.2g} mm thick; shorten numerics.contact_time (now "
            f"{scene.numerics.contact_time:g} s) or lower the fall"
        )
    return lines
