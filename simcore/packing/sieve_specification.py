"""Writes the specification of a packing of a measured sieve curve."""

import re

import numpy as np
import yaml

from simcore.grains.forms_by_class import sample_of_class
from simcore.grains.sieve import SieveCurve
from simcore.grains.sources import load_grains
from simcore.packing.expectation import DEEP_IMPACT, expect
from simcore.packing.forecast import expected_solid_fraction
from simcore.scene.quantity import rounded_down
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve

DENSITY = 2650.0  # [kg/m³], of quartz; the default of material.density
# The bed is WIDTH largest sieve sizes wide and HEIGHT high; at least 5 and 6 are advised.
# The domain is DOMAIN times as high as the bed, and at least LEAST_DOMAIN [m].
WIDTH, HEIGHT, DOMAIN, LEAST_DOMAIN = 5.0, 10.0, 2.5, 1.0
# Beds are made as those to which the model of size and form is fitted (config/size_and_form.yaml).
FACES, SPEED = 300, 3.0  # [m/s]
PROCESS = f"""# The bed is inserted and shaken as those to which the model of size and form is fitted.
generation:
  placement: filled
  solid_fraction: 0.03
  fill: bed
  drop_height: 20 mm
  velocity_z: {-SPEED:g} m/s
shaking: {{duration: 1 s}}"""
# Minimum number of grains of the coarsest class in the mass; a specification needs at least 5.
LARGEST_GRAINS = 8
MANY = 100_000  # grains above which a packing takes days on one core
TOO_MANY = 5e6  # grains above which no specification is written


def sieve_specification(curve, source, sample=None, classes=None, *, draw=True):
    """Return (YAML text of a specification that packs this SieveCurve, notices). source: file that the curve is from.

    The text is accepted by `explain` and `pack`. sample: simcore.grains.measured_forms.Sample with the form of the
    grains, or classes: forms by sieve class, as from simcore.grains.forms_by_class.classes_of_table; None: synthetic
    pebbles, because a sieve curve says nothing about form. draw: draw the grains, and set contact time and steps so
    that `explain` has no warning about them; otherwise a contact time for grains of any form is written, as by `scree
    page`. ValueError if the curve has too many grains for any packing, or if a class with mass has no forms.
    """
    largest = curve.largest
    width, solid, mass, grains = _bed(curve)
    if grains > TOO_MANY:
        raise ValueError(
            f"a packing of this curve with {LARGEST_GRAINS} grains of its coarsest class has {_about(grains)} grains, "
            f"more than can be packed; {_leave_out(curve)}"
        )
    bed = mass / (DENSITY * solid * width**2)
    name = re.sub(r"[^A-Za-z0-9_.+-]+", "_", source.stem).strip("_.+-") or "sieve"
    bounds = ", ".join(f"{D * 1e3:.6g} mm" for D in curve.bounds)
    shares = ", ".join(f"{share:.6f}" for share in _rounded(curve.mass_fractions))
    height = max(np.ceil(DOMAIN * bed * 100) / 100, LEAST_DOMAIN)
    notices = []
    if grains > MANY:
        notices.append(
            f"the packing has {_about(grains)} grains, most of them fine, and takes days on one core; `explain` prints "
            f"its cost. If that is too much, {_leave_out(curve)}"
        )
    start = f"""# Packs the sieve curve of {source.name}. See what it costs:  scree explain THIS_FILE
name: "{name}"
seed: 1
sizes:
  bounds: [{bounds}]
  mass_fractions: [{shares}]
  draw: {"quota" if len(curve.mass_fractions) > 1 else "random"}
{_shapes(sample) if classes is None else _shapes_by_size(curve, classes)}
faces: {FACES}
# Width and height of the bed are {WIDTH:g} and {bed / largest:.0f} times the largest sieve opening.
domain: {{type: periodic, width: {width * 1e3:g} mm, height: {height:g} m}}
amount: {{mass: {mass:.3g} kg}}
accuracy: standard
{PROCESS}
"""
    contact_time = _contact_time(curve.least, height)
    numerics = _numerics(start, contact_time) if draw else _NUMERICS.format(contact_time * 1e3, "")
    return start + numerics, notices


def _bed(curve):
    """Return (width [m], solid fraction, mass [kg], expected number of grains) of the bed of a SieveCurve."""
    width = np.ceil(WIDTH * curve.largest * 1e3) / 1e3
    centres = np.sqrt(curve.bounds[1:] * curve.bounds[:-1])
    solid = expected_solid_fraction(centres, curve.mass_fractions / curve.mass_fractions.sum())
    grain = DENSITY * np.pi / 6 * curve.mean(3)  # mean mass by number
    least = LARGEST_GRAINS * grain / curve.number_fractions()[-1]
    mass = max(DENSITY * solid * width**2 * HEIGHT * curve.largest, least)
    return width, solid, mass, mass / grain


