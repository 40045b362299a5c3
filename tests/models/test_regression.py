"""Correlation, screening, cross-validation and fit, on data whose result is given."""

import logging

import numpy as np
import pandas as pd
import pytest
import statsmodels.api as sm
from scipy.stats import norm
from sklearn.linear_model import LinearRegression
from sklearn.model_selection import GroupKFold

from simcore.grains.form import features as form_features
from simcore.models.regression import (
    LEAST_FOR_BOOTSTRAP,
    RESAMPLES,
    bootstrap,
    correlate,
    cross_validate,
    dependent,
    fit,
    fit_and_validate,
    predict_unseen,
    screen,
    usable_features,
)
from simcore.models.single_form import single_form_models


def forms(n, seed=0):
    """Return L, I, S of n grains with flatness and elongation spread over [0.35, 0.95]."""
    rng = np.random.default_rng(seed)
    flatness, elongation = rng.uniform(0.35, 0.95, (2, n))
    return 1.0 / elongation, np.ones(n), flatness


def test_known_coefficients_are_recovered_within_their_intervals():
    """Of 600 intervals (three coefficients, 200 data sets) 570 should contain the truth, with a binomial sd of 5.3."""
    truth, noise = np.array([0.278, 0.019, 0.014]), 0.006
    features = form_features(*forms(63))[["EQ_inv", "EL_inv"]]
    mean = truth[0] + features.to_numpy() @ truth[1:]
    rng = np.random.default_rng(1)
    hits, rmse = 0, []
    for _ in range(200):
        model = fit(features, mean + noise * rng.normal(size=63))
        hits += np.sum((np.array(model.lower) <= truth) & (truth <= np.array(model.upper)))
        rmse.append(model.rmse)
    assert abs(hits - 570) < 4 * 5.3
    # The mean square residual is noise² (n - 3)/n.
    assert np.mean(np.square(rmse)) == pytest.approx(noise**2 * 60 / 63, rel=4 * np.sqrt(2 / 60 / 200))


def test_exact_data_give_exact_coefficients_and_predictions():
    L, I, S = forms(20)
    features = form_features(L, I, S)[["EQ_inv", "EL_inv"]]
    n = 0.25 + 0.02 * features["EQ_inv"] - 0.01 * features["EL_inv"]
    model = fit(features, n, "single_form", "U1")
    np.testing.assert_allclose(model.coefficients, [0.25, 0.02, -0.01], rtol=1e-10)
    assert model.r_squared == pytest.approx(1.0) and model.rmse < 1e-14
    np.testing.assert_allclose(model.predict_form(L, I, S), n, rtol=1e-12)
    np.testing.assert_allclose(model.predict_form(1e-3 * L, 1e-3 * I, 1e-3 * S), n, rtol=1e-12)
    assert model.to_rows()["term"].tolist() == ["intercept", "EQ_inv", "EL_inv"]
    with pytest.raises(ValueError, match="lacks its feature EL_inv"):
        model.predict(features[["EQ_inv"]])


def test_cross_validated_errors_are_those_of_the_noise():
    """For normal errors E|e| = sqrt(2/pi) s and median |e| = 0.6745 s; s² is noise² to 3/3600."""
    rng = np.random.default_rng(2)
    n, noise = 4000, 0.005
    features = pd.DataFrame({"a": rng.normal(size=n), "b": rng.normal(size=n)})
    result = cross_validate(features, 0.3 + 0.01 * features["a"] + noise * rng.normal(size=n), repeats=1)
    assert result["mean_absolute_error"] == pytest.approx(np.sqrt(2 / np.pi) * noise, rel=4 * 0.76 / np.sqrt(n))
    assert result["median_absolute_error"] == pytest.approx(0.67449 * noise, rel=4 * 1.17 / np.sqrt(n))


def test_cross_validation_is_out_of_sample():
    """Pure noise on many features: the fit looks good, the error on unseen samples is larger than that of no model."""
    rng = np.random.default_rng(3)
    features = pd.DataFrame(rng.normal(size=(30, 20)))
    n = pd.Series(rng.normal(size=30))
    assert fit(features.set_axis([f"f{i}" for i in range(20)], axis=1), n).r_squared > 0.5
    assert cross_validate(features, n)["mean_absolute_error"] > n.abs().mean()


def test_few_samples_are_left_out_one_by_one():
    features = pd.DataFrame({"a": [0.0, 1.0, 2.0, 4.0]})
    n = np.array([0.1, 0.2, 0.4, 0.3])
    result = cross_validate(features, n)
    assert (result["folds"], result["repeats"]) == (4, 1)
    errors = []
    for i in range(4):
        rest = np.arange(4) != i
        slope, intercept = np.polyfit(features["a"][rest], n[rest], 1)
        errors.append(abs(intercept + slope * features["a"][i] - n[i]))
    assert result["mean_absolute_error"] == pytest.approx(np.mean(errors), rel=1e-10)
    assert result["median_absolute_error"] == pytest.approx(np.median(errors), rel=1e-10)


