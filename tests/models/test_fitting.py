"""Models fitted to committed rows whose truth is given, and models from the files of a campaign."""

import numpy as np
import pandas as pd
import pytest

from simcore.models.files import models_dataset
from simcore.models.fitting import fit_reference_models, read_campaign_models
from simcore.models.mixtures import mixture_models
from simcore.models.prediction import predict_samples
from simcore.models.single_form import single_form_models
from tests.helpers.reference_rows import porosity_of_form, random_forms, random_mixtures, sample_of_one_form


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
    assert both.models["single_form", "U1"].scatter == pytest.approx(0.005, rel=0.3)  # half of the sources' difference
    with pytest.raises(ValueError, match="no grains of source clay; choose one of the sources: scans, synthetic"):
        fit_reference_models(reference, source="clay")
    with pytest.raises(ValueError, match="nor its default/ has tables"):
        fit_reference_models(reference / "none")


def test_models_are_fitted_to_the_committed_rows_by_default():
    fitted = fit_reference_models()
    assert {("single_form", "U1"), ("form_mixture", "U1"), ("unified", "U1")} <= set(fitted.models)
    for key in fitted.models:
        assert fitted.behind[key]


def test_what_a_campaign_has_not_finished_is_taken_from_the_default_one(reference, tmp_path):
    default = reference / "default"
    default.mkdir()
    flatness, elongation = random_forms(8, seed=3)
    table = pd.DataFrame({"case": "U1", "grain": [f"G{i}" for i in range(8)], "FL": flatness, "EL": elongation})
    table.assign(n=0.5 + 1e-6 * flatness).to_csv(default / "single_form.csv", index=False)
    beds = random_mixtures(seed=4).rename(columns={"mu_EQ": "EQ", "mu_EL": "EL"})
    asked = {name: np.arange(16) / 16 for name in ("mean_FL", "std_FL", "mean_EL", "std_EL")}
    beds = beds.assign(n=0.5 + 1e-6 * beds.EQ, **asked)
    beds.to_csv(default / "form_mixtures.csv", index=False)
    assert "default" not in " ".join(fit_reference_models(reference).behind.values())
    few = pd.read_csv(reference / "form_mixture.csv").head(5)
    few.to_csv(reference / "form_mixture.csv", index=False)
    fitted = fit_reference_models(reference)
    assert "default" not in fitted.behind["single_form", "U1"]
    assert "default" in fitted.behind["form_mixture", "U1"]
    assert fitted.models["form_mixture", "U1"].coefficients[0] == pytest.approx(0.5, abs=1e-5)
    # The unified model takes both kinds of bed from one campaign, the complete one.
    assert fitted.models["unified", "U1"].n_samples == 8 + 16


def test_a_case_of_the_default_campaign_alone_is_fitted_too(reference):
    default = reference / "default"
    default.mkdir()
    for name, source in (("single_form", "single_form"), ("form_mixtures", "form_mixture")):
        rows = pd.read_csv(reference / f"{source}.csv")
        pd.concat([rows, rows.assign(case="U7")]).to_csv(default / f"{name}.csv", index=False)
    fitted = fit_reference_models(reference)
    for name in ("single_form", "form_mixture", "unified"):
        assert "/default/" not in fitted.behind[name, "U1"] and "/default/" in fitted.behind[name, "U7"]
        assert fitted.models[name, "U7"].coefficients == fitted.models[name, "U1"].coefficients


def test_a_campaigns_models_are_read_from_its_folder(tmp_path):
    flatness, elongation = random_forms(20)
    packings = pd.DataFrame({"case": "U7", "L": 1 / elongation, "I": 1.0, "S": flatness})
    packings["n"] = porosity_of_form(flatness, elongation) + 1e-4 * np.random.default_rng(0).normal(size=20)
    tables, models = single_form_models(packings)
    dataset = models_dataset(models, tables["models"], "Models").assign_attrs(test_only=1)
    dataset.to_netcdf(tmp_path / "single_form.nc")
    fitted = read_campaign_models(tmp_path)
    assert fitted.models == {("single_form", "U7"): models["single_form", "U7"]}
    assert fitted.behind["single_form", "U7"] == f"20 beds, test only: {tmp_path / 'single_form.nc'}"
    row = predict_samples([sample_of_one_form(0.6, 0.7)], "U7", fitted).iloc[0]
    assert row.lower < porosity_of_form(0.6, 0.7) < row.upper
    (tmp_path / "bad.nc").write_text("no netCDF")
    with pytest.raises(ValueError, match=r"bad.nc cannot be read as a file of models \(.*\); give a netCDF file"):
        read_campaign_models(tmp_path / "bad.nc")
    with pytest.raises(ValueError, match="none: there is no such folder or file of models"):
        read_campaign_models(tmp_path / "none")
    (tmp_path / "empty").mkdir()
    with pytest.raises(ValueError, match="there is no model in single_form.nc, form_mixture.nc, unified.nc"):
        read_campaign_models(tmp_path / "empty")


def test_a_campaign_without_mixtures_leaves_a_file_that_can_be_read(tmp_path):
    tables, models = mixture_models(pd.DataFrame({"case": ["U1"] * 3, "n": [0.3, 0.4, 0.35], "mu_EQ_inv": [2.0, 3, 4]}))
    models_dataset(models, tables["models"], "Models").to_netcdf(tmp_path / "form_mixture.nc")
    with pytest.raises(ValueError, match="there is no model in"):
        read_campaign_models(tmp_path)
