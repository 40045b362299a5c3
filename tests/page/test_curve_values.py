"""The page and the command predict the same porosity of beds with a free sieve curve."""

import io
from urllib.parse import urlencode

import numpy as np
import pandas as pd
import pytest

from simcore.grains.forms_by_class import class_name, classes_of_table
from simcore.grains.measured_forms import read_measured
from simcore.grains.sieve_table import read_curve
from simcore.grains.table_file import read_table
from simcore.models.size_and_form.bed_prediction import (
    other_predictors,
    predict_curve,
    rhine_sample,
    sensitivity,
)
from simcore.models.size_and_form.bed_prediction_text import predict_curve_file
from simcore.models.size_and_form.candidates import CANDIDATES, predict
from simcore.models.size_and_form.forms_by_class import one_class_by_class, predict_by_class
from simcore.models.size_and_form.predicted_specification import write_specification
from simcore.models.size_and_form.sized_model import unfitted_model
from simcore.page.curve_data import PORTED, model_data
from simcore.page.data import LEVELS
from simcore.paths import ROOT
from tests.helpers.random_sieves import random_sieves
from tests.helpers.random_tables import random_table
from tests.helpers.table_cases import CLASSES, SAME_SIEVES, SIEVES

TOLERANCE = 1e-9
NUMBERS = [
    "n", "lower", "upper", "n_long_shaken", "n_not_shaken", "n_one_class", "one_class_lower",
    "one_class_upper", "one_class_few_grains_error",
]  # fmt: skip
EVALUATE = """
inputs => inputs.map(({sieves, table, finest, coarsest, level, more}) => {
  const texts = (row) => Object.fromEntries(
    Object.entries(row).filter(([k]) => k !== "oneClass").map(([k, v]) => [k, typeof v === "number" ? String(v) : v]));
  try {
    const read = SieveTable.read("curve.csv", sieves, coarsest);
    const curve = SieveTable.curve("curve.csv", read, finest, coarsest);
    const samples = table === null ? [Bed.RHINE] : Grains.read("table.csv", table, "", [], true).samples;
    const beds = samples.map((sample) => Bed.predict(curve, sample, level));
    const first = beds.find((bed) => !bed.refused);
    return {
      curve, notices: [...read.notices, ...curve.notices], beds: beds.map(texts),
      sensitivity: more && first ? Bed.sensitivity(curve, first.n_one_class) : null,
      others: more && first ? Bed.others(curve, first.n_one_class) : null,
      written: more ? BedSpecification.write(curve, "curve.csv", table === null ? null : samples[0]) : null,
    };
  } catch (error) {
    if (!(error instanceof Numbers.InputError)) throw error;
    return {error: error.message};
  }
})
"""
SPECIFIC = (
    ("with --finest", "in the field Finest grains"),
    ("with --coarsest", "in the field Coarsest grains"),
    ("leave out --coarsest", "leave the field Coarsest grains empty"),
    (
        "that of --case one-class, and that of the name U1 in a column of sieve curves",
        "that of the sieve curve “any single sieve class”",
    ),
)


def inputs(seed, number, faulty=False):
    rng = np.random.default_rng(seed)
    return [
        {
            "sieves": random_sieves(rng, faulty),
            "table": random_table(rng) if rng.random() < 0.8 else None,
            "finest": 0.2 if rng.random() < 0.8 else None,
            "coarsest": 120.0 if rng.random() < 0.8 else None,
            "level": float(rng.choice(LEVELS)),
            "more": i % 20 == 0,
        }
        for i in range(number)
    ]


def by_command(folder, entry, fitted):
    """Return what the page should, or the message of the error."""
    sieves, forms = folder / "curve.csv", folder / "table.csv"
    sieves.write_text(entry["sieves"], encoding="utf-8")
    ends = [None if entry[key] is None else entry[key] * 1e-3 for key in ("finest", "coarsest")]
    try:
        curve, notices = read_curve(sieves, *ends)
        samples = [rhine_sample()]
        if entry["table"] is not None:
            forms.write_bytes(entry["table"].encode())
            samples, _ = read_measured(forms)
        expected = {"curve": curve, "notices": notices, "table": predict_curve(curve, samples, fitted, entry["level"])}
        if entry["more"]:
            of_first = forms if entry["table"] is not None else None
            if len(samples) == 1:
                said = write_specification(folder / "bed.yaml", sieves, of_first, None, *ends, draw=False)
                expected["written"] = {"text": (folder / "bed.yaml").read_text(encoding="utf-8"), "notices": said}
        return expected
    except ValueError as error:
        text = str(error).replace(f"{folder}/", "")
        for ours, page in SPECIFIC:
            text = text.replace(ours, page)
        return {"error": text}


