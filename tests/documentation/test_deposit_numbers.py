"""The numbers in docs/reference/deposits.md are those of results/reference/deposits.csv."""

import numpy as np
import pandas as pd
import pytest

from simcore.campaign.deposit_findings import findings
from simcore.campaign.deposits import plain_means, read_deposits
from simcore.evaluation import curve_maximum
from simcore.paths import REFERENCE, ROOT

PAGE = " ".join((ROOT / "docs" / "reference" / "deposits.md").read_text(encoding="utf-8").split())


@pytest.fixture(scope="module")
def rows():
    return read_deposits(REFERENCE / "deposits.csv")


@pytest.fixture(scope="module")
def found(rows):
    return findings(rows)


def test_number_and_cost(rows):
    assert f"The {len(rows)} deposits took {rows['cpu_s'].sum() / 3600.0:.1f} CPU hours" in PAGE


def test_spheres(rows):
    spheres = plain_means(rows).query("eta == 1 and zeta == 1").iloc[0]
    assert f"solid fraction of {spheres.solid_fraction:.4f} ± {spheres.solid_fraction_error:.4f} and" in PAGE
    assert f"and {spheres.coordination_number:.2f} contacts" in PAGE
    assert f"(P2 {spheres.P2_contact_normal:+.3f} ± {spheres.P2_contact_normal_error:.3f})" in PAGE


def test_densest_forms(rows, found, monkeypatch):
    tops = found["maxima"].query("of == 'solid_fraction'").set_index("family")
    top = tops.loc["diagonal"]
    assert f"at {top.ratio:.2f} ± {top.ratio_error:.2f} | {top.value:.4f} ± {top.value_error:.4f} |" in PAGE
    assert top.misfit_p >= curve_maximum.LEAST_P
    means = plain_means(rows).query("eta == zeta").set_index("eta")
    highest = means.loc[means.solid_fraction.idxmax()]
    error = highest.solid_fraction_error
    assert f"highest mean, at {highest.name} | {highest.solid_fraction:.4f} ± {error:.4f} |" in PAGE
    for name, words in (("prolate", "(ζ = 1, η = {:.2f})"), ("oblate", "(ζ = {:.2f})")):
        row = tops.loc[name]
        words = words.format(row.ratio)
        assert f"densest {name} {words} | {row.value:.4f} ± {row.value_error:.4f} |" in PAGE
    less = [top.value - tops.value[name] for name in ("prolate", "oblate")]
    assert "spheroids are {:.3f} and {:.3f} less dense".format(*less) in PAGE
    assert f"at 1.6, where ours is {means.solid_fraction[1.6]:.4f}" in PAGE
    monkeypatch.setattr(curve_maximum, "WIDTHS", curve_maximum.WIDTHS[-1:])
    narrow = findings(rows)["maxima"].query("of == 'solid_fraction'").set_index("family").loc["diagonal"]
    assert f"In the narrowest window the maximum is at {narrow.ratio:.2f} ± {narrow.ratio_error:.2f}." in PAGE


def test_exchange_of_the_ratios(rows, found):
    of = found["symmetry"].set_index("of")
    solid, contacts = of.loc["solid_fraction"], of.loc["coordination_number"]
    assert f"of {solid.pairs:.0f} pairs of forms by {solid.rms:.4f} (root mean square)" in PAGE
    assert f"would give {solid.expected_rms:.4f}" in PAGE
    assert (
        f"the {contacts.pairs:.0f} pairs have {contacts['mean']:.2f} ± {contacts.mean_error:.2f} more contacts" in PAGE
    )
    means = plain_means(rows).set_index(["eta", "zeta"]).solid_fraction
    pairs = [(one, other) for one, other in means.index if other < one and one > 2.0 and other > 1.0]
    flatter = [means[other, one] - means[one, other] for one, other in pairs]
    assert len(pairs) == 7 and "In all seven pairs of 2.2 or 2.5" in PAGE
    assert f"is denser, by {min(flatter):.3f} to {max(flatter):.3f};" in PAGE
    mirror = rows[rows.study == "deposit_change_mirror"].pivot(index="seed", columns="eta", values="solid_fraction")
    difference = mirror[1.6] - mirror[2.5]
    error = difference.std(ddof=1) / np.sqrt(len(difference))
    assert len(difference) == 4 and f"by {difference.mean():.4f} ± {error:.4f}. With" in PAGE


def test_crossings():
    table = pd.read_csv(REFERENCE / "deposit_crossings.csv").set_index("direction")
    angles = {
        name: f"{np.degrees(row.angle):.1f}° ± {np.degrees(row.std_error):.1f}°" for name, row in table.iterrows()
    }
    assert f"{angles['contact_normal']} for normals and at {angles['long_axis']} for long axes" in PAGE


def test_friction(rows):
    changed = rows[rows.study.isin(["deposit_change", "deposit_change_rounder"])]
    means = changed.groupby(["change", "eta"]).solid_fraction.mean().unstack()
    names = {
        "static": "friction_law static, steps_per_contact_time 15",
        "viscous": "friction_law viscous",
        "dynamic": "none",
        "dynamic, ten times stronger": "sliding_time 0.001",
        "dynamic, ten times weaker": "sliding_time 0.1",
    }
    for name, change in names.items():
        assert f"| {name} | {means[1.3][change]:.4f} | {means[1.6][change]:.4f} |" in PAGE
        assert means[1.3][change] > means[1.6][change]
