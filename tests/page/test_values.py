"""The page and the command give the same porosity, interval, remarks and messages."""

import io
import json
from urllib.parse import urlencode

import numpy as np
import pandas as pd
import pytest

from simcore.grains.measured_forms import read_measured, read_two_axes
from simcore.grains.sieve import read_cases
from simcore.models.packing_models.compressible import compressible
from simcore.models.packing_models.linear import linear
from simcore.models.prediction import predict_samples
from simcore.models.prediction_text import predict_file
from simcore.models.two_axes import predict_two_axes
from simcore.page.data import LEVELS
from simcore.paths import CONFIG, ROOT
from tests.helpers.random_tables import random_table
from tests.helpers.table_cases import GRAINS

CASES = ("one-class", "U1", "U7", "B50")
NUMBERS = ["n", "lower", "upper", "few_grains_error", "distance"]
TEXTS = ["by", "model", "preferred", "outside", "refused"]
STATISTICS = ["mu_FL", "sigma_FL", "mu_EL", "sigma_EL", "mu_EQ", "sigma_EQ"]
RANGE = ["n_low", "n_high", "lower", "upper", "flatness_low", "flatness_high"]
TOLERANCE = 1e-9
# JSON has no nan and no infinity, so numbers travel as text.
EVALUATE = """
inputs => inputs.map(({text, choice, level}) => {
  const texts = (row) => Object.fromEntries(
    Object.entries(row).map(([k, v]) => [k, typeof v === "number" ? String(v) : v]));
  try {
    const read = Grains.read("table.csv", text);
    const twoAxes = read.kind === Columns.TWO_AXES;
    const samples = read.samples.map((sample) => ({
      ...texts({...sample, forms: undefined}),
      rows: twoAxes ? null : Prediction.predict(sample, choice, level).map(texts),
      range: twoAxes ? Prediction.predictTwoAxes(sample, choice, level) : null,
    }));
    return {samples: samples, notices: read.notices};
  } catch (error) {
    if (!(error instanceof Numbers.InputError)) throw error;
    return {error: error.message};
  }
})
"""


def inputs(seed, number, faulty=False):
    rng = np.random.default_rng(seed)
    return [
        {
            "text": random_table(rng, faulty),
            "choice": CASES[rng.integers(len(CASES))],
            "level": float(rng.choice(LEVELS)),
        }
        for _ in range(number)
    ]


def by_command(path, entry, fitted):
    """Return what the page should: samples and notices, or the message of the error."""
    path.write_bytes(entry["text"].encode())
    try:
        two_axes = read_two_axes(path)
        samples, notices = two_axes or read_measured(path)
    except ValueError as error:
        return {"error": str(error)}
    rows = []
    for sample in samples:
        predict = predict_two_axes if two_axes else predict_samples
        try:
            options = {} if two_axes else {"require": False}
            table = predict([sample], entry["choice"], fitted, entry["level"], **options)
        except ValueError as error:  # none can be evaluated
            assert "no model" in str(error)
            table = str(error) if two_axes else None
        if isinstance(table, pd.DataFrame) and "model" in table and (table.model == "").any():
            table = None  # the page has one sentence on such samples instead of a row
        rows.append((sample, table))
    return {"samples": rows, "notices": notices}


def page_words(text):
    """Return a message of the command as the page writes it, where it names an option of the command."""
    return text.split("; if its values are samples")[0]


