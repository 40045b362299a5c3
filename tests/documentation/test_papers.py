"""The page of the two papers: its numbers follow from the committed rows."""

import re

import numpy as np
import pandas as pd

from docs.generate import papers
from simcore.paths import REFERENCE, ROOT
from simcore.reference.r22_tables import read_r22_table


def test_every_entry_has_a_place_a_size_and_a_difference():
    entries = [entry for listed in papers.listed().values() for entry in listed]
    assert {entry.get("compared") for entry in entries} - {None} == set(papers.COMPARED)
    for entry in entries:
        assert len({"study", "compared", "picture", "absent"} & set(entry)) == 1 and entry["shows"] and entry["here"], (
            entry
        )


def test_a_picture_is_on_the_page_that_is_named():
    pictures = [entry for listed in papers.listed().values() for entry in listed if "picture" in entry]
    assert pictures
    for entry in pictures:
        page, anchor = re.fullmatch(r"\[.*\]\(([^#)]+)#?([^)]*)\)", entry["here"]).groups()
        text = (ROOT / "docs" / "reference" / page).read_text(encoding="utf-8")
        section = text if not anchor else _section(text, anchor)
        assert re.search(r"!\[.+\]\(\S+\.png\)", section), entry


def test_all_tables_and_figures_of_the_paper_are_listed():
    """The arXiv version has twelve figures, and the journal one more, which is its third."""
    items = [entry["item"] for entry in papers.listed()["r22"]]
    figures = [item for item in items if item.startswith("Fig. ")]
    assert sorted(figures) == sorted([*(f"Fig. {number}" for number in range(1, 13)), "Fig. 3 of the journal"])
    items = set(items)
    assert {f"Table {number}" for number in range(1, 12)} <= items
    assert {f"Eq. {number}" for number in (17, 18, 19, 23, 24)} <= items


def test_all_figures_of_baram_and_lind_are_listed():
    """Their figures have no numbers in the text that we have."""
    assert {entry["item"] for entry in papers.listed()["baram_lind"]} >= {
        "Distribution of size",
        "Picture of a deposit",
        "Density over the ratios of the axes",
        "Density of spheroids",
        "Density over the spread of size",
        "Coordination number over the ratios of the axes",
        "Angles over the spread of size",
        "Directions of contacts and long axes",
        "Azimuth of contacts and long axes",
    }


def test_volumes_of_decimated_grains_are_beside_those_of_table_4():
    ours = pd.read_csv(REFERENCE / "grains" / "decimation.csv").groupby("target")["volume_change_percent"].mean()
    text = papers.COMPARED["faces"]()[1].replace("−", "-")
    for faces, theirs in {300: "-0.2", 200: "-0.4", 100: "-1.3", 50: "-3.6"}.items():
        assert f"{faces} faces {ours[faces]:+.2f} % (theirs {theirs} %)" in text


def test_beds_of_fewer_faces_are_compared_with_those_of_300_as_in_table_4():
    beds = {"U7": {"original": 0.31, 300: 0.3, 50: 0.32}, "B50": {100: 0.29}}
    rows = [(case, faces, n, 0.01) for case, by_faces in beds.items() for faces, n in by_faces.items()]
    text = papers._porosity_over_faces(pd.DataFrame(rows, columns=["case", "faces", "n", "n_error"]))
    original, fewer = "U7 original +0.010 ± 0.014 (theirs −0.001)", "U7 50 faces +0.020 ± 0.014 (theirs +0.019)"
    assert text == f"minus that of 300 faces: {original}, {fewer}"
    assert papers._porosity_over_faces(pd.DataFrame(rows[3:], columns=["case", "faces", "n", "n_error"])) == ""


def test_what_is_not_here_has_a_reason():
    absent = [entry for entries in papers.listed().values() for entry in entries if "absent" in entry]
    assert absent
    for entry in absent:
        assert entry["here"] == "not here" and papers._compare(entry) == ("", entry["absent"])


def test_numbers_of_the_figures_follow_from_the_rows():
    explained = pd.read_csv(REFERENCE / "grains" / "components.csv")["explained"]
    assert f"explain {100 * explained[:2].sum():.1f} %" in papers.COMPARED["components"]()[1]
    grains = pd.read_csv(REFERENCE / "grains" / "statistics.csv").iloc[0]
    assert f"FL p = {grains.shapiro_p_FL:.2f}" in papers.COMPARED["normality"]()[1]
    r = pd.read_csv(REFERENCE / "models" / "single_form_correlations.csv").query(
        "source == 'synthetic' and case == 'U7' and feature == 'JFF_inv'"
    )
    assert f"JFF⁻¹ {r.r.iloc[0] - 0.955:+.3f}".replace("-", "−") in papers.COMPARED["correlation"]()[1]
    model = pd.read_csv(REFERENCE / "models" / "form_mixture.csv").iloc[0]
    assert papers.COMPARED["prediction_of_mixtures"]()[1] == f"R² {model.r_squared:.3f} (theirs 0.980)"
    error = pd.read_csv(REFERENCE / "models" / "single_form.csv").query(
        "source == 'synthetic' and model == 'single_form' and case == 'B50'"
    )["mean_absolute_error"]
    assert f"B50 {error.iloc[0]:.4f} (theirs 0.0065)" in papers.COMPARED["prediction_of_forms"]()[1]


