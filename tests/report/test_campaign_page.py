"""The page of a campaign with finished packings."""

import re
from pathlib import Path
from types import SimpleNamespace

import pandas as pd
import pytest

from simcore.paths import ROOT
from simcore.report.campaign_page import CHECK_HEADING, LARGEST, OWN_STUDIES, TEST_ONLY, campaign_page

PNG = b"\x89PNG\r\n\x1a\n" + bytes(8) + (1).to_bytes(4, "big") + (1).to_bytes(4, "big")
GROUPS = (
    "models",
    "model_figures",
    "campaign_tables",
    "campaign_figures",
    "grain_tables",
    "grain_figures",
    "committed",
)
OF_A_STUDY = ("tables", "packings", "study_figures", "pictures", "profiles")
CAPTIONS = ROOT / "workflow" / "report"
MODEL = {"model": "single_form", "case": "U1", "term": "intercept", "coefficient": 0.3, "mean_absolute_error": 0.005}
MODEL |= {"samples": 9, "feature_min": float("nan"), "feature_max": float("nan")}


@pytest.fixture
def files(tmp_path):
    """Return the files of a campaign of two studies, with no model and no grains of its own."""

    def write(folder, name, **columns):
        path = tmp_path / folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(PNG) if path.suffix == ".png" else pd.DataFrame([columns]).to_csv(path, index=False)
        return str(path)

    listed = {group: [] for group in (*GROUPS, *OF_A_STUDY)}
    for study in ("spheres", "validation"):
        columns = {"case": "U1", "n": 0.36, "n_std_error": 0.01, "grains": 300, "packing": f"table of {study}"}
        listed["tables"].append(write("tables", f"{study}.csv", **columns))
        listed["packings"].append(write("tables", f"{study}_packings.csv", packing="p", warnings=f"warned of {study}"))
        for group in ("study_figures", "pictures", "profiles"):
            listed[group].append(write(group, f"{study}.png"))
    listed["campaign_tables"].append(write("campaign", "cost.csv", packing="table of cost"))
    listed["campaign_figures"].append(write("campaign", "trends.png"))
    return SimpleNamespace(**listed, write=write)


def said(html):
    found = re.findall(r"<h[23] id[^>]*>([^<]+)|>(table of \w+)|(off in \w+)|(warned of \w+)|(<figure) id", html)
    return ["".join(each) for each in found]


STUDIES = {"spheres": "Round", "validation": "Measured"}
EFFECTS = {study: f"off in {study}" for study in STUDIES}


def test_each_study_has_its_table_its_effects_its_warnings_and_then_its_figures(files):
    whole, bare = campaign_page(files, STUDIES, EFFECTS, CAPTIONS, made="Made today.")
    of_studies = {
        study: [title, f"table of {study}", f"off in {study}", f"warned of {study}", "<figure", "<figure"]
        for study, title in STUDIES.items()
    }
    # The comparison with measurements is evidence, so it comes before other studies, and the cost at the end.
    cost = ["Cost, and order in the beds", "<figure", "table of cost"]
    assert said(whole) == ["How sure is this?", *of_studies["validation"], "Studies", *of_studies["spheres"], *cost]
    assert said(bare) == [text for text in said(whole) if text != "<figure"]
    assert TEST_ONLY not in whole and LARGEST not in whole and "Made today." in whole
    assert whole.count('class="asked"') == whole.count('class="outcome"') == 2
    assert "The porosity is 0.360 ± 0.010." in whole


def test_models_and_grains_have_a_heading_where_there_are_some(files):
    files.grain_tables.append(files.write("grains", "principal_components.csv", component="table of grains"))
    files.model_figures.append(files.write("models", "shape_kinds.png"))
    files.models.append(files.write("models", "single_form.csv", **MODEL))
    whole, bare = campaign_page(files, STUDIES, EFFECTS, CAPTIONS, test_only=True)
    headings = re.findall(r"<h2 id[^>]*>([^<]+)", whole)
    assert headings == ["The answer", "How sure is this?", "Models", "Grains", "Studies", "Cost, and order in the beds"]
    assert "table of grains" in whole and "Janke form factor" in whole
    assert TEST_ONLY in whole and TEST_ONLY in bare


def test_the_largest_committed_campaign_comes_first_and_then_its_check(files):
    write, folder = files.write, "committed"
    rows = {"case": "U1", "runs": 2, "n": 0.384, "n_std_error": 0.002, "experiment_n": 0.371, "grains": 4700}
    path = write(folder, "validation.csv", **rows, experiment_error_percent=3.5, packing="table of committed")
    write(folder, "single_form.csv", **MODEL)
    write(folder, "collected.csv", packing="table of collected")
    files.committed.append(path.rsplit("/", 1)[0])
    whole, bare = campaign_page(files, STUDIES, EFFECTS, CAPTIONS, {"validation": "Is it right?"})
    assert LARGEST in whole
    headings = [text for text in said(whole) if not text.startswith(("<", "table", "off", "warned"))]
    assert headings == [
        "The answer",
        "How sure is this?",
        "Measured",
        "Models",
        CHECK_HEADING,
        f"{OWN_STUDIES}Round",
        f"{OWN_STUDIES}Measured",
        "Cost, and order in the beds",
    ]
    # There are two comparisons with measurements; that of small beds refers to the larger ones.
    assert whole.count("Is it right?") == 2 and "same comparison gives +3.5 to +3.5 %" in whole
    write(folder, "validation.csv", **{**rows, "grains": 400}, experiment_error_percent=3.5)
    as_large = campaign_page(files, STUDIES, EFFECTS, CAPTIONS)[0]
    assert "same comparison gives" not in as_large
    assert said(whole)[-3:] == ["<figure", "table of cost", "table of collected"]
    # The settings that both have in common differ by more than the errors.
    assert ">−0.024 ± 0.010</td>" in whole
    assert whole.count("First packing: picture, and porosity over the height") == 2
    assert "table of committed" in whole and "table of committed" not in bare


def test_committed_rows_without_their_cost_keep_all_their_sections(files):
    rows = {"case": "U1", "runs": 2, "n": 0.384, "n_std_error": 0.002, "experiment_n": 0.371, "grains": 4700}
    path = files.write(
        "committed", "validation.csv", **rows, experiment_error_percent=3.5, packing="table of committed"
    )
    files.committed.append(path.rsplit("/", 1)[0])
    whole, _ = campaign_page(files, STUDIES, EFFECTS, CAPTIONS)
    assert "table of committed" in whole
    Path(path).unlink()
    whole, _ = campaign_page(files, STUDIES, EFFECTS, CAPTIONS)
    assert "table of committed" not in whole and "table of cost" in whole
