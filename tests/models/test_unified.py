"""One model for one form and for distributions, on beds whose porosity is known."""

import logging

import numpy as np
import pandas as pd
import pytest

from simcore.grains.statistics import mixture_features
from simcore.models.unified import UNIFIED, UNIFIED_SETS, fit_unified, unified_features, unified_models

TRUTH = np.array([0.28, 0.03, 0.01, 0.08, 0.2])
STUDY = pd.DataFrame(
    {
        "model": ["single_form", "form_mixture"],
        "case": "U1",
        "intercept": [0.25, 0.35],
        "EQ_inv": [0.02, np.nan],
        "EL_inv": [0.01, np.nan],
        "mu_EQ_inv": [np.nan, 0.03],
        "sigma_EQ_inv": [np.nan, -0.003],
        "mu_EL_inv": [np.nan, 0.01],
        "sigma_EL_inv": [np.nan, np.nan],
    }
)


def truth(statistics):
    return TRUTH[0] + unified_features(statistics)[list(UNIFIED)].to_numpy() @ TRUTH[1:]


@pytest.fixture(scope="module")
def beds():
    """Return 30 forms and 24 mixtures about 12 mean forms, with two seeds each and a noise of 1e-4."""
    rng = np.random.default_rng(0)
    flatness, elongation = np.repeat(rng.uniform(0.35, 0.95, (2, 30)), 2, axis=1)
    forms = pd.DataFrame({"case": "U1", "L": 1 / elongation, "I": 1.0, "S": flatness})
    forms["grain"] = np.repeat([f"G{i}" for i in range(30)], 2)
    zero = {"sigma_EQ": 0.0, "sigma_EL": 0.0}
    forms["n"] = truth(pd.DataFrame({"mu_EQ": forms.S / forms.L, "mu_EL": 1 / forms.L, **zero}))
    rows = []
    for i, mean in enumerate(rng.uniform(0.45, 0.75, (12, 2))):
        for sigma in (0.05, 0.12):
            for _ in range(2):
                fl, el = np.clip(rng.normal(mean, rng.uniform(0.6, 1.0) * sigma, (200, 2)), 0.2, 1.0).T
                features = mixture_features(1 / el, np.ones(200), fl)
                rows.append(
                    {"case": "U1", "sample": f"{i} {sigma}", "mean_FL": mean[0], "mean_EL": mean[1], **features}
                )
    mixtures = pd.DataFrame(rows)
    mixtures["n"] = truth(mixtures)
    for table in (forms, mixtures):
        table["n"] += 1e-4 * rng.normal(size=len(table))
    return forms, mixtures


def test_its_coefficients_are_recovered(beds):
    model = fit_unified(*beds)["unified", "U1"]
    assert model.n_samples == 30 + 24
    # Four standard errors are allowed.
    assert np.all(np.abs(model.coefficients - TRUTH) < 4 * np.array(model.std_errors))
    assert np.all(np.array(model.std_errors) < [1e-3, 1e-3, 1e-3, 1e-2, 2e-2])


def test_it_becomes_the_model_of_one_form_as_the_width_goes_to_zero(beds):
    model = fit_unified(*beds)["unified", "U1"]
    widths = np.array([0.0, 1e-9, 1e-3, 1e-2, 1e-1])
    statistics = pd.DataFrame({"mu_EQ": 0.4, "sigma_EQ": widths, "mu_EL": 0.7, "sigma_EL": widths})
    features = unified_features(statistics)
    n = model.predict(features)
    b = model.coefficients
    assert n[0] == pytest.approx(b[0] + b[1] / 0.4 + b[2] / 0.7, rel=1e-12)
    # The difference is smooth: it is proportional to the square of the width.
    np.testing.assert_allclose((n - n[0])[2:] / widths[2:] ** 2, b[3] / 0.4**2 + b[4] / 0.7**2, rtol=1e-8)
    assert features.sigma_EQ_inv[0] == np.inf  # the feature of the model of Rettinger et al. in its place


def test_the_set_that_holds_the_truth_has_the_least_error(beds):
    tables, models = unified_models(*beds, STUDY)
    table = tables["feature_sets"]
    ours = table[table.model == "unified"].set_index("features")
    assert set(ours.index) == {" ".join(columns) for columns in UNIFIED_SETS}
    assert ours.mean_absolute_error.idxmin() == " ".join(UNIFIED)
    best = ours.loc[" ".join(UNIFIED)]
    assert (best.single_forms, best.form_mixtures, best.folds) == (30, 24, 10)
    # The noise is 1e-4/sqrt(2) over two seeds, its mean size 0.8 of that; 54 beds in 10 repeats are not independent.
    assert best.mean_absolute_error == pytest.approx(0.8e-4 / np.sqrt(2), rel=4 * 0.76 / np.sqrt(54))
    separate = table[table.model == "separate"].iloc[0]
    assert separate.form_mixture_error > 3 * best.form_mixture_error  # 1/sigma is not in the truth
    assert models["unified", "U1"].mean_absolute_error == best.mean_absolute_error
    assert models["unified", "U1"].error_of_mixtures == best.form_mixture_error != best.mean_absolute_error
    assert tables["models"].term.tolist() == ["intercept", *UNIFIED]


def test_r22_models_are_compared_as_published(beds):
    forms, mixtures = beds
    table = unified_models(*beds, STUDY)[0]["feature_sets"].set_index("model")
    means = forms.groupby("grain", sort=False)[["L", "I", "S", "n"]].mean()
    difference = 0.25 + 0.02 * means.L / means.S + 0.01 * means.L / means.I - means.n
    assert table.single_form_error["r22"] == pytest.approx(difference.abs().mean())
    many = mixtures.groupby("sample", sort=False)[["mu_EQ", "sigma_EQ", "mu_EL", "n"]].mean()
    many = 0.35 + 0.03 / many.mu_EQ - 0.003 / many.sigma_EQ + 0.01 / many.mu_EL - many.n
    assert table.form_mixture_error["r22"] == pytest.approx(many.abs().mean())
    assert table.bias["r22"] == pytest.approx(np.concatenate([difference, many]).mean())


def test_a_case_that_lacks_one_kind_is_left_out_with_a_message(beds, caplog):
    forms, mixtures = beds
    with caplog.at_level(logging.WARNING):
        tables, models = unified_models(forms, mixtures[mixtures["sample"].str.startswith(("0", "2"))].head(6))
    assert models == {} and "30 beds of one form and 3 mixtures are too few" in caplog.text
    assert tables["models"].empty and "term" in tables["models"]
    plain = [name for name in mixtures if not name.startswith(("mu_1/", "sigma_1/"))]
    with caplog.at_level(logging.WARNING):
        tables, _ = unified_models(forms, mixtures[plain])
    assert "the packings lack one of its columns" in caplog.text
    assert tables["feature_sets"].query("model == 'unified'").shape[0] == 5


def test_the_number_of_folds_is_that_of_the_argument(beds):
    table = unified_models(*beds, folds=4)[0]["feature_sets"]
    assert (table.folds.dropna() == 4).all()
