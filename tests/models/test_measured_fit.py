"""Fits to measured beds whose truth is given: what is chosen and refused, and how `predict` uses the result."""

import json
import re
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import simcore
from simcore.__main__ import main
from simcore.grains.measured_beds import MeasuredBed
from simcore.grains.measured_forms import Sample, read_measured
from simcore.models.files import models_dataset
from simcore.models.fitting import FittedModels, fit_reference_models, read_campaign_models
from simcore.models.measured_candidates import freedom_text
from simcore.models.measured_file import read_measured_models, write_measured_models
from simcore.models.measured_fit import Candidate, MeasuredFit, average_repeats, choose, fit_case, left_out_errors
from simcore.models.measured_fit_text import describe_fit, sentences
from simcore.models.measured_plausibility import question_beds
from simcore.models.prediction import predict_samples
from simcore.models.scatter import scatter_of
from simcore.models.single_form import single_form_models
from tests.helpers.reference_rows import porosity_of_form, random_forms, sample_of_one_form


@pytest.fixture
def fitted(reference):
    """Return our models without error: porosity_of_form for beds of one form."""
    return fit_reference_models(reference, source="synthetic")


def beds_of_one_form(number, porosity, seed=5, scatter=0.0):
    rng = np.random.default_rng(seed)
    return [
        MeasuredBed(sample, porosity(sample.mu_FL, sample.mu_EL) + scatter * rng.normal(), np.nan, "U1")
        for sample in (
            Sample(f"bed {i}", 1, FL, 0.0, EL, 0.0, FL * EL, 0.0)
            for i, (FL, EL) in enumerate(rng.uniform(0.45, 0.9, (number, 2)))
        )
    ]


def ours(FL, EL):
    return porosity_of_form(FL, EL)


def own(FL, EL):
    return 0.2 + 0.05 / (FL * EL) - 0.03 / EL


@pytest.mark.parametrize(
    ("truth", "kind", "coefficients"),
    [
        (lambda FL, EL: ours(FL, EL) + 0.013, "offset", [0.013]),
        (lambda FL, EL: 0.05 + 0.8 * ours(FL, EL), "rescaling", [0.05, 0.8]),
        (own, "features", [0.2, 0.05, -0.03]),
    ],
)
def test_the_truth_is_chosen_and_recovered(fitted, truth, kind, coefficients):
    result = fit_case(beds_of_one_form(12, truth, scatter=1e-6), "U1", fitted)
    assert result.chosen.kind == kind and result.base == "single_form" and result.only_kind == "one form"
    np.testing.assert_allclose(result.chosen.coefficients.value, coefficients, atol=2e-5)
    sample = sample_of_one_form(0.6, 0.7)
    table = predict_samples([sample], "U1", FittedModels({("measured", "U1"): result.model}, {}))
    assert table[table.preferred].n.item() == pytest.approx(truth(0.6, 0.7), abs=1e-5)


def test_bias_and_scatter_are_those_of_the_differences(fitted):
    beds = beds_of_one_form(6, ours)
    added = np.array([0.01, 0.02, 0.015, 0.005, 0.012, 0.018])
    beds = [MeasuredBed(bed.sample, bed.n + extra, np.nan, "U1") for bed, extra in zip(beds, added, strict=True)]
    row = fit_case(beds, "U1", fitted).agreement.set_index(["by", "model"]).loc["ours", "single_form"]
    assert row.bias == pytest.approx(-added.mean(), rel=1e-8)
    assert row.scatter == pytest.approx(added.std(ddof=1), rel=1e-8)
    assert row.bias_error == pytest.approx(added.std(ddof=1) / np.sqrt(6), rel=1e-8)
    assert row.inside == 0  # our model is exact, so its interval has no width
    r22 = [0.278 + 0.019 / bed.sample.mu_EQ + 0.014 / bed.sample.mu_EL - bed.n for bed in beds]
    r22_row = fit_case(beds, "U1", fitted).agreement.query("by == 'r22'").iloc[0]
    assert r22_row.bias == pytest.approx(np.mean(r22)) and np.isnan(r22_row.inside)


