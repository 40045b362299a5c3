"""Prediction for measured grains: rows whose truth is known, the study's data sets, the command line."""

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
from simcore.grains.measured_forms import Sample, read_samples
from simcore.models.files import models_dataset
from simcore.models.mixtures import mixture_models
from simcore.models.prediction import describe, fit_reference_models, predict_samples, read_campaign_models
from simcore.models.single_form import single_form_models
from simcore.reference.r22_tables import read_study_table

ROOT = Path(__file__).resolve().parents[2]
TABLE_2 = ROOT / "examples" / "table2.csv"


def grains(number, seed=0):
    return np.random.default_rng(seed).uniform(0.35, 0.95, (2, number))


def mixtures(number=16, seed=1):
    rng = np.random.default_rng(seed)
    table = pd.DataFrame({"mu_EQ": rng.uniform(0.25, 0.55, number), "mu_EL": rng.uniform(0.5, 0.8, number)})
    return table.assign(sigma_EQ=rng.uniform(0.08, 0.16, number), sigma_EL=rng.uniform(0.1, 0.2, number), case="U1")


def single_truth(flatness, elongation):
    return 0.30 + 0.02 / (flatness * elongation) + 0.01 / elongation


@pytest.fixture
def reference(tmp_path):
    """A folder of committed rows as a campaign leaves them: two sources, ellipsoids that must not count, two seeds."""
    parts = []
    for source, seed in (("synthetic", 0), ("scans", 1)):
        flatness, elongation = grains(20, seed)
        table = pd.DataFrame({"grain": [f"G{i}" for i in range(20)], "L": 5 / elongation, "I": 5.0, "S": 5 * flatness})
        n = single_truth(flatness, elongation) + (0.01 if source == "scans" else 0.0)
        for run, sign in ((1, 1), (2, -1)):
            mesh = table.assign(source=source, case="U1", representation="mesh", seed=run, n=n + sign * 1e-3)
            parts += [mesh, mesh.assign(representation="ellipsoid", n=0.2)]
    pd.concat(parts).to_csv(tmp_path / "single_form.csv", index=False)
    table = mixtures()
    for name in ("mu_FL", "sigma_FL", "mu_EL", "sigma_EL"):
        table[f"{name}_nominal"] = np.arange(16) / 16
    table["n"] = 0.31 + 0.03 / table.mu_EQ - 0.003 / table.sigma_EQ + 0.02 / table.mu_EL - 0.002 / table.sigma_EL
    table.to_csv(tmp_path / "form_mixture.csv", index=False)
    return tmp_path


def one_form(flatness, elongation):
    return Sample("one", 1, flatness, 0.0, elongation, 0.0, flatness * elongation, 0.0)


def test_the_rows_of_a_campaign_are_what_is_fitted(reference):
    fitted = fit_reference_models(reference, source="synthetic")
    np.testing.assert_allclose(fitted.models["single_form", "U1"].coefficients, [0.30, 0.02, 0.01], rtol=1e-9)
    np.testing.assert_allclose(
        fitted.models["form_mixture", "U1"].coefficients, [0.31, 0.03, -0.003, 0.02, -0.002], rtol=1e-8
    )
    assert fitted.behind["single_form", "U1"].endswith("single_form.csv, 20 forms in 40 packings")
    assert fitted.models["unified", "U1"].n_samples == 20 + 16
    both = fit_reference_models(reference)
    assert both.models["single_form", "U1"].n_samples == 40
    assert both.models["single_form", "U1"].scatter == pytest.approx(0.005, rel=0.3)  # half of what the sources differ
    with pytest.raises(ValueError, match="has no grains of source clay; there are scans, synthetic"):
        fit_reference_models(reference, source="clay")
    with pytest.raises(ValueError, match="nor its default/ has tables"):
        fit_reference_models(reference / "none")


def test_the_committed_rows_stand_in_until_then():
    fitted = fit_reference_models()
    assert {("single_form", "U1"), ("form_mixture", "U1"), ("unified", "U1")} <= set(fitted.models)
    for key in fitted.models:
        assert fitted.behind[key]


