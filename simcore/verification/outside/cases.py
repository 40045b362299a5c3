"""Expected values of the verification packings, with sources.

A band is set before its packing is simulated, and is not changed if the result is outside.
"""

from typing import NamedTuple

AGNOLIN = "Agnolin & Roux 2007, arXiv:0705.3194"
ASTE = "Aste, Saadatfar & Senden 2005, Phys. Rev. E 71, 061302"
BAKER = "Baker & Kudrolli 2010, Phys. Rev. E 82, 061304"
BENYAHIA = "Benyahia & O'Neill 2005, Particulate Science and Technology 23, 169"
BERRYMAN = "Berryman 1983, Phys. Rev. A 27, 1053"
CONSERVATION = "conservation of energy"
FARR = "Farr & Groot 2009, arXiv:0912.0852"
GEOMETRY = "closed form (geometry)"
JERKINS = "Jerkins et al. 2008, Phys. Rev. Lett. 101, 018301"
PILLITTERI = "Pillitteri et al. 2020, Soft Matter, doi:10.1039/d0sm00939c"
SILBERT = "Silbert 2011, arXiv:1108.0012"


class Case(NamedTuple):
    """A measured number and the band in which it is expected."""

    name: str
    packings: tuple[str, ...]  # names in PACKINGS; the mean of a second one is subtracted
    quantity: str
    measure: str  # key of MEASURES in simcore.verification.outside.measures
    options: dict  # arguments of the measure; lengths in m
    low: float
    high: float
    source: str
    reason: str


def _porosity(name, packing, floor, surface, low, high, source, reason):
    options = {"floor": floor, "surface": surface}
    return Case(name, (packing,), "porosity", "porosity", options, low, high, source, reason)


def _column(ratio, middle):
    return Case(
        f"column_{ratio}",
        (f"column_{ratio}",),
        "porosity",
        "column_porosity",
        {},
        middle - 0.0005,
        middle + 0.0005,
        GEOMETRY,
        "Smooth spheres in a tube narrower than 1.866 of their diameters can only come to rest in a plane zigzag, "
        "whose porosity follows from the Pythagorean theorem; their weight shortens the column by less than the band.",
    )


def _wall(ratio, middle):
    return _porosity(
        f"cylinder_{ratio}",
        f"cylinder_{ratio}",
        0.014,
        0.014,
        middle * (1.0 - 0.0375),
        middle * (1.0 + 0.0375),
        BENYAHIA,
        "Their formula 0.390 + 1.740 / (D/d + 1.140)² has a mean error of 1.5 %, so a standard deviation of 1.9 %; the "
        "band is two of those.",
    )


def _bidisperse(share, middle):
    return _porosity(
        f"bidisperse_{share}",
        f"bidisperse_{share}",
        0.016,
        0.012,
        middle - 0.02,
        middle + 0.02,
        FARR,
        "Their rods are within about 0.01 of packed spheres, and values of random close packing, on which the rods are "
        "calibrated, differ by another 0.01.",
    )


def _die(solid, loose, close):
    """loose, close: published solid fractions, each with a standard deviation of 0.01."""
    return _porosity(
        f"dice_{solid}",
        f"dice_{solid}",
        0.020,
        0.015,
        1.0 - close - 0.01,
        1.0 - loose + 0.01,
        BAKER,
        f"Plastic dice filled from {loose:g} (fluidised) to {close:g} (vibrated), with a standard deviation of 0.01.",
    )


BULK = {"floor": 0.021, "surface": 0.014}  # three and two diameters of the equal spheres
CASES = [
    Case(
        "smooth_shaken",
        ("smooth_spheres_shaken",),
        "porosity",
        "core_porosity",
        {"core": 0.021, **BULK},
        0.34,
        0.38,
        BERRYMAN,
        "Random close packing is predicted at a solid fraction of 0.64 ± 0.02; three diameters beside the wall, which "
        "orders the spheres, are left out.",
    ),
    _porosity(
        "smooth_poured",
        "smooth_spheres_poured",
        *BULK.values(),
        0.34,
        0.38,
        BERRYMAN,
        "Without friction nothing holds spheres in a looser state than random close packing, 0.64 ± 0.02, whether they "
        "are shaken or not.",
    ),
    Case(
        "smooth_coordination",
        ("smooth_spheres_poured",),
        "contacts per grain",
        "coordination",
        {**BULK, "bearing_contacts": 4},
        5.8,
        6.2,
        AGNOLIN,
        "A force-carrying sphere without friction has six contacts: three degrees of freedom, and each contact is "
        "shared by two. Soft contacts add a few hundredths.",
    ),
    _porosity(
        "frictional_poured",
        "frictional_spheres_poured",
        *BULK.values(),
        0.395,
        0.450,
        f"{JERKINS}; {PILLITTERI}",
        "Rough spheres that settle as gently as can be reach a solid fraction of 0.550, and spheres poured under "
        "normal gravity about 0.60.",
    ),
    Case(
        "frictional_coordination",
        ("frictional_spheres_poured",),
        "contacts per grain",
        "coordination",
        {**BULK, "bearing_contacts": 2},
        4.0,
        6.0,
        SILBERT,
        "The coordination number falls from about six to four as the coefficient of friction grows over several orders "
        "of magnitude.",
    ),
    _porosity(
        "frictional_shaken",
        "frictional_spheres_shaken",
        *BULK.values(),
        0.36,
        0.42,
        ASTE,
        "Beads whose packings were measured by tomography filled between 0.58 and 0.64.",
    ),
    _column("1.3", 0.58648),
    _column("1.5", 0.65787),
    _column("1.7", 0.67698),
    _wall("3", 0.4915),
    _wall("5", 0.4362),
    _wall("8", 0.4108),
    _bidisperse("0.30", 0.3358),
    _bidisperse("0.50", 0.3242),
    _bidisperse("0.70", 0.3181),
    _bidisperse("0.85", 0.3259),
    Case(
        "bidisperse_gain",
        ("smooth_spheres_poured", "bidisperse_0.70"),
        "difference of porosities",
        "porosity",
        BULK,
        0.0285,
        0.0485,
        FARR,
        "By their rods equal spheres are 0.0385 looser than a mixture with 70 % of the volume in spheres of twice the "
        "size; in the difference the calibration drops out, so ± 0.01.",
    ),
    _die("tetrahedron", 0.51, 0.64),
    _die("cube", 0.54, 0.67),
    _die("octahedron", 0.52, 0.64),
    _die("dodecahedron", 0.51, 0.63),
    _die("icosahedron", 0.50, 0.59),
    Case(
        "dice_order",
        ("dice_icosahedron", "dice_cube"),
        "difference of porosities",
        "porosity",
        {"floor": 0.020, "surface": 0.015},
        0.012,
        0.108,
        BAKER,
        "Cubes fill 0.04 (fluidised) to 0.08 (vibrated) more than icosahedra; each difference has a standard deviation "
        "of 0.014, and the band adds two.",
    ),
    Case(
        "elastic_energy",
        ("elastic_spheres",),
        "energy over its initial value",
        "energy_ratio",
        {},
        0.995,
        1.005,
        CONSERVATION,
        "Elastic spheres without friction lose and gain nothing. At 40 steps a contact time each contact is off by "
        "6.5e-4 of its energy, either way; 16 000 contacts of 64 spheres add up to 0.005 (four standard deviations).",
    ),
]
