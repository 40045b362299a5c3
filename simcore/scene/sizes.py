"""The sizes that a specification asks for: sieve curve, beta distribution or the grains' own, lattice spacing, enough
top grains."""

import numpy as np

from simcore.grains.beta_sizes import BetaSizes
from simcore.grains.own_sizes import OwnSizes
from simcore.grains.sieve import SieveCurve, read_cases
from simcore.paths import CONFIG

MINIMUM_OF_TOP_CLASS = 5
MAX_GRAINS = 10_000_000  # the maximum of amount.grains in the schema, for a mass too
# Upright grains need √(S² + I²) = √2 D across; the rest is clearance.
UPRIGHT_REACH = 1.05 * np.sqrt(2.0)


def size_curve(sizes, cases=CONFIG / "cases.tsv", grains=()):
    """The SieveCurve, BetaSizes or OwnSizes of the resolved group `sizes` of a specification.

    grains: list of Grain as they are packed, for sizes that are their own. ValueError for an unknown case, or if the
    sizes are those of grains and there are none.
    """
    if sizes["own"]:
        if not grains:
            raise ValueError("sizes.own: the grains are not read here; give a case, bounds or beta")
        return OwnSizes(np.array([grain.sieve_size for grain in grains]))
    if sizes["beta"] is not None:
        group = sizes["beta"]
        return BetaSizes(group["radius"], group["spread"], group["alpha"], group["beta"])
    if sizes["case"] is None:
        return SieveCurve(np.array(sizes["bounds"]), np.array(sizes["mass_fractions"]), "sizes")
    known = read_cases(cases)
    if sizes["case"] not in known:
        raise ValueError(f"sizes.case: '{sizes['case']}' is unknown; the cases are {', '.join(known)}")
    return known[sizes["case"]].curve


def case_spacing(sizes, cases=CONFIG / "cases.tsv"):
    """Generation spacing [m] of the case of the resolved group `sizes`; None for a sieve curve of one's own."""
    return None if sizes["case"] is None else read_cases(cases)[sizes["case"]].generation_spacing


def lattice_spacing(spec, curve):
    """Distance of nearest lattice points [m] on which grains are born.

    # ASSUME: without one given, batches just above the bed stand as close as the largest grain allows, but not
    # farther than the case's own spacing; fill "r22" takes that of the case.
    """
    spacing = spec["generation"]["spacing"]
    if spacing is not None:
        return spacing
    needed = UPRIGHT_REACH * curve.largest
    of_case = case_spacing(spec["sizes"])
    if of_case is None:
        return needed
    return of_case if spec["generation"]["fill"] == "r22" else min(needed, of_case)


def check_top_class(spec, where=""):
    """Refuse a specification of fewer than five grains of its top class, unless it allows that by name.

    Sizes without classes have none. Sizes that are the grains' own are refused where the shapes are not.
    """
    try:
        if spec["sizes"]["own"]:
            _check_own(spec["shapes"])
            return
        curve = size_curve(spec["sizes"])
        if curve.of_volume:
            return
        density, mass = spec["material"]["density"], spec["amount"]["mass"]
        if mass is None:
            mass = spec["amount"]["grains"] * density * np.pi / 6 * curve.mean(3)
        if not spec["sizes"]["allow_few_top_grains"]:
            curve.check_top_class(mass, density, MINIMUM_OF_TOP_CLASS)
    except ValueError as error:
        raise ValueError(f"{where}: {error}" if where else str(error)) from None


def check_amount(spec, curve):
    """ValueError where the mass of a specification is that of more grains than can be packed; curve: of its sizes."""
    mass, density = spec["amount"]["mass"], spec["material"]["density"]
    if mass is None:
        return
    grains = mass / (density * np.pi / 6.0 * curve.mean(3))
    if grains > MAX_GRAINS:
        raise ValueError(
            f"amount.mass: {mass:.3g} kg are about {grains:.2g} grains, more than {MAX_GRAINS}; give at most "
            f"{mass * MAX_GRAINS / grains:.3g} kg, or leave out the finest classes"
        )


def _check_own(shapes):
    if shapes["kind"] == "sphere" or shapes["choice"] not in ("one", "random"):
        raise ValueError(
            f"sizes.own: shapes of kind {shapes['kind']} and choice {shapes['choice']} have no size of their own; set "
            "shapes.kind to polyhedron, ellipsoid or mixed and shapes.choice to one or random"
        )