def assert_equal(page, command):
    """Compare one answer of the page and of the command, and return the number of porosities that were compared."""
    assert page.get("error") == command.get("error")
    if "error" in command:
        return 0
    assert [page_words(text) for text in page["notices"]] == [page_words(text) for text in command["notices"]]
    assert len(page["samples"]) == len(command["samples"])
    compared = 0
    for ours, (sample, table) in zip(page["samples"], command["samples"], strict=True):
        assert (ours["name"], float(ours["grains"])) == (sample.name, sample.grains)
        for key in STATISTICS if hasattr(sample, "mu_FL") else STATISTICS[2:4]:
            assert float(ours[key]) == pytest.approx(getattr(sample, key), abs=TOLERANCE), key
        if table is None:
            assert not ours["rows"] and ours["range"] is None
        elif isinstance(table, str):
            assert f": {ours['range']['refused']}; " in table and np.isnan(ours["range"]["n_low"])
        elif ours["range"] is not None:
            row = table.iloc[0]
            assert ours["range"]["refused"] == ""
            values = [ours["range"][key] for key in RANGE]
            assert values == pytest.approx(row[RANGE].astype(float).tolist(), abs=TOLERANCE, nan_ok=True)
            compared += 1
        else:
            assert len(ours["rows"]) == len(table)
            for mine, (_, row) in zip(ours["rows"], table.iterrows(), strict=True):
                assert {key: mine[key] for key in TEXTS} == {key: row[key] for key in TEXTS}
                numbers = [float(mine[key].replace("Infinity", "inf")) for key in NUMBERS]
                assert numbers == pytest.approx(row[NUMBERS].astype(float).tolist(), abs=TOLERANCE, nan_ok=True)
                compared += int(np.isfinite(row.n))
    return compared


def compare(page, entries, fitted, folder):
    answers = page.evaluate(EVALUATE, entries)
    compared = [0, 0]
    for answer, entry in zip(answers, entries, strict=True):
        expected = by_command(folder / "table.csv", entry, fitted)
        if "error" in expected:
            expected["error"] = expected["error"].replace(str(folder / "table.csv"), "table.csv")
        else:
            expected["notices"] = [text.replace(str(folder / "table.csv"), "table.csv") for text in expected["notices"]]
        try:
            compared[0] += assert_equal(answer, expected)
        except AssertionError as error:
            raise AssertionError(f"{error}\nfor the input {json.dumps(entry)}") from None
        compared[1] += "error" in expected
    return compared


def test_500_random_inputs(open_page, fitted, tmp_path):
    porosities, errors = compare(open_page(), inputs(1, 500), fitted, tmp_path)
    assert porosities > 500 and errors < 50


def test_faulty_inputs_have_the_same_messages(open_page, fitted, tmp_path):
    porosities, errors = compare(open_page(), inputs(2, 200, faulty=True), fitted, tmp_path)
    assert errors > 50


def test_shared_cases_have_the_same_words(open_page, fitted, tmp_path):
    entries = [{"text": case.text, "choice": "one-class", "level": 0.95} for case in GRAINS]
    compare(open_page(), entries, fitted, tmp_path)


def test_the_table_to_take_away_is_that_of_the_command(open_page, fitted):
    path = ROOT / "examples" / "table2.csv"
    expected = pd.read_csv(io.StringIO(predict_file(path, "U1", output="csv")))
    page = open_page()
    page.get_by_label("Table of grains").fill(path.read_text())
    page.get_by_label("Sieve curve").select_option("U1")
    for mark, options in ((".", {}), (",", {"sep": ";", "decimal": ","})):
        page.get_by_label("Decimals of results").select_option(mark)
        with page.expect_download() as download:
            page.get_by_role("button", name="Table as CSV").click()
        got = pd.read_csv(download.value.path(), encoding="utf-8-sig", **options)
        pd.testing.assert_frame_equal(got, expected, rtol=0, atol=TOLERANCE)


