"""A resolved specification and its grains become a scene of the core, base shapes, and a draw of grains by id."""

from typing import NamedTuple

import numpy as np

from simcore.dem.shapes.hulls import CONVEX, ELLIPSOID, MIXED, SPHERE, Base, unit_sphere
from simcore.grains.beta_sizes import BetaSizes
from simcore.grains.mesh import decimate
from simcore.grains.own_sizes import OwnSizes
from simcore.grains.sampling import grain_uniforms, sample_grains
from simcore.grains.sieve import SieveCurve
from simcore.grains.sources import needs_grains
from simcore.grains.spread import shape_choice
from simcore.packing.expectation import GRAINS
from simcore.packing.insertion.batches import Draw
from simcore.scene.domain import Domain
from simcore.scene.impact import derive_hertzian, fall_speed
from simcore.scene.scene import Convergence, Damping, Generation, Material, Numerics, Scene, Shaking
from simcore.scene.sizes import check_top_class, lattice_spacing, size_curve

KINDS = {"sphere": SPHERE, "ellipsoid": ELLIPSOID, "mesh": CONVEX, "mixed": MIXED}
BIRTH_STREAM = 1  # random numbers of birth stand apart from those of size and form


class Setup(NamedTuple):
    """What a packing starts from. sample(ids) -> GrainSample; draw(ids) -> Draw, the same grains for the core."""

    scene: Scene
    bases: list
    curve: SieveCurve | BetaSizes | OwnSizes
    sample: object
    draw: object


def set_up(specification: dict, load_grains) -> Setup:
    """Scene, base shapes and grain draw of a resolved specification.

    load_grains(group) -> list of Grain is called only where the shapes need a grain set. ValueError where the
    specification cannot be packed.
    """
    check_top_class(specification)
    choice = shape_choice(specification["shapes"])
    hulls = choice.kind in ("mesh", "mixed")
    grains = load_grains(specification["grains"]) if needs_grains(specification["shapes"]) else []
    grains, bases = _chosen(grains, choice), []
    if hulls:
        if specification["faces"] != "original":
            grains = [decimate(grain, specification["faces"]) for grain in grains]
        bases = [Base(g.name, g.vertices, g.faces, g.volume, g.second_moments) for g in grains]
    if choice.kind != "mesh":
        bases.append(unit_sphere())
    curve = size_curve(specification["sizes"], grains=grains)
    seed = specification["seed"]
    spacing = lattice_spacing(specification, curve)
    generation = specification["generation"]
    drop_height = spacing if generation["drop_height"] is None else generation["drop_height"]

    def sample(ids):
        return sample_grains(ids, seed, curve, choice, grains)

    def draw(ids):
        drawn = sample(ids)
        return Draw(drawn.shape, drawn.scale, drawn.D, grain_uniforms(ids, seed, stream=BIRTH_STREAM))

    domain, material = Domain(**specification["domain"]), Material(**specification["material"])
    born = Generation(**{**generation, "spacing": spacing, "drop_height": drop_height})
    numerics, hertzian = specification["numerics"], None
    if material.law == "hertz":
        # As many as `expect` looks at; all of a packing may be a million.
        volume = sample(np.arange(min(GRAINS, specification["amount"]["grains"] or GRAINS))).volume
        mass = material.density * volume
        speed = fall_speed(born, domain.height, material.effective_gravity)
        hertzian = derive_hertzian(material, float(mass.mean()), float(mass.min()), speed)
        numerics = {**numerics, "contact_time": hertzian.duration}
    scene = Scene(
        name=specification["name"],
        seed=seed,
        kind=KINDS[choice.kind],
        amount_mass=specification["amount"]["mass"],
        amount_grains=specification["amount"]["grains"],
        domain=domain,
        material=material,
        generation=born,
        shaking=Shaking(**specification["shaking"]),
        damping=Damping(**specification["damping"]),
        convergence=Convergence(**specification["convergence"]),
        numerics=Numerics(**numerics),
        hertzian=hertzian,
    )
    _check_height(scene, sample)
    return Setup(scene, bases, curve, sample, draw)


def _check_height(scene, sample):
    """ValueError where the grains, were they without pores, would stand higher than the domain."""
    mass = scene.amount_mass
    if mass is None:
        some = sample(np.arange(min(GRAINS, scene.amount_grains))).volume
        mass = scene.material.density * scene.amount_grains * float(some.mean())
    domain = scene.domain
    solid = mass / (scene.material.density * domain.area)
    if solid > domain.height:
        raise ValueError(
            f"domain.height: {mass:.3g} kg of grains would fill a {domain.type} domain {domain.width * 1e3:g} mm wide "
            f"to {solid * 1e3:.0f} mm without a pore, above its {domain.height * 1e3:g} mm; make it higher or "
            f"wider, or pour less"
        )


def _chosen(grains, choice):
    """Only the grain that all bodies share, where one is chosen: the others need no decimation and no memory."""
    if choice.choice != "one":
        return grains
    return [grain for grain in grains if grain.name == choice.grain] or grains
