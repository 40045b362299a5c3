"""Predictions as people and programs read them: text, CSV, JSON and the command line."""

import csv
import io
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from simcore.__main__ import main
from simcore.grains.measured_forms import Sample
from simcore.models.fitting import fit_reference_models
from simcore.models.prediction import predict_samples
from simcore.models.prediction_text import describe, few_grains_caveats, few_grains_error_caveats
from simcore.paths import REFERENCE
from tests.helpers.reference_rows import porosity_of_form, sample_of_one_form

ROOT = Path(__file__).resolve().parents[2]
TABLE_2 = ROOT / "examples" / "table2.csv"


def test_on_the_command_line(capsys, tmp_path):
    assert main(["predict", "--case", "U1", str(TABLE_2)]) == 0
    text = capsys.readouterr().out
    assert "railway ballast" in text and "* outside the fitted range of the model" in text
    assert "their Eq. 23" in text and "mixtures in " in text and "results/reference/" in text
    (tmp_path / "few.csv").write_text("sample,FL,EL\nA,0.6,0.7\nA,0.8,0.5\n")
    assert main(["predict", "--case", "U1", str(tmp_path / "few.csv")]) == 0
    assert "Fewer than 30 grains do not determine the spread of form well: A." in capsys.readouterr().out
    assert main(["predict", "--case", "U1", str(TABLE_2), "--csv"]) == 0
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert [(row["sample"], row["by"], row["model"]) for row in rows[:3]] == [
        ("Rhine", "ours", "form_mixture"),
        ("Rhine", "ours", "unified"),
        ("Rhine", "r22", "form_mixture"),
    ]
    assert len(rows) == 27
    assert main(["predict", "--case", "U1", str(TABLE_2), "--json", "--level", "0.5"]) == 0
    output = json.loads(capsys.readouterr().out)
    assert (output["case"], output["level"], len(output["samples"])) == ("U1", 0.5, 9)
    first = output["samples"][0]["predictions"]
    assert first[0]["n"] == pytest.approx(float(rows[0]["n"])) and first[2]["lower"] is None
    assert first[0]["upper"] - first[0]["lower"] < float(rows[0]["upper"]) - float(rows[0]["lower"])
    (tmp_path / "bad.csv").write_text("L,I,S\n1,2,3\n")
    assert main(["predict", "--case", "U1", str(tmp_path / "bad.csv")]) == 2
    output = capsys.readouterr().err
    assert output.startswith("scree predict: ") and output.count("\n") == 1 and "bad.csv, row 2" in output
    assert main(["predict", "--case", "U1", str(TABLE_2), "--level", "95"]) == 2
    assert "level 95: give a number between 0 and 1" in capsys.readouterr().err


def test_smooth_grains_that_are_nearly_round_have_a_notice(capsys, tmp_path):
    """The porosities are those of near_spheres.csv."""
    rows = pd.read_csv(REFERENCE / "near_spheres.csv")
    spheres = rows.query("shape_kind == 'sphere'").n.mean()
    (tmp_path / "beads.csv").write_text("sample,L,I,S\nbeads,10,10,10\nbeads,10,10,10\npebbles,13,10,10\n")
    for words in (["--case", "one-class"], ["--sieve", "U7"]):
        assert main(["predict", *words, str(tmp_path / "beads.csv")]) == 0
        text = capsys.readouterr().out
        assert f"with L/S = 1.2 have 0.343, and those of spheres {spheres:.3f}: beads.\n" in text
        assert main(["predict", *words, str(TABLE_2)]) == 0
        assert "nearly round" not in capsys.readouterr().out


def test_the_error_of_few_grains_is_stated_or_its_absence():
    def lines(errors, one_form=(False, False, False)):
        return few_grains_error_caveats(["a", "b", "c"], one_form, errors, "the porosity")

    assert lines([0.0035, 0.0071, 0.005]) == [
        "Because only some grains were measured, the porosity has a standard error of 0.004 to 0.007, which the "
        "intervals contain."
    ]
    assert "error of less than 0.001, which" in lines([2e-4, 3e-4, 1e-4])[0]
    known, unknown = lines([0.004, np.nan, np.nan])
    assert "a standard error of 0.004, which" in known
    assert unknown.startswith("The intervals do not contain the error of measuring few grains of b, c; it is known if")
    assert lines([np.nan] * 3) == [unknown.replace(" of b, c", "")]
    assert lines([0.0, np.nan, 0.0], one_form=(True, True, True)) == []


