"""Predict the bed of a packing before it runs: its height, the part that is evaluated, and the sampling error.

The height follows from the volume of the grains and the expected solid fraction. The evaluated part follows from the
rule of simcore.evaluation.interval. The sampling error of the porosity follows from the number of large grains there.
docs/explanation/accuracy.md compares the predictions with packings. This module needs no numba.
"""

from dataclasses import fields as fields_of
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from simcore.evaluation.interval import end_cuts, median_size, slice_height
from simcore.grains.sampling import GrainSample, sample_sizes
from simcore.grains.sieve import SieveCurve
from simcore.packing.cost import estimate, typical_pour
from simcore.packing.insertion.random_placement import DILUTE
from simcore.scene.domain import Domain
from simcore.scene.height import in_mm
from simcore.scene.scene import GRAINS
from simcore.scene.setup import Setup
from simcore.scene.sizes import size_curve

# Solid fraction of shaken beds: of one sieve class, and its increase with the standard deviation of the logarithm (base
# 2) of the grains' sizes, by volume, up to LARGEST_SOLID. Beds are expected within SOLID_RANGE of it:
# docs/explanation/accuracy.md.
ONE_CLASS, BY_SPREAD, LARGEST_SOLID, SOLID_RANGE = 0.64, 0.085, 0.8, 0.12
# Sampling error of the porosity over √(φ (1 − φ) v / V), with the volume V of the evaluated part, its solid fraction φ
# and the volume-weighted mean volume v of its grains. ONE_FORM applies to grains of one form in a periodic box,
# MIXED_FORMS to mixed forms and to cylinders.
ONE_FORM, MIXED_FORMS = 0.16, 0.23
BY_QUOTA = 0.5  # factor of the sampling error if sizes that may differ much are drawn by quota
ERROR_FACTOR = 1.6  # nine of ten committed beds of mixed forms are within this factor of the predicted error
LARGE_ERROR, GOOD_ERROR = 0.015, 0.01  # predicted sampling error that causes a warning, and target of its advice
# Highest bed of fill r22 over the height of the domain: a batch begins only above a bed below REFILL_HEIGHT, 0.6, and
# grains that fill a quarter of the rest add at most 0.16.
R22_HIGHEST = 0.76
NARROW = 4.0  # width of a box in largest grains; no narrower box is advised
DRAWN_AT_ONCE, ENOUGH = 10_000, 100_000  # grains drawn at once, and grains that represent a larger packing
PER_CLASS = (
    20  # sizes that represent a class of a sieve curve: the mean volume of a class of ratio 2 is right to 0.05 %
)
SAME_FORM = 0.03  # standard deviation of flatness and elongation below which all grains count as of one form


class Grains(NamedTuple):
    """The grains of a packing, or a sample that represents them."""

    sieve_size: np.ndarray  # (k,) [m]
    volume: np.ndarray  # (k,) [m³]
    share: np.ndarray  # (k,), of the volume of all grains that such grains have; the sum is 1
    total: float  # [m³], volume of all grains of the packing
    largest: float  # [m], upper bound of the sieve sizes
    one_form: bool  # whether all have the same form
    by_quota: bool = False  # whether their sizes may differ much and are drawn by quota

    @property
    def mean_volume(self) -> float:
        """Return the mean volume of a grain [m³], weighted by volume."""
        return float(self.share @ self.volume)


class Forecast(NamedTuple):
    """Predicted properties of a bed."""

    solid_fraction: float
    height: float  # [m]
    at_floor: float  # [m], height left out of the evaluation at the floor
    at_surface: float  # [m], height left out at the surface
    highest: float  # [m], evaluated height of the loosest bed that is expected
    smallest: float  # [m], smallest height that is evaluated: a slice
    sampling_error: float  # of the porosity; nan if nothing is left to evaluate

    @property
    def evaluated(self) -> float:
        """Return the height of the part that is evaluated [m], at least 0."""
        return max(self.height - self.at_floor - self.at_surface, 0.0)

    @property
    def too_low(self) -> bool:
        """Return whether even the loosest bed of these grains is too low to be evaluated."""
        return self.highest < self.smallest