def test_what_a_campaign_has_not_finished_is_taken_from_the_default_one(reference, tmp_path):
    default = reference / "default"
    default.mkdir()
    flatness, elongation = grains(8, seed=3)
    table = pd.DataFrame({"case": "U1", "grain": [f"G{i}" for i in range(8)], "FL": flatness, "EL": elongation})
    table.assign(n=0.5 + 1e-6 * flatness).to_csv(default / "single_form.csv", index=False)
    beds = mixtures(seed=4).rename(columns={"mu_EQ": "EQ", "mu_EL": "EL"})
    asked = {name: np.arange(16) / 16 for name in ("mean_FL", "std_FL", "mean_EL", "std_EL")}
    beds.assign(n=0.5 + 1e-6 * beds.EQ, **asked).to_csv(default / "form_mixtures.csv", index=False)
    assert "default" not in " ".join(fit_reference_models(reference).behind.values())
    few = pd.read_csv(reference / "form_mixture.csv").head(5)
    few.to_csv(reference / "form_mixture.csv", index=False)
    fitted = fit_reference_models(reference)
    assert "default" not in fitted.behind["single_form", "U1"]
    assert "default" in fitted.behind["form_mixture", "U1"]
    assert fitted.models["form_mixture", "U1"].coefficients[0] == pytest.approx(0.5, abs=1e-5)
    # Both kinds of bed of one campaign: the whole one.
    assert fitted.models["unified", "U1"].n_samples == 8 + 16


def test_one_form_and_a_distribution_take_their_own_models(reference):
    fitted = fit_reference_models(reference, source="synthetic")
    narrow = Sample("narrow", 50, 0.6, 0.01, 0.7, 0.01, 0.42, 0.01)
    wide = Sample("wide", 50, 0.6, 0.15, 0.7, 0.15, 0.42, 0.12)
    table = predict_samples([one_form(0.6, 0.7), narrow, wide], "U1", fitted)
    ours = table[table.preferred].set_index("name")
    assert ours.model.to_dict() == {"one": "single_form", "narrow": "unified", "wide": "form_mixture"}
    assert ours.taken_as.to_dict() == {"one": "one form", "narrow": "a distribution", "wide": "a distribution"}
    assert ours.n["one"] == pytest.approx(single_truth(0.6, 0.7), rel=1e-9)
    assert ours.n["wide"] == pytest.approx(0.31 + 0.03 / 0.42 - 0.003 / 0.12 + 0.02 / 0.7 - 0.002 / 0.15, rel=1e-8)
    mixture = table.query("name == 'narrow' and by == 'ours' and model == 'form_mixture'").iloc[0]
    assert "sigma_EQ_inv = 100, fitted from" in mixture.outside
    # The unified model does not jump where the study's runs away.
    unified = table.query("model == 'unified'").set_index("name").n
    assert unified["narrow"] == pytest.approx(unified["one"], abs=1e-3)
    study = table.query("name == 'narrow' and by == 'study'").iloc[0]
    assert study.model == "single_form" and "below 0.05: taken for one form" in study.outside
    assert study.n == pytest.approx(0.278 + 0.019 / 0.42 + 0.014 / 0.7)


def test_of_our_models_the_one_that_errs_less_is_taken(reference):
    """Of mixtures that scatter about the unified model's truth."""
    rows = mixtures()
    rows["n"] = 0.30 + 0.02 / rows.mu_EQ + 0.01 / rows.mu_EL + 0.2 * (rows.sigma_EL / rows.mu_EL) ** 2
    committed = pd.read_csv(reference / "form_mixture.csv").assign(n=rows.n)
    committed.to_csv(reference / "form_mixture.csv", index=False)
    wide = Sample("wide", 50, 0.6, 0.15, 0.7, 0.15, 0.42, 0.12)
    table = predict_samples([wide], "U1", fit_reference_models(reference, source="synthetic"))
    assert table[table.preferred].model.tolist() == ["unified"]


def test_a_size_class_is_u1_and_an_unknown_case_is_refused(reference):
    fitted = fit_reference_models(reference)
    one = [one_form(0.6, 0.7)]
    pd.testing.assert_frame_equal(predict_samples(one, "one-class", fitted), predict_samples(one, "U1", fitted))
    alone = predict_samples(one, "B50", fitted)
    assert alone.by.tolist() == ["study"]
    assert alone.n.item() == pytest.approx(0.217 + 0.014 / 0.42 - 0.006 / 0.7)
    wide = Sample("wide", 50, 0.6, 0.15, 0.7, 0.15, 0.42, 0.12)
    with pytest.raises(ValueError, match="case B50, sample wide: no model, ours or the study's, was fitted to beds"):
        predict_samples([*one, wide], "B50", fitted)
    with pytest.raises(ValueError, match="case B30: no model was fitted to it; there are B50, U1, U7, one-class"):
        predict_samples(one, "B30", fitted)


