"""Text on the predicted grains and bed of a packing, for `explain` and for the warnings of `pack`."""

import numpy as np

from simcore.grains.sieve import SieveCurve, class_fractions
from simcore.packing.forecast import (
    ERROR_FACTOR,
    bed_warnings,
    check_bed,
    check_height_of_bed,
    forecast,
    grains_of,
    height_warnings,
)
from simcore.packing.softness import expected_warnings
from simcore.scene.height import in_mm
from simcore.scene.setup import Setup

FAR_OFF = 0.05  # difference of specified and drawn mass fractions that causes a warning
INDENT = 12 * " "


def grain_lines(setup: Setup, sample) -> list[str]:
    """Return lines on the shapes, sizes and convex hulls of the grains of a packing. sample: all of them."""
    flatness, elongation = (sample.S / sample.I).mean(), (sample.I / sample.L).mean()
    lines = [
        f"Grains      {_shapes(setup, sample)}. The mean flatness FL = S/I is {flatness:.3f} and the mean elongation "
        f"EL = I/L is {elongation:.3f};",
        f"{INDENT}both are 1 for a grain that is neither flat nor elongated",
    ]
    if len(setup.grains):
        lines.append(_hull_line(setup, sample))
    if setup.size_note:
        lines.append(f"{INDENT}{setup.size_note}")
    if isinstance(setup.curve, SieveCurve):
        lines += _class_lines(setup.curve, sample)
    return lines


def bed_lines(setup: Setup, sample) -> list[str]:
    """Return lines on the height of the bed, the part that is evaluated, and the sampling error of its porosity."""
    grains = grains_of(setup, sample)
    bed = forecast(setup.scene.domain, grains)
    lines = [
        f"Bed         It will be about {in_mm(bed.height)} mm high, at a solid fraction of {bed.solid_fraction:.2f}"
    ]
    if np.isnan(bed.sampling_error):
        return [*lines, f"{INDENT}Nothing of it is left to evaluate: see the warning below"]
    left_out = ""
    if bed.at_floor > 0.0 or bed.at_surface > 0.0:
        left_out = f", without the lowest {in_mm(bed.at_floor)} mm and the uppermost {in_mm(bed.at_surface)} mm"
    return [
        *lines,
        f"{INDENT}Its porosity is evaluated over a height of about {in_mm(bed.evaluated)} mm{left_out}",
        f"{INDENT}and will have a sampling error of about {bed.sampling_error:.2g}; this estimate is right within a "
        f"factor of {ERROR_FACTOR:g} for nine beds of ten",
    ]


def setup_warnings(setup: Setup, sample=None, low_bed: bool = True, cut: float | None = None) -> list[str]:
    """Return a warning for each property of the grains and the bed that may make the result differ from the intention.

    sample: all grains of the packing, if they have been drawn already. low_bed: whether to warn if the bed is too low
    to be evaluated. cut [m]: with which it will be evaluated.
    """
    grains = grains_of(setup, sample)
    scene = setup.scene
    density = scene.material.density
    lines = bed_warnings(scene.domain, grains, density, cut)
    if not low_bed and forecast(scene.domain, grains, cut).too_low:
        lines = []
    lines += height_warnings(scene.domain, grains, density, vars(scene.generation))
    lines += expected_warnings(scene, grains)
    return [*lines, *setup.notes, *_class_warnings(setup, grains)]


def check_setup(setup: Setup, sample=None, cut: float | None = None) -> None:
    """Raise ValueError if the bed of a packing will be too high for the domain, or too low to be evaluated.

    sample: all grains of the packing, if they have been drawn already. cut [m]: with which it will be evaluated.
    """
    grains, scene = grains_of(setup, sample), setup.scene
    check_height_of_bed(scene.domain, grains, scene.material.density, vars(scene.generation))
    try:
        check_bed(scene.domain, grains, scene.material.density, cut)
    except ValueError as error:
        raise ValueError(
            f"{error} To pack it anyway, and to evaluate it with a smaller `porosity --cut`, add --force (in Python: "
            "force=True)."
        ) from None


def _shapes(setup, sample):
    """Return the number and kinds of the grains' shapes, in words."""
    drawn = [setup.bases[shape] for shape in np.unique(sample.shape)]
    polyhedra = sum(len(base.vertices) > 0 for base in drawn)
    words = []
    if polyhedra:
        words.append(f"{polyhedra} different polyhedra" if polyhedra > 1 else "one polyhedron")
    if polyhedra < len(drawn):
        forms = len(np.unique(np.round(np.column_stack([sample.S / sample.I, sample.I / sample.L]), 9), axis=0))
        round_ = np.all(sample.L == sample.S)
        words.append("spheres" if round_ else "ellipsoids of one form" if forms == 1 else "ellipsoids of many forms")
    return f"The grains are {' and '.join(words)}"


def hull_ratios(setup: Setup) -> dict:
    """Return, by grain name, the volume of the convex hull over that of the grain's mesh, if the ratio is recorded."""
    ratios = {grain.name: getattr(grain, "hull_ratio", None) for grain in setup.grains}
    return {name: float(ratio) for name, ratio in ratios.items() if ratio is not None and np.isfinite(ratio)}


def _hull_line(setup, sample):
    ratios = hull_ratios(setup)
    if len(ratios) < len(setup.grains):
        return (
            f"{INDENT}Each is packed as its convex hull; by how much the hull is larger is not recorded for all grains"
        )
    drawn = sample.shape[sample.shape < len(setup.grains)]
    added = np.maximum(np.array([ratios[grain.name] for grain in setup.grains])[drawn] - 1.0, 0.0)  # no -0.0
    name, largest = max(ratios.items(), key=lambda item: item[1])
    return (
        f"{INDENT}Each is packed as its convex hull, which adds {100 * added.mean():.1f} % to its volume on average "
        f"and {100 * max(largest - 1.0, 0.0):.1f} % at most ({name})"
    )


def _class_lines(curve, sample):
    specified, drawn = curve.mass_fractions, class_fractions(curve, sample.D, sample.volume)
    lines = ["Sizes       The sieve classes have these shares of the mass:"]
    lines.append(f"{INDENT}  {'class':<18}{'specified':>11}{'drawn':>8}")
    for low, high, wanted, share in zip(curve.bounds, curve.bounds[1:], specified, drawn, strict=False):
        if wanted > 0.0 or share > 0.0:
            lines.append(f"{INDENT}  {f'{low * 1e3:g} to {high * 1e3:g} mm':<18}{wanted:>11.1%}{share:>8.1%}")
    return lines


def _class_warnings(setup, grains):
    if not isinstance(setup.curve, SieveCurve):
        return []
    drawn = class_fractions(setup.curve, grains.sieve_size, grains.volume)
    deviation = drawn - setup.curve.mass_fractions
    worst = int(np.argmax(np.abs(deviation)))
    if abs(deviation[worst]) < FAR_OFF:
        return []
    low, high = setup.curve.bounds[worst : worst + 2] * 1e3
    return [
        f"The sieve class from {low:g} to {high:g} mm has {drawn[worst]:.1%} of the drawn mass instead of "
        f"{setup.curve.mass_fractions[worst]:.1%}: so few grains do not represent the sieve curve. Raise amount, or "
        f"pack several seeds."
    ]
