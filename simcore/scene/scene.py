"""A scene: everything that decides a packing besides its grains. Frozen, validated, hashable; SI units."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from simcore.dem.forces.hertz import HertzLaw, hertz_law, linear_law
from simcore.dem.forces.sliding import CAPPED, NONE, VISCOUS
from simcore.dem.forces.spring_dashpot import ContactLaw, contact_law, explicit_dashpot, implicit_dashpot, implicit_law
from simcore.dem.shapes.hulls import CONVEX, ELLIPSOID, MIXED
from simcore.dem.state.features import Features
from simcore.scene.domain import Domain
from simcore.scene.impact import Hertzian

# Steps per contact time with which beds of the default material came to rest: `snakemake work_precision`, rest.csv.
STEPS_FOR_REST = {"explicit": 40, "implicit": 10}
SPRUNG = ("static", "preloaded")  # friction laws with a tangential spring


@dataclass(frozen=True)
class Material:
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
    placement: str = "lattice"
    batch_grains: int | None = None
    batch_interval: float | None = None


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
    rule: str = "still"
    window: float = 0.1
    compaction: float = 5e-4
    kinetic_energy: float = 1e-5


@dataclass(frozen=True)
class Numerics:
    contact_time: float
    steps_per_contact_time: float
    dashpot: str
    contact_region: str
    skin: float | None
    progress_interval: float
    ellipsoid_contact: str = "common_normal"

    @property
    def time_step(self) -> float:
        return self.contact_time / self.steps_per_contact_time


@dataclass(frozen=True)
class Scene:
    """One packing to be made. amount_mass [kg] or amount_grains is None. ValueError if it cannot be stepped."""

    name: str
    seed: int
    kind: int  # of simcore.dem.shapes.hulls: SPHERE, ELLIPSOID, CONVEX or MIXED
    amount_mass: float | None
    amount_grains: int | None
    domain: Domain
    material: Material
    generation: Generation
    shaking: Shaking
    damping: Damping
    convergence: Convergence
    numerics: Numerics
    hertzian: Hertzian | None = None  # of material.law hertz; numerics.contact_time then is its duration

    def __post_init__(self):
        if self.hertzian is not None and self.implicit:
            raise ValueError(
                "numerics.dashpot: implicit is for material.law spring_dashpot; of law hertz the dashpots of a bed at "
                "rest are weak, take explicit"
            )
        if self.material.friction_law not in SPRUNG and self.implicit:
            raise ValueError(
                f"numerics.dashpot: implicit is for material.friction_law {' and '.join(SPRUNG)}, not "
                f"{self.material.friction_law}; take explicit"
            )
        needed = self.least_steps
        if self.numerics.steps_per_contact_time < needed:
            raise ValueError(
                f"numerics.steps_per_contact_time: {self.numerics.steps_per_contact_time:g} is unstable for a grain "
                f"pinched between two others; at restitution {self.material.restitution:g} with an "
                f"{self.numerics.dashpot} dashpot at least {needed:.2f} steps are needed, and "
                f"{STEPS_FOR_REST[self.numerics.dashpot]} for beds whose grains have many contacts to come to rest"
            )
        if self.material.fluid_density >= self.material.density:
            raise ValueError(
                f"material.fluid_density: {self.material.fluid_density:g} kg/m3 is not below the grains' density of "
                f"{self.material.density:g} kg/m3, they would not settle"
            )
        if self.kind == MIXED and self.numerics.ellipsoid_contact == "potential":
            raise ValueError(
                "numerics.ellipsoid_contact: potential is for scenes of ellipsoids alone; set it to common_normal, or "
                "shapes.kind to ellipsoid"
            )
        if self.kind != CONVEX and self.numerics.contact_region == "inflated":
            raise ValueError(
                "numerics.contact_region: inflated is for scenes of polyhedra alone; set it to patch or point, or "
                "shapes.kind to mesh"
            )

    @property
    def features(self) -> Features:
        """What the step of this scene is composed of."""
        return Features(
            kind=self.kind,
            friction=self._springs,
            attractive=self.material.end_of_contact == "attractive",
            floor=True,
            cylinder=not self.domain.periodic,
            periodic=self.domain.periodic,
            shaken=self.shaking.amplitude > 0.0,
            patch=self.kind in (CONVEX, MIXED) and self.numerics.contact_region == "patch",
            implicit=self.implicit,
            potential=self.kind == ELLIPSOID and self.numerics.ellipsoid_contact == "potential",
            hertz=self.hertzian is not None,
            sliding=self._sliding,
            preloaded=self._springs and self.material.friction_law == "preloaded",
            inflated=self.numerics.contact_region == "inflated",
        )

    @property
    def implicit(self) -> bool:
        """Whether the dashpot is."""
        return self.numerics.dashpot == "implicit"

    @property
    def _springs(self) -> bool:
        """Whether friction remembers shear."""
        return self.material.friction > 0.0 and self.material.friction_law in SPRUNG

    @property
    def _sliding(self) -> int:
        if self.material.friction_law == "dynamic":
            return CAPPED if self.material.friction > 0.0 else NONE
        return VISCOUS if self.material.friction_law == "viscous" else NONE

    @property
    def law(self) -> ContactLaw | HertzLaw:
        """The law as this scene's time step applies it."""
        if self.hertzian is not None:
            m = self.material
            return hertz_law(self.hertzian, m.poisson_ratio, m.friction, m.density, self._sliding_rate)
        return implicit_law(self.continuous_law, self.numerics.time_step) if self.implicit else self.continuous_law

    @property
    def continuous_law(self) -> ContactLaw:
        """What it tends to with the time step; of law hertz the linear law of the stiffest expected contact."""
        m = self.material
        if self.hertzian is not None:
            return linear_law(self.law, self.hertzian.least_mass, self.hertzian.least_mass, self.hertzian.deepest)
        return contact_law(m.restitution, self.numerics.contact_time, m.poisson_ratio, m.friction, self._sliding_rate)

    @property
    def _sliding_rate(self) -> float:
        return 1.0 / self.material.sliding_time if self._sliding != NONE else 0.0

    @property
    def stiffest_law(self) -> ContactLaw:
        """The linear law of contacts as stiff as any is expected to become."""
        return self.law if self.hertzian is None else self.continuous_law

    @property
    def firmness(self):
        """Springs and dashpots of contacts over those of continuous_law, see stability.stiffest_body; None: all 1."""
        if self.hertzian is None:
            return None
        law, unit = self.law, self.continuous_law.stiffness
        return lambda mass, partner, overlap: linear_law(law, mass, partner, overlap).stiffness / unit

    @property
    def stiffen(self) -> str:
        """How the user makes contacts stiffer: the beginning of a sentence with a bracket that the message closes."""
        if self.material.youngs_modulus is not None:
            return f"Raise material.youngs_modulus (now {self.material.youngs_modulus:g} Pa"
        if self.material.overlap_at_rest is not None:
            return f"Lower material.overlap_at_rest (now {self.material.overlap_at_rest:g}"
        return f"Shorten numerics.contact_time (now {self.numerics.contact_time:g} s"

    @property
    def least_steps(self) -> float:
        """Steps per contact time at which a grain pinched between two others is just stable."""
        if self.hertzian is None:
            return minimum_steps_per_contact_time(self.continuous_law, self.implicit)
        return self.numerics.contact_time / longest_stable_step(self.continuous_law, False)


