"""The bed that a packing will make, predicted before it is run: its height, what of it is evaluated, and how exactly.

The bed is as high as its grains fill the domain at the expected solid fraction. The part that its porosity is taken
from follows from the rule of simcore.evaluation.interval. The sampling error follows from the number of large grains
there. How good the predictions are is measured in docs/accuracy.md. No numba is needed.
"""

from dataclasses import fields as fields_of
from typing import NamedTuple

import numpy as np

from simcore.evaluation.interval import end_cuts, median_size
from simcore.grains.sampling import GrainSample, sample_sizes
from simcore.packing.cost import typical_pour
from simcore.scene.domain import Domain
from simcore.scene.scene import GRAINS
from simcore.scene.setup import Setup
from simcore.scene.sizes import size_curve

# Solid fraction of shaken beds: of one sieve class, and its rise with the standard deviation of the grains' sizes in
# powers of two, by volume. Beds are expected within SOLID_RANGE of it: docs/accuracy.md, "Before a run".
ONE_CLASS, BY_SPREAD, SOLID_RANGE = 0.64, 0.085, 0.12
# Sampling error of the porosity over √(φ (1 − φ) v / V), with the volume V of the evaluated part, its solid fraction φ
# and the mean volume v of its grains by volume: of one form in periodic boxes; of mixed forms, and in cylinders.
ONE_FORM, MIXED_FORMS = 0.16, 0.29
ERROR_FACTOR = 1.6  # nine of ten beds of the committed tables lie within this factor of the predicted error
SLICE = 1e-3  # [m], least height that is evaluated
LARGE_ERROR, GOOD_ERROR = 0.015, 0.01  # predicted sampling errors: worth a warning, and what the warning advises for
NARROW = 4.0  # largest grains across a box: a narrower one is no advice
CHUNK, ENOUGH = 10_000, 100_000  # grains that are drawn at once, and that represent a larger packing
SAME_FORM = 0.03  # standard deviation of flatness and elongation below which all grains count as of one form


class Grains(NamedTuple):
    """Grains that a packing is made of, or some of them that represent all."""

    sieve_size: np.ndarray  # (k,) [m]
    volume: np.ndarray  # (k,) [m³]
    total: float  # [m³], volume of all grains of the packing
    largest: float  # [m], upper bound of the sieve sizes
    one_form: bool  # whether all have the same form


class Forecast(NamedTuple):
    """What is expected of a bed."""

    solid_fraction: float
    height: float  # [m]
    at_floor: float  # [m], left out there
    at_surface: float  # [m]
    highest: float  # [m], evaluated height if the bed is as loose as any
    sampling_error: float  # of the porosity; nan where nothing is left to evaluate

    @property
    def evaluated(self) -> float:
        """Height of the part that porosity is taken from [m], at least 0."""
        return max(self.height - self.at_floor - self.at_surface, 0.0)

    @property
    def too_low(self) -> bool:
        """Whether no bed of these grains, be it as loose as any, is high enough to be evaluated."""
        return self.highest < SLICE


def draw_packing(setup: Setup, most: int | None = None) -> GrainSample:
    """Return the grains of the packing of `setup`, in the order of their ids, or the first `most` of them."""
    scene, parts, mass = setup.scene, [], 0.0
    wanted = scene.amount_grains if most is None else min(scene.amount_grains or most, most)
    count = 0
    while mass < (scene.amount_mass or np.inf) and (wanted is None or count < wanted):
        ids = np.arange(count, count + CHUNK if wanted is None else min(count + CHUNK, wanted))
        parts.append(setup.sample(ids))
        mass += scene.material.density * float(parts[-1].volume.sum())
        count += len(ids)
    fields = [np.concatenate([getattr(part, field.name) for part in parts]) for field in fields_of(GrainSample)]
    if scene.amount_mass is not None:
        poured = scene.material.density * np.cumsum(fields[-1])
        fields = [field[: np.searchsorted(poured, scene.amount_mass) + 1] for field in fields]
    return GrainSample(*fields)


def grains_of(setup: Setup, sample: GrainSample | None = None) -> Grains:
    """Return the Grains of the packing of `setup`; sample: all of its grains, where they have been drawn already."""
    scene = setup.scene
    complete = sample is not None
    sample = draw_packing(setup, ENOUGH) if sample is None else sample
    total = float(sample.volume.sum())
    if not complete:
        each = total / len(sample.volume)
        number = scene.amount_grains
        total = max(total, scene.amount_mass / scene.material.density) if number is None else number * each
    flatness, elongation = sample.S / sample.I, sample.I / sample.L
    one_form = max(flatness.std(), elongation.std()) < SAME_FORM
    return Grains(sample.D, sample.volume, total, setup.curve.largest, bool(one_form))


def typical_grains(specification: dict) -> Grains:
    """Return the Grains of a resolved specification, of which none is read: their forms are typical ones."""
    curve = size_curve(specification["sizes"])
    pour = typical_pour(specification, curve)
    sizes = sample_sizes(curve, np.arange(GRAINS), specification["seed"])
    mass, total = specification["amount"]["mass"], pour.solid(pour.grains)
    if mass is not None:
        total = mass / specification["material"]["density"]
    volume = sizes**3 * (total / pour.grains / np.mean(sizes**3))
    shapes = specification["shapes"]
    one_form = shapes["kind"] == "sphere" or shapes["choice"] not in ("random", "form_distribution")
    return Grains(sizes, volume, total, curve.largest, one_form)