def test_samples_with_two_axes_that_are_refused_are_in_the_table_as_by_the_command(open_page, fitted, tmp_path):
    path = tmp_path / "two.csv"
    path.write_text("sample,L,I\nA,3,2\nA,4,2\nB,90,1\nB,95,1\n")
    expected = pd.read_csv(io.StringIO(predict_file(path, "one-class", output="csv")))
    assert expected["refused"].notna().tolist() == [False, True]
    page = open_page()
    page.get_by_label("Table of grains").fill(path.read_text())
    with page.expect_download() as download:
        page.get_by_role("button", name="Table as CSV").click()
    got = pd.read_csv(download.value.path(), encoding="utf-8-sig")
    pd.testing.assert_frame_equal(got, expected, rtol=0, atol=TOLERANCE)
    page.locator("#chosen").select_option("B")
    assert f"at any flatness: {expected['refused'][1]}." in page.locator("#answer").inner_text()


def test_a_sample_without_a_model_is_in_the_table_as_by_the_command(open_page, fitted, tmp_path):
    path = tmp_path / "forms.csv"
    path.write_text("sample,mean_FL,std_FL,mean_EL,std_EL\nbar,0.65,0.17,0.7,0.14\ncubes,0.9,0,0.9,0\n")
    expected = pd.read_csv(io.StringIO(predict_file(path, "B50", output="csv")))
    assert (
        expected["refused"]
        == "no model was fitted to beds of B50 with a distribution of form, only to beds with one form"
    ).sum() == 1
    page = open_page()
    page.get_by_label("Table of grains").fill(path.read_text())
    page.get_by_label("Sieve curve").select_option("B50")
    with page.expect_download() as download:
        page.get_by_role("button", name="Table as CSV").click()
    got = pd.read_csv(download.value.path(), encoding="utf-8-sig")
    pd.testing.assert_frame_equal(got, expected, rtol=0, atol=TOLERANCE)


def test_formats_are_those_of_python(open_page):
    rng = np.random.default_rng(3)
    values = [*(10.0 ** rng.uniform(-9, 12, 300) * rng.choice([-1, 1], 300)).tolist(), 0.0, 1.0, 100.0, 99999.95, 1e-5]
    values += [3.125, 3.135, 2.5, 0.0078125, 1234.5, 12345.5]
    digits = (3, 4, 6)
    texts = open_page().evaluate("([v, d]) => v.map((x) => d.map((k) => Numbers.general(x, k)))", [values, digits])
    assert texts == [[f"{value:.{k}g}" for k in digits] for value in values]


def test_packing_models_of_500_random_mixtures(open_page):
    rng = np.random.default_rng(4)
    mixtures, expected = [], []
    for _ in range(500):
        number = int(rng.integers(1, 12))
        sizes, fractions = np.exp(rng.uniform(-2, 4, number)), rng.dirichlet(np.ones(number))
        n1, K = float(rng.uniform(0.25, 0.5)), float(rng.uniform(3.5, 15))
        mixtures.append([sizes.tolist(), fractions.tolist(), n1, K])
        expected.append([float(linear(sizes, fractions, n1)), float(compressible(sizes, fractions, n1, K))])
    script = "all => all.map(([s, y, n, K]) => [Packing.linear(s, y, n), Packing.compressible(s, y, n, K)])"
    np.testing.assert_allclose(open_page().evaluate(script, mixtures), expected, rtol=0, atol=TOLERANCE)


@pytest.mark.parametrize("case", ["U7", "B50"])
def test_packing_models_get_the_porosity_of_one_class(open_page, fitted, tmp_path, case):
    text = "FL,EL\n0.6,0.7\n"
    (tmp_path / "table.csv").write_text(text)
    samples, _ = read_measured(tmp_path / "table.csv")
    table = predict_samples(samples, "one-class", fitted)
    curve = read_cases(CONFIG / "cases.tsv")[case].curve
    sizes, held = np.sqrt(curve.bounds[1:] * curve.bounds[:-1]), curve.mass_fractions > 0
    n = linear(sizes[held], curve.mass_fractions[held], table.n[table.preferred].iloc[0])
    page = open_page("#" + urlencode({"table": text, "case": case, "mark": "."}))
    assert f"linear packing model: {n:.3f};" in page.locator("#predictions svg").get_attribute("aria-label")