def minimum_steps_per_contact_time(law: ContactLaw, implicit: bool = False, **mode: float) -> float:
    """Steps per contact time at which a mode is just stable; for law, implicit and mode see longest_stable_step."""
    contact_time = 2.0 * np.pi / np.sqrt(4.0 * law.stiffness - law.damping**2)
    return float(contact_time / longest_stable_step(law, implicit, **mode))


def longest_stable_step(
    law: ContactLaw, implicit: bool, contacts: float = 2.0, normal: float | None = None, tangential: float = 0.0
) -> float:
    """Time step [s] at which semi-implicit Euler is just stable for a mode of a grain.

    law: the continuous one. contacts: of the grain, at least 1. normal, tangential: how many springs of each kind act
    on the mode, per effective mass; None: all contacts along one line, of which a grain pinched between two, as it
    occurs in any bed, has two. A sphere among z fixed ones that surround it evenly has z / 3 and 2 z / 3 when it moves,
    0 and 5 z / 3 when it turns.

    With stiffness K and damping D of the mode its motion is u' = -K x - D u, x' = u, and semi-implicit Euler is stable
    where 4 - 2 D h - K h² > 0 (Jury's conditions). For s contacts along a line that is, with an explicit dashpot, up to
    h = (√(γ² + 4 ω² / s) - γ) / ω²; with an implicit one, up to the positive root of
    (4 + 2 (s - 1) γ h) (1 + γ h / 2) = s ω² h² (1 + (s - 1/2) γ h): h = 2 / ω for s = 1.
    """
    if contacts < 1.0:
        raise ValueError(f"contacts: {contacts:g}, but a mode needs at least 1")
    normal = contacts if normal is None else normal

    def margin(h):
        at_step = implicit_law(law, h) if implicit else law
        dashpots = implicit_dashpot.py_func(at_step, contacts) if implicit else explicit_dashpot.py_func(law)
        stiffness = (normal + tangential * at_step.tangential) * at_step.stiffness
        return 4.0 - 2.0 * h * (normal * dashpots[0] + tangential * dashpots[1]) - h * h * stiffness

    # The margin falls with h all the way: both h D and h² K grow.
    beyond = 1.0 / np.sqrt(law.stiffness)
    while margin(beyond) > 0.0:
        beyond *= 2.0
    return float(brentq(margin, 0.0, beyond, xtol=1e-12 * beyond))
