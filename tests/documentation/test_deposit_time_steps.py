"""The page on deposits says by how much the time step of its rows differs from that of today's code."""

import pandas as pd
import pytest
import yaml

from simcore.campaign.plan import Plan
from simcore.paths import CONFIG, REFERENCE, ROOT
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve


@pytest.fixture(scope="module")
def time_steps():
    """Return study, spread of sizes and the time step of each row over that of its specification today."""
    campaign, deposits = (
        yaml.safe_load((CONFIG / name).read_text("utf-8")) for name in ("config.yaml", "deposits.yaml")
    )
    plan = Plan(resolve({**campaign, "studies": deposits["studies"]}, "config"))
    rows = pd.read_csv(REFERENCE / "deposits.csv").set_index(["study", "packing"])
    table = []
    for packing in plan.packings.itertuples():
        row = rows.loc[packing.study, packing.packing]
        today = set_up(packing.specification, lambda group: []).scene.numerics.time_step
        table.append({"spread": row["spread"], "ratio": row["time_s"] / row["steps"] / today})
    assert len(table) == len(rows)
    return pd.DataFrame(table)


def test_rows_of_equal_grains_have_todays_time_step(time_steps):
    assert time_steps.query("spread == 0")["ratio"].to_numpy() == pytest.approx(1.0, abs=1e-5)


def test_the_page_has_the_time_steps_of_unequal_grains(time_steps):
    largest = time_steps.query("spread > 0").groupby("spread")["ratio"].max()
    words = " ".join((ROOT / "docs" / "reference" / "deposits.md").read_text(encoding="utf-8").split())
    assert list(largest.index) == [0.2, 0.5, 0.8]
    assert "up to {:.2f}, {:.2f} and {:.2f} times today's".format(*largest) in words
