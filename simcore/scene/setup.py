"""Builds the scene, the base shapes and the draw of grains by id from a resolved specification and its grains."""

from typing import NamedTuple

import numpy as np

from simcore.grains.beta_sizes import BetaSizes
from simcore.grains.mesh import decimate
from simcore.grains.own_sizes import OwnSizes
from simcore.grains.sampling import (
    FormsBelow,
    ShapeChoice,
    grain_uniforms,
    quota_uniforms,
    sample_grains,
    with_volume_factors,
)
from simcore.grains.sieve import SieveCurve
from simcore.grains.sources import grain_warnings, needs_grains, size_note
from simcore.scene.domain import Domain
from simcore.scene.height import check_height
from simcore.scene.impact import derive_hertzian, fall_speed
from simcore.scene.scene import GRAINS, Convergence, Damping, Generation, Material, Numerics, Scene, Shaking
from simcore.scene.shapes import ELLIPSOID, MIXED, POLYHEDRON, SPHERE, Base, Draw, unit_sphere
from simcore.scene.sizes import check_amount, check_top_class, have_own_sizes, lattice_spacing, size_curve

KIND_NUMBERS = {"sphere": SPHERE, "ellipsoid": ELLIPSOID, "polyhedron": POLYHEDRON, "mixed": MIXED}
INSERTION_STREAM = 1  # stream of the random numbers of insertion, separate from those of size and form


class Setup(NamedTuple):
    """Input of a packing; sample(ids) -> GrainSample, draw(ids) -> Draw, the same grains as the core needs them."""

    scene: Scene
    bases: list
    curve: SieveCurve | BetaSizes | OwnSizes
    sample: object
    draw: object
    grains: tuple = ()  # Grain of each base that is a polyhedron
    notes: tuple = ()  # sentences about the grains, such as concave grains and files that were left out
    size_note: str | None = None  # sentence about the use of the grains' own sizes
    by_quota: bool = False  # whether sizes are drawn by quota


def set_up(specification: dict, load_grains) -> Setup:
    """Return the Setup of a resolved specification.

    load_grains(group) -> list of Grain is called only if the shapes need a grain set. ValueError if the specification
    cannot be packed.
    """
    check_top_class(specification)
    choice = shape_choice(specification["shapes"])
    has_polyhedra = choice.kind in ("polyhedron", "mixed")
    grains = load_grains(specification["grains"]) if needs_grains(specification["shapes"]) else []
    grains, bases = _select_grains(grains, choice), []
    notes = tuple(grain_warnings(grains, specification["grains"], choice.kind)) if grains else ()
    if has_polyhedra:
        if specification["faces"] != "original":
            grains = [decimate(grain, specification["faces"]) for grain in grains]
        bases = [Base(g.name, g.vertices, g.faces, g.volume, g.second_moments) for g in grains]
    if choice.kind != "polyhedron":
        bases.append(unit_sphere())
    curve = size_curve(specification["sizes"], grains=grains)
    if choice.choice == "form_by_size" and not isinstance(curve, SieveCurve):
        raise ValueError(
            "shapes.choice: form_by_size needs sieve sizes; give a sieve curve in `sizes`, by `case`, or by `bounds` "
            "and `mass_fractions`"
        )
    notes += tuple(_unused_forms(choice.by_size, curve)) if choice.choice == "form_by_size" else ()
    curve = with_volume_factors(curve, choice)
    check_amount(specification, curve)
    seed, quota, number = specification["seed"], None, specification["amount"]["grains"]
    if specification["sizes"]["draw"] == "quota":
        number = number or _number_of_mass(specification, curve, choice, grains)
        quota = quota_uniforms(curve, number, seed)

    def sample(ids):
        return sample_grains(ids, seed, curve, choice, grains, quota)

    def draw(ids):
        drawn = sample(ids)
        return Draw(drawn.shape, drawn.scale, drawn.D, grain_uniforms(ids, seed, stream=INSERTION_STREAM))

    def masses():
        """Return the mean and the least mass of a grain."""
        mean, least = _volumes(curve, sample, number)
        return specification["material"]["density"] * mean, specification["material"]["density"] * least

    scene = make_scene(specification, curve, masses, number)
    _check_height(scene, curve, sample)
    return Setup(
        scene,
        bases,
        curve,
        sample,
        draw,
        tuple(grains) if has_polyhedra else (),
        notes,
        size_note(grains, specification["sizes"], have_own_sizes(specification["shapes"])),
        quota is not None,
    )


