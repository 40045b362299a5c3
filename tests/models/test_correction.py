"""Corrections of a model and prediction intervals, compared with statsmodels and with draws of a known truth."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
import statsmodels.api as sm
from scipy.stats import norm
from scipy.stats import t as student

from simcore.models.correction import correct_model, regressors
from simcore.models.regression import fit

NAMES = ["EQ_inv", "EL_inv"]
TRUTH = np.array([0.27, 0.02, 0.015])


def random_forms(number, rng, low=(1.5, 1.1), high=(5.0, 2.2)):
    return pd.DataFrame(rng.uniform(low, high, (number, 2)), columns=NAMES)


def porosity(forms, coefficients=TRUTH):
    return coefficients[0] + forms.to_numpy() @ coefficients[1:]


def base_model(rng, number=40, scatter=0.005):
    forms = random_forms(number, rng)
    return fit(forms, porosity(forms) + scatter * rng.normal(size=number), "single_form", "U1")


def exact(base):
    """Return the same model with coefficients that have no error."""
    return replace(base, covariance=tuple(map(tuple, np.zeros((3, 3)))))


def intervals(model, forms, level):
    return np.array(model.predict_interval(forms, level))


def of_statsmodels(y, columns, new, level):
    frame = sm.OLS(y, columns).fit().get_prediction(new).summary_frame(alpha=1 - level)
    return frame[["mean", "obs_ci_lower", "obs_ci_upper"]].to_numpy().T


@pytest.mark.parametrize("level", [0.5, 0.95, 0.99])
@pytest.mark.parametrize("number", [4, 9, 30])
def test_prediction_intervals_are_those_of_statsmodels(number, level):
    rng = np.random.default_rng(number)
    forms = random_forms(number, rng)
    y = porosity(forms) + 0.005 * rng.normal(size=number)
    model = fit(forms, y)
    middle = forms.mean().to_numpy()
    new = pd.DataFrame(middle + 0.9 * (forms.to_numpy() - middle), columns=NAMES)
    expected = of_statsmodels(y, sm.add_constant(forms.to_numpy()), sm.add_constant(new.to_numpy()), level)
    np.testing.assert_allclose(intervals(model, new, level), expected, rtol=1e-10)


@pytest.mark.parametrize("level", [0.5, 0.95])
@pytest.mark.parametrize(("kind", "number"), [("offset", 3), ("offset", 20), ("rescaling", 6), ("rescaling", 20)])
def test_a_correction_of_an_exact_model_is_the_regression_of_statsmodels(kind, number, level):
    rng = np.random.default_rng(number)
    base = exact(base_model(rng))
    forms, new = random_forms(number, rng, (2, 1.2), (4, 2)), random_forms(5, rng, (2, 1.2), (4, 2))
    y = 0.01 + 1.1 * porosity(forms) + 0.004 * rng.normal(size=number)
    model, _ = correct_model(base, kind, forms, y, "measured", "U1")
    columns, added = regressors(kind, base.predict(forms))
    new_columns, new_added = regressors(kind, base.predict(new))
    expected = of_statsmodels(y - added, columns, new_columns, level) + new_added
    np.testing.assert_allclose(intervals(model, new, level), expected, rtol=1e-9)
    assert model.degrees_of_freedom == number - {"offset": 1, "rescaling": 2}[kind]
    assert (model.minimum, model.maximum) == (base.minimum, base.maximum)


def test_an_offset_is_the_mean_difference_with_one_degree_of_freedom_less():
    rng = np.random.default_rng(0)
    base = exact(base_model(rng))
    forms = random_forms(4, rng)
    difference = np.array([0.01, 0.02, 0.015, 0.005])
    model, result = correct_model(base, "offset", forms, base.predict(forms) + difference, "measured", "U1")
    assert result.coefficients[0] == pytest.approx(0.0125)
    assert model.scatter == pytest.approx(difference.std(ddof=1))
    np.testing.assert_allclose(np.subtract(model.coefficients, base.coefficients), [0.0125, 0, 0], atol=1e-14)
    n, lower, upper = model.predict_interval(forms)
    half = student.ppf(0.975, 3) * difference.std(ddof=1) * np.sqrt(1 + 1 / 4)
    np.testing.assert_allclose(upper - n, half)


def test_the_slopes_of_an_inexact_model_count_with_the_distance_from_the_beds():
    """The variance of an offset is scatter² (1 + 1/n) + (x - mean)ᵀ V (x - mean), with V of the slopes."""
    rng = np.random.default_rng(1)
    base = replace(base_model(rng), scatter_line=None)
    forms, new = random_forms(8, rng, (1.6, 1.15), (2.2, 1.3)), random_forms(6, rng)
    model, _ = correct_model(base, "offset", forms, porosity(forms) + 0.003 * rng.normal(size=8), "measured", "U1")
    away = new.to_numpy() - forms.mean().to_numpy()
    slopes = np.array(base.covariance)[1:, 1:]
    variance = model.scatter**2 * (1 + 1 / 8) + np.einsum("ni,ij,nj->n", away, slopes, away)
    inside = model.distance_outside(new) == 0
    n, _, upper = model.predict_interval(new)
    assert inside.sum() >= 4
    np.testing.assert_allclose((upper - n)[inside], (student.ppf(0.975, 7) * np.sqrt(variance))[inside])


def test_the_scatter_grows_as_that_of_the_model_that_is_corrected():
    """Beds of compact grains determine the scatter of long ones by the law of the model; it is scaled to these beds."""
    rng = np.random.default_rng(3)
    base = replace(exact(base_model(rng)), scatter=0.004, scatter_line=(-0.001, 0.002, 0.002, 0.0))
    forms = random_forms(4000, rng, (1.6, 1.15), (2.2, 1.3))
    own = 0.5 * (-0.001 + 0.002 * forms.EQ_inv)
    measured = base.predict(forms) + 0.01 + own * rng.normal(size=4000)
    model, _ = correct_model(base, "offset", forms, measured, "measured", "U1")
    np.testing.assert_allclose(model.scatter_line, (-0.0005, 0.001, 0.001, 0.0), rtol=0.05)
    n, _, upper = model.predict_interval(pd.DataFrame({"EQ_inv": [4.0], "EL_inv": [1.5]}))
    assert (upper - n).item() == pytest.approx(1.96 * 0.0035, rel=0.05)


@pytest.mark.parametrize("kind", ["offset", "rescaling"])
def test_errors_of_the_coefficients_are_those_of_repeated_fits_if_the_scatter_grows(kind):
    """With one scatter for all beds, the error of the factor would be a quarter too small."""
    rng = np.random.default_rng(7)
    base = replace(exact(base_model(rng)), scatter=0.004, scatter_line=(-0.003, 0.003, 0.001, 0.0))
    forms = random_forms(12, rng, (1.3, 1.1), (4.0, 1.8))
    own = np.maximum(-0.003 + 0.003 * forms.EQ_inv, 0.001)
    drawn = [
        correct_model(base, kind, forms, base.predict(forms) + own * rng.normal(size=12), "measured", "U1")[1]
        for _ in range(1500)
    ]
    found = np.std([each.coefficients for each in drawn], axis=0)
    stated = np.sqrt(np.mean([np.diag(each.covariance) for each in drawn], axis=0))
    np.testing.assert_allclose(stated, found, rtol=0.06)


@pytest.mark.parametrize("kind", ["offset", "rescaling"])
def test_intervals_for_forms_unlike_the_beds_contain_a_new_bed_as_often_as_stated(kind):
    """Without the uncertainty of the model's slopes, they would contain it less often.

    Each of 200 draws fits a model to 12 beds of all forms, corrects it by 30 nearly alike, and predicts one far away.
    The probability of one draw varies by less than a binomial one, whose standard error is 0.0154.
    """
    rng = np.random.default_rng(2)
    new = pd.DataFrame([[4.6, 1.3]], columns=NAMES)
    chances = {"with": [], "without": []}
    for _ in range(200):
        base = base_model(rng, 12, 0.01)
        base = replace(base, minimum=(1.0, 1.0), maximum=(6.0, 3.0))
        forms = random_forms(30, rng, (1.6, 1.5), (2.2, 1.8))
        n = 0.01 + porosity(forms) + 0.004 * rng.normal(size=30)
        expected = 0.01 + porosity(new)[0]
        for name, model in (("with", base), ("without", exact(base))):
            corrected, _ = correct_model(model, kind, forms, n, "measured", "U1")
            _, lower, upper = corrected.predict_interval(new)
            chances[name].append(norm.cdf((upper[0] - expected) / 0.004) - norm.cdf((lower[0] - expected) / 0.004))
    if kind == "offset":
        assert np.mean(chances["without"]) < 0.95 - 4 * 0.0154
    assert np.mean(chances["with"]) == pytest.approx(0.95, abs=4 * 0.0154)
    assert np.mean(chances["with"]) > np.mean(chances["without"])
