"""The tables of Rettinger et al. (2022) from synthetic packings, beside values made up for the paper."""

import logging

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from simcore.grains.statistics import equancy_statistics, flatness_statistics, mixture_features
from simcore.models.files import models_dataset, read_models, table_dataset
from simcore.models.mixtures import FEWEST_MEANS, MIXTURE, application_table, mixture_models
from simcore.models.regression import fit_and_validate
from simcore.models.shape_kinds import shape_kind_table
from simcore.models.single_form import single_form_models
from simcore.models.tables import over_seeds

SINGLE = {"U1": (0.278, 0.019, 0.014), "B50": (0.217, 0.014, -0.006)}


@pytest.fixture(scope="module")
def single_form_packings():
    rng = np.random.default_rng(0)
    parts = []
    for case, (b0, b1, b2) in SINGLE.items():
        flatness, elongation = rng.uniform(0.35, 0.95, (2, 40))
        n = b0 + b1 / (flatness * elongation) + b2 / elongation + 1e-4 * rng.normal(size=40)
        parts.append(pd.DataFrame({"case": case, "L": 1 / elongation, "I": 1.0, "S": flatness, "n": n}))
    return pd.concat(parts, ignore_index=True)


@pytest.fixture(scope="module")
def mixture_packings():
    rng = np.random.default_rng(1)
    rows = []
    for _ in range(20):
        mu = rng.uniform(0.45, 0.75, 2)
        sigma = rng.uniform(0.05, 0.12, 2)
        flatness, elongation = np.clip(rng.normal(mu, sigma, (300, 2)), 0.2, 0.99).T
        features = mixture_features(1 / elongation, np.ones(300), flatness)
        n = 0.287 + 0.032 * features["mu_EQ_inv"] - 0.003 * features["sigma_EQ_inv"] + 0.011 * features["mu_EL_inv"]
        rows.append({"case": "U1", "n": n + 1e-5 * rng.normal(), **features})
    return pd.DataFrame(rows)


def test_single_form_tables_are_compared_with_r22(single_form_packings):
    r22_r = pd.DataFrame({"study": "single_form", "case": ["U1"], "feature": ["EQ_inv"], "r": [0.964]})
    r22_errors = pd.DataFrame({"case": ["U1"], "EQ_inv": [5.74], "EL_inv": [4.66]})
    r22_models = pd.DataFrame(
        {
            "model": "single_form",
            "case": ["U1"],
            "intercept": [0.278],
            "EQ_inv": [0.019],
            "EL_inv": [0.014],
            "mu": [np.nan],
        }
    )
    tables, models = single_form_models(single_form_packings, r22_r, r22_errors, r22_models)
    for case, truth in SINGLE.items():
        model = models["single_form", case]
        np.testing.assert_allclose(model.coefficients, truth, atol=5e-4)
        assert np.all(np.abs(np.subtract(model.coefficients, truth)) < 4 * np.array(model.std_errors))
    for _, of_case in tables["correlations"].groupby("case"):
        assert of_case["r"].abs().is_monotonic_decreasing
    r = tables["correlations"].set_index(["case", "feature"])
    assert r.loc[("U1", "EQ_inv"), "r22_r"] == 0.964 and r.loc[("U1", "EQ_inv"), "kept"]
    assert np.isnan(r.loc[("B50", "EQ_inv"), "r22_r"]) and not r.loc[("U1", "EQ"), "kept"]
    errors = tables["second_features"].set_index(["case", "feature"])
    assert errors.loc[("U1", "EL_inv"), "r22_error"] == pytest.approx(4.66e-3)
    # The data depend on EL_inv, so its error is that of the noise, sqrt(2/pi) 1e-4, and the least of all.
    assert errors.loc["U1"]["mean_absolute_error"].idxmin() == "EL_inv"
    assert errors.loc[("U1", "EL_inv"), "mean_absolute_error"] == pytest.approx(8e-5, rel=0.5)
    assert errors.loc[("U1", "EQ_inv"), "mean_absolute_error"] > 1e-3
    rows = tables["models"].set_index(["model", "case", "term"])
    assert rows.loc[("single_form", "U1", "EL_inv"), "r22_coefficient"] == 0.014


def test_a_case_with_few_packings_is_left_out_with_a_message(single_form_packings, caplog):
    few = pd.concat([single_form_packings.query("case == 'U1'"), single_form_packings.query("case == 'B50'").head(4)])
    with caplog.at_level(logging.WARNING):
        _, models = single_form_models(few)
    assert {case for _, case in models} == {"U1"}
    assert "case B50 is left out: it has 4 packings" in caplog.text
    with pytest.raises(ValueError, match="no case has the 5 packings"):
        single_form_models(few.query("case == 'B50'"))