def test_a_case_with_beds_of_one_form_alone_leaves_distributions_to_the_study_and_says_so(reference, caplog):
    rows = pd.read_csv(reference / "single_form.csv")
    pd.concat([rows, rows.assign(case="U7", n=rows.n - 0.05)]).to_csv(reference / "single_form.csv", index=False)
    fitted = fit_reference_models(reference, source="synthetic")
    assert not caplog.messages
    one, wide = one_form(0.6, 0.7), Sample("wide", 50, 0.6, 0.15, 0.7, 0.15, 0.42, 0.12)
    table = predict_samples([one, wide], "U7", fitted)
    assert table[table.preferred].name.tolist() == ["one"]
    assert table[table.preferred].n.item() == pytest.approx(single_truth(0.6, 0.7) - 0.05, abs=1e-3)
    said = "Too few of our packings of U7 have a distribution of form: the study's model alone for these samples"
    assert said in describe(table, "U7", fitted)
    assert "Too few" not in describe(table[table.name == "one"], "U7", fitted)
    assert "Too few" not in describe(predict_samples([wide], "U1", fitted), "U1", fitted)


def test_what_lies_outside_is_said_of_ours_and_of_the_studys(reference):
    fitted = fit_reference_models(reference)
    inside, outside = (predict_samples([one_form(*form)], "U1", fitted) for form in ((0.65, 0.7), (0.2, 0.3)))
    assert (inside.outside == "").all()
    single, unified, study = outside.outside
    assert "EQ_inv = 16.67, fitted from" in single and "mu_EQ_inv = 16.67" in unified
    assert "mu_FL = 0.2, fitted from 0.297 to 0.997" in study and "mu_EL = 0.3, fitted from 0.404 to 0.96" in study
    width = outside.upper - outside.lower
    assert width[0] > (inside.upper - inside.lower)[0]


def test_table_2_is_the_studys_and_gives_its_predictions():
    """The example against the study's table, and its first data set against what Table 11 predicts for it.

    The published coefficients have three decimals: 5e-4 in each, times 1, 2.3, 6.2, 1.5 (and 7.2).
    """
    theirs, ours = read_study_table("table2_form_statistics"), pd.read_csv(TABLE_2)
    names = {"mu_FL": "mean_FL", "sigma_FL": "std_FL", "mu_EL": "mean_EL", "sigma_EL": "std_EL"}
    np.testing.assert_array_equal(ours[list(names.values())], theirs[list(names)])
    samples = read_samples(TABLE_2)
    assert len(samples) == 9 and all(sample.grains == 0 for sample in samples)
    fitted = fit_reference_models()
    predicted = read_study_table("table11_application").set_index("case").predicted
    for case, rounding in (("U1", 11.0), ("U7", 18.2)):
        table = predict_samples(samples, case, fitted)
        study = table[table.by == "study"].set_index("name")
        assert len(study) == 9
        assert study.n["Rhine"] == pytest.approx(predicted[case], abs=5e-4 * (rounding + 1))
        assert {name for name, text in study.outside.items() if text} == {"Kall", "rock aggregate"}


def test_the_grains_of_a_bed_give_what_their_statistics_give(reference, tmp_path):
    """Two samples in one file, and the second again by its means: EQ as of independence, and so its porosity."""
    rng = np.random.default_rng(0)
    flatness, elongation = np.meshgrid(rng.uniform(0.4, 0.9, 12), rng.uniform(0.5, 0.9, 12))
    flatness, elongation = flatness.ravel(), elongation.ravel()  # every pair: independent to the last digit
    bed = pd.DataFrame({"sample": "mixed", "L [mm]": 7 / elongation, "I [mm]": 7.0, "S [mm]": 7 * flatness})
    alike = pd.DataFrame({"sample": "alike", "L [mm]": [30.0, 15.0], "I [mm]": [20.0, 10.0], "S [mm]": [10.0, 5.0]})
    pd.concat([alike, bed]).to_csv(tmp_path / "grains.csv", index=False)
    means = {"mean_FL": flatness.mean(), "std_FL": flatness.std(), "mean_EL": elongation.mean()}
    pd.DataFrame([means | {"std_EL": elongation.std()}]).to_csv(tmp_path / "means.csv", index=False)
    fitted = fit_reference_models(reference)
    by_grain, by_mean = (
        predict_samples(read_samples(tmp_path / name), "U1", fitted) for name in ("grains.csv", "means.csv")
    )
    assert by_grain.groupby("name", sort=False).grains.first().to_dict() == {"alike": 2, "mixed": 144}
    np.testing.assert_allclose(by_grain.query("name == 'mixed'").n, by_mean.n, rtol=1e-9)
    assert by_grain.query("name == 'alike'").model.tolist() == ["single_form", "unified", "single_form"]


