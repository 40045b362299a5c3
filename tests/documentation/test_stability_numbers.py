"""Numbers of the page on stability, from the committed maps."""

import numpy as np
import pandas as pd
import pytest

from simcore.paths import REFERENCE, ROOT
from simcore.scene.specification import resolve
from tests.helpers.few_spheres import specify_few_spheres

PAGE = " ".join((ROOT / "docs" / "explanation" / "stability.md").read_text(encoding="utf-8").split())
RIGHT = ("stable", "soft")


@pytest.fixture(scope="module")
def maps():
    """Return the rows of the maps with explicit dashpots by the name of the map."""
    rows = pd.read_csv(REFERENCE / "stability.csv")
    assert not rows["outcome"].isin(["wrong", "vibrating"]).any() and f"{len(rows)} scenes vary two settings" in PAGE
    return dict(list(rows.groupby("map")))


def fewest_steps(cells):
    """Return the number of steps from which on all cells of each x are right, Series by x."""
    wrong = cells[~cells["outcome"].isin(RIGHT)].groupby("x")["y"].max()
    above = [cells.loc[(cells["x"] == x) & (cells["y"] > last), "y"].min() for x, last in wrong.items()]
    return pd.Series(above, wrong.index)


def test_steps_that_beds_with_an_explicit_dashpot_need(maps):
    restitution = resolve(specify_few_spheres())["material"]["restitution"]
    by_time, by_ratio = (fewest_steps(maps[f"steps and {of}"]) for of in ("contact time", "size ratio"))
    most = int(max(by_time.max(), by_ratio.max()))
    assert f"beds with the default restitution of {restitution:g} need {most} steps per contact time" in PAGE
    low, high = 1e3 * by_time.index.min(), 1e3 * by_time.index.max()
    assert f"for contact times from {low:g} to {high:g} ms and size ratios up to {by_ratio.index.max():g}." in PAGE
    by_restitution = fewest_steps(maps["steps and restitution"])
    assert by_restitution[restitution] == most
    few, many = (f"{by_restitution[value]:.0f}" for value in (0.3, 0.01))
    assert f"Beds with a restitution of 0.01 need {many}, those with 0.3 need {few}." in PAGE


def test_outcomes_of_the_scheme_of_campaigns():
    rows = pd.read_csv(REFERENCE / "stability_campaign.csv")
    counts = rows["outcome"].value_counts()
    assert f"{len(rows)} scenes of 60 to 100 pebbles" in PAGE and not counts.get("wrong", 0)
    words = {
        "stable": "stable",
        "soft": "correct, but soft",
        "vibrating": "at rest on average, but forces alternate from step to step",
        "stopped": "stopped with an error",
    }
    assert set(counts.index) <= set(words)
    for outcome, text in words.items():
        assert f"| {text} | {counts.get(outcome, 0)} |" in PAGE


def test_dashpots_are_compared_by_the_committed_rows():
    folder = REFERENCE / "work_precision"
    beds = pd.read_csv(folder / "rest.csv").query("shape == 'polyhedron'").set_index(["dashpot", "steps"])
    contacts = pd.read_csv(folder / "one_contact.csv").query("case == 'attractive' and quantity == 'restitution, mean'")
    errors = contacts.set_index(["method", contacts["setting"].astype(int)])["error"]
    for name, key in (("`numerics.dashpot: implicit`", ("implicit", 10)), ("explicit", ("explicit", 40))):
        error, force = (f"{value:.0e}".replace("e-0", "e-") for value in (errors[key], beds["unbalanced_force"][key]))
        assert f"| {name} | {key[1]} | {error} | {force} |" in PAGE
    explicit = beds.loc["explicit", "kinetic_energy"]
    assert (explicit[explicit.index <= 20] == np.inf).all() and explicit[40] < 1e-6
    assert "With 20 explicit steps or fewer it flies apart." in PAGE
    ratio = beds["cpu_s"]["implicit", 10] / beds["cpu_s"]["explicit", 40]
    assert f"take {ratio:.2f} of their CPU time" in PAGE
