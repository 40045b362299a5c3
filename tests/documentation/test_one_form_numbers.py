"""Numbers of the page of single forms in U7 and B50 are those of the tables of models."""

import numpy as np
import pandas as pd
import pytest

from simcore.paths import REFERENCE, ROOT
from simcore.reference.r22_tables import read_r22_table

PAGE = (ROOT / "docs" / "appendices" / "one_form.md").read_text(encoding="utf-8")
CASES = ["U7", "B50"]
R22 = "Rettinger et al."


def cells(start):
    """Return the cells of U7 and B50 in the row of the page that begins so."""
    (line,) = [line for line in PAGE.splitlines() if line.startswith(f"| {start} |")]
    return [cell.strip() for cell in line.strip("|").split("|")][1:]


@pytest.fixture(scope="module")
def correlations():
    table = pd.read_csv(REFERENCE / "models" / "single_form_correlations.csv").query("source == 'synthetic'")
    return table.assign(rank=table.groupby("case")["r"].transform(lambda r: r.abs().rank(ascending=False).astype(int)))


@pytest.mark.parametrize(("name", "feature"), [("EQ⁻¹", "EQ_inv"), ("JFF⁻¹", "JFF_inv"), ("WFI", "WFI")])
def test_correlations(correlations, name, feature):
    rows = correlations[correlations["feature"] == feature].set_index("case").loc[CASES]
    assert cells(f"r of n with {name}, {R22}") == [f"{row.r:.3f}, {row.r22_r:.3f}" for row in rows.itertuples()]


def test_correlations_in_one_sieve_class(correlations):
    """The first table of the page: inverse equancy and the inverse of Krumbein's sphericity are the two highest."""
    rows = correlations.query("case == 'U1'").set_index("feature")
    assert set(rows.index[rows["rank"] <= 2]) == {"EQ_inv", "KIS_inv"}
    for start, feature in (
        ("r of n with EQ⁻¹, one of the two highest of 26 form factors", "EQ_inv"),
        ("with the inverse of Krumbein's sphericity", "KIS_inv"),
        ("with the inverse of Janke's form factor JFF", "JFF_inv"),
        ("with the Wentworth flatness index WFI", "WFI"),
    ):
        row = rows.loc[feature]
        assert cells(start) == [f"{row.r:.3f}", f"{row.r22_r:.3f}" if np.isfinite(row.r22_r) else ""]


def test_rank_of_the_inverse_equancy(correlations):
    rows = correlations[correlations["feature"] == "EQ_inv"].set_index("case").loc[CASES]
    assert (correlations.groupby("case").size() == 26).all()
    assert cells("rank of EQ⁻¹ among 26 form factors by r") == [str(rank) for rank in rows["rank"]]


def test_in_b50_two_form_factors_have_a_higher_correlation_here_and_in_the_paper(correlations):
    table = correlations.query("case == 'B50'").set_index("feature")
    for column in ("r", "r22_r"):
        assert table.loc[["JFF_inv", "WFI"], column].min() > table.loc["EQ_inv", column]


def test_errors_with_and_without_the_second_factor():
    ours = pd.read_csv(REFERENCE / "models" / "single_form_second_features.csv").query("source == 'synthetic'")
    ours = ours.pivot(index="case", columns="feature", values="mean_absolute_error").loc[CASES]
    theirs = read_r22_table("table9_second_factor_mae").set_index("case").loc[CASES] * 1e-3
    for start, feature in (
        (f"error on a form left out, {R22}", "EL_inv"),
        ("the same by a model of EQ⁻¹ alone", "EQ_inv"),
    ):
        shown = [cell.removesuffix(" (63 forms)") for cell in cells(start)]
        assert shown == [f"{ours.loc[case, feature]:.4f}, {theirs.loc[case, feature]:.4f}" for case in CASES]
    assert (ours["EQ_inv"] < ours["EL_inv"]).to_dict() == {"U7": False, "B50": True}
    assert theirs.loc["B50", "EQ_inv"] < theirs.loc["B50", "EL_inv"]


def test_ellipsoids_near_spheres():
    rows = pd.read_csv(REFERENCE / "near_spheres.csv")
    rows["L_over_S"] = 1 / (rows.flatness * rows.elongation)
    beds = rows.groupby("L_over_S")
    n, error = beds["n"].mean(), np.sqrt(beds["n_error"].agg(lambda errors: (errors**2).sum())) / beds.size()
    assert (beds.size() == 2).all() and len(beds) == 11
    section = PAGE.partition("## Ellipsoids near spheres")[2]
    assert [line for line in section.splitlines() if line.startswith("| ")][1:] == [
        f"| {ratio:.1f} | {n[ratio]:.3f} ± {error[ratio]:.3f} |" for ratio in n.index
    ]
    assert f"From spheres to L/S = 1.6 the porosity falls by {n.iloc[0] - n.iloc[6]:.3f}" in section
    # Chi-squared of the five beds from 1.6 on about their mean has four degrees of freedom; 9.5 is exceeded in 5 %.
    flat, weights = n.iloc[6:], error.iloc[6:] ** -2
    assert (weights * (flat - np.average(flat, weights=weights)) ** 2).sum() < 9.5


def test_ellipsoids_of_the_same_axes():
    rows = pd.read_csv(REFERENCE / "single_form.csv").query("source == 'synthetic' and case == 'U1'")
    seeds = rows.query("representation == 'ellipsoid'").groupby("grain").size()
    assert len(seeds) == 63 and seeds.nunique() == 1
    means = rows.groupby(["grain", "representation"])["n"].mean().unstack()
    ratio, difference = (rows["L"] / rows["S"]).groupby(rows["grain"]).first(), means["ellipsoid"] - means["polyhedron"]
    section = " ".join(PAGE.partition("## Ellipsoids of the same axes")[2].partition("## Ellipsoids near")[0].split())
    words = {1: "one seed", 2: "two seeds"}[seeds.iloc[0]]
    assert f"Ellipsoids of the 63 synthetic forms have {words} and" in section
    assert f"root mean square is {np.sqrt((difference**2).mean()):.4f}" in section
    means_by_ratio = (
        means["ellipsoid"].groupby(pd.cut(ratio, np.arange(1.0, 5.0, 0.2), right=False), observed=True).mean()
    )
    assert means_by_ratio.idxmin().left == pytest.approx(1.6)
    assert f"densest for L/S of 1.6 to 1.8, with a mean porosity of {means_by_ratio.min():.3f}" in section
    by_seed = rows.query("representation == 'ellipsoid'").pivot(index="grain", columns="seed", values="n")
    change = by_seed[2] - by_seed[1]
    assert f"by {change.mean():+.4f} ± {change.std() / np.sqrt(len(change)):.4f} on average" in section
    bounds = [0.0, 1.5, 2.0, 2.5, np.inf]
    names = ["below 1.5", "1.5 to 2", "2 to 2.5", "above 2.5"]
    for name, group in difference.groupby(pd.cut(ratio, bounds, right=False, labels=names), observed=True):
        mean, error = group.mean(), group.std() / np.sqrt(len(group))
        assert f"| {name} | {len(group)} | {mean:+.3f} ± {error:.3f} |".replace("-", "−") in section
