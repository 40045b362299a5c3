"""Builds the size distribution of a specification and checks it: number of grains, grains in the coarsest class.

It also computes the spacing of the lattice of insertion, which depends on the largest size.
"""

import functools

import numpy as np

from simcore.grains.beta_sizes import BetaSizes
from simcore.grains.own_sizes import OwnSizes
from simcore.grains.sieve import SieveCurve, read_cases
from simcore.paths import CONFIG

MINIMUM_OF_TOP_CLASS = 5
MAX_GRAINS = 10_000_000  # the maximum of amount.grains in the schema; here it limits a mass as well
# An upright grain needs a width of at most √(S² + I²) = √2 D; the factor 1.05 adds clearance.
UPRIGHT_REACH = 1.05 * np.sqrt(2.0)


@functools.cache  # each packing of a campaign needs them
def all_cases():
    """Return a dict from name to Case: those of Rettinger et al. (2022), then those of the model of size and form."""
    return read_cases(CONFIG / "cases.tsv") | read_cases(CONFIG / "curves.tsv", "mean_volume")


def size_curve(sizes, grains=()):
    """Return the SieveCurve, BetaSizes or OwnSizes of the resolved group `sizes` of a specification.

    grains: list of Grain in the shape in which they are packed, needed for `sizes.own`. ValueError if the case is
    unknown, or if `sizes.own` is set and there are no grains.
    """
    if sizes["own"]:
        if not grains:
            raise ValueError("sizes.own: the grains are not read at this point; give a case, bounds or beta")
        return OwnSizes(np.array([grain.sieve_size for grain in grains]))
    if sizes["beta"] is not None:
        group = sizes["beta"]
        return BetaSizes(group["radius"], group["spread"], group["alpha"], group["beta"])
    if sizes["case"] is None:
        return SieveCurve(np.array(sizes["bounds"]), np.array(sizes["mass_fractions"]), "sizes")
    table = all_cases()
    if sizes["case"] not in table:
        raise ValueError(f"sizes.case: '{sizes['case']}' is unknown; the cases are {', '.join(table)}")
    return table[sizes["case"]].curve


def case_spacing(sizes):
    """Return the generation spacing [m] of the case of the resolved group `sizes`, or None if it names no case."""
    return None if sizes["case"] is None else all_cases()[sizes["case"]].generation_spacing


def lattice_spacing(spec, curve):
    """Return the distance between neighbouring points of the lattice on which grains are inserted [m].

    curve: the size distribution of the specification.
    # ASSUME: if `generation.spacing` is not given, the points are as close as the largest grain allows, but not farther
    # apart than the spacing of the case; with fill "r22" the spacing is that of the case.
    """
    spacing = spec["generation"]["spacing"]
    if spacing is not None:
        return spacing
    smallest_spacing = UPRIGHT_REACH * curve.largest
    spacing_of_case = case_spacing(spec["sizes"])
    if spacing_of_case is None:
        return smallest_spacing
    return spacing_of_case if spec["generation"]["fill"] == "r22" else min(smallest_spacing, spacing_of_case)


def check_top_class(spec, where=""):
    """Raise ValueError if fewer than five grains of the coarsest class are expected and the specification forbids that.

    `where` precedes the message. Sizes without classes are not checked. `sizes.own` is rejected for shapes that are not
    those of grains of the set.

    With `amount.mass`, grains count as spheres of their sieve size, because the grains are not read at this point. Flat
    grains have less volume and are undercounted: a packing of them may be rejected although five would be drawn. The
    synthetic grains have 1.5 times this volume (simcore.packing.cost) and are overcounted. With `amount.grains`, the
    number is that of the grains if all classes have the same forms.
    """
    try:
        if spec["sizes"]["own"]:
            _check_own(spec["shapes"])
            return
        curve = size_curve(spec["sizes"])
        if curve.of_volume:
            return
        density, mass, grains = spec["material"]["density"], spec["amount"]["mass"], spec["amount"]["grains"]
        if mass is None:
            mass = grains * density * np.pi / 6 * curve.mean(3)
        if not spec["sizes"]["allow_few_top_grains"]:
            curve.check_top_class(mass, density, MINIMUM_OF_TOP_CLASS, grains)
    except ValueError as error:
        raise ValueError(f"{where}: {error}" if where else str(error)) from None


def check_amount(spec, curve):
    """Raise ValueError if the mass of a specification corresponds to more than MAX_GRAINS grains.

    curve: the size distribution of the specification.
    """
    mass, density = spec["amount"]["mass"], spec["material"]["density"]
    if mass is None:
        return
    grains = mass / (density * np.pi / 6.0 * curve.mean(3))
    if grains > MAX_GRAINS:
        raise ValueError(
            f"amount.mass: {mass:.3g} kg are about {grains:.2g} grains, more than {MAX_GRAINS}; give at most "
            f"{mass * MAX_GRAINS / grains:.3g} kg, or omit the finest classes"
        )


def have_own_sizes(shapes):
    """Return whether shapes of the resolved group `shapes` can have the sizes of the grains of the set."""
    return shapes["kind"] != "sphere" and shapes["choice"] in ("one", "random")


def _check_own(shapes):
    if not have_own_sizes(shapes):
        raise ValueError(
            f"sizes.own: shapes of kind {shapes['kind']} and choice {shapes['choice']} have no size of their own; set "
            "shapes.kind to polyhedron, ellipsoid or mixed and shapes.choice to one or random"
        )
