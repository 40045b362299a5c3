"""Scene: everything besides the grains that determines a packing, as frozen, hashable data in SI units.

simcore.dem.from_scene derives the parts, force laws and limits of the time step from it.
"""

from dataclasses import dataclass

import numpy as np

from simcore.scene.domain import Domain
from simcore.scene.impact import Hertzian
from simcore.scene.shapes import MIXED, POLYHEDRON

SPRUNG = ("static", "preloaded")  # friction laws with a tangential spring
# Lower end of the insertion heights of Rettinger et al. (2022) as a share of the domain's height: of all batches but
# the first, and of the first.
REFILL_HEIGHT = 0.6
R22_FIRST_FILL = 0.1
LEAST_STEPS = 20  # time steps in a period of shaking
GRAINS = 1000  # number of the first grains of a packing that represent all in the setup and checks of a scene


@dataclass(frozen=True)
class Material:
    """Grains, fluid and contact law; config/packing.schema.yaml describes each field."""

    density: float
    fluid_density: float
    gravity: float
    restitution: float
    poisson_ratio: float
    friction: float
    end_of_contact: str
    law: str = "spring_dashpot"
    youngs_modulus: float | None = None
    overlap_at_rest: float | None = None
    restitution_speed: float = 1.0
    friction_law: str = "static"
    sliding_time: float = 1e-2

    @property
    def effective_gravity(self) -> float:
        """Gravity minus buoyancy [m/s²]."""
        return self.gravity * (1.0 - self.fluid_density / self.density)


@dataclass(frozen=True)
class Generation:
    """Insertion of the grains: lattice, heights, velocities; config/packing.schema.yaml describes each."""

    spacing: float
    fill: str
    drop_height: float
    velocity_z: float
    velocity_horizontal: float
    velocity_angular: float
    orientation: str
    placement: str = "lattice"
    batch_grains: int | None = None
    batch_interval: float | None = None
    solid_fraction: float = 0.2
    stretch_x: float = 1.0
    stretch_z: float = 1.0


@dataclass(frozen=True)
class Shaking:
    """Horizontal shaking; config/packing.schema.yaml describes each field."""

    amplitude: float
    period: float
    duration: float

    @property
    def rate(self) -> float:
        """Angular frequency [1/s]."""
        return 2.0 * np.pi / self.period

    @property
    def acceleration(self) -> float:
        """Amplitude of the acceleration [m/s²], A (2π/T)²."""
        return self.amplitude * self.rate**2


@dataclass(frozen=True)
class Damping:
    """Damping after the shaking; config/packing.schema.yaml describes each field."""

    factor: float
    max_time: float


@dataclass(frozen=True)
class Convergence:
    """Criteria of rest; config/packing.schema.yaml describes each field."""

    interval: float
    height_change: float
    max_speed: float
    max_unbalanced_force: float
    rule: str = "still"
    window: float = 0.1
    compaction: float = 5e-4
    kinetic_energy: float = 1e-5


@dataclass(frozen=True)
class Numerics:
    """Numerical settings; config/packing.schema.yaml describes each field."""

    contact_time: float
    steps_per_contact_time: float
    dashpot: str
    polyhedron_contact: str
    skin: float | None
    progress_interval: float
    ellipsoid_contact: str = "common_normal"

    @property
    def time_step(self) -> float:
        """Time step [s]."""
        return self.contact_time / self.steps_per_contact_time


@dataclass(frozen=True)
class Scene:
    """One packing to be made; either amount_mass [kg] or amount_grains is None. ValueError if settings contradict."""

    name: str
    seed: int
    kind: int  # of simcore.scene.shapes: SPHERE, ELLIPSOID, POLYHEDRON or MIXED
    amount_mass: float | None
    amount_grains: int | None
    domain: Domain
    material: Material
    generation: Generation
    shaking: Shaking
    damping: Damping
    convergence: Convergence
    numerics: Numerics
    hertzian: Hertzian | None = None  # with material.law hertz; then its duration is numerics.contact_time

    def __post_init__(self):
        if self.hertzian is not None and self.implicit:
            raise ValueError(
                "numerics.dashpot: implicit works only with material.law spring_dashpot; use explicit with law hertz, "
                "whose dashpots are weak in a bed at rest"
            )
        if self.material.friction_law not in SPRUNG and self.implicit:
            raise ValueError(
                f"numerics.dashpot: implicit works only with material.friction_law {' and '.join(SPRUNG)}; use "
                f"explicit with {self.material.friction_law}"
            )
        if self.shaking.amplitude > 0.0 and self.shaking.period < LEAST_STEPS * self.numerics.time_step:
            raise ValueError(
                f"shaking.period: {self.shaking.period:g} s are fewer than {LEAST_STEPS} time steps of "
                f"{self.numerics.time_step:.3g} s, which do not resolve the shaking; give a longer period, or "
                + ("stiffer grains" if self.hertzian is not None else "a shorter numerics.contact_time")
            )
        if self.damping.max_time < self.convergence.interval:
            raise ValueError(
                f"damping.max_time: {self.damping.max_time:g} s are shorter than convergence.interval, "
                f"{self.convergence.interval:g} s, after which rest is checked; give a longer time"
            )
        if self.material.fluid_density >= self.material.density:
            raise ValueError(
                f"material.fluid_density: {self.material.fluid_density:g} kg/m3 is not below the grains' density of "
                f"{self.material.density:g} kg/m3, so they would not settle; give a lower value"
            )
        if self.kind == MIXED and self.numerics.ellipsoid_contact == "potential":
            raise ValueError(
                "numerics.ellipsoid_contact: potential works only if all grains are ellipsoids; set it to "
                "common_normal, or shapes.kind to ellipsoid"
            )
        if self.kind != POLYHEDRON and self.numerics.polyhedron_contact == "inflated":
            raise ValueError(
                "numerics.polyhedron_contact: inflated works only if all grains are polyhedra; set it to patch or "
                "point, or shapes.kind to polyhedron"
            )

    @property
    def implicit(self) -> bool:
        """Whether dashpots use the velocity at the end of the step as well (numerics.dashpot implicit)."""
        return self.numerics.dashpot == "implicit"
