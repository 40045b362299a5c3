"""The page of the two papers: its numbers follow from the committed rows."""

import re

import numpy as np
import pandas as pd

from docs.generate import papers
from simcore.paths import REFERENCE, ROOT


def test_every_entry_has_a_place_a_size_and_a_difference():
    entries = [entry for listed in papers.listed().values() for entry in listed]
    assert {entry.get("compared") for entry in entries} - {None} == set(papers.COMPARED)
    for entry in entries:
        assert len({"study", "compared", "picture"} & set(entry)) == 1 and entry["shows"] and entry["here"], entry


def test_a_picture_is_on_the_page_that_is_named():
    pictures = [entry for listed in papers.listed().values() for entry in listed if "picture" in entry]
    assert pictures
    for entry in pictures:
        page, anchor = re.fullmatch(r"\[.*\]\(([^#)]+)#?([^)]*)\)", entry["here"]).groups()
        text = (ROOT / "docs" / "reference" / page).read_text(encoding="utf-8")
        section = text if not anchor else _section(text, anchor)
        assert re.search(r"!\[.+\]\(\S+\.png\)", section), entry


def test_all_tables_of_the_paper_are_listed():
    items = {entry["item"] for entry in papers.listed()["r22"]}
    assert {f"Table {number}" for number in range(1, 12)} <= items
    assert {f"Eq. {number}" for number in (17, 18, 19, 23, 24)} <= items


def test_numbers_follow_from_the_rows():
    rows = pd.read_csv(REFERENCE / "application.csv")
    n = rows[rows["choice"] == "random"]["n"]
    difference, error = n.mean() - 0.353, np.hypot(n.sem(), 5e-4 / np.sqrt(3))
    assert papers.COMPARED["application"]()[1].endswith(
        f"+{difference:.4f} ± {error:.4f} ({difference / error:.1f} standard errors)"
    )
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
