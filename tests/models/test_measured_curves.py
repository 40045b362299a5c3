"""Fits to measured beds with sieve curves: known truths are recovered, files keep them, wrong input is named."""

import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scipy.stats import norm

import simcore
from simcore.__main__ import main
from simcore.grains.measured_beds import CurveReader, MeasuredBed, read_measured_beds
from simcore.grains.measured_forms import Sample
from simcore.grains.statistics import equancy_statistics
from simcore.models.fitting import fit_reference_models, read_campaign_models
from simcore.models.measured_check import check_models
from simcore.models.measured_curves import CORRECTED, OURS, fit_curves
from simcore.models.measured_fit import MeasuredFit
from simcore.models.measured_fit_text import describe_fit
from simcore.models.prediction import ONE_CLASS, predict_preferred, predict_samples, sample_features
from simcore.models.scatter import scatter_of
from simcore.models.size_and_form.bed_prediction import predict_curve
from simcore.models.size_and_form.curve_correction import correct_curves
from simcore.page.data import page_data
from simcore.paths import ROOT
from simcore.scene.sizes import all_cases
from tests.helpers.reference_rows import sample_of_one_form

EXAMPLE = ROOT / "examples" / "measured_curves.csv"
NAMES = ("U3", "U5", "U7", "B30", "B50", "B70")


@pytest.fixture(scope="module")
def fitted():
    return fit_reference_models()


def sample_of(FL, EL, name="bed"):
    form = (FL, 0.15, EL, 0.12)
    return Sample(name, 0, *form, *map(float, equancy_statistics(*form)))


def beds_of(truth, number, fitted, seed=1, scatter=1e-6):
    """Return MeasuredBeds whose porosity is truth(that of the model), of different forms and sieve curves."""
    rng = np.random.default_rng(seed)
    beds = []
    for i in range(number):
        curve, sample = all_cases()[NAMES[i % 6]].curve, sample_of(*rng.uniform(0.55, 0.8, 2), f"bed {i}")
        n = predict_curve(curve, [sample], fitted).n.item()
        beds.append(MeasuredBed(sample, truth(n) + scatter * rng.normal(), np.nan, NAMES[i % 6], curve))
    return beds


@pytest.mark.parametrize(
    ("truth", "number", "kind", "coefficients"),
    [
        (lambda n: n + 0.013, 4, "offset", [0.013]),
        (lambda n: n + 0.013, 8, "offset", [0.013]),
        (lambda n: 0.05 + 0.85 * n, 8, "rescaling", [0.05, 0.85]),
    ],
)
def test_the_truth_is_chosen_and_recovered(fitted, truth, number, kind, coefficients):
    result = fit_curves(beds_of(truth, number, fitted), fitted)
    assert result.chosen.kind == kind
    np.testing.assert_allclose(result.model.coefficients, coefficients, atol=1e-4)
    np.testing.assert_allclose(result.chosen.coefficients.value, coefficients, atol=1e-4)
    new = [sample_of(0.62, 0.7)]
    curve = all_cases()["B50"].curve
    with_model = type(fitted)({}, {}, curve=result.model)
    before, after = (predict_curve(curve, new, models) for models in (fitted, with_model))
    assert after.n.item() == pytest.approx(truth(before.n.item()), abs=1e-5)
    assert (
        np.isnan(after.n_not_shaken.item())
        and np.isnan(after.n_long_shaken.item())
        and after.n_one_class.item() == before.n_one_class.item()
    )


def test_bias_scatter_and_the_literature_are_reported(fitted):
    added = np.array([0.01, 0.02, 0.015, 0.005, 0.012, 0.018])
    beds = beds_of(lambda n: n, 6, fitted, scatter=0.0)
    beds = [MeasuredBed(b.sample, b.n + extra, np.nan, b.case, b.curve) for b, extra in zip(beds, added, strict=True)]
    table = fit_curves(beds, fitted).agreement.set_index("model")
    row = table.loc[OURS]
    assert (row.bias, row.scatter) == (pytest.approx(-added.mean()), pytest.approx(added.std(ddof=1)))
    assert row.bias_error == pytest.approx(added.std(ddof=1) / np.sqrt(6))
    assert {"linear", "rods", "Frings 2011", "Komura"} <= set(table.index) and table.inside.notna().sum() == 1


def test_too_few_beds_and_repeats(fitted):
    beds = beds_of(lambda n: n + 0.01, 3, fitted)
    assert (
        fit_curves(beds, fitted).candidates[1].reason.startswith("a rescaling needs 6 beds of different form or sieve")
    )
    assert len(fit_curves(2 * beds, fitted).beds) == 3
    with pytest.raises(ValueError, match="4 rows with a sieve curve with 2 different beds; .* needs 3 beds"):
        fit_curves(2 * beds[:2], fitted)
    same_form = [MeasuredBed(beds[0].sample, bed.n, np.nan, bed.case, bed.curve) for bed in beds]
    assert len(fit_curves(same_form, fitted).beds) == 3, "beds of one form with different curves are different beds"