def test_forms_that_do_not_differ_are_refused(single_form_packings):
    same = single_form_packings.assign(L=2.0, I=1.0, S=0.5)
    with pytest.raises(ValueError, match="EQ_inv, EL_inv is the same"):
        single_form_models(same)


@pytest.mark.parametrize("means", [FEWEST_MEANS - 1, FEWEST_MEANS])
def test_sets_of_one_mean_form_are_left_out_of_a_mixture_model_together(mixture_packings, means):
    """With too few mean forms, those that remain hardly determine the coefficients; each set is then left out alone."""
    specified = mixture_packings.assign(mean_FL=np.arange(20) % means / 10.0, mean_EL=0.7)
    tables, models = mixture_models(specified)
    assert not {"mean_FL", "mean_EL"} & set(tables["correlations"]["feature"])
    groups = specified["mean_FL"] if means == FEWEST_MEANS else None
    expected = fit_and_validate(mixture_packings[list(MIXTURE)], specified["n"], "form_mixture", "U1", groups=groups)
    assert models["form_mixture", "U1"] == expected
    plain, _ = mixture_models(mixture_packings)
    pd.testing.assert_frame_equal(plain["feature_sets"], tables["feature_sets"])


def test_mixture_models_recover_their_coefficients(mixture_packings):
    study = pd.DataFrame(
        {
            "mu_EQ_inv": [1, 1],
            "sigma_EQ_inv": [0, 1],
            "mu_EL_inv": [0, 1],
            "sigma_EL_inv": [0, 1],
            "U1_mae_1e-3": [6.93, 4.33],
            "U1_R2": [0.939, 0.98],
            "U7_mae_1e-3": [5.94, 5.33],
            "U7_R2": [0.867, 0.914],
        }
    )
    tables, models = mixture_models(mixture_packings, r22_sets=study)
    model = models["form_mixture", "U1"]
    np.testing.assert_allclose(model.coefficients, [0.287, 0.032, -0.003, 0.011, 0.0], atol=2e-4)
    sets = tables["feature_sets"]
    assert len(sets) == 6
    assert sets["r_squared"].iloc[3] == sets["r_squared"].max()
    assert sets["r22_error"].dropna().tolist() == pytest.approx([6.93e-3, 4.33e-3])
    table = application_table(
        models,
        mixture_packings.iloc[:2].assign(kind=["continuous", "discrete"]),
        pd.DataFrame(
            {
                "case": ["U1"],
                "predicted": [0.356],
                "continuous_simulated": [0.356],
                "continuous_abs_error_1e-3": [0.04],
                "discrete_simulated": [0.353],
                "discrete_abs_error_1e-3": [3.29],
            }
        ),
    )
    assert table["abs_error"].max() < 1e-4
    assert table["r22_simulated"].tolist() == [0.356, 0.353]


def test_a_set_that_packings_do_not_carry_is_left_out_with_a_message(mixture_packings, caplog):
    with caplog.at_level(logging.WARNING):
        tables, models = mixture_models(mixture_packings.iloc[:5])
    assert "is left out: 5 packings are too few" in caplog.text
    assert len(tables["feature_sets"]) == 3 and models == {}


def test_mixture_features_are_104_statistics_over_the_grains():
    L, I, S = np.array([4.0, 3.0]), np.array([2.0, 2.0]), np.array([1.0, 1.5])
    features = mixture_features(L, I, S)
    assert len(features) == 104 and features.index.is_unique
    assert features["mu_EQ"] == pytest.approx(0.375) and features["mu_EQ_inv"] == pytest.approx(1 / 0.375)
    assert features["sigma_EQ"] == pytest.approx(0.125)
    assert features["mu_1/EQ"] == pytest.approx(3.0) and features["mu_1/EQ_inv"] == pytest.approx(1 / 3)


def test_equancy_of_independent_flatness_and_elongation():
    rng = np.random.default_rng(0)
    n = 400000
    product = rng.normal(0.65, 0.17, n) * rng.normal(0.68, 0.14, n)
    mean, std = equancy_statistics(0.65, 0.17, 0.68, 0.14)
    assert product.mean() == pytest.approx(mean, abs=4 * std / np.sqrt(n))
    assert product.std() == pytest.approx(std, rel=4 * 0.8 / np.sqrt(n))


def test_statistics_of_flatness_follow_from_those_of_equancy():
    equancy = equancy_statistics(0.65, 0.17, 0.68, 0.14)
    assert flatness_statistics(*equancy, 0.68, 0.14) == pytest.approx((0.65, 0.17), abs=1e-12)


