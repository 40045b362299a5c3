"""A scene: everything that decides a packing besides its grains. Frozen, validated, hashable; SI units."""

from dataclasses import dataclass

import numpy as np

from simcore.dem.features import Features
from simcore.dem.force_laws import ContactLaw, contact_law
from simcore.dem.shapes import CONVEX, MIXED


@dataclass(frozen=True)
class Domain:
    """Horizontally periodic box of period `width`, or upright cylinder of that diameter; floor at z = 0."""

    type: str
    width: float
    height: float

    @property
    def periodic(self) -> bool:
        return self.type == "periodic"

    @property
    def area(self) -> float:
        return self.width**2 if self.periodic else 0.25 * np.pi * self.width**2


@dataclass(frozen=True)
class Material:
    density: float
    fluid_density: float
    gravity: float
    restitution: float
    poisson_ratio: float
    friction: float
    end_of_contact: str

    @property
    def effective_gravity(self) -> float:
        """Gravity less buoyancy [m/s²]."""
        return self.gravity * (1.0 - self.fluid_density / self.density)


@dataclass(frozen=True)
class Generation:
    """How grains are born: lattice, heights, velocities; see config/packing.schema.yaml for each."""

    spacing: float
    fill: str
    drop_height: float
    velocity_z: float
    velocity_horizontal: float
    velocity_angular: float
    orientation: str


@dataclass(frozen=True)
class Shaking:
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
    factor: float
    max_time: float


@dataclass(frozen=True)
class Convergence:
    interval: float
    height_change: float
    max_speed: float
    max_unbalanced_force: float


@dataclass(frozen=True)
class Numerics:
    contact_time: float
    steps_per_contact_time: float
    contact_region: str
    skin: float | None
    progress_interval: float

    @property
    def time_step(self) -> float:
        return self.contact_time / self.steps_per_contact_time


@dataclass(frozen=True)
class Scene:
    """One packing to be made. amount_mass [kg] or amount_grains is None. ValueError if it cannot be stepped."""

    name: str
    seed: int
    kind: int  # of simcore.dem.shapes: SPHERE, ELLIPSOID, CONVEX or MIXED
    amount_mass: float | None
    amount_grains: int | None
    domain: Domain
    material: Material
    generation: Generation
    shaking: Shaking
    damping: Damping
    convergence: Convergence
    numerics: Numerics

    def __post_init__(self):
        needed = minimum_steps_per_contact_time(self.law)
        if self.numerics.steps_per_contact_time < needed:
            raise ValueError(
                f"numerics.steps_per_contact_time: {self.numerics.steps_per_contact_time:g} is unstable for a grain "
                f"pinched between two others; at restitution {self.material.restitution:g} at least {needed:.2f} "
                f"steps are needed, and 40, the study's, for beds whose grains have many contacts to come to rest"
            )
        if self.material.fluid_density >= self.material.density:
            raise ValueError(
                f"material.fluid_density: {self.material.fluid_density:g} kg/m3 is not below the grains' density of "
                f"{self.material.density:g} kg/m3, they would not settle"
            )

    @property
    def features(self) -> Features:
        """What the step of this scene is composed of."""
        return Features(
            kind=self.kind,
            friction=self.material.friction > 0.0,
            attractive=self.material.end_of_contact == "attractive",
            floor=True,
            cylinder=not self.domain.periodic,
            periodic=self.domain.periodic,
            shaken=self.shaking.amplitude > 0.0 and self.shaking.duration > 0.0,
            patch=self.kind in (CONVEX, MIXED) and self.numerics.contact_region == "patch",
        )

    @property
    def law(self) -> ContactLaw:
        m = self.material
        return contact_law(m.restitution, self.numerics.contact_time, m.poisson_ratio, m.friction)


def minimum_steps_per_contact_time(law: ContactLaw) -> float:
    """Steps per contact time at which semi-implicit Euler is just stable for a grain held by two contacts.

    A mode with s contacts of one kind has stiffness s k and damping s d (proportional damping), and is stable up to
    dt = (√(d² + 4 k m) − d) / k with these; s = 2 occurs in any bed.
    """
    stiffness, damping = 2.0 * law.stiffness, 2.0 * law.damping
    contact_time = 2.0 * np.pi / np.sqrt(4.0 * law.stiffness - law.damping**2)
    return float(contact_time * stiffness / (np.sqrt(damping**2 + 4.0 * stiffness) - damping))