def draw_packing(setup: Setup, max_grains: int | None = None) -> GrainSample:
    """Return the grains of the packing of `setup` in the order of their ids, or the first `max_grains` of them."""
    scene, parts, mass = setup.scene, [], 0.0
    wanted = scene.amount_grains if max_grains is None else min(scene.amount_grains or max_grains, max_grains)
    count = 0
    while mass < (scene.amount_mass or np.inf) and (wanted is None or count < wanted):
        ids = np.arange(count, count + DRAWN_AT_ONCE if wanted is None else min(count + DRAWN_AT_ONCE, wanted))
        parts.append(setup.sample(ids))
        mass += scene.material.density * float(parts[-1].volume.sum())
        count += len(ids)
    fields = [np.concatenate([getattr(part, field.name) for part in parts]) for field in fields_of(GrainSample)]
    if scene.amount_mass is not None:
        poured = scene.material.density * np.cumsum(fields[-1])
        fields = [field[: np.searchsorted(poured, scene.amount_mass) + 1] for field in fields]
    return GrainSample(*fields)


def grains_of(setup: Setup, sample: GrainSample | None = None) -> Grains:
    """Return the Grains of the packing of `setup`; sample: all of its grains, if they have been drawn already."""
    scene = setup.scene
    complete = sample is not None
    sample = draw_packing(setup, ENOUGH) if sample is None else sample
    total = float(sample.volume.sum())
    if not complete:
        mean_volume = total / len(sample.volume)
        number = scene.amount_grains
        total = max(total, scene.amount_mass / scene.material.density) if number is None else number * mean_volume
    flatness, elongation = sample.S / sample.I, sample.I / sample.L
    one_form = max(flatness.std(), elongation.std()) < SAME_FORM
    share = sample.volume / sample.volume.sum()
    by_quota = setup.by_quota and _differ_in_size(setup.curve)
    return Grains(sample.D, sample.volume, share, total, setup.curve.largest, bool(one_form), by_quota)


def typical_grains(specification: dict) -> Grains:
    """Return typical Grains of a resolved specification; no grain is read, and their forms are typical forms."""
    curve = size_curve(specification["sizes"])
    pour = typical_pour(specification, curve)
    sizes, share = _typical_sizes(curve, specification["seed"])
    mass, total = specification["amount"]["mass"], pour.solid(pour.grains)
    if mass is not None:
        total = mass / specification["material"]["density"]
    volume = sizes**3 * (total / pour.grains * np.sum(share / sizes**3))
    shapes = specification["shapes"]
    one_form = shapes["kind"] == "sphere" or shapes["choice"] not in ("random", "form_distribution", "form_by_size")
    by_quota = specification["sizes"]["draw"] == "quota" and _differ_in_size(curve)
    return Grains(sizes, volume, share, total, curve.largest, one_form, by_quota)


def with_last_batch(grains: Grains, specification: dict) -> Grains:
    """Return typical Grains of a resolved specification with those of its last batch beyond the specified mass."""
    generation = specification["generation"]
    if specification["amount"]["mass"] is None or generation["placement"] != "lattice" or generation["fill"] != "r22":
        return grains
    inserted = estimate(specification).grains
    expected = typical_pour(specification, size_curve(specification["sizes"])).grains
    return grains._replace(total=grains.total * max(inserted / expected, 1.0))


def _differ_in_size(curve):
    """Return whether grains may differ much in size: several sieve classes with mass, or sizes without classes."""
    return not isinstance(curve, SieveCurve) or np.count_nonzero(curve.mass_fractions) > 1


def _typical_sizes(curve, seed):
    """Return sizes (k,) [m] that represent a curve, and their shares (k,) of its volume.

    A sieve curve is represented by the same number of sizes from each class that has mass: of sizes drawn by number,
    hardly any would be in the coarse classes of a wide curve. From other curves, sizes are drawn by number.
    """
    if not isinstance(curve, SieveCurve):
        sizes = sample_sizes(curve, np.arange(GRAINS), seed)
        return sizes, sizes**3 / np.sum(sizes**3)
    filled = curve.mass_fractions > 0.0
    low, high = curve.bounds[:-1][filled, None], curve.bounds[1:][filled, None]
    sizes = low * (high / low) ** ((np.arange(PER_CLASS) + 0.5) / PER_CLASS)
    share = sizes**3 / np.sum(sizes**3, axis=1, keepdims=True) * curve.expected_fractions()[filled, None]
    return sizes.ravel(), share.ravel()