def test_a_single_grain_is_named_and_few_grains_of_one_form_are_not():
    single, few, fewer = few_grains_caveats(list("abcd"), [1, 3, 3, 40], [True, True, False, False])
    assert single.startswith("a: a single grain was measured, and all grains are taken to have its form.")
    assert few.startswith("Fewer than 30 grains") and few.endswith(": c.") and fewer.endswith(": c.")


@pytest.mark.parametrize("case", ["--case one-class", "--sieve examples/sieve_curve.csv"])
def test_means_and_two_axes_say_that_the_interval_lacks_the_error_of_few_grains(tmp_path, monkeypatch, capsys, case):
    monkeypatch.chdir(ROOT)
    (tmp_path / "means.csv").write_text("mean_FL,std_FL,mean_EL,std_EL\n0.6,0.15,0.7,0.12\n")
    (tmp_path / "two.csv").write_text("L,I\n" + "".join(f"{L},10\n" for L in range(12, 20)))
    for name in ["means.csv", *(["two.csv"] if "one-class" in case else [])]:
        assert main(["predict", str(tmp_path / name), *case.split()]) == 0
        assert "The intervals do not contain the error of measuring few grains" in capsys.readouterr().out
    assert main(["predict", "examples/grains.csv", *case.split()]) == 0
    assert "do not contain the error" not in capsys.readouterr().out


def test_a_reader_that_has_seen_enough_is_no_error():
    words = [sys.executable, "-m", "simcore", "predict", "--case", "U1", str(TABLE_2)]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=ROOT) as run:
        run.stdout.close()
        assert run.stderr.read() == b""
    assert run.returncode == 141


def test_a_case_without_mixtures_is_predicted_by_r22_alone_with_a_remark(reference, caplog):
    rows = pd.read_csv(reference / "single_form.csv")
    pd.concat([rows, rows.assign(case="U7", n=rows.n - 0.05)]).to_csv(reference / "single_form.csv", index=False)
    fitted = fit_reference_models(reference, source="synthetic")
    assert not caplog.messages
    one, wide = sample_of_one_form(0.6, 0.7), Sample("wide", 50, 0.6, 0.15, 0.7, 0.15, 0.42, 0.12)
    table = predict_samples([one, wide], "U7", fitted)
    assert table[table.preferred].name.tolist() == ["one"]
    assert table[table.preferred].n.item() == pytest.approx(porosity_of_form(0.6, 0.7) - 0.05, abs=1e-3)
    too_few = "Too few of our packings of U7 have a distribution of form: only the model of Rettinger et al."
    assert too_few in describe(table, "U7", fitted)
    assert "Too few" not in describe(table[table.name == "one"], "U7", fitted)
    assert "Too few" not in describe(predict_samples([wide], "U1", fitted), "U1", fitted)


def run(capsys, *words):
    status = main(["predict", "--case", "U1", *map(str, words)])
    return status, *capsys.readouterr()


FAR_OUTSIDE = "needles,0.12,0.12\nneedles,0.15,0.13\nslate,0.023,0.72\n"


def test_samples_far_outside_are_listed_beside_those_that_are_predicted(capsys, tmp_path):
    """Needles and thin slate are between good samples, in each of the three output formats."""
    path = tmp_path / "bed.csv"
    path.write_text(f"sample,FL,EL\n{FAR_OUTSIDE}good,0.6,0.7\ngood,0.7,0.6\n")
    status, text, err = run(capsys, path)
    assert status == 0 and err.count("\n") == 2 and "row 4: S/I or I/L is 0.1 or less" in err
    assert "the sample slate has one row, so that" in err
    assert "No model is evaluated for: needles, slate. The reasons are listed below" in text
    assert "only that of Rettinger et al., for" not in text
    assert "needles, ours unified: 1/mean EQ = 59 is above" in text and "slate, Rettinger et al. single_form" in text
    rows = {line.split("  ")[0]: line for line in text.splitlines()}
    assert "0." in rows["good"][40:] and rows["slate"].count("  -") >= 3
    table = pd.read_csv(io.StringIO(run(capsys, path, "--csv")[1])).groupby("sample", sort=False)
    assert table.n.count().to_dict() == {"needles": 0, "slate": 0, "good": 2}
    assert table.preferred.sum().to_dict() == {"needles": 0, "slate": 0, "good": 1}
    samples = json.loads(run(capsys, path, "--json")[1])["samples"]
    assert [row["n"] for row in samples[1]["predictions"]] == [None] * 3
    assert sum(row["n"] is not None for row in samples[2]["predictions"]) == 2


