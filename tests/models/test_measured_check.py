"""Our models, or those of an earlier fit, are tested on beds, from one bed on, and nothing is fitted."""

import json

import numpy as np
import pandas as pd
import pytest

import simcore
from simcore.__main__ import main
from simcore.models.measured_check import check_models
from simcore.models.measured_check_text import describe_check
from simcore.paths import ROOT

HEAD = "sample,n,mean_FL,std_FL,mean_EL,std_EL\n"
FORM, OTHER = "0.62,0.13,0.72,0.12", "0.55,0.13,0.7,0.12"


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    """Return the path of an offset that was fitted to the 13 beds of the example."""
    path = tmp_path_factory.mktemp("model") / "model.json"
    assert simcore.fit(ROOT / "examples" / "measured.csv", case="one-class", out=path).cases[0].chosen.kind == "offset"
    return path


@pytest.fixture
def write(tmp_path):
    def write_beds(*rows, head=HEAD):
        (tmp_path / "new.csv").write_text(head + "".join(f"{row}\n" for row in rows))
        return tmp_path / "new.csv"

    return write_beds


def test_bias_scatter_and_share_are_those_of_the_predictions(write, model):
    """The beds are predicted as by `predict`, and lie at known distances from the predictions."""
    forms = [f"f{i},{form}" for i, form in enumerate((FORM, OTHER, FORM, OTHER))]
    path = write(*forms, head=HEAD.replace("n,", ""))
    predicted = simcore.predict(path, "U1", models=model).query("by == 'ours'")
    added = np.array([0.0, 0.002, -0.004, 0.05])
    n = predicted.n.to_numpy() + added
    path = write(*(f"f{i},{value!r},{(FORM, OTHER)[i % 2]}" for i, value in enumerate(n.tolist())))
    (check,) = check_models(path, model).checks
    np.testing.assert_allclose(check.beds[["predicted", "lower", "upper"]], predicted[["n", "lower", "upper"]])
    assert check.beds.inside.tolist() == [True, True, True, False] and check.inside == 0.75
    assert check.bias == pytest.approx(-added.mean()) and check.scatter == pytest.approx(added.std(ddof=1))
    for case in ("U1", "one-class"):
        assert check_models(path, model, case=case).checks[0].beds.equals(check.beds)


def test_one_bed_and_beds_of_one_form_are_tested(write, model, capsys):
    path = write(f"A,0.35,{FORM}")
    assert main(["fit", str(path), "--models", str(model)]) == 0
    printed = capsys.readouterr()
    assert printed.err == "" and "new.csv: 1 bed, case U1\n" in printed.out
    assert f"Model: offset of unified, 13 measured beds: {model}\n" in printed.out
    (check,) = check_models(path, model).checks
    bed = check.beds.iloc[0]
    difference, interval = f"{bed.predicted - 0.35:+.4f}", f"{bed.lower:.4f} to {bed.upper:.4f}"
    assert f"A    0.3500    {bed.predicted:.4f}     {interval}  {difference}     yes" in printed.out.splitlines()
    assert f"1     {difference}  -        1 of 1 (100 %)" in printed.out.splitlines()
    assert np.isnan(check.scatter)
    assert main(["fit", str(path), "--models", str(model), "--json"]) == 0
    (test,) = json.loads(capsys.readouterr().out)["tests"]
    assert test["scatter"] is None and test["inside"] == 1 and test["beds"][0]["predicted"] == bed.predicted
    path = write(f"A,0.35,{FORM}", f"B,0.36,{FORM}", f"B,0.40,{FORM}")
    (check,) = check_models(path, model).checks
    assert check.beds.name.tolist() == ["A", "B", "B (row 4)"] and check.scatter == pytest.approx(0.0264575, abs=1e-6)


LEAVE_OUT = "leave out --models to compare with our models, or give a file that was fitted to such beds"