def _leave_out(curve):
    """Return what to leave out of a SieveCurve so that at most MANY grains remain; its coarsest class has fewer."""
    for k in range(1, len(curve.mass_fractions)):
        coarse = SieveCurve(curve.bounds[k:], curve.mass_fractions[k:] / curve.mass_fractions[k:].sum())
        grains = _bed(coarse)[-1]
        if grains <= MANY:
            break
    share = 1.0 - curve.mass_fractions[k:].sum() / curve.mass_fractions.sum()
    return (
        f"leave out the grains below {curve.bounds[k] * 1e3:.6g} mm, which are {100 * share:.3g}% of the mass; then "
        f"the packing has {_about(grains)} grains"
    )


def _about(number):
    """Return a number rounded to two digits, such as "2 900 000"."""
    return f"{float(f'{number:.1e}'):,.0f}".replace(",", " ")


_NUMERICS = """# Contacts of so short a time are stiff enough that falling grains do not sink into the finest ones.
numerics: {{contact_time: {:.3g} ms{}}}
"""
SYNTHETIC = """# A sieve curve says nothing about form: these are synthetic pebbles. If you have measured flatness
# S/I and elongation I/L, write their means and deviations here, as in examples/sieve_and_form.yaml.
shapes: {kind: polyhedron, choice: random}"""


def _shapes(sample):
    """Return the lines on the form of the grains."""
    if sample is None:
        return SYNTHETIC
    return f"""# Flatness S/I and elongation I/L as measured.
shapes:
  kind: polyhedron
  choice: form_distribution
  flatness: {_distribution(sample, "FL")}
  elongation: {_distribution(sample, "EL")}"""


def _shapes_by_size(curve, classes):
    """Return the lines on the form of the grains if it differs between sieve classes."""
    samples = [sample_of_class(curve, index, classes) for index in np.flatnonzero(curve.mass_fractions > 0)]
    limits = curve.bounds[1:][curve.mass_fractions > 0]
    # A class with the forms of the next coarser one needs no element of its own.
    ends = [k for k in range(len(samples)) if k + 1 == len(samples) or samples[k] != samples[k + 1]]
    if len(ends) == 1:
        return _shapes(samples[0])
    lines = ["# Flatness S/I and elongation I/L as measured, by sieve size.", "shapes:", "  kind: polyhedron"]
    lines += ["  choice: form_by_size", "  by_size:"]
    for k in ends:
        below = "" if k == ends[-1] else f"below: {limits[k] * 1e3:.6g} mm, "
        flatness, elongation = (_distribution(samples[k], ratio) for ratio in ("FL", "EL"))
        lines.append(f"    - {{{below}flatness: {flatness}, elongation: {elongation}}}")
    return "\n".join(lines)


def _distribution(sample, ratio):
    return f"{{mean: {getattr(sample, f'mu_{ratio}'):.4f}, std: {getattr(sample, f'sigma_{ratio}'):.4f}}}"


def _numerics(start, contact_time):
    """Return the line on the numerics with which `explain` has no warning. start: the rest of the specification.

    contact_time [s] is a first guess, which does not depend on the forms.
    """
    setup = set_up(resolve(yaml.safe_load(start + _NUMERICS.format(contact_time * 1e3, ""))), load_grains)
    expected = expect(setup.scene, setup.bases, setup.draw)
    deepest = DEEP_IMPACT * expected.half_thickness
    if expected.impact_depth > deepest:
        contact_time = rounded_down(contact_time * deepest / expected.impact_depth)
    needed, standard = np.ceil(expected.stability.expected), setup.scene.numerics.steps_per_contact_time
    return _NUMERICS.format(contact_time * 1e3, f", steps_per_contact_time: {needed:.0f}" if needed > standard else "")


def _contact_time(finest, height):
    """Return a contact time [s] at which no impact is deeper than a quarter of the thinnest of the finest grains.

    finest: sieve size of the finest grains [m]; height of the domain [m], from which they may fall. With the settings
    of `standard` an impact at the speed v is about 0.14 v times the contact time deep, and the thinnest pebble is 0.4
    of its sieve size thick.
    """
    longest = 0.25 * 0.4 * finest / (0.14 * np.sqrt(SPEED**2 + 2 * 9.81 * height))
    return min(2e-3, rounded_down(longest))


def _rounded(shares):
    """Return shares rounded to 1e-6 whose sum is 1; the largest takes up the difference."""
    rounded = np.round(shares, 6)
    rounded[np.argmax(rounded)] += 1.0 - rounded.sum()
    return rounded
