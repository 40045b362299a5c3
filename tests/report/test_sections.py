"""The page of a campaign's committed rows."""

import re

import pandas as pd

from simcore.models.formulas import BEDS
from simcore.provenance.digest import ROOT
from simcore.report.sections import committed_page

CAPTIONS = ROOT / "workflow" / "report"


def test_the_page_holds_every_table_once_under_its_heading(tmp_path):
    """Models of synthetic grains first; a study's table with its bias; what has no table has no heading."""
    names = ("single_form", "single_form_mean_form", "unified", "single_form_porosities", "validation", "collected")
    for name in names:
        rows = pd.DataFrame({"n": [0.36], "of": [f"this is {name}"]})
        (rows.assign(**_model(name)) if name in BEDS else rows).to_csv(tmp_path / f"{name}.csv", index=False)
    titles = {"validation": "Against the experiment", "single_form": "One form", "domain_size": "Width"}
    html = committed_page(tmp_path, titles, {study: f"off in {study}" for study in titles}, CAPTIONS)
    text = re.findall(r"<h2[^>]*>([^<]+)|this is (\w+)|(off in \w+)", html)
    assert ["".join(each) for each in text] == [
        "In short",
        "Models",
        "single_form",
        "single_form_mean_form",
        "unified",
        "Cost, and order in the beds",
        "collected",
        "Studies",
        "Against the experiment",
        "validation",
        "off in validation",
        "One form",
        "single_form_porosities",
        "off in single_form",
    ]
    assert all(f"n = {beds}" in html for beds in ("0.111", "0.333"))
    # Nothing is known of the grains' source and of the study.
    assert re.findall("<th[^>]*>([^<]+)", html)[:6] == ["beds", "case", "porosity", "error", "samples", "range"]


def test_a_study_shows_its_difference_before_its_details(tmp_path):
    row = {"case": "U1", "n": 0.384, "n_std": 0.001, "grains": 4700, "r22_n": 0.383, "difference": 0.001}
    pd.DataFrame([row]).to_csv(tmp_path / "validation.csv", index=False)
    html = committed_page(tmp_path, {"validation": "Against the experiment"}, {"validation": ""}, CAPTIONS)
    names = [name.replace("<wbr>", "") for name in re.findall("<th[^>]*>(.+?)</th>", html)]
    assert names == ["case", "n", "r22_n", "difference", "n_std", "grains"]


def _model(name):
    """Of a table of coefficients what its formula is made of."""
    known = {"intercept": {"single_form": 0.111, "unified": 0.333}[name], "mean_absolute_error": 0.005, "samples": 9}
    columns = {"model": name, "case": "U1", "term": "intercept", "coefficient": known.pop("intercept")}
    return columns | known | {"feature_min": float("nan"), "feature_max": float("nan")}


def test_a_caption_names_the_grains_of_its_figure(tmp_path):
    header = b"\x89PNG\r\n\x1a\n" + bytes(8) + (1).to_bytes(4, "big") + (1).to_bytes(4, "big")
    for source in ("scans", "synthetic"):
        (tmp_path / f"single_form_zingg_{source}.png").write_bytes(header)
    html = committed_page(tmp_path, {}, {}, CAPTIONS)
    assert re.findall(r"Grains: (\w+)\.", html)[::2] == ["synthetic", "scans"]