@pytest.mark.parametrize(
    ("features", "number", "kinds"),
    [
        ("single_form", 3, ["offset"]),
        ("single_form", 5, ["offset"]),
        ("single_form", 6, ["offset", "rescaling"]),
        ("single_form", 8, ["offset", "rescaling"]),
        ("single_form", 9, ["offset", "rescaling", "features"]),
        ("single_form_EQ", 6, ["offset", "rescaling", "features"]),
        ("unified", 14, ["offset", "rescaling"]),
    ],
)
def test_each_kind_needs_its_number_of_beds(fitted, features, number, kinds):
    result = fit_case(beds_of_one_form(number, ours, scatter=0.004), "U1", fitted, features)
    assert [item.kind for item in result.candidates if item.model is not None] == kinds
    for item in result.candidates:
        assert (item.model is None) == (item.needed > number) == bool(item.reason)
        assert not item.reason or f"needs {item.needed} beds of different form, and there are {number}" in item.reason


def test_fewer_than_three_beds_are_refused(fitted):
    beds = beds_of_one_form(2, ours)
    with pytest.raises(
        ValueError, match="case U1: 2 rows with 2 different forms; the simplest model, an offset, needs 3"
    ):
        fit_case(beds, "U1", fitted)
    with pytest.raises(ValueError, match="case U1: 6 rows with 2 different forms"):
        fit_case(3 * beds, "U1", fitted)
    with pytest.raises(ValueError, match="case U1: 1 row with 1 form;"):
        fit_case(beds[:1], "U1", fitted)


def test_repeats_become_one_bed(fitted):
    beds = beds_of_one_form(3, ours)
    repeats = [MeasuredBed(bed.sample, bed.n + extra, 0.006, "U1") for bed in beds for extra in (-0.002, 0.0, 0.002)]
    samples, table, scatter = average_repeats(repeats)
    assert samples == [bed.sample for bed in beds]
    np.testing.assert_allclose(table.n, [bed.n for bed in beds])
    np.testing.assert_allclose(table.n_error, 0.006 / np.sqrt(3))
    assert table.repeats.tolist() == [3, 3, 3]
    assert scatter == pytest.approx(0.002)  # 3 * 8e-6 over 6 degrees of freedom
    text = " ".join(sentences(fit_case(repeats, "U1", fitted)))
    assert "Repeats of the same form scatter by 0.0020." in text


def test_a_left_out_bed_is_predicted_from_the_others():
    rng = np.random.default_rng(3)
    columns, y = np.column_stack([np.ones(7), rng.normal(size=(7, 2))]), rng.normal(size=7)
    expected = []
    for i in range(7):
        rest = np.arange(7) != i
        expected.append(y[i] - columns[i] @ np.linalg.lstsq(columns[rest], y[rest])[0])
    np.testing.assert_allclose(left_out_errors(columns, y), expected, rtol=1e-9)


def test_columns_that_one_bed_alone_determines_are_refused():
    x = np.array([1.0, 1, 1, 1, 2])
    assert left_out_errors(np.column_stack([np.ones(5), x]), np.arange(5)) is None
    assert left_out_errors(np.column_stack([np.ones(5), np.ones(5)]), np.arange(5)) is None
    assert left_out_errors(np.column_stack([np.ones(5), np.zeros(5)]), np.arange(5)) is None


def test_the_simplest_within_one_standard_error_of_the_best_is_chosen(fitted):
    model = fitted.models["single_form", "U1"]

    def candidates(*errors):
        kinds = ("offset", "rescaling", "features")
        return [Candidate(kind, 3, model, None, *pair) for kind, pair in zip(kinds, errors, strict=True)]

    assert choose(candidates((5.0, 0.1), (4.0, 0.1), (3.0, 2.0))).kind == "offset"
    assert choose(candidates((5.1, 9.0), (4.0, 0.1), (3.0, 2.0))).kind == "rescaling"
    assert choose(candidates((5.1, 9.0), (5.1, 0.1), (3.0, 2.0))).kind == "features"
    absent = Candidate("features", 9, None, None, np.nan, np.nan, "too few")
    assert choose([*candidates((5.0, 0.1), (4.0, 0.5), (3.0, 2.0))[:2], absent]).kind == "rescaling"