def test_beds_that_share_a_form_share_the_error_of_its_porosity(fitted):
    def sentence(beds):
        text = " ".join(describe_fit(MeasuredFit([], [], [], fit_curves(beds, fitted)), "beds.csv").split())
        return text.partition("its standard error is ")[2].partition(",")[0]

    own = beds_of(lambda n: n + 0.01, 6, fitted)
    assert sentence(own) == "", "each bed has a form of its own"
    n = [predict_curve(bed.curve, [own[i < 4].sample], fitted).n.item() for i, bed in enumerate(own)]
    shared = [replace(bed, sample=own[i < 4].sample, n=n[i] + 0.01) for i, bed in enumerate(own)]
    # Four beds of one form and two of another, which do not scatter.
    assert {predict_preferred(own[i].sample, ONE_CLASS, fitted)["model"] for i in (0, 1)} == {"unified"}
    model = fitted.models["unified", "U1"]
    designs = [model.design(sample_features([own[i].sample])) for i in (1, 0)]
    four, two = (scatter_of(design, model.scatter, model.scatter_line).item() for design in designs)
    assert sentence(shared) == f"{np.hypot(4 * four, 2 * two) / 6:.4f} instead of 0.0000"
    # Of one form, the model of beds of one form gives the porosity.
    flat = sample_of_one_form(0.35, 0.55)
    n = [predict_curve(bed.curve, [flat], fitted).n.item() for bed in own]
    rows = [replace(bed, sample=flat, n=value + 0.01) for bed, value in zip(own, n, strict=True)]
    model = fitted.models["single_form", "U1"]
    scatter = scatter_of(model.design(sample_features([flat])), model.scatter, model.scatter_line).item()
    assert sentence(rows) == f"{scatter:.4f} instead of 0.0000"
    repeated = rows + [replace(bed, n=bed.n + 0.004) for bed in rows]
    text = " ".join(describe_fit(MeasuredFit([], [], [], fit_curves(repeated, fitted)), "beds.csv").split())
    assert "Repeats of the same form and sieve curve scatter by 0.0028." in text


def test_a_solid_fraction_of_a_bed_with_a_sieve_curve_is_questioned(fitted):
    beds = beds_of(lambda n: n + 0.01, 4, fitted)
    result = fit_curves([*beds[:3], replace(beds[3], n=1 - beds[3].n)], fitted)
    (notice,) = result.notices
    assert notice.startswith("bed 3: n = 0.") and f". If it is the solid fraction, write {beds[3].n:.4g}" in notice
    text = describe_fit(MeasuredFit([], [], [], result), "beds.csv")
    assert "Measured porosity and the prediction of our model of size and form as it is" in text
    assert f"{1 - beds[3].n:.4f}" in text


def test_a_bed_that_is_not_evaluated_is_named(fitted):
    beds = beds_of(lambda n: n, 3, fitted)
    far = MeasuredBed(sample_of(0.16, 0.2, "flat"), 0.5, np.nan, "U7", all_cases()["U7"].curve)
    with pytest.raises(
        ValueError, match="flat, sieve curve .*U7.*: the model is not evaluated: .*; correct the row or"
    ):
        fit_curves([*beds, far], fitted)


@pytest.mark.parametrize("forms", [1, 3])
def test_the_interval_for_another_form_contains_it_as_often_as_stated(fitted, forms):
    """The error of the one-class porosity is one number per form: without its part the interval would miss it.

    The probability of one of 300 draws varies by less than a binomial one, whose standard error is 0.0126.
    """
    rng, scatter = np.random.default_rng(3), 0.003
    beds = beds_of(lambda n: n, 9, fitted, scatter=0.0)
    beds = [replace(bed, sample=beds[i % forms].sample) for i, bed in enumerate(beds)]
    model = fit_curves(beds, fitted).model
    new = sample_of(0.45, 0.62)
    assert model.unlike([beds[0].sample, new]).tolist() == [0.0, pytest.approx(np.sqrt(2 / forms))]
    assert len(model.forms) == forms
    half, nothing = 0.012, np.zeros(9)  # of the one-class porosity; the other errors are left out
    predicted = np.linspace(0.25, 0.35, 9)
    constants = {"forms": model.forms, "form_model": model.form_model, "one_class": None, "sized": model.sized}
    chances = {"with": [], "without": []}
    for _ in range(300):
        of_form = half / 1.96 * rng.normal(size=forms)
        n = predicted + of_form[np.arange(9) % forms] + scatter * rng.normal(size=9)
        drawn, _ = correct_curves("offset", predicted, n, (nothing, nothing), **constants)
        spread = np.hypot(half / 1.96, scatter)
        for name, of_one_class in (("with", half * model.unlike([new])), ("without", [0.0])):
            (at,), (width,) = drawn.apply([0.3], [0.0], [0.0], of_one_class, [0.0])
            ends = norm.cdf((np.array([at - width, at + width]) - 0.3) / spread)
            chances[name].append(ends[1] - ends[0])
    assert np.mean(chances["with"]) == pytest.approx(0.95, abs=4 * 0.0126)
    assert np.mean(chances["without"]) < 0.95 - 4 * 0.0126


