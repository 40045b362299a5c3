"""How much the beds of the cylinder exceed their mass, because their last batch is inserted whole."""

import numpy as np
import pandas as pd
import yaml

from simcore.campaign.studies import expand, merge
from simcore.grains.mesh import decimate
from simcore.grains.synthetic import synthetic_grains
from simcore.paths import CONFIG, REFERENCE, ROOT
from simcore.scene.setup import set_up
from simcore.scene.shapes import grain_volumes
from simcore.scene.specification import resolve


def excess(specification, grains, number):
    """Return the share by which the mass of this number of grains exceeds the specified mass."""
    setup = set_up(specification, lambda _: grains)
    volumes = grain_volumes(setup.bases, setup.draw(np.arange(number)))
    mass = specification["material"]["density"] * np.cumsum(volumes)
    # The bed was not complete before its last batch, and has at least one grain more than it needs.
    assert mass[-2] > specification["amount"]["mass"]
    return mass[-1] / specification["amount"]["mass"] - 1.0


def test_the_page_has_the_excess_of_the_beds_in_the_cylinder():
    rows = pd.read_csv(REFERENCE / "validation.csv").set_index(["case", "run"])
    config = resolve(
        merge(*(yaml.safe_load((CONFIG / f"{n}.yaml").read_text()) for n in ("config", "workstation"))), "config"
    )
    listed = expand({**config, "studies": {"validation": config["studies"]["validation"]}})
    grains = [decimate(grain, 300) for grain in synthetic_grains(seed=1, n=63)]
    shares = []
    for specification in listed.specification:
        bed = (specification["sizes"]["case"], specification["seed"])
        if bed in rows.index:
            shares.append(100.0 * excess(specification, grains, int(rows.grains[bed])))
    assert len(shares) == len(rows)
    text = " ".join((ROOT / "docs" / "explanation" / "differences_r22.md").read_text(encoding="utf-8").split())
    low, mean, high = min(shares), np.mean(shares), max(shares)
    assert (
        f"The {len(rows)} beds of `validation.csv` exceed it by {low:.1f} to {high:.1f} %, by {mean:.1f} % in the mean"
        in text
    )