def test_cross_validation_depends_on_its_seed_alone():
    features = form_features(*forms(25))[["EQ_inv"]]
    n = np.random.default_rng(0).normal(size=25)
    assert cross_validate(features, n, seed=1) == cross_validate(features, n, seed=1)
    assert cross_validate(features, n, seed=1) != cross_validate(features, n, seed=2)


def test_features_that_are_not_finite_or_constant_are_left_out_with_a_message(caplog):
    L, I, S = (np.append(axis, 1.0) for axis in forms(10))  # the last is a sphere: DRI and OPI are 0/0
    features = form_features(L, I, S).assign(same=0.5)
    with caplog.at_level(logging.WARNING):
        kept = usable_features(features)
    assert set(features) - set(kept) == {"DRI", "DRI_inv", "OPI", "OPI_inv", "same"}
    assert "not finite for every row: DRI, OPI, DRI_inv, OPI_inv" in caplog.text
    assert "the same for all rows: same" in caplog.text


def test_correlation_and_screening():
    features = form_features(*forms(63))
    n = 0.5 - 0.1 * features["EQ_inv"]
    r = correlate(features, n)
    assert r["EQ_inv"] == pytest.approx(-1.0)
    assert r["EQ"] == pytest.approx(np.corrcoef(features["EQ"], n)[0, 1])
    kept = screen(features)
    assert kept[0] == "EQ_inv" and "EL_inv" in kept
    assert not {"EQ", "JFF_inv", "WFI", "CSF"} & set(kept)
    to_first = correlate(features, features["EQ_inv"]).abs()
    assert all((to_first[name] <= 0.8) == (name in kept) for name in features if name != "EQ_inv")


@pytest.mark.parametrize("function", [fit, cross_validate])
def test_too_few_samples_are_refused(function):
    features = pd.DataFrame({"a": [1.0, 2.0, 3.0], "b": [1.0, 0.0, 2.0]})
    with pytest.raises(ValueError, match="3 samples are too few"):
        function(features, [0.1, 0.2, 0.3])


@pytest.mark.parametrize("noise", [0.0, 1e-9])
def test_features_whose_effects_cannot_be_told_apart_are_refused(noise):
    x = np.random.default_rng(0).uniform(1.0, 3.0, 20)
    of_rods = pd.DataFrame({"EQ_inv": x, "EL_inv": x * (1.0 + noise * np.random.default_rng(1).normal(size=20))})
    with pytest.raises(ValueError, match="EQ_inv and EL_inv depend linearly on each other in all 20 samples"):
        fit(of_rods, 0.3 + 0.02 * x)
    assert dependent(pd.DataFrame({"x": x, "constant": np.full(20, 2.0)}))
    alike = pd.DataFrame({"EQ_inv": x, "EL_inv": x + 1e-3 * np.sin(100 * x)})
    assert not dependent(alike)
    assert fit(alike, alike @ [0.5, -0.3]).coefficients == pytest.approx([0.0, 0.5, -0.3], abs=1e-6)


def test_a_campaign_of_rods_alone_has_no_model_of_single_forms():
    long_axis = np.linspace(1.2, 3.0, 12)
    rods = pd.DataFrame({"case": "U1", "L": long_axis, "I": 1.0, "S": 1.0, "n": 0.3 + 0.02 * long_axis})
    with pytest.raises(ValueError, match="L/S depends linearly on L/I in all 12 packings, as for rods"):
        single_form_models(rods)


def test_equal_porosities_have_no_share_that_is_explained():
    features = pd.DataFrame({"x": np.arange(8.0)})
    assert np.isnan(fit(features, np.full(8, 0.1 + 0.2)).r_squared)


def test_a_prediction_interval_holds_a_new_form_as_often_as_it_says():
    """The probability that an interval contains a new porosity is exact for a fit; its mean over fits is the level."""
    rng = np.random.default_rng(5)
    truth, noise = np.array([0.278, 0.019, 0.014]), 0.006
    new = pd.DataFrame({"EQ_inv": [2.0, 8.0], "EL_inv": [1.4, 2.6]})  # amid the forms, and far outside them
    expected = truth[0] + new.to_numpy() @ truth[1:]
    features = form_features(*forms(12))[["EQ_inv", "EL_inv"]]
    for level in (0.8, 0.95):
        chance = []
        for _ in range(150):
            model = fit(features, truth[0] + features.to_numpy() @ truth[1:] + noise * rng.normal(size=12))
            n, lower, upper = model.predict_interval(new, level)
            np.testing.assert_allclose((lower + upper) / 2, n, rtol=1e-12)
            # The probability is computed for both forms, and that of the first is compared with the level.
            chance.append(norm.cdf((upper - expected) / noise) - norm.cdf((lower - expected) / noise))
        amid = np.array(chance)[:, 0]
        assert amid.mean() == pytest.approx(level, abs=4 * amid.std() / np.sqrt(150))
    # Far outside the forms, the errors of the coefficients widen the interval.
    widths = upper - lower
    assert widths[1] > 1.2 * widths[0]