def test_predict_takes_the_file_that_fit_wrote(tmp_path, capsys):
    path = tmp_path / "model.json"
    result = simcore.fit(EXAMPLE, out=path)
    assert result.cases == [] and result.table.query("chosen").case.tolist() == ["sieve curves"]
    assert result.curves.agreement.bias.iloc[0] == pytest.approx(-0.0119, abs=5e-4)
    curve = ROOT / "examples" / "sieve_curve.csv"
    before, after = (simcore.predict(curve=curve, models=models) for models in (None, path))
    assert after.n.item() - before.n.item() == pytest.approx(result.curves.model.coefficients[0], abs=1e-12)
    read = read_campaign_models(path)
    assert read.curve.sized == result.curves.model.sized and read.curve.covariance == result.curves.model.covariance
    assert main(["predict", "--sieve", str(curve), "--models", str(path)]) == 0
    text = capsys.readouterr().out
    assert "Correction: offset of the model of size and form, 7 measured beds" in text
    assert "made and measured like those" in text and "nan" not in text
    assert main(["predict", "--sieve", str(curve), "--models", str(path), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["correction"]["kind"] == "offset"
    again = simcore.fit(EXAMPLE, models=path).curves
    assert again.agreement.set_index("model").bias[CORRECTED] == pytest.approx(0, abs=1e-9)
    assert "ours, size and form, corrected" in describe_fit(result._replace(curves=again), EXAMPLE)
    assert main(["fit", str(EXAMPLE), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["curves"]["candidates"][0]["chosen"]


def test_the_offset_belongs_to_the_model_of_the_file(tmp_path):
    """A file of another version has other parameters; its own beds have no mean residual after a new fit either."""
    path, again = tmp_path / "model.json", tmp_path / "again.json"
    simcore.fit(EXAMPLE, out=path)
    content = json.loads(path.read_text())
    lines = [model.pop("scatter_line") for model in content["curve"]["one_class"]]  # files of before had none
    assert any(lines)
    content["curve"]["correction"]["sized"] |= {"candidate": "H", "parameters": {"K": 4.1, "m0": 1.0, "kappa": 0.0}}
    path.write_text(json.dumps(content))
    result = simcore.fit(EXAMPLE, models=path, out=again).curves
    assert result.model.sized.candidate == "H"
    assert check_models(EXAMPLE, models=again).checks[0].bias == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("by_class", [False, True])
def test_few_grains_of_measured_forms_widen_the_corrected_interval(tmp_path, by_class):
    """Forms like those of the fit: the error of the model of one class is in the scatter of the measured beds."""
    path, curve = tmp_path / "model.json", ROOT / "examples" / "sieve_curve.csv"
    simcore.fit(EXAMPLE, out=path)
    half, errors = [], []
    for count in (2.5, 3, 300):  # weights, so that the number of grains is unknown; few and many grains
        rows = [f"{FL},{EL},{count}" for FL in (0.472, 0.822) for EL in (0.543, 0.821)]
        lines = [f"{label},{row}" for label in ("0-5.6 mm", "> 5.6 mm") for row in rows] if by_class else rows
        forms = tmp_path / "forms.csv"
        forms.write_text("\n".join(["class,FL,EL,count" if by_class else "FL,EL,count", *lines]) + "\n")
        row = simcore.predict(forms, curve=curve, models=path).iloc[0]
        half.append(0.5 * (row.upper - row.lower))
        errors.append(row.one_class_few_grains_error)
    assert np.isnan(errors[0]) and errors[1] > 5 * errors[2]
    unknown, few, many = half
    assert unknown < many < few and many == pytest.approx(unknown, rel=0.02)
    # The porosity of a bed changes by less than that of one class.
    assert 1.96 * 0.5 * errors[1] < np.sqrt(few**2 - unknown**2) < 2.3 * 1.4 * errors[1]


def test_the_file_is_refused_where_it_has_no_meaning(tmp_path, capsys):
    path = tmp_path / "model.json"
    simcore.fit(EXAMPLE, out=path)
    forms = str(ROOT / "examples" / "grains.csv")
    assert main(["predict", forms, "--case", "U7", "--models", str(path)]) != 0
    assert "fitted to beds with sieve curves; give a sieve curve with --sieve" in capsys.readouterr().err
    with pytest.raises(ValueError, match="the page does not evaluate models of measured beds"):
        page_data(read_campaign_models(path))
    content = json.loads(path.read_text())
    for change in ("kind", "of_form", "form_model"):
        broken = json.loads(json.dumps(content))
        broken["curve"]["correction"][change] = ["unknown", "U1"]
        path.write_text(json.dumps(broken))
        with pytest.raises(ValueError, match="is not a file of models that `fit` wrote"):
            read_campaign_models(path)


def test_cases_and_curves_in_one_table_are_fitted_separately(tmp_path, fitted):
    rows = pd.read_csv(EXAMPLE)
    U1 = rows.iloc[[0]].drop(columns="sieve")
    forms = pd.DataFrame({"mean_FL": [0.5, 0.6, 0.7], "mean_EL": [0.7, 0.65, 0.75]})
    cases = pd.concat([U1.assign(case="U1", sample=f"c {i}", **form) for i, form in forms.iterrows()])
    pd.concat([rows, cases]).to_csv(tmp_path / "beds.csv", index=False)
    result = simcore.fit(tmp_path / "beds.csv", out=tmp_path / "model.json")
    assert [case.case for case in result.cases] == ["U1"] and len(result.curves.beds) == 7
    models = read_campaign_models(tmp_path / "model.json")
    sample = sample_of(0.6, 0.7)
    assert (predict_samples([sample], "U1", models).query("by == 'ours'").model == "measured").all()
    in_curve = predict_curve(all_cases()["U7"].curve, [sample], models).n_one_class.item()
    assert in_curve == predict_curve(all_cases()["U7"].curve, [sample], fitted).n_one_class.item()


@pytest.fixture
def write(tmp_path):
    (tmp_path / "fine.csv").write_text("opening [mm];mass [g]\n8;0\n4;50,5\n2;40\npan;10\n")
    (tmp_path / "good.csv").write_text("opening [mm];passing [%]\n8;100\n4;50,5\n2;0\n")

    def write_text(text):
        (tmp_path / "beds.csv").write_text(text)
        return tmp_path / "beds.csv"

    return write_text


def test_a_row_has_a_file_or_a_listed_curve(write):
    path = write("FL,EL,n,sieve\n0.6,0.7,0.35,good.csv\n0.6,0.7,0.3,U7\n")
    beds, notices = read_measured_beds(path, curves=CurveReader({"U7": all_cases()["U7"].curve}))
    assert [bed.curve.name for bed in beds] == ["good", "U7"] and [bed.case for bed in beds] == ["good.csv", "U7"]
    np.testing.assert_allclose(beds[0].curve.mass_fractions, [0.505, 0.495])
    path = write("FL,EL,n\n0.6,0.7,0.35\n0.6,0.7,0.3\n")
    beds, _ = read_measured_beds(path, sieve=path.parent / "good.csv")
    assert beds[0].curve is beds[1].curve


@pytest.mark.parametrize(
    ("text", "options", "message"),
    [
        ("FL,EL,n,sieve\n0.6,0.7,0.3,none.csv\n", {}, r"beds.csv, row 2: the sieve curve none.csv is no file \(.*none"),
        ("FL,EL,n,sieve\n0.6,0.7,0.3,\n", {}, "beds.csv, row 2: sieve is empty; name the sieve curve"),
        (
            "FL,EL,n,sieve\n0.6,0.7,0.3,fine.csv\n",
            {},
            "row 2: .*fine.csv: 10.0% of the mass pass the finest .* --finest",
        ),
        ("FL,EL,n,sieve\n0.6,0.7,0.3,beds.csv\n", {}, "row 2: .*beds.csv: the columns FL, EL are not named as amounts"),
        ("FL,EL,n,sieve,case\n0.6,0.7,0.3,good.csv,U1\n", {}, "row 2: case and sieve are both given; each row has one"),
        ("FL,EL,n,sieve,case\n0.6,0.7,0.3,,\n", {}, "row 2: case and sieve are empty"),
        ("FL,EL,n,sieve\n0.6,0.7,0.3,good.csv\n", {"case": "U1"}, "has a column sieve; leave out --case"),
        ("FL,EL,n\n0.6,0.7,0.3\n", {"case": "U1", "sieve": "good.csv"}, "--case and --sieve are both"),
        ("FL,EL,n\n0.6,0.7,0.3\n", {"sieve": "gone.csv"}, "--sieve: the sieve curve gone.csv is no file"),
    ],
)
def test_what_is_wrong_is_named(write, text, options, message):
    with pytest.raises(ValueError, match=message):
        read_measured_beds(write(text), **options)