def test_a_campaigns_models_are_read_from_its_folder(tmp_path):
    flatness, elongation = grains(20)
    packings = pd.DataFrame({"case": "U7", "L": 1 / elongation, "I": 1.0, "S": flatness})
    packings["n"] = single_truth(flatness, elongation) + 1e-4 * np.random.default_rng(0).normal(size=20)
    tables, models = single_form_models(packings)
    dataset = models_dataset(models, tables["models"], "Models").assign_attrs(test_only=1)
    dataset.to_netcdf(tmp_path / "single_form.nc")
    fitted = read_campaign_models(tmp_path)
    assert fitted.models == {("single_form", "U7"): models["single_form", "U7"]}
    assert fitted.behind["single_form", "U7"] == f"20 beds, test only: {tmp_path / 'single_form.nc'}"
    row = predict_samples([one_form(0.6, 0.7)], "U7", fitted).iloc[0]
    assert row.lower < single_truth(0.6, 0.7) < row.upper
    with pytest.raises(ValueError, match="has no model in single_form.nc, form_mixture.nc, unified.nc"):
        read_campaign_models(tmp_path / "none")


def test_a_campaign_without_mixtures_leaves_a_file_that_can_be_read(tmp_path):
    tables, models = mixture_models(pd.DataFrame({"case": ["U1"] * 3, "n": [0.3, 0.4, 0.35], "mu_EQ_inv": [2.0, 3, 4]}))
    models_dataset(models, tables["models"], "Models").to_netcdf(tmp_path / "form_mixture.nc")
    with pytest.raises(ValueError, match="has no model in"):
        read_campaign_models(tmp_path)


def test_on_the_command_line(capsys, tmp_path):
    assert main(["predict", "--case", "U1", str(TABLE_2)]) == 0
    text = capsys.readouterr().out
    assert "railway ballast" in text and "* outside what the model was fitted to" in text
    assert "its Eq. 23" in text and "mixtures in " in text and "results/reference/" in text
    (tmp_path / "few.csv").write_text("sample,FL,EL\nA,0.6,0.7\nA,0.8,0.5\n")
    assert main(["predict", "--case", "U1", str(tmp_path / "few.csv")]) == 0
    assert "Fewer than 30 grains do not tell how widely form is spread: A." in capsys.readouterr().out
    assert main(["predict", "--case", "U1", str(TABLE_2), "--csv"]) == 0
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert [(row["sample"], row["by"], row["model"]) for row in rows[:3]] == [
        ("Rhine", "ours", "form_mixture"),
        ("Rhine", "ours", "unified"),
        ("Rhine", "study", "form_mixture"),
    ]
    assert len(rows) == 27
    assert main(["predict", "--case", "U1", str(TABLE_2), "--json", "--level", "0.5"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["case"], told["level"], len(told["samples"])) == ("U1", 0.5, 9)
    first = told["samples"][0]["predictions"]
    assert first[0]["n"] == pytest.approx(float(rows[0]["n"])) and first[2]["lower"] is None
    assert first[0]["upper"] - first[0]["lower"] < float(rows[0]["upper"]) - float(rows[0]["lower"])
    (tmp_path / "bad.csv").write_text("L,I,S\n1,2,3\n")
    assert main(["predict", "--case", "U1", str(tmp_path / "bad.csv")]) == 2
    told = capsys.readouterr().err
    assert told.startswith("simcore predict: ") and told.count("\n") == 1 and "bad.csv, row 2" in told
    assert main(["predict", "--case", "U1", str(TABLE_2), "--level", "95"]) == 2
    assert "level 95: a number between 0 and 1" in capsys.readouterr().err


def test_a_reader_that_has_seen_enough_is_no_error():
    words = [sys.executable, "-m", "simcore", "predict", "--case", "U1", str(TABLE_2)]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=ROOT) as run:
        run.stdout.close()
        assert run.stderr.read() == b""
    assert run.returncode == 141