def forecast(domain: Domain, grains: Grains, cut=None) -> Forecast:
    """Return the Forecast of a bed of these grains. cut: as of simcore.evaluation.interval.end_cuts."""
    solid = expected_solid_fraction(grains)
    median = median_size(grains.sieve_size, grains.volume)

    def bed(fraction):
        height = grains.total / (fraction * domain.area)
        return height, *end_cuts(domain.periodic, height, grains.largest, median, cut)

    height, at_floor, at_surface = bed(solid)
    evaluated, error = height - at_floor - at_surface, float("nan")
    if evaluated >= SLICE:
        error = sampling_error(domain, grains, solid, evaluated)
    loosest, *cuts = bed(solid - SOLID_RANGE)
    return Forecast(solid, height, at_floor, at_surface, loosest - sum(cuts), error)


def expected_solid_fraction(grains: Grains) -> float:
    """Return the solid fraction that a shaken bed of these grains is expected to have."""
    logs, weight = np.log2(grains.sieve_size), grains.volume / grains.volume.sum()
    spread = np.sqrt(weight @ (logs - weight @ logs) ** 2)
    return float(min(ONE_CLASS + BY_SPREAD * spread, 0.8))


def sampling_error(domain: Domain, grains: Grains, solid: float, height: float) -> float:
    """Return the expected sampling error of the porosity of that height [m] of a bed of solid fraction `solid`.

    A grain counts by its volume: few large ones scatter more than many small ones.
    """
    by_volume = float(grains.volume @ grains.volume) / float(grains.volume.sum())
    scatter = ONE_FORM if grains.one_form and domain.periodic else MIXED_FORMS
    return float(scatter * np.sqrt(solid * (1.0 - solid) * by_volume / (domain.area * height)))


def bed_warnings(domain: Domain, grains: Grains, density: float, cut=None) -> list[str]:
    """Return a sentence for each reason why the porosity of the bed will be impossible to tell, or uncertain.

    density [kg/m³]: of the grains.
    """
    bed = forecast(domain, grains, cut)
    text = f"The bed will be about {bed.height * 1e3:.0f} mm high"
    if bed.at_floor > 0.0 or bed.at_surface > 0.0:
        text += (
            f", of which {bed.at_floor * 1e3:.0f} mm at the floor and {bed.at_surface * 1e3:.0f} mm below the surface "
            f"are left out of its porosity"
        )
    if bed.evaluated < SLICE:
        certain = "" if bed.too_low else "probably "
        return [f"{text}: {certain}nothing is left to evaluate. {_remedy(domain, grains, density, bed, cut)}"]
    if bed.sampling_error > LARGE_ERROR or (bed.at_floor > 0.0 and bed.evaluated < grains.largest):
        return [
            f"{text}: about {bed.evaluated * 1e3:.0f} mm are evaluated, and the sampling error of the porosity will be "
            f"about {bed.sampling_error:.2g}. {_remedy(domain, grains, density, bed, cut)}"
        ]
    return []


def check_bed(domain: Domain, grains: Grains, density: float, cut=None) -> None:
    """ValueError where the bed will be too low for its porosity to be evaluated. density [kg/m³]: of the grains."""
    if forecast(domain, grains, cut).too_low:
        raise ValueError(f"amount: {bed_warnings(domain, grains, density, cut)[0]}")


def _remedy(domain, grains, density, bed, cut):
    """Return the sentence that says which mass or which box makes the bed high enough."""
    height = _needed_height(domain, grains, bed, cut)
    factor = height / bed.height
    text = (
        f"A bed {height * 1e3:.0f} mm high is needed: give at least {_round_up(density * grains.total * factor):g} kg "
        f"(now {density * grains.total:.3g} kg)"
    )
    width = domain.width / np.sqrt(factor)
    if width >= NARROW * grains.largest:
        return f"{text}, or set domain.width to at most {np.floor(width * 1e3):g} mm (now {domain.width * 1e3:g} mm)."
    return f"{text}; in a narrower domain, fewer than {NARROW:g} of the largest grains would lie side by side."


def _needed_height(domain, grains, bed, cut):
    """Return the height [m] at which at least one largest grain's height is evaluated.

    Where something is evaluated already, the sampling error is at most GOOD_ERROR at that height too.
    """
    median, evaluated = median_size(grains.sieve_size, grains.volume), grains.largest
    if bed.evaluated >= SLICE:
        exact = (sampling_error(domain, grains, bed.solid_fraction, 1.0) / GOOD_ERROR) ** 2
        evaluated = max(evaluated, exact)
    height = bed.height
    while height - sum(end_cuts(domain.periodic, height, grains.largest, median, cut)) < evaluated:
        height += 0.02 * evaluated
    return height


def _round_up(value):
    """Return the value with two digits, rounded up."""
    step = 10.0 ** (np.floor(np.log10(value)) - 1.0)
    return float(np.ceil(value / step - 1e-9) * step)
