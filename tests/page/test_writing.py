"""The file of the page, without a browser."""

import json
import re
from dataclasses import replace

import pytest
from scipy.stats import t as student

from simcore.__main__ import main
from simcore.models.prediction import predict_samples
from simcore.page.data import LEVELS, SHAPES, page_data
from simcore.page.writing import _compact, page_text


@pytest.fixture(scope="module")
def data(fitted):
    return page_data(fitted)


def test_the_page_needs_no_other_file(page_file):
    text = page_file.read_text(encoding="utf-8")
    assert set(re.findall(r"https?://[^\"']*", text)) == {"http://www.w3.org/2000/svg"}  # a name, never fetched
    assert not re.search(r"<link|\bsrc=|@import|url\(|\bfetch\(|XMLHttpRequest|\bimport\(", text)
    assert len(text.encode()) < 220_000
    assert not re.search(r"^\s*//", text, re.MULTILINE) and "const Grains = (() => {" in text


def test_scripts_lose_comments_and_indentation_but_texts_in_backquotes_stay():
    script = "// comment\n\n  const a = `one\n  // two\n\n  three`;\n    f(`x`, `y`);\n"
    assert _compact(script) == "const a = `one\n  // two\n\n  three`;\nf(`x`, `y`);"


def test_the_data_are_those_of_the_models(data, fitted, page_file):
    line = re.search(r"^const DATA = (.*);$", page_file.read_text(encoding="utf-8"), re.MULTILINE)[1]
    assert json.loads(line) == json.loads(json.dumps(data))
    assert {(model["model"], model["case"]) for model in data["models"]} == set(fitted.models)
    for model in data["models"]:
        freedom = model["n_samples"] - len(model["coefficients"])
        for level in LEVELS:
            # By definition the probability between minus and plus the quantile is the level.
            t = model["quantiles"][f"{level:g}"]
            assert student.cdf(t, freedom) - student.cdf(-t, freedom) == pytest.approx(level, abs=1e-12)


def test_each_case_that_is_offered_is_accepted_by_the_command(data, fitted):
    from simcore.grains.measured_forms import Sample

    one_form = Sample("a", 1, 0.7, 0.0, 0.7, 0.0, 0.49, 0.0)
    for case in data["cases"]:
        assert predict_samples([one_form], case["name"], fitted).n.notna().any()
        assert case["specification"].count(SHAPES) == 1
        assert "synthetic" not in case["specification"] and "shapes:" not in case["specification"]
        assert case["predictors"]


def test_text_in_the_data_cannot_end_the_script(data):
    text = page_text({**data, "models": [{**data["models"][0], "behind": "</script><b>"}]})
    assert text.count("</script>") == 1


def test_every_identifier_of_the_scripts_is_in_the_template(page_file):
    text = page_file.read_text(encoding="utf-8")
    identifiers = set(re.findall(r'\bid="([\w-]+)"', text))
    used = set(re.findall(r'byId\("([\w-]+)"\)', text))
    assert len(used) > 10 and used <= identifiers
    assert set(re.findall(r'<label[^>]* for="([\w-]+)"', text)) <= identifiers


def test_the_command_refuses_a_folder_and_what_is_no_page(tmp_path, capsys):
    (tmp_path / "page.html").mkdir()
    (tmp_path / "bed.nc").write_text("a packing")
    for name, message in (("page.html", "is a folder; give the name of a file in it"), ("bed.nc", "must end in .html")):
        assert main(["page", str(tmp_path / name)]) == 2
        assert message in capsys.readouterr().err
    assert (tmp_path / "bed.nc").read_text() == "a packing"


def test_models_of_measured_beds_are_refused(fitted):
    of_fit = replace(fitted, behind={**fitted.behind, ("measured", "U1"): "offset, 5 measured beds: m.json"})
    with pytest.raises(
        ValueError, match="offset, 5 measured beds: m.json: the page does not evaluate models of measured"
    ):
        page_data(of_fit)