def test_what_lies_outside_the_fit_is_named():
    features = form_features(*forms(20))[["EQ_inv", "EL_inv"]]
    model = fit(features, 0.3 + 0.01 * features["EQ_inv"] + 1e-3 * np.random.default_rng(0).normal(size=20))
    low, high = features.min(), features.max()
    assert model.outside(features) == [[]] * 20
    inside, one, both = model.outside(
        pd.DataFrame({"EQ_inv": [low["EQ_inv"], 0.5, 50.0], "EL_inv": [high["EL_inv"], high["EL_inv"], 9.0]})
    )
    assert inside == []
    assert one == [("EQ_inv", 0.5, low["EQ_inv"], high["EQ_inv"])]
    assert [name for name, *_ in both] == ["EQ_inv", "EL_inv"]


def test_the_bootstrap_includes_scatter_that_grows():
    """The deviations of the draws are the sandwich estimate's to 1/sqrt(2 RESAMPLES) = 1.6 % and the order of 3/400."""
    rng = np.random.default_rng(6)
    features = pd.DataFrame({"a": rng.uniform(1.0, 5.0, 400), "b": rng.normal(size=400)})
    n = 0.3 + 0.01 * features["a"] + 1e-3 * features["a"] ** 2 * rng.normal(size=400)
    drawn = bootstrap(features, n, seed=3)
    assert drawn.shape == (RESAMPLES, 3)
    ols = sm.OLS(n.to_numpy(), sm.add_constant(features.to_numpy())).fit()
    np.testing.assert_allclose(drawn.std(axis=0), ols.HC0_se, rtol=4 * 0.016 + 3 / 400)
    assert ols.HC0_se[1] > 1.1 * ols.bse[1]  # least squares alone underestimates it
    np.testing.assert_array_equal(bootstrap(features, n, seed=3), drawn)
    model = fit(features, n)
    assert model.bootstrap_upper[1] - model.bootstrap_lower[1] > 1.1 * (model.upper[1] - model.lower[1])


def test_draws_that_carry_no_model_are_left_out():
    """Draws without the one row that differs have no slope: (4/5)^5 = 0.328 of all, binomial with sd 21."""
    drawn = bootstrap(pd.DataFrame({"a": [0.0, 0.0, 0.0, 0.0, 1.0]}), [0.3, 0.31, 0.29, 0.3, 0.4])
    assert abs(len(drawn) - 0.672 * RESAMPLES) < 4 * 21
    assert np.abs(drawn).max() < 1.0


def test_few_samples_have_no_intervals_of_a_bootstrap():
    features = pd.DataFrame({"a": np.arange(LEAST_FOR_BOOTSTRAP) ** 2.0})
    n = 0.3 + 0.01 * np.sin(features["a"])
    assert np.isfinite(fit(features, n).bootstrap_lower).all()
    few = fit(features[1:], n[1:])
    assert np.isnan(few.bootstrap_lower).all() and np.isnan(few.bootstrap_upper).all() and np.isfinite(few.lower).all()


@pytest.mark.parametrize("dependent_columns", [False, True])
def test_predictions_have_the_bits_of_sklearn(dependent_columns):
    rng = np.random.default_rng(8)
    X = rng.uniform(1.0, 4.0, (40, 3))
    if dependent_columns:
        X[:, 2] = X[:, 0] - X[:, 1]
    y = 0.3 + X @ [0.02, 0.01, 0.0] + 0.005 * rng.standard_normal(40)
    predicted, folds = predict_unseen(pd.DataFrame(X), y, repeats=3, seed=5)
    assert folds == 10
    expected = np.empty_like(predicted)
    for repeat in range(3):
        for train, test in GroupKFold(10, shuffle=True, random_state=5 + repeat).split(X, y, np.arange(40)):
            expected[repeat, test] = LinearRegression().fit(X[train], y[train]).predict(X[test])
    np.testing.assert_array_equal(predicted, expected)


def test_a_group_is_left_out_whole():
    x = np.repeat([0.0, 1.0, 2.0, 4.0, 5.0], 2) + np.tile([0.0, 0.3], 5)
    y = np.repeat([0.1, 0.5, 0.2, 0.9, 0.4], 2)
    groups = np.repeat(list("abcde"), 2)
    predicted, folds = predict_unseen(pd.DataFrame({"x": x}), y, groups=groups)
    assert folds == 5 and predicted.shape == (1, 10)
    for group in "abcde":
        rest = groups != group
        np.testing.assert_allclose(predicted[0, ~rest], np.polyval(np.polyfit(x[rest], y[rest], 1), x[~rest]))
    model = fit_and_validate(pd.DataFrame({"x": x}), y, groups=groups)
    assert model.mean_absolute_error == pytest.approx(np.abs(predicted[0] - y).mean())
    assert model.mean_absolute_error > cross_validate(pd.DataFrame({"x": x}), y)["mean_absolute_error"]