def assert_equal(page, expected, entry, folder, fitted):
    """Compare one answer of the page and of the command, and return the number of porosities that were compared."""
    assert page.get("error") == expected.get("error")
    if "error" in expected:
        return 0
    curve, table = expected["curve"], expected["table"]
    np.testing.assert_allclose(page["curve"]["bounds"], 1e3 * curve.bounds, rtol=1e-12)
    np.testing.assert_allclose(page["curve"]["mass_fractions"], curve.mass_fractions, atol=1e-12)
    assert page["notices"] == [text.replace(f"{folder}/", "") for text in expected["notices"]]
    assert len(page["beds"]) == len(table)
    for bed, (_, row) in zip(page["beds"], table.iterrows(), strict=True):
        assert (bed["outside"], bed["refused"]) == (row.outside, row.refused)
        assert [float(bed[key]) for key in NUMBERS] == pytest.approx(
            row[NUMBERS].astype(float).tolist(), abs=TOLERANCE, nan_ok=True
        )
    evaluated = table[table.refused == ""]
    if entry["more"] and len(evaluated):
        n1 = evaluated.n_one_class.iloc[0]
        np.testing.assert_allclose(page["sensitivity"], sensitivity(curve, n1, fitted), atol=TOLERANCE)
        others = other_predictors(curve, n1)
        assert [row["model"] for row in page["others"]] == others.model.tolist()
        np.testing.assert_allclose([row["n"] for row in page["others"]], others.n, atol=TOLERANCE)
    if "written" in expected:
        assert page["written"] == expected["written"]
    return int(table.n.notna().sum())


def compare(page, entries, fitted, folder):
    porosities = errors = 0
    for answer, entry in zip(page.evaluate(EVALUATE, entries), entries, strict=True):
        expected = by_command(folder, entry, fitted)
        try:
            porosities += assert_equal(answer, expected, entry, folder, fitted)
        except AssertionError as error:
            raise AssertionError(f"{error}\nfor the input {entry}") from None
        errors += "error" in expected
    return porosities, errors


def test_500_random_curves_and_forms(open_page, fitted, tmp_path):
    porosities, errors = compare(open_page(), inputs(5, 500), fitted, tmp_path)
    assert porosities > 400 and errors < 200


def test_faulty_curves_have_the_same_messages(open_page, fitted, tmp_path):
    _, errors = compare(open_page(), inputs(6, 120, faulty=True), fitted, tmp_path)
    assert errors > 60


def test_shared_cases_have_the_same_words(open_page, fitted, tmp_path):
    given = {"table": None, "finest": 0.2, "level": 0.95, "more": False}
    texts = [*(case.text for case in SIEVES), *(text for pair in SAME_SIEVES for text in pair)]
    entries = [{"sieves": text, "coarsest": coarsest, **given} for text in texts for coarsest in (None, 120.0)]
    compare(open_page(), entries, fitted, tmp_path)


def test_a_bed_of_too_many_grains_has_the_same_words(open_page, fitted, tmp_path):
    sieves = "opening [mm];mass [%]\n63;0\n31.5;20\n16;30\n8;20\n4;15\n2;10\n0.063;5\n"
    entry = {"sieves": sieves, "table": None, "finest": None, "coarsest": None, "level": 0.95, "more": True}
    assert "leave out the grains below 4 mm, which are 15%" in by_command(tmp_path, entry, fitted)["error"]
    assert compare(open_page(), [entry], fitted, tmp_path) == (0, 1)


def test_each_candidate_that_is_ported_gives_the_same_porosity(open_page):
    rng = np.random.default_rng(7)
    model, models, cases, expected = unfitted_model(), [], [], []
    for name in PORTED:
        rods = name in ("F", "D_F")
        for _ in range(3 if rods else 20):
            parameters = {key: float(rng.uniform(p.low, p.high)) for key, p in CANDIDATES[name].parameters.items()}
            law, k = str(rng.choice(["number", "mass"])), int(rng.integers(2, 7))
            curve = read_random_curve(rng, k)
            n1 = float(rng.uniform(0.3, 0.45)) if rng.random() < 0.5 else rng.uniform(0.3, 0.45, k)
            chosen = model._replace(candidate=name, parameters=parameters, law=law)
            models.append(model_data(chosen, LEVELS))
            of_rhine = float(rng.uniform(0.3, 0.45))
            cases.append([{"bounds": (1e3 * curve.bounds).tolist(), "mass_fractions": curve.mass_fractions.tolist()}])
            cases[-1] += [n1 if isinstance(n1, float) else n1.tolist(), of_rhine]
            expected.append(float(np.squeeze(predict(name, curve, n1, parameters, law=law, reference=of_rhine))))
    script = "([cases, models]) => cases.map(([curve, n1, n], i) => Skeletons.predict(curve, n1, n, models[i]))"
    np.testing.assert_allclose(open_page().evaluate(script, [cases, models]), expected, rtol=0, atol=TOLERANCE)


def read_random_curve(rng, k):
    from simcore.grains.sieve import SieveCurve

    bounds = np.exp(np.cumsum(np.r_[rng.uniform(-7, -5), rng.uniform(0.2, 0.8, k)]))
    return SieveCurve(bounds, rng.dirichlet(np.ones(k)))