def make_scene(specification: dict, curve, masses, number: int | None = None) -> Scene:
    """Return the Scene of a resolved specification.

    curve: its size distribution. masses() -> (mean, least) mass of its grains [kg], only called for material.law hertz.
    number: number of grains to pack; None packs as many grains, or as much mass, as is specified.
    """
    generation, numerics, hertzian = specification["generation"], specification["numerics"], None
    spacing = lattice_spacing(specification, curve)
    drop_height = spacing if generation["drop_height"] is None else generation["drop_height"]
    domain, material = Domain(**specification["domain"]), Material(**specification["material"])
    insertion = Generation(**{**generation, "spacing": spacing, "drop_height": drop_height})
    if material.law == "hertz":
        speed = fall_speed(insertion, domain.height, material.effective_gravity)
        hertzian = derive_hertzian(material, *masses(), speed)
        numerics = {**numerics, "contact_time": hertzian.duration}
    return Scene(
        name=specification["name"],
        seed=specification["seed"],
        kind=KIND_NUMBERS[specification["shapes"]["kind"]],
        amount_mass=specification["amount"]["mass"] if number is None else None,
        amount_grains=specification["amount"]["grains"] if number is None else number,
        domain=domain,
        material=material,
        generation=insertion,
        shaking=Shaking(**specification["shaking"]),
        damping=Damping(**specification["damping"]),
        convergence=Convergence(**specification["convergence"]),
        numerics=Numerics(**numerics),
        hertzian=hertzian,
    )


def _number_of_mass(specification, curve, choice, grains) -> int:
    """Return the number of grains drawn by quota that have about the specified mass."""
    mass, density, seed = specification["amount"]["mass"], specification["material"]["density"], specification["seed"]
    number = max(1, round(mass / (density * np.pi / 6.0 * curve.mean(3))))
    # The mean volume of the grains drawn differs from that of spheres of the same sieve sizes; it hardly depends on
    # their number, so that two steps are enough.
    for _ in range(2):
        drawn = sample_grains(np.arange(number), seed, curve, choice, grains, quota_uniforms(curve, number, seed))
        number = max(1, round(mass / (density * float(drawn.volume.mean()))))
    return number


def shape_choice(shapes: dict) -> ShapeChoice:
    """Return the ShapeChoice of the resolved group `shapes`, in which a distribution is {mean, std}."""
    settings = {key: shapes[key] for key in ("kind", "choice", "grain")}
    if shapes["kind"] == "mixed":  # packings of a study may share the key
        settings["ellipsoid_share"] = shapes["ellipsoid_share"]
    for key in ("flatness", "elongation", "eta", "zeta"):
        value = shapes[key]
        if isinstance(value, dict):
            settings |= {key: value["mean"], f"{key}_std": value["std"]}
        else:
            settings[key] = value
    if shapes["by_size"] is not None:
        settings["by_size"] = tuple(_forms_below(group) for group in shapes["by_size"])
    return ShapeChoice(**settings)


def _unused_forms(by_size, curve):
    """Return a sentence on each FormsBelow that no grain of a SieveCurve has."""
    above = 0.0
    for number, forms in enumerate(by_size):
        if forms.below <= curve.least or above >= curve.largest:
            yield (
                f"shapes.by_size[{number}] has no effect, because the sieve sizes of the grains are from "
                f"{1000 * curve.least:g} to {1000 * curve.largest:g} mm"
            )
        above = forms.below


def _forms_below(group):
    """Return the FormsBelow of an element of the resolved list shapes.by_size."""
    below = np.inf if group["below"] is None else group["below"]
    return FormsBelow(below, *(group[key][part] for key in ("flatness", "elongation") for part in ("mean", "std")))


def _volumes(curve, sample, number):
    """Return the mean and the least volume of a grain [m³]: sizes are those of the curve, whatever is drawn.

    The volumes of grains over those of spheres of their sieve sizes follow from the first GRAINS grains. If forms
    depend on size, these factors are taken relative to the mean one of their sieve class.
    """
    sphere = np.pi / 6.0
    if curve.of_volume:
        return sphere * curve.mean(3), sphere * curve.least**3
    drawn = sample(np.arange(min(GRAINS, number or GRAINS)))
    factors = drawn.volume / (sphere * drawn.D**3)
    if getattr(curve, "volume_factors", None) is None:
        return sphere * curve.mean(3) * float(factors.mean()), sphere * curve.least**3 * float(factors.min())
    of_class = curve.class_of(drawn.D)
    relative = factors / curve.volume_factors[of_class]
    mean = curve.number_fractions() @ (curve.class_means(3) * curve.volume_factors)
    least = [curve.bounds[k] ** 3 * factors[of_class == k].min() for k in set(of_class.tolist())]
    return sphere * float(mean * relative.mean()), sphere * float(min(least))


def _check_height(scene, curve, sample):
    """Raise ValueError if the grains would be higher than the domain even without pores."""
    mass, number = scene.amount_mass, scene.amount_grains
    if mass is None:
        mass = scene.material.density * number * _volumes(curve, sample, number)[0]
    check_height(scene.domain, mass, scene.material.density)


def _select_grains(grains, choice):
    """Return only the grain that all bodies share if choice is "one", so that no other is decimated or stored."""
    if choice.choice != "one":
        return grains
    return [grain for grain in grains if grain.name == choice.grain] or grains