def test_a_case_that_contradicts_the_model_is_an_error(write, model, tmp_path, capsys):
    path = write(f"A,0.35,{FORM}")
    for more in ([], ["--out", str(tmp_path / "new.json")]):
        assert main(["fit", str(path), "--models", str(model), "--case", "U7", *more]) == 2
        printed = capsys.readouterr()
        assert printed.out == "" and not (tmp_path / "new.json").exists()
        assert printed.err == f"scree fit: --case U7: {model} is for case U1; leave out --case, or give other models\n"
    head = HEAD.replace("n,", "case,n,")
    result = check_models(write(f"A,one-class,0.35,{FORM}", f"B,U7,0.3,{FORM}", head=head), model)
    assert [check.beds.name.tolist() for check in result.checks] == [["A"]]
    assert result.left_out == [f"case U7: 1 row; {model} is for case U1; {LEAVE_OUT}"]
    assert "Left out: case U7: 1 row;" in describe_check(result, path, model)
    with pytest.raises(ValueError, match=f"new.csv: case U7: 1 row; .*model.json is for case U1; {LEAVE_OUT}$"):
        check_models(write(f"B,U7,0.3,{FORM}", head=head), model)
    with pytest.raises(ValueError, match=f"new.csv: 1 row with a sieve curve; .* is for case U1; {LEAVE_OUT}$"):
        check_models(write(f"A,0.35,{FORM}"), model, sieve=ROOT / "examples" / "sieve_curve.csv")


def test_with_out_the_model_is_corrected(write, model, tmp_path, capsys):
    path, out = write(f"A,0.35,{FORM}", f"B,0.36,{OTHER}", "C,0.345,0.66,0.12,0.74,0.11"), tmp_path / "new.json"
    assert main(["fit", str(path), "--models", str(model), "--out", str(out)]) == 0
    assert "The chosen model is the offset of your fit" in " ".join(capsys.readouterr().out.split())
    assert check_models(path, out).checks[0].behind.startswith("offset of an earlier fit, 3 measured beds")
    assert main(["fit", str(path), "--models", str(out), "--out", str(out)]) == 2
    assert "is read by this command" in capsys.readouterr().err
    assert main(["fit", str(path), "--models", str(out), "--features", "single_form"]) == 2
    assert "--features: the models of --models are only tested" in capsys.readouterr().err
    out.unlink()
    assert main(["fit", str(write(f"A,0.35,{FORM}")), "--models", str(model), "--out", str(out)]) == 2
    assert "case U1: 1 row with 1 form; the simplest model" in capsys.readouterr().err and not out.exists()


