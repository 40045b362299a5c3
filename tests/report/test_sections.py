"""The page of a campaign's committed rows."""

import re

import pandas as pd

from simcore.models.formulas import BEDS
from simcore.provenance.digest import ROOT
from simcore.report.sections import committed_page, study_section

CAPTIONS = ROOT / "workflow" / "report"
PNG = b"\x89PNG\r\n\x1a\n" + bytes(8) + (1).to_bytes(4, "big") + (1).to_bytes(4, "big")


def test_the_answer_comes_first_and_each_table_once_under_its_heading(tmp_path):
    """Models of synthetic grains come first, a study's table has its effects, and what has no table has no heading."""
    names = ("single_form", "single_form_mean_form", "unified", "single_form_porosities", "validation", "collected")
    for name in names:
        rows = pd.DataFrame({"n": [0.36], "packing": [f"this is {name}"]})
        (rows.assign(**_model(name)) if name in BEDS else rows).to_csv(tmp_path / f"{name}.csv", index=False)
    titles = {"validation": "Against the experiment", "single_form": "One form", "domain_size": "Width"}
    html = committed_page(tmp_path, titles, {study: f"off in {study}" for study in titles}, CAPTIONS)
    text = re.findall(r"<h[23] id[^>]*>([^<]+)|>this is (\w+)|(off in \w+)", html)
    assert ["".join(each) for each in text] == [
        "The answer",
        "How sure is this?",
        "Against the experiment",
        "validation",
        "off in validation",
        "Models",
        "single_form",
        "single_form_mean_form",
        "unified",
        "Studies",
        "One form",
        "single_form_porosities",
        "off in single_form",
        "Cost, and order in the beds",
        "collected",
    ]
    assert all(f"<i>n</i> = {beds}" in html for beds in ("0.111", "0.333"))
    # The rows name neither the source of the grains nor the study.
    headings = [words.strip() for words in re.findall("<th[^>]*>([^<]+)", html)]
    assert headings[:4] == ["grains", "porosity, U1", "flatness S/I", "elongation I/L"]
    assert headings[4:8] == ["beds", "porosity", "mean error of porosity, cross-validated", "samples"]


def test_a_study_has_what_was_asked_what_came_out_and_its_table(tmp_path):
    row = {"case": "U1", "runs": 2, "n": 0.384, "n_std_error": 0.002, "grains": 4700, "r22_n": 0.383}
    row |= {"r22_n_error": 0.0014, "difference": 0.001, "z": 0.4, "experiment_n": 0.371, "experiment_n_std": 0.001}
    rows = pd.DataFrame([row]).assign(experiment_error_percent=3.5, r22_error_percent=3.2)
    rows.to_csv(tmp_path / "validation.csv", index=False)
    (tmp_path / "validation.png").write_bytes(PNG)
    effects = {"validation": [("settings", "+0.004 ± 0.001 (this instead of that)"), ("insertion", "not measured")]}
    titles, questions = {"validation": "Against the experiment"}, {"validation": "Is it right?"}
    html = committed_page(tmp_path, titles, effects, CAPTIONS, questions)
    assert '<p class="asked">Is it right?</p>' in html
    assert '<p class="outcome">The simulated porosity differs from the measured one by +3.5 %' in html
    headings = [words.strip() for words in re.findall('<th scope="col"[^>]*>([^<]+)', html)]
    assert headings[:3] == ["sieve curve", "packings", "porosity"]
    assert headings[3:6] == ["porosity, experiment", "difference to experiment", "porosity, Rettinger et al."]
    assert headings[-3:] == ["grains", "cause", "effect on the porosity"], "details come last, effects follow"
    assert ">0.384 ± 0.002</td>" in html and "+0.004 ± 0.001 (this instead of that)" in html
    # A figure of one row would show no more than the sentence.
    assert "<figure" not in html
    asked = committed_page(tmp_path, titles, {}, CAPTIONS)
    assert '<p class="asked">What is the porosity with these settings?</p>' in asked
    assert "and the values of Rettinger et al. (2022)." in asked


def test_a_study_without_published_values_has_a_caption_without_them(tmp_path):
    rows = pd.DataFrame({"case": "U1", "friction": [0.3, 0.5, 0.6], "runs": 1, "n": [0.35, 0.36, 0.37]})
    rows.assign(n_std_error=0.002, r22_n=float("nan")).to_csv(tmp_path / "mine.csv", index=False)
    (tmp_path / "mine.png").write_bytes(PNG)
    html = committed_page(tmp_path, {"mine": "Mine"}, {}, CAPTIONS)
    assert "Porosity for each setting of the study. In all rows: sieve curve U1; packings 1." in html
    assert "How does the porosity depend on: friction?" in html
    assert html.count("<figure id") == 1


def test_a_sentence_has_the_names_of_grains_as_they_are(tmp_path):
    """A grain may be named 001 or 1e3, which are no numbers."""
    rows = pd.DataFrame({"case": "U1", "grain": ["001", "1e3", "NA"], "runs": 1, "n": [0.34, 0.37, 0.35]})
    rows.assign(n_std_error=0.002, r22_n=float("nan")).to_csv(tmp_path / "mine.csv", index=False)
    section = study_section("Mine", tmp_path / "mine.csv")
    (sentence,) = [part["text"] for part in section.parts if part.get("kind") == "outcome"]
    assert "001" in sentence and "1e3" in sentence


def _model(name):
    """Return the columns of a table of coefficients from which its formula is made."""
    known = {"intercept": {"single_form": 0.111, "unified": 0.333}[name], "samples": 9}
    known["mean_absolute_error"] = {"single_form": 0.005, "unified": 0.006}[name]
    columns = {"model": name, "case": "U1", "term": "intercept", "coefficient": known.pop("intercept")}
    return columns | known | {"feature_min": float("nan"), "feature_max": float("nan")}


def test_a_caption_names_the_grains_of_its_figure(tmp_path):
    for source in ("scans", "synthetic"):
        (tmp_path / f"single_form_zingg_{source}.png").write_bytes(PNG)
    html = committed_page(tmp_path, {}, {}, CAPTIONS)
    assert re.findall(r"</b> [^<]*Grains: ([\w ]+)\.", html) == ["synthetic pebbles", "scanned grains"]
