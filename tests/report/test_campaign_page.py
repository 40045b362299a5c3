"""The page of a campaign whose packings are there."""

import re
from types import SimpleNamespace

import pandas as pd
import pytest

from simcore.paths import ROOT
from simcore.report.campaign_page import TEST_ONLY, campaign_page

PNG = b"\x89PNG\r\n\x1a\n" + bytes(8) + (1).to_bytes(4, "big") + (1).to_bytes(4, "big")
GROUPS = ("models", "model_figures", "campaign_tables", "campaign_figures", "grain_tables", "grain_figures")
OF_A_STUDY = ("tables", "packings", "study_figures", "pictures", "profiles")


@pytest.fixture
def files(tmp_path):
    """Files of a campaign of two studies, with no model and no grains of its own."""

    def write(folder, name, **columns):
        path = tmp_path / folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(PNG) if path.suffix == ".png" else pd.DataFrame([columns]).to_csv(path, index=False)
        return str(path)

    listed = {group: [] for group in (*GROUPS, *OF_A_STUDY)}
    for study in ("spheres", "stones"):
        listed["tables"].append(write("tables", f"{study}.csv", n=0.36, of=f"table of {study}"))
        listed["packings"].append(write("tables", f"{study}_packings.csv", packing="p", warnings=f"warned of {study}"))
        for group in ("study_figures", "pictures", "profiles"):
            listed[group].append(write(group, f"{study}.png"))
    listed["campaign_tables"].append(write("campaign", "cost.csv", of="table of cost"))
    listed["campaign_figures"].append(write("campaign", "trends.png"))
    return SimpleNamespace(**listed, write=write)


def said(html):
    found = re.findall(r"<h2[^>]*>([^<]+)|(table of \w+)|(off in \w+)|(warned of \w+)|(<figure)", html)
    return ["".join(each) for each in found]


def test_each_study_has_its_table_its_bias_its_warnings_and_then_its_figures(files):
    studies = {"spheres": "Round", "stones": "Large"}
    biases = {study: f"off in {study}" for study in studies}
    whole, bare = campaign_page(files, studies, biases, ROOT / "workflow" / "report")
    head = ["Cost, and order in the beds", "<figure", "table of cost", "Studies"]
    of_studies = [
        ["Round", "table of spheres", "off in spheres", "warned of spheres", *3 * ["<figure"]],
        ["Large", "table of stones", "off in stones", "warned of stones", *3 * ["<figure"]],
    ]
    assert said(whole) == [*head, *of_studies[0], *of_studies[1]]
    assert said(bare) == [text for text in said(whole) if text != "<figure"]
    assert TEST_ONLY not in whole


def test_models_and_grains_have_a_heading_where_there_are_some(files):
    files.grain_tables.append(files.write("grains", "principal_components.csv", of="table of grains"))
    files.model_figures.append(files.write("models", "shape_kinds.png"))
    biases = {"spheres": "", "stones": ""}
    whole, bare = campaign_page(files, biases, biases, ROOT / "workflow" / "report", test_only=True)
    assert said(whole)[:6] == ["Models", "<figure", "Cost, and order in the beds", "<figure", "table of cost", "Grains"]
    assert TEST_ONLY in whole and TEST_ONLY in bare