def test_it_is_an_error_if_no_sample_can_be_predicted(capsys, tmp_path):
    path = tmp_path / "bed.csv"
    path.write_text(f"sample,FL,EL\n{FAR_OUTSIDE}")
    for form in ([], ["--csv"], ["--json"]):
        status, out, err = run(capsys, path, *form)
        assert (status, out, err.count("\n")) == (2, "", 1)
        assert "the porosity of samples needles, slate cannot be predicted. For needles no model is evaluated" in err
        assert "ours unified: 1/mean EQ = 59 is above" in err and "Rettinger et al. single_form: L/S" in err


def test_no_number_is_printed_for_a_model_near_sigma_0(capsys, tmp_path):
    """For two nearly equal grains the model with 1/sigma gives no number, but the unified one does."""
    path = tmp_path / "two.csv"
    path.write_text("L (mm) ,I  (mm), S(mm)\n30,22,14\n41,30,22\n")
    status, text, err = run(capsys, path)
    assert (status, err) == (0, "")
    row = next(line.split("  ") for line in text.splitlines() if line.startswith("two"))
    assert "unified" in row and "-" in row
    assert "two, ours form_mixture: 1/std. dev. EL = 1230 is above" in text
    _, text, _ = run(capsys, path, "--csv")
    rows = list(csv.DictReader(io.StringIO(text)))
    assert [(row["model"], bool(row["n"]), bool(row["lower"]), bool(row["refused"])) for row in rows] == [
        ("form_mixture", False, False, True),
        ("unified", True, True, False),
        ("single_form", True, False, False),
    ]
    _, text, _ = run(capsys, path, "--json")
    assert [p["n"] is None for p in json.loads(text)["samples"][0]["predictions"]] == [True, False, False]


def test_notices_go_to_the_error_output_and_into_json(capsys, tmp_path):
    path = tmp_path / "bed.csv"
    path.write_text("river,FL,EL,D50\nRhine,0.6,0.7,9\nRhine,0.7,0.6,8\nKall,0.5,0.7,8\nMean,0.6,0.67,8\n")
    notices = ["row 5 (Mean)", "--sample 'river'", "not used: D50"]
    for form in ([], ["--csv"], ["--json"]):
        status, out, err = run(capsys, path, *form)
        lines = err.splitlines()
        assert status == 0 and len(lines) == 3
        assert all(notice in line and str(path) in line for notice, line in zip(notices, lines, strict=True))
    assert [f"scree predict: {notice}" for notice in json.loads(out)["notices"]] == lines
    assert json.loads(run(capsys, TABLE_2, "--json")[1])["notices"] == []


def test_where_none_of_ours_can_be_evaluated_it_is_said(reference):
    """Our models are far outside their ranges, and the model of Rettinger et al. is inside its own."""
    rows = pd.read_csv(reference / "single_form.csv")
    narrow = rows.assign(S=rows.I * (0.9 + rows.S / rows.I / 10), L=rows.I / (0.9 + rows.I / rows.L / 10))
    narrow.to_csv(reference / "single_form.csv", index=False)
    (reference / "form_mixture.csv").unlink()
    fitted = fit_reference_models(reference)
    table = predict_samples([sample_of_one_form(0.5, 0.6)], "U1", fitted)
    assert table[table.refused == ""].by.tolist() == ["r22"] and not table.preferred.any()
    text = describe(table, "U1", fitted)
    assert "None of our models can be evaluated, only that of Rettinger et al., for: one." in text
    assert "Too few" not in text
