"""Pictures of the page of deposits: a deposit, the angles of contacts and long axes, and distributions of size."""

import functools

import yaml

from simcore.paths import CONFIG, REFERENCE

RATIO = 1.6  # of neighbouring axes, near the densest form of Baram and Lind
# Number of grains in a box of 40 mm for each spread of sizes S; it is four long axes wide, as in deposit_sizes.
GRAINS = {0.0: 600, 0.5: 750}


@functools.cache
def bed(spread):
    """Pack a smaller deposit with the settings of the study deposit_sizes, and this spread of sizes S."""
    from simcore.packing.single import pack

    study = yaml.safe_load((CONFIG / "deposits.yaml").read_text(encoding="utf-8"))["studies"]["deposit_sizes"]["fixes"]
    changes = {
        "name": "deposit",
        "seed": 1,
        "domain": {"type": "periodic", "width": "40 mm", "height": "0.3 m"},
        "amount": {"grains": GRAINS[spread]},
        "shapes": study["shapes"] | {"eta": RATIO, "zeta": RATIO},
        # Hertzian contacts have no contact time of their own, which a single packing refuses.
        "numerics": {key: value for key, value in study["numerics"].items() if key != "contact_time"},
        "sizes": {"beta": study["sizes"]["beta"] | {"spread": spread}},
    }
    if spread:
        changes["material"] = study["material"] | {"restitution": 0.5}
    return pack(study | changes)


def picture():
    """Draw the deposit of equal grains; the colour shows the direction of their longest axes."""
    from simcore.report.figures.packings import packing_figure

    return packing_figure(bed(0.0))


def angles_over_sizes():
    """Draw histograms of the angles of contacts and long axes, of equal grains and of grains of different sizes."""
    from simcore.evaluation.deposit import deposit
    from simcore.report.figures.fabric import fabric_figure

    return fabric_figure(
        {f"S = {spread:g}": deposit(bed(spread)) for spread in GRAINS}, ["contact_normal", "long_axis"]
    )


def size_distributions():
    """Draw the distributions of size of the committed deposits."""
    from simcore.campaign.deposits import read_deposits
    from simcore.report.figures.deposits import size_distributions_figure

    rows = read_deposits(REFERENCE / "deposits.csv")
    return size_distributions_figure(sorted(set(rows["spread"]) - {0.0}))


FIGURES = {
    "reference/deposit_bed.png": picture,
    "reference/deposit_angles.png": angles_over_sizes,
    "reference/deposit_sizes.png": size_distributions,
}