def test_a_case_without_our_models_has_features_only(fitted):
    beds = beds_of_one_form(9, own, scatter=1e-6)
    result = fit_case(beds, "my curve", fitted)
    assert result.agreement.empty and result.base == "" and result.chosen.kind == "features"
    assert [bool(item.reason) for item in result.candidates] == [True, True, False]
    text = " ".join(sentences(result))
    assert "Not fitted: offset and rescaling, because there is no model of ours for case my curve" in text
    assert not np.isfinite(result.base_error)
    with pytest.raises(
        ValueError, match="case my curve: no model can be fitted to its 8 beds: there is no model of ours"
    ):
        fit_case(beds[:8], "my curve", fitted)


def test_a_bed_far_outside_our_range_leaves_the_features_with_the_reason(fitted):
    beds = [*beds_of_one_form(9, ours, scatter=0.004), MeasuredBed(sample_of_one_form(0.2, 0.3), 0.6, np.nan, "U1")]
    result = fit_case(beds, "U1", fitted)
    assert result.chosen.kind == "features" and result.base == ""
    assert "ours single_form is not evaluated for one: L/S = 16.67 is above" in result.base_reason
    assert result.agreement.query("model == 'single_form' and by == 'ours'").beds.item() == 9


def test_features_that_are_not_finite_or_do_not_vary_are_named(fitted):
    beds = beds_of_one_form(15, ours, scatter=0.004)
    result = fit_case(beds, "U1", fitted, "form_mixture")
    assert "sigma_EQ_inv is not finite for bed 0" in result.candidates[-1].reason
    result = fit_case(beds, "U1", fitted, "unified")
    assert "the beds do not differ enough to separate mu_EQ_inv" in result.candidates[-1].reason


def test_equal_porosities_bear_only_an_offset(fitted):
    result = fit_case(beds_of_one_form(9, lambda FL, EL: 0.36), "U1", fitted)
    reasons = [item.reason for item in result.candidates]
    assert reasons == ["", "all measured porosities are the same", "all measured porosities are the same"]
    assert result.chosen.kind == "offset" and result.model.scatter > 0.005
    # The mean of three repeats differs from them in the last digit.
    beds = beds_of_one_form(9, lambda FL, EL: 0.37)
    assert np.ptp([0.37, np.mean(3 * [0.37])]) > 0.0
    result = fit_case(beds + 2 * beds[::2], "U1", fitted)
    assert [item.reason for item in result.candidates] == reasons


def test_nearly_dependent_features_leave_the_corrections(fitted):
    """Beds of one flatness, up to errors of 1e-8: a fit would refuse the whole case."""
    beds = beds_of_one_form(10, ours, scatter=0.004)
    noise = 1.0 + 1e-8 * np.random.default_rng(1).normal(size=10)
    samples = [sample_of_one_form(0.7 * extra, bed.sample.mu_EL) for bed, extra in zip(beds, noise, strict=True)]
    result = fit_case([replace(bed, sample=s) for bed, s in zip(beds, samples, strict=True)], "U1", fitted)
    assert [item.model is not None for item in result.candidates] == [True, True, False]
    assert "the beds do not differ enough to separate EQ_inv, EL_inv" in result.candidates[-1].reason