def test_numbers_of_the_deposits_follow_from_the_rows():
    rows = pd.read_csv(REFERENCE / "deposits.csv")
    sizes = rows[rows["study"].str.startswith("deposit_sizes") & (rows["eta"] == 2.2)]
    n = sizes.groupby("spread")["solid_fraction"].mean()
    assert f"S = 0.5 +0.008 to +{n[0.5] - n[0.0]:.3f}" in papers.COMPARED["spread"]()[1]
    plain = rows[rows["study"].str.contains("map|diagonal|prolate|oblate") & (rows["eta"] == 1) & (rows["zeta"] == 1)]
    assert papers.COMPARED["coordination"]()[1].startswith(
        f"{plain['coordination_number'].mean():.1f} contacts for spheres"
    )
    p, page = rows["azimuth_p2_long_axis"].dropna(), (ROOT / "docs" / "reference" / "deposits.md").read_text("utf-8")
    few = f"{(p ** (1 / 1.83) < 0.05).sum()} of"
    assert f"{few} {len(p)} deposits for long axes" in papers.COMPARED["azimuth"]()[1]
    assert f"With *c* = {papers.VARIANCE_FACTOR}, {few} the {len(p)} p-values" in page


def test_numbers_follow_from_the_rows():
    rows = pd.read_csv(REFERENCE / "application.csv")
    n = rows[rows["choice"] == "random"]["n"]
    difference, error = n.mean() - 0.353, np.hypot(n.sem(), 5e-4 / np.sqrt(3))
    size, texts = papers.COMPARED["application"]()
    assert f"+{difference:.4f} ± {error:.4f} ({difference / error:.1f} standard errors)" in texts
    rain = pd.read_csv(REFERENCE / "mixtures_wide.csv").query("mu_FL_nominal == 0.647")
    assert f"as a rain +{rain['n'].mean() - 0.288:.4f} ± " in texts and size.endswith(f"U7, {len(rain)}")
    forms = pd.read_csv(REFERENCE / "single_form.csv").query("case == 'U7'")["grain"].nunique()
    assert papers.COMPARED["single_U7"]()[0].startswith(f"{forms} of 63 forms")


def test_a_study_without_rows_is_said_to_be_open(monkeypatch):
    table = pd.DataFrame({"study": ["domain_size"], "packings": [0], "planned": [6]})
    monkeypatch.setattr(papers, "_rows", lambda name: table)
    assert papers._not_packed("domain_size") == ("0 of 6 packings", "not packed yet")


def test_a_negative_difference_has_a_minus_sign():
    assert papers._apart(-0.004, 0.002) == "−0.0040 ± 0.0020 (2.0 standard errors)"


def _section(text, anchor):
    """Return the part of a page below the heading with this anchor, which is its words in lower case with hyphens."""
    parts = {
        re.sub(r"[^\w]+", "-", part.split("\n")[0].lower()).strip("-"): part
        for part in re.split(r"^#+ ", text, flags=re.M)
    }
    return parts[anchor]


def test_a_study_is_compared_with_its_table_case_by_case(monkeypatch, tmp_path):
    planned = {"study": ["shaking_cylinder", "domain_size"], "packings": [3, 0], "planned": [8, 4]}
    pd.DataFrame(planned).to_csv(tmp_path / "collected.csv", index=False)
    theirs = read_r22_table("table5_shaking_cylinder").set_index(["case", "t_s"])["n"]
    rows = [("U7", 1.0, theirs["U7", 1.0] + 0.02, 0.01), ("U7", 2.0, theirs["U7", 2.0] - 0.01, 0.01)]
    rows += [("B50", 7.5, 0.3, 0.01)]  # a time that is not in the table
    table = pd.DataFrame(rows, columns=["case", "shaking_s", "n", "n_error"])
    table.to_csv(tmp_path / "shaking_cylinder.csv", index=False)
    monkeypatch.setattr(papers, "REFERENCE", tmp_path)
    size, difference = papers._study("shaking_cylinder")
    assert size == "3 of 8 packings"
    assert difference == "U7 −0.010 to +0.020 (up to 2.0 standard errors)"
    assert papers._study("domain_size") == ("0 of 4 packings", "not packed yet")


def test_sets_in_U7_are_compared_with_their_model(monkeypatch):
    """Its equation is n = 0.239 + 0.024 / mean EQ - 0.003 / std EQ + 0.002 / mean EL + 0.001 / std EL."""
    table = pd.read_csv(REFERENCE / "mixtures_wide.csv")
    table = table[table["mu_FL_nominal"] == 0.647]
    monkeypatch.setattr(papers, "_rows", lambda name: table)
    assert papers.COMPARED["mixtures_U7"]()[1] == "not packed yet"
    columns = ["mu_FL_nominal", "mu_EL_nominal", "sigma_FL_nominal", "sigma_EL_nominal"]
    table = pd.concat([table, table.iloc[:1].assign(**dict(zip(columns, (0.5, 0.7, 0.1, 0.1), strict=True)), n=0.32)])
    monkeypatch.setattr(papers, "_rows", lambda name: table)
    mu, sigma = 0.35, np.sqrt((0.49 + 0.01) * (0.25 + 0.01) - 0.35**2)
    theirs = 0.239 + 0.024 / mu - 0.003 / sigma + 0.002 / 0.7 + 0.001 / 0.1
    size, text = papers.COMPARED["mixtures_U7"]()
    assert size == "1 of 52 sets, inserted as a rain"
    assert text == f"packings minus their model: {0.32 - theirs:+.4f}"