BY_CLASS = """
([sieves, tables, level]) => tables.map((table) => {
  const curve = SieveTable.curve("curve.csv", SieveTable.read("curve.csv", sieves));
  const column = Bed.classColumn("table.csv", table);
  const classes = Bed.readClasses("table.csv", column, Grains.read("table.csv", table, column).samples);
  const { sample, bed } = Bed.predictByClass(curve, classes, level);
  const sensitivity = bed.refused ? null : Bed.sensitivity(curve, bed.by_class).map(String);
  const values = { ...bed, ...sample, sensitivity, by_class: undefined, oneClass: undefined, forms: undefined };
  return Object.fromEntries(Object.entries(values).map(([k, v]) => [k, typeof v === "number" ? String(v) : v]));
})
"""


def test_a_form_for_each_sieve_class(open_page, fitted, tmp_path):
    rng, tables, path = np.random.default_rng(8), [], tmp_path / "table.csv"
    sieves = "opening [mm];mass [g]\n31.5;0\n16;80\n8;300\n4;250\n2;120\n"
    (tmp_path / "curve.csv").write_text(sieves)
    curve, _ = read_curve(tmp_path / "curve.csv")
    for _ in range(20):
        header, labels = (
            ("class", ["2-8 mm", "8-16 mm", "1.6 cm - 40 mm"]),
            ("size class [mm]", ["0.5-16", "16..64"]),
        )[rng.integers(2)]
        rows = [f"{rng.choice(labels)};{FL:.4f};{EL:.4f}" for FL, EL in rng.uniform(0.35, 0.95, (12, 2))]
        rows += [f"{label};0.6;0.7" for label in labels]
        # In some tables one class has a one-class porosity near the limit of the model, or its forms are refused.
        rows += [f"{labels[0]};{FL};0.15" for FL in (0.2, 0.25, 0.95)] * int(rng.integers(3))
        tables.append(f"{header};FL;EL\n" + "\n".join(rows) + "\n")
    answers = open_page().evaluate(BY_CLASS, [sieves, tables, 0.9])
    for table, answer in zip(tables, answers, strict=True):
        path.write_text(table)
        given = read_table(path)
        classes, _ = classes_of_table(given, class_name(given.header))
        row = predict_by_class(curve, classes, fitted, 0.9).iloc[0]
        assert (answer["name"], float(answer["grains"])) == (row["sample"], row.grains)
        assert (answer["outside"], answer["refused"]) == (row.outside, row.refused)
        keys = [*NUMBERS, "mu_FL", "sigma_FL", "mu_EL", "sigma_EL"]
        got = [float(answer[key]) for key in keys]
        assert got == pytest.approx(row[keys].astype(float).tolist(), abs=TOLERANCE, nan_ok=True)
        if not row.refused:
            changes = sensitivity(curve, one_class_by_class(curve, classes, fitted), fitted)
            got = [float(value) for value in answer["sensitivity"]]
            assert got == pytest.approx(changes.tolist(), abs=TOLERANCE, nan_ok=True)


def test_classes_of_shared_cases_have_the_same_words(open_page):
    script = """
    texts => texts.map((text) => {
      try {
        const column = Bed.classColumn("table.csv", text);
        const { samples, notices } = Grains.read("table.csv", text, column);
        const classes = Bed.readClasses("table.csv", column, samples);
        return { bounds: classes.map(({ low, high }) => [low, high]), notices };
      } catch (error) {
        return error instanceof Numbers.InputError ? error.message : String(error.stack);
      }
    })
    """
    for answer, case in zip(open_page().evaluate(script, [case.text for case in CLASSES]), CLASSES, strict=True):
        if case.error:
            assert answer.removeprefix("table.csv").lstrip(",: ") == case.error
        else:
            np.testing.assert_allclose(answer["bounds"], [[8, 11.2], [11.2, 16]], rtol=1e-12)
            assert any(case.notice in notice for notice in ["", *answer["notices"]])


def test_a_candidate_without_a_port_is_refused():
    with pytest.raises(ValueError, match="candidate H_form, which .* does not evaluate; add it there"):
        model_data(unfitted_model()._replace(candidate="H_form"), LEVELS)


def test_the_table_to_take_away_is_that_of_the_command(open_page):
    sieves, forms = ROOT / "examples" / "sieve_curve.csv", ROOT / "examples" / "table2.csv"
    expected = pd.read_csv(io.StringIO(predict_curve_file(sieves, forms, output="csv")), keep_default_na=False)
    state = {"case": "own", "sieves": sieves.read_text(), "curve": "sieve_curve.csv", "mark": "."}
    page = open_page("#" + urlencode({**state, "table": forms.read_text()}))
    with page.expect_download() as download:
        page.get_by_role("button", name="Table as CSV").click()
    got = pd.read_csv(download.value.path(), keep_default_na=False)
    pd.testing.assert_frame_equal(got, expected, rtol=0, atol=TOLERANCE)