@pytest.mark.parametrize("grows", [False, True])
@pytest.mark.parametrize("repeats", [(2, 2, 2), (5, 5, 5), (1, 1, 10)])
def test_intervals_of_few_repeated_beds_contain_a_single_bed_as_often_as_stated(fitted, repeats, grows):
    """With the degrees of freedom of three means they would contain 0.99; if scatter grows, all forms do so."""
    line = (-0.003, 0.003, 0.001, 0.0) if grows else None
    model = replace(fitted.models["single_form", "U1"], scatter=0.004, scatter_line=line)
    base = FittedModels({("single_form", "U1"): model}, {})
    forms = pd.DataFrame({"EQ_inv": [1.4, 2.0, 2.6], "EL_inv": [1.1, 1.5, 1.3]})
    beds = [
        MeasuredBed(sample_of_one_form(row.EL_inv / row.EQ_inv, 1 / row.EL_inv), n, np.nan, "U1")
        for row, n in zip(forms.itertuples(), model.predict(forms), strict=True)
    ]
    scatter = scatter_of(model.design(forms), 0.003, line)
    rng, inside = np.random.default_rng(8), []
    for _ in range(250):
        shifts = scatter * rng.normal(size=3)
        rows = [
            replace(bed, n=bed.n + shift + 0.004 * rng.normal())
            for bed, shift, number in zip(beds, shifts, repeats, strict=True)
            for _ in range(number)
        ]
        offset = fit_case(rows, "U1", base).candidates[0].model
        assert offset.freedom > 2
        n, lower, upper = offset.predict_interval(forms)
        truth = model.predict(forms) + rng.normal(size=(20, 3)) * scatter + 0.004 * rng.normal(size=(20, 3))
        inside.append(np.mean((lower <= truth) & (truth <= upper), axis=0))
    of_beds = np.mean(inside, axis=0)
    assert 0.90 < of_beds.min() and of_beds.max() < 0.985, of_beds


def test_degrees_of_freedom_are_whole_or_have_one_digit(fitted):
    single = fit_case(beds_of_one_form(1200, ours, scatter=0.004), "U1", fitted)
    assert freedom_text(single.model) == f"{single.model.freedom:.0f}" and single.model.freedom > 1190
    assert freedom_text(replace(single.model, degrees_of_freedom=17.34)) == "17.3"


def write_table(path, beds, **columns):
    rows = [{"sample": bed.sample.name, "FL": bed.sample.mu_FL, "EL": bed.sample.mu_EL, "n": bed.n} for bed in beds]
    pd.DataFrame(rows).assign(**columns).to_csv(path, index=False)
    return path