def forecast(domain: Domain, grains: Grains, cut=None) -> Forecast:
    """Return the Forecast of a bed of these grains. cut: as in simcore.evaluation.interval.end_cuts."""
    solid = expected_solid_fraction(grains.sieve_size, grains.share)
    median = median_size(grains.sieve_size, grains.share)

    def bed(fraction):
        height = grains.total / (fraction * domain.area)
        return height, *end_cuts(domain.periodic, height, grains.largest, median, cut)

    height, at_floor, at_surface = bed(solid)
    evaluated, error, smallest = height - at_floor - at_surface, float("nan"), slice_height(median)
    if evaluated >= smallest:
        error = sampling_error(domain, grains, solid, evaluated)
    loosest, *cuts = bed(solid - SOLID_RANGE)
    return Forecast(solid, height, at_floor, at_surface, loosest - sum(cuts), smallest, error)


def expected_solid_fraction(sizes: np.ndarray, share: np.ndarray) -> float:
    """Return the solid fraction that a shaken bed of grains of these sizes is expected to have.

    sizes: (n,) [m]; share: (n,), of the volume of the grains that grains of this size have; the sum is 1.
    """
    logs = np.log2(sizes)
    spread = np.sqrt(share @ (logs - share @ logs) ** 2)
    return float(min(ONE_CLASS + BY_SPREAD * spread, LARGEST_SOLID))


def sampling_error(domain: Domain, grains: Grains, solid: float, height: float) -> float:
    """Return the expected sampling error of the porosity of that height [m] of a bed of solid fraction `solid`.

    Grains are weighted by volume: a few large grains cause more scatter than many small ones.
    """
    scatter = ONE_FORM if grains.one_form and domain.periodic else MIXED_FORMS
    if grains.by_quota:
        scatter *= BY_QUOTA
    return float(scatter * np.sqrt(solid * (1.0 - solid) * grains.mean_volume / (domain.area * height)))


def bed_warnings(domain: Domain, grains: Grains, density: float, cut=None) -> list[str]:
    """Return a warning for each reason why the porosity of the bed cannot be evaluated or will be uncertain.

    density [kg/m³]: of the grains.
    """
    bed = forecast(domain, grains, cut)
    text = f"The bed will be about {in_mm(bed.height)} mm high"
    if bed.at_floor > 0.0 or bed.at_surface > 0.0:
        by = "" if cut is None else f", with a cut of {in_mm(cut)} mm,"
        text += (
            f"; its porosity{by} leaves out {in_mm(bed.at_floor)} mm at the floor and {in_mm(bed.at_surface)} mm "
            "below the surface"
        )
    if bed.evaluated < bed.smallest:
        certainty = "" if bed.too_low else "probably "
        return [f"{text}, so {certainty}nothing is left to evaluate. {_remedy(domain, grains, density, bed, cut)}"]
    if bed.sampling_error > LARGE_ERROR or (bed.at_floor > 0.0 and bed.evaluated < grains.largest):
        return [
            f"{text}. About {in_mm(bed.evaluated)} mm are evaluated, and the sampling error of the porosity will be "
            f"about {bed.sampling_error:.2g}. {_remedy(domain, grains, density, bed, cut)}"
        ]
    return []


def height_warnings(domain: Domain, grains: Grains, density: float, generation: dict) -> list[str]:
    """Return a warning if the bed will probably be higher than the domain allows.

    density [kg/m³]: of the grains. generation: how they are inserted, with the keys of the group of a specification.
    """
    height = grains.total / (expected_solid_fraction(grains.sieve_size, grains.share) * domain.area)
    room = _room(domain, grains, generation, height)
    return [_too_high(domain, grains, density, height, generation)] if height + room > domain.height else []


def check_height_of_bed(domain: Domain, grains: Grains, density: float, generation: dict) -> None:
    """Raise ValueError if even the densest expected bed is higher than the domain allows; as in `height_warnings`."""
    densest = expected_solid_fraction(grains.sieve_size, grains.share) + SOLID_RANGE
    height = grains.total / (densest * domain.area)
    room = _room(domain, grains, generation, height)
    if height + room > domain.height:
        raise ValueError(_too_high(domain, grains, density, height, generation))