def test_mesh_and_ellipsoid_differ_by_their_rms():
    packings = pd.DataFrame({"case": ["U1", "U1"], "n_mesh": [0.40, 0.36], "n_ellipsoid": [0.39, 0.38]})
    table = shape_kind_table(packings, pd.DataFrame({"case": ["U1"], "rms_difference": [0.0087]}))
    assert table["rms_difference"][0] == pytest.approx(np.sqrt(2.5e-4))
    assert table["mean_difference"][0] == pytest.approx(-0.005)
    assert table["r22_rms_difference"][0] == 0.0087


def test_tables_survive_netcdf(tmp_path, single_form_packings):
    tables, _ = single_form_models(single_form_packings)
    for name, table in tables.items():
        table_dataset(table, name).to_netcdf(tmp_path / "table.nc")
        with xr.open_dataset(tmp_path / "table.nc") as dataset:
            assert dataset["case"].values.tolist() == table["case"].tolist()
            column = "r" if name == "correlations" else table.columns[3]
            np.testing.assert_array_equal(dataset[column].values, table[column])


def test_models_come_back_from_netcdf_whole(tmp_path, single_form_packings):
    tables, models = single_form_models(single_form_packings)
    models_dataset(models, tables["models"], "Models").to_netcdf(tmp_path / "models.nc")
    assert read_models(tmp_path / "models.nc") == models
    table_dataset(tables["models"], "Models").to_netcdf(tmp_path / "old.nc")
    with pytest.raises(ValueError, match="old.nc: these models were written without covariances"):
        read_models(tmp_path / "old.nc")


def test_the_table_of_models_holds_intervals_errors_and_ranges(single_form_packings):
    tables, models = single_form_models(single_form_packings)
    rows = tables["models"].query("model == 'single_form' and case == 'U1'").set_index("term")
    assert (rows.bootstrap_lower_95 < rows.coefficient).all() and (rows.coefficient < rows.bootstrap_upper_95).all()
    u1 = single_form_packings.query("case == 'U1'")
    assert rows.feature_max["EQ_inv"] == pytest.approx((u1.L / u1.S).max())
    assert rows.feature_min["EL_inv"] == pytest.approx((u1.L / u1.I).min())
    assert np.isnan(rows.feature_min["intercept"])
    errors = tables["second_features"].set_index(["case", "feature"]).loc[("U1", "EL_inv")]
    assert rows.mean_absolute_error["EQ_inv"] == errors.mean_absolute_error
    assert rows.median_absolute_error["EQ_inv"] == errors.median_absolute_error


def test_sets_of_one_mean_form_stay_together_after_the_mean_over_seeds():
    """The mean of three 0.7 is not 0.7, so that sets with one and with three seeds would have different means."""
    assert np.mean([0.7] * 3) != 0.7
    rows = pd.DataFrame(
        {"case": "U1", "set": ["a", "b", "b", "b"], "mean_FL": 0.7, "mean_EL": 0.8, "n": 0.4, "faces": 9}
    )
    means = over_seeds(rows, "set")
    assert means.groupby(["mean_FL", "mean_EL"]).ngroups == 1 and means.n.tolist() == [0.4, 0.4]


def test_seeds_of_a_form_are_no_forms(single_form_packings):
    once = single_form_packings.assign(grain=[f"G{i % 40}" for i in range(80)])
    noise = 0.01 * np.random.default_rng(0).normal(size=80)
    seeds = pd.concat([once.assign(n=once.n + noise), once.assign(n=once.n - noise)])
    assert len(over_seeds(seeds, "grain")) == 80
    averaged, plain = single_form_models(seeds)[1], single_form_models(single_form_packings)[1]
    for key, model in plain.items():
        assert averaged[key].n_samples == model.n_samples == 40
        np.testing.assert_allclose(averaged[key].coefficients, model.coefficients, rtol=1e-9)
        np.testing.assert_allclose(averaged[key].std_errors, model.std_errors, rtol=1e-6)


def test_the_number_of_folds_is_that_of_the_argument(single_form_packings, mixture_packings):
    for folds in (4, 10):
        errors = single_form_models(single_form_packings, folds=folds)[0]["second_features"]
        assert (errors.folds == folds).all()
        assert (mixture_models(mixture_packings, folds=folds)[0]["feature_sets"].folds == folds).all()
    few, many = (single_form_models(single_form_packings, folds=folds)[1]["single_form", "U1"] for folds in (2, 10))
    assert few.coefficients == many.coefficients and few.mean_absolute_error != many.mean_absolute_error