@pytest.mark.parametrize("case", [["--case", "one-class"], ["--sieve", str(ROOT / "examples" / "sieve_curve.csv")]])
def test_too_few_beds_for_a_fit_are_compared_with_our_models(write, tmp_path, capsys, case):
    path = write(f"A,0.35,{FORM}", f"B,0.34,{FORM}", "C,0.345,0.66,0.12,0.74,0.11")
    assert main(["fit", str(path), *case, "--out", str(tmp_path / "m.json")]) == 2
    assert (
        "needs 3 beds" in (error := capsys.readouterr().err) and "without --out" in error and not error.count("\n") > 1
    )
    assert main(["fit", str(path), *case, "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    (test,) = printed["tests"]
    options = {"curve": case[1]} if case[0] == "--sieve" else {"case": case[1]}
    forms = write(*(f"{name},{FORM}" for name in "AB"), "C,0.66,0.12,0.74,0.11", head=HEAD.replace("n,", ""))
    predicted = simcore.predict(forms, **options)
    predicted = predicted[predicted.preferred] if "preferred" in predicted else predicted
    for name, column in (("predicted", "n"), ("lower", "lower"), ("upper", "upper")):
        np.testing.assert_allclose([bed[name] for bed in test["beds"]], predicted[column])
    assert "3 rows" in printed["not_fitted"] and printed["models"] is None and test["model"].startswith("ours")
    write(f"A,0.35,{FORM}")
    assert main(["fit", str(path), *case]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "1 bed, case one-class " in text or case[0] == "--sieve"
    assert "Nothing is fitted." in text and "an offset, needs 3 beds" in text


@pytest.mark.parametrize(("case", "curve"), [("U3", "U3"), ("bar", "a file, or a listed curve such as U3,")])
def test_beds_of_a_case_without_a_model_are_left_out_with_the_remedy(write, case, curve):
    path = write(f"A,{case},0.35,{FORM}", f"B,U1,0.36,{FORM}", head=HEAD.replace("n,", "case,n,"))
    (left_out,) = check_models(path).left_out
    assert left_out.startswith(f"case {case}: 1 row")
    assert f"give {curve} as --sieve or in a column sieve, not as a case" in left_out
    assert left_out.endswith("for beds of any single sieve class the case is one-class") == (case == "bar")


def test_beds_of_a_case_without_a_model_do_not_hide_the_others(write, capsys):
    rows = [f"{name},U7,0.3,0.6{i},0.1,0.7,0.1" for i, name in enumerate("abc")]
    path = write(*rows, f"d,U1,0.35,{FORM}", head=HEAD.replace("n,", "case,n,"))
    assert main(["fit", str(path)]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "1 bed, case U1" in text and "give --sieve U7 instead of the case" in text


def test_beds_that_cannot_be_predicted_are_an_error_beside_too_few_of_a_case(write, capsys):
    rows = ["A,,U7,0.3,0.6,0.1,0.7,0.1", "B,,U7,0.3,0.61,0.1,0.7,0.1", "C,,U7,0.5,0.12,0.02,0.3,0.02"]
    path = write("D,one-class,,0.35,0.6,0.1,0.7,0.1", *rows, head=HEAD.replace("n,", "case,sieve,n,"))
    assert main(["fit", str(path)]) == 2
    printed = capsys.readouterr()
    assert printed.out == "" and "C, sieve curve U7: the model is not evaluated" in printed.err


def test_beds_outside_the_range_and_unlikely_porosities_are_named(write, model, capsys):
    path = write(f"A,0.62,{FORM}", "flat,0.5,0.12,0.06,0.3,0.06")
    assert main(["fit", str(path), "--models", str(model)]) == 0
    printed = capsys.readouterr()
    assert (
        printed.err.startswith(f"scree fit: {path}, row 2: n = 0.62 is far from the predicted 0.3")
        and printed.err.count("\n") == 1
    )
    assert "If it is the solid fraction, write 0.38; if it is the void ratio e, write 0.3827." in printed.err
    assert "- Bed flat is not predicted: 1/mean EQ = " in printed.out and "0 of 1 (0 %)" in printed.out
    with pytest.raises(ValueError, match="the model is evaluated for none of the beds; flat: 1/mean EQ = "):
        check_models(write("flat,0.5,0.12,0.06,0.3,0.06"), model)
    path = write("A,0.35,0.62,0.72", head="sample,n,FL,EL\n")
    text = describe_check(check_models(path, model), path, model)
    expected = "Bed A differs from the beds behind the model: it was fitted only to beds with a distribution of form."
    assert expected in " ".join(text.split())


def test_a_correction_for_sieve_curves_is_tested(tmp_path, capsys):
    """Each gravel of the example is predicted by the offset that the seven give."""
    example, path = ROOT / "examples" / "measured_curves.csv", tmp_path / "model.json"
    fitted = simcore.fit(example, out=path).curves
    (check,) = check_models(example, path).checks
    assert check.case == "" and check.bias == pytest.approx(0, abs=1e-9)
    np.testing.assert_allclose(check.beds.predicted, fitted.beds.predicted + fitted.model.coefficients[0])
    assert check.scatter == pytest.approx(fitted.model.scatter)
    rows = pd.read_csv(example).iloc[:1]
    rows.drop(columns="sieve").to_csv(tmp_path / "one.csv", index=False)
    assert main(["fit", str(tmp_path / "one.csv"), "--models", str(path)]) == 2
    assert "the sieve curve of the beds is not given" in capsys.readouterr().err
    curve = ROOT / "examples" / "sieve_curve.csv"
    assert main(["fit", str(tmp_path / "one.csv"), "--models", str(path), "--sieve", str(curve)]) == 0
    text = capsys.readouterr().out
    assert "one.csv: 1 bed with sieve curves\n" in text and "offset of the model of size and form, 7 measured" in text
    assert main(["fit", str(tmp_path / "one.csv"), "--models", str(path), "--case", "U1"]) == 2
    assert "is for beds with sieve curves; leave out --case" in capsys.readouterr().err