def _room(domain, grains, generation, height):
    """Return the height [m] that must remain above a bed of this height [m], so that all of it can be inserted."""
    if generation["fill"] == "r22":
        return (1.0 - R22_HIGHEST) * domain.height
    clearance = generation["drop_height"] or 0.0
    if generation["placement"] == "lattice":  # a layer is inserted as long as it begins below the top of the domain
        return max(clearance - grains.largest, 0.0)
    if generation["placement"] == "filled":
        return clearance + grains.largest
    # Only the last batch may be smaller than the others.
    number = grains.share / grains.volume
    mean_square = (number @ grains.sieve_size**2) / number.sum()
    whole = min((generation["batch_grains"] or domain.area / mean_square) / number.sum(), grains.total)
    batches = int(np.ceil(grains.total / whole - 1e-9))
    last = grains.total - (batches - 1) * whole
    batch = whole if batches > 1 else last
    needed = (
        before / grains.total * height + clearance + grains.largest + volume / (DILUTE * domain.area)
        for before, volume in ((grains.total - last, last), (max(grains.total - last - batch, 0.0), batch))
    )
    return max(*needed, height) - height


def _too_high(domain, grains, density, height, generation):
    """Return what is wrong with a bed of this height [m], and the remedy."""
    room = _room(domain, grains, generation, height)
    needed = 1.2 * height / R22_HIGHEST if generation["fill"] == "r22" else 1.2 * height + room
    lower = f"amount (now {density * grains.total:.3g} kg)"
    if generation["fill"] == "bed" and room > height:
        clearance = generation["drop_height"] or 0.0
        if clearance > 0.5 * room:
            lower = f"generation.drop_height (now {in_mm(clearance)} mm)"
        elif generation["batch_grains"]:
            lower = f"generation.batch_grains (now {generation['batch_grains']})"
    why = "" if room == 0.0 else f", of which insertion needs {in_mm(room)} mm above the bed"
    return (
        f"domain.height: The bed will be about {in_mm(height)} mm high, in a domain of {in_mm(domain.height)} mm{why}; "
        f"raise domain.height to at least {in_mm(needed)} mm, or lower {lower}."
    )


def check_bed(domain: Domain, grains: Grains, density: float, cut=None) -> None:
    """Raise ValueError if the bed will be too low for its porosity to be evaluated. density [kg/m³]: of the grains."""
    if forecast(domain, grains, cut).too_low:
        raise ValueError(f"amount: {bed_warnings(domain, grains, density, cut)[0]}")


def _remedy(domain, grains, density, bed, cut):
    """Return the advice: the mass, or the width of the domain, that makes the bed high enough."""
    height = _needed_height(domain, grains, bed, cut)
    factor = height / bed.height
    text = (
        f"A bed {in_mm(height)} mm high is needed: set amount to at least "
        f"{_round_up(density * grains.total * factor):g} kg (now {density * grains.total:.3g} kg)"
    )
    width = _needed_width(domain, grains, cut)
    if width >= NARROW * grains.largest:
        return (
            f"{text}, or set domain.width to at most {_round_down(width * 1e3):g} mm (now {domain.width * 1e3:g} mm)."
        )
    return f"{text}. A narrower domain would be less than {NARROW:g} of the largest grains wide."


def _needed_height(domain, grains, bed, cut):
    """Return the height [m] of a bed whose evaluated part is at least as high as its largest grain.

    If a part of the bed is evaluated already, the sampling error at this height is also at most GOOD_ERROR.
    """
    median, evaluated = median_size(grains.sieve_size, grains.share), grains.largest
    if bed.evaluated >= bed.smallest:
        needed = (sampling_error(domain, grains, bed.solid_fraction, 1.0) / GOOD_ERROR) ** 2
        evaluated = max(evaluated, needed)
    height = bed.height
    while height - sum(end_cuts(domain.periodic, height, grains.largest, median, cut)) < evaluated:
        height += 0.02 * evaluated
    return height


def _needed_width(domain, grains, cut):
    """Return the largest width [m] at which a bed of these grains is as high as needed and evaluated as precisely."""
    width = domain.width
    while width >= NARROW * grains.largest:
        narrower = replace(domain, width=width)
        bed = forecast(narrower, grains, cut)
        if bed.evaluated >= bed.smallest and bed.height >= _needed_height(narrower, grains, bed, cut):
            break
        width *= 0.99
    return width


def _round_up(value):
    """Return the value rounded up to two significant digits."""
    step = 10.0 ** (np.floor(np.log10(value)) - 1.0)
    return float(np.ceil(value / step - 1e-9) * step)


def _round_down(value):
    """Return the value rounded down to a whole number, or below 10 to two digits."""
    step = 1.0 if value >= 10.0 else 10.0 ** (np.floor(np.log10(value)) - 1.0)
    return float(np.floor(value / step + 1e-9) * step)