def test_predict_takes_the_model_that_fit_wrote(tmp_path, capsys):
    """An offset of 0.02 from the committed models is fitted, and a note is given for a distribution of form."""
    rng = np.random.default_rng(0)
    forms = pd.DataFrame(rng.uniform(0.5, 0.85, (5, 2)), columns=["FL", "EL"])
    forms["sample"] = [f"bed {i}" for i in range(5)]
    forms.to_csv(tmp_path / "forms.csv", index=False)
    before = simcore.predict(tmp_path / "forms.csv", "U1", column="sample").query("preferred")
    n = before.n.to_numpy() + 0.02 + 0.002 * np.array([-1, 1, 0, 1, -1])
    forms.assign(n=n).to_csv(tmp_path / "measured.csv", index=False)
    result = simcore.fit(tmp_path / "measured.csv", case="U1", out=tmp_path / "model.json")
    assert result.cases[0].chosen.kind == "offset"
    assert result.table.query("chosen").kind.tolist() == ["offset"]
    after = simcore.predict(tmp_path / "forms.csv", "U1", models=tmp_path / "model.json").query("preferred")
    assert (after.model == "measured").all() and (after.outside == "").all()
    np.testing.assert_allclose(after.n.to_numpy() - before.n.to_numpy(), 0.02, atol=1e-9)
    half = (after.upper - after.lower) / 2
    # Student's t has 4 degrees of freedom; long and flat grains scatter more than compact ones.
    assert half.mean() > 2.776 * 0.002 * np.sqrt(1 + 1 / 5) and (half < 0.02).all()
    assert np.corrcoef(half, 1 / (forms.FL * forms.EL))[0, 1] > 0.9
    (tmp_path / "wide.csv").write_text("mean_FL,std_FL,mean_EL,std_EL\n0.65,0.15,0.7,0.12\n")
    words = ["predict", str(tmp_path / "wide.csv"), "--case", "one-class", "--models", str(tmp_path / "model.json")]
    assert main(words) == 0
    text = capsys.readouterr().out
    assert "row 2, your fit: it was fitted only to beds with one form" in text
    assert f"offset of single_form, 5 measured beds: {tmp_path / 'model.json'}" in text
    assert main([*words, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["models"][0]["model"] == "measured"
    # The form is inside the range: what is remarked is the kind of bed.
    assert "* inside the fitted range, with a remark\n  row 2, your fit" in text
    assert "* outside the fitted range" not in text.split("Rettinger et al. form_mixture")[0]
    again = simcore.fit(tmp_path / "measured.csv", case="U1", models=tmp_path / "model.json").cases[0]
    assert again.base == "measured" and again.agreement.set_index("model").bias["measured"] == pytest.approx(
        0, abs=1e-9
    )
    words = ["--models", str(tmp_path / "model.json"), "--out", str(tmp_path / "again.json")]
    assert main(["fit", str(tmp_path / "measured.csv"), "--case", "U1", *words]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "the range of your fit is that of the model that it corrects, 1/EQ from" in text


def test_a_fit_of_one_class_says_that_it_is_used_for_sieve_curves(tmp_path, capsys):
    """Its one-class porosity is 0.02 larger; the step to the curve is that of our model."""
    forms = pd.DataFrame({"mean_FL": [0.5, 0.6, 0.7, 0.8], "mean_EL": [0.7, 0.6, 0.8, 0.65]})
    forms = forms.assign(std_FL=0.15, std_EL=0.12, sample=["a", "b", "c", "d"])
    before = predict_samples(read_measured(write(tmp_path / "forms.csv", forms))[0], "U1", fit_reference_models())
    n = before[before.preferred].n.to_numpy() + 0.02 + 0.001 * np.array([-1, 1, 1, -1])
    write(tmp_path / "measured.csv", forms.assign(n=n))
    model = str(tmp_path / "model.json")
    assert main(["fit", str(tmp_path / "measured.csv"), "--case", "one-class", "--out", model]) == 0
    capsys.readouterr()
    words = ["predict", str(tmp_path / "forms.csv"), "--sieve", "U7"]
    for more in ([], ["--models", model]):
        assert main([*words, *more]) == 0
        text = capsys.readouterr().out
        ours, theirs = "shaken for eight seconds" in text, "The one-class porosity is that of your fit" in text
        assert (ours, theirs) == (not more, bool(more))
        assert (f"One-class porosity: offset of unified, 4 measured beds: {model}" in text) == bool(more)
        assert main([*words, *more, "--json"]) == 0
        answer = json.loads(capsys.readouterr().out)
        assert (answer["one_class_fit"] is None) == (answer["samples"][0]["n_not_shaken"] is not None) == (not more)


def write(path, table):
    table.to_csv(path, index=False)
    return path


def test_a_file_keeps_each_digit(tmp_path, fitted):
    # Twelve beds have a bootstrap; fewer have limits of nan, which are not equal to themselves.
    features = fit_case(beds_of_one_form(12, own, scatter=1e-6), "U1", fitted)
    of_U7 = FittedModels({("single_form", "U7"): fitted.models["single_form", "U1"]}, {})
    offset = fit_case(beds_of_one_form(3, ours, scatter=0.004), "U7", of_U7)
    models = [(features.model, features.describe(), "one form"), (offset.model, offset.describe(), None)]
    write_measured_models(tmp_path / "model.json", models)
    read, behind, only_kind = read_measured_models(tmp_path / "model.json")
    assert read["measured", "U1"] == features.model
    new = pd.DataFrame({"EQ_inv": [2.0], "EL_inv": [1.4]})
    np.testing.assert_array_equal(read["measured", "U7"].predict_interval(new), offset.model.predict_interval(new))
    assert read["measured", "U7"].degrees_of_freedom == 2 and np.isnan(read["measured", "U7"].bootstrap_lower).all()
    assert behind["measured", "U1"] == f"fit of EQ_inv, EL_inv, 12 measured beds: {tmp_path / 'model.json'}"
    assert only_kind == {("measured", "U1"): "one form"}
    assert read_campaign_models(tmp_path / "model.json").cases() == ["U1", "U7"]


@pytest.mark.parametrize("change", ["{", "[]", '{"format": "other", "models": []}', "cut", "shorter"])
def test_another_file_is_refused(tmp_path, fitted, change):
    path = tmp_path / "model.json"
    result = fit_case(beds_of_one_form(9, own, scatter=1e-3), "U1", fitted)
    write_measured_models(path, [(result.model, result.describe(), None)])
    content = json.loads(path.read_text())
    if change == "cut":
        del content["models"][0]["covariance"]
    elif change == "shorter":
        content["models"][0]["features"].pop()
    path.write_text(json.dumps(content) if change in ("cut", "shorter") else change)
    with pytest.raises(ValueError, match=r"model.json: this is not a file of models that `fit` wrote"):
        read_campaign_models(path)


def test_a_file_of_a_campaign_is_read_too(tmp_path):
    flatness, elongation = random_forms(20)
    packings = pd.DataFrame({"case": "U7", "L": 1 / elongation, "I": 1.0, "S": flatness})
    packings["n"] = porosity_of_form(flatness, elongation) + 1e-4 * np.random.default_rng(0).normal(size=20)
    tables, models = single_form_models(packings)
    models_dataset(models, tables["models"], "Models").to_netcdf(tmp_path / "single_form.nc")
    assert read_campaign_models(tmp_path / "single_form.nc") == read_campaign_models(tmp_path)
    (tmp_path / "empty").mkdir()
    with pytest.raises(ValueError, match="or the file of a model that `fit` wrote"):
        read_campaign_models(tmp_path / "empty")
    with pytest.raises(ValueError, match="there is no such folder or file of models"):
        read_campaign_models(tmp_path / "none.json")


def test_several_cases_are_fitted_and_small_ones_left_out(tmp_path, capsys):
    beds = beds_of_one_form(8, ours, scatter=0.004)
    path = write_table(tmp_path / "beds.csv", beds, case=["U1"] * 3 + ["one-class"] * 2 + ["U7"] * 2 + ["B30"])
    assert main(["fit", str(path), "--out", str(tmp_path / "model.json")]) == 0
    text = capsys.readouterr().out
    assert "5 beds, case U1" in text  # any single sieve class is U1
    assert "Left out: case U7: 2 rows with 2 different forms; the simplest model" in text
    assert "Left out: case B30: 1 row with 1 form" in text
    assert "The model of case U1 is written. Use it: scree predict FORMS.csv --case U1 --models" in text
    assert read_campaign_models(tmp_path / "model.json").cases() == ["U1"]


@pytest.mark.parametrize(
    ("n", "question"),
    [
        (
            0.62,
            "n = 0.62 is far from the predicted 0.35. If it is the solid fraction, write 0.38; if it is the void ratio "
            "e, write 0.3827.",
        ),
        (
            0.51,
            "n = 0.51 is far from the predicted 0.35. If it is the solid fraction, write 0.49; if it is the void ratio "
            "e, write 0.3377.",
        ),
        (
            0.95,
            "n = 0.95 is far from the predicted 0.35. If it is the void ratio e, write 0.4872.",
        ),
        (
            0.15,
            "n = 0.15 is far from the predicted 0.35. Check that it is the volume of the pores over the volume of the",
        ),
        (0.49, None),
        (0.21, None),
    ],
)
def test_a_porosity_far_from_the_prediction_is_questioned(n, question):
    bed = MeasuredBed(Sample("A", 0, 0.6, 0.1, 0.7, 0.1, 0.42, 0.1), n, np.nan, "U1")
    notices = question_beds([bed], [0.35])
    assert (notices == []) if question is None else notices[0].startswith(f"bed A: {question}")
    assert question_beds([bed], [np.nan]) == []


def test_fit_names_the_bed_whose_column_n_has_the_solid_fraction(tmp_path, capsys):
    head, form = "sample,n,mean_FL,std_FL,mean_EL,std_EL\n", "0.62,0.13,0.72,0.12"
    rest = "B,0.36,0.55,0.13,0.7,0.12\nC,0.345,0.66,0.12,0.74,0.11\n"
    path = tmp_path / "beds.csv"
    path.write_text(f"{head}A,0.62,{form}\n{rest}")
    assert main(["fit", str(path), "--case", "one-class"]) == 0
    printed = capsys.readouterr()
    far = (
        "n = 0.62 is far from the predicted 0.35. If it is the solid fraction, write 0.38; if it is the void ratio e, "
        "write 0.3827.\n"
    )
    assert printed.err == f"scree fit: {path}, row 2: {far}"
    assert re.search(r"^A +0.6200 +0.3500 +-0.2700$", printed.out, re.MULTILINE)
    path.write_text(f"{head}A,0.36,{form}\nA,0.62,{form}\nA,0.36,{form}\n{rest}")
    result = simcore.fit(path, case="U1")
    (notice,) = result.notices
    assert notice.startswith(f"{path}, row 3: n = 0.62 is far"), "each repeat is compared by itself"
    assert result.cases[0].beds.predicted.iloc[0] == pytest.approx(0.3500, abs=1e-4)
    path.write_text(
        f"{head}A,62,{form}\n{rest}".replace(",n,", ",n [%],").replace(",0.36,", ",36,").replace(",0.345,", ",34.5,")
    )
    percent = path.read_text()
    (notice,) = simcore.fit(path, case="U1").notices
    assert notice.endswith(
        "row 2: n = 62 % is far from the predicted 35 %. If it is the solid fraction, write 38; if it is the void "
        "ratio e, write 38.27."
    )
    path.write_text(percent.replace("A,62,", "A,0.36,"))
    (notice,) = simcore.fit(path, case="U1").notices
    assert notice.endswith("row 2: n = 0.36 % is far from the predicted 35 %. If it is a fraction, write 36.")


@pytest.mark.parametrize("number", [10, 11])
def test_a_long_table_lists_the_ten_beds_with_the_largest_differences(fitted, number):
    beds = beds_of_one_form(number, ours)
    beds = [replace(bed, n=bed.n + 0.001 * (i + 1) * (-1) ** i) for i, bed in enumerate(beds)]
    text = describe_fit(MeasuredFit([fit_case(beds, "U1", fitted)], [], []), "beds.csv")
    rows = re.findall(r"^bed (\d+) .* ([+-]\d\.\d{4})$", text, re.MULTILINE)
    expected = [(str(i), f"{-0.001 * (i + 1) * (-1) ** i:+.4f}") for i in range(number)]
    assert rows == (expected if number == 10 else expected[:0:-1])
    assert ("the 10 of 11 beds with the largest difference" in " ".join(text.split())) == (number == 11)


def test_beds_without_a_prediction_are_not_questioned(fitted):
    """Without a model of the case nothing is listed; of a model that does not suit all beds, the others are."""
    beds = beds_of_one_form(9, own, scatter=1e-6)
    result = fit_case([replace(bed, n=bed.n + 0.3) for bed in beds], "my curve", fitted)
    assert result.beds.predicted.isna().all() and result.notices == ()
    assert "prediction of" not in describe_fit(MeasuredFit([result], [], []), "beds.csv")
    far = MeasuredBed(sample_of_one_form(0.2, 0.3), 0.6, np.nan, "U1")
    result = fit_case([*beds_of_one_form(9, ours, scatter=0.004), far], "U1", fitted)
    assert result.beds.predicted.notna().tolist() == [True] * 9 + [False] and result.notices == ()


def test_the_hint_has_the_case_that_was_given(tmp_path, capsys):
    path, out = write_table(tmp_path / "beds.csv", beds_of_one_form(3, ours, scatter=0.004)), tmp_path / "model.json"
    for case in ("one-class", "U1"):
        assert main(["fit", str(path), "--case", case, "--out", str(out)]) == 0
        text = capsys.readouterr().out
        assert f"beds.csv: 3 beds, case {case}\n" in text
        hint = f"The model of case {case} is written. Use it: scree predict FORMS.csv --case {case} --models {out}"
        assert text.rstrip().endswith(hint)
        words = hint.split("scree ")[1].replace("FORMS.csv", str(path)).split()
        assert main(words) == 0, "the hint is a command that works"
        assert "your fit" in capsys.readouterr().out


def test_text_and_json_have_the_same_numbers(tmp_path, capsys):
    path = write_table(tmp_path / "beds.csv", beds_of_one_form(10, ours, scatter=0.004), n_error=0.003)
    assert main(["fit", str(path), "--case", "U1"]) == 0
    text = capsys.readouterr().out
    assert main(["fit", str(path), "--case", "U1", "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    (case,) = content["cases"]
    assert content["beds_needed"] == {"offset": 3, "rescaling": 6} and len(case["beds"]) == 10
    for item in case["candidates"]:
        assert f"{item['error']:.4f}" in text
        for row in item["fitted"]:
            assert f"{row['lower']:.4f} to {row['upper']:.4f}" in text
    plain = " ".join(text.split())
    for sentence in case["sentences"]:
        assert sentence in plain
    assert "The measurement errors that you give are 0.0030" in plain and "No model is written" in text


def test_sentences_name_what_the_beds_do_not_show(fitted):
    """Equancy and elongation vary together in these beds, and form has no effect."""
    beds = [
        MeasuredBed(Sample(f"bed {i}", 1, FL, 0.0, FL + 0.05, 0.0, FL * (FL + 0.05), 0.0), 0.36 + d, np.nan, "U1")
        for i, (FL, d) in enumerate(zip(np.linspace(0.5, 0.9, 9), 0.004 * np.sin(np.arange(9)), strict=True))
    ]
    result = fit_case(beds, "U1", fitted)
    text = " ".join(sentences(result))
    assert "so these beds hardly separate their effects" in text
    one_axis = " ".join(sentences(fit_case(beds, "U1", fitted, "single_form_EQ")))
    assert "The correlation between 1/EQ and 1/EL is 1.00." in one_axis, "the fit has one of them only"
    assert "The beds do not show whether EL_inv has an effect" in text
    assert "form has a weaker effect than in our model" in text
    opposite = fit_case(beds_of_one_form(9, lambda FL, EL: 0.7 - ours(FL, EL), scatter=1e-4), "U1", fitted)
    assert "form has the opposite of the effect in our model" in " ".join(sentences(opposite))
    assert (
        "If n_error is not given for every bed, measurement errors and errors of the model cannot be separated." in text
    )
    assert "Each bed has one form; these data do not show the error for beds with a distribution of form." in text
    exact = fit_case(beds_of_one_form(3, ours, scatter=0.004), "U1", fitted)
    assert exact.base_error <= exact.chosen.error
    assert "These beds give no reason to correct our model single_form" in " ".join(
        describe_fit(MeasuredFit([exact], [], []), "beds.csv").split()
    )


def test_wrong_arguments_end_with_one_line(tmp_path, capsys):
    path = write_table(tmp_path / "beds.csv", beds_of_one_form(3, ours))
    for words, message in (
        ([str(path)], "the sieve curve of the beds is not given"),
        (
            [str(path), "--case", "U1", "--features", "FL"],
            "--features FL: there is no such set of features; choose single",
        ),
        ([str(path), "--case", "U1", "--sample", "bed"], "there is no column bed"),
        ([str(tmp_path / "none.csv"), "--case", "U1"], "there is no such file"),
        ([str(path), "--case", "B30"], "case B30: no model can be fitted to its 3 beds: there is no model of ours"),
        ([str(path), "--case", "U1", "--models", "x", "--source", "scans"], "are already fitted; give only one"),
    ):
        out = tmp_path / "model.json"
        assert main(["fit", *words, "--out", str(out)]) == 2
        printed = capsys.readouterr()
        assert printed.err.startswith("scree fit: ") and message in printed.err
        assert printed.err.count("\n") == 1 and printed.out == "" and not out.exists()
