"""Prediction for measured grains: rows with a given truth, the data sets of Rettinger et al., and refusals."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.stats import t as student

from simcore.grains.measured_forms import Sample, read_samples
from simcore.models.fitting import fit_reference_models
from simcore.models.prediction import predict_samples
from simcore.models.prediction_text import describe
from simcore.models.regression import fit
from simcore.reference.r22_tables import read_r22_table
from tests.helpers.reference_rows import porosity_of_form, random_mixtures, sample_of_one_form

TABLE_2 = Path(__file__).resolve().parents[2] / "examples" / "table2.csv"


def test_one_form_and_a_distribution_take_their_own_models(reference):
    fitted = fit_reference_models(reference, source="synthetic")
    narrow = Sample("narrow", 50, 0.6, 0.01, 0.7, 0.01, 0.42, 0.01)
    wide = Sample("wide", 50, 0.6, 0.15, 0.7, 0.15, 0.42, 0.12)
    table = predict_samples([sample_of_one_form(0.6, 0.7), narrow, wide], "U1", fitted)
    ours = table[table.preferred].set_index("name")
    assert ours.model.to_dict() == {"one": "single_form", "narrow": "unified", "wide": "form_mixture"}
    assert ours.kind_of_bed.to_dict() == {
        "one": "one form",
        "narrow": "a distribution of form",
        "wide": "a distribution of form",
    }
    assert ours.n["one"] == pytest.approx(porosity_of_form(0.6, 0.7), rel=1e-9)
    assert ours.n["wide"] == pytest.approx(0.31 + 0.03 / 0.42 - 0.003 / 0.12 + 0.02 / 0.7 - 0.002 / 0.15, rel=1e-8)
    mixture = table.query("name == 'narrow' and by == 'ours' and model == 'form_mixture'").iloc[0]
    assert "1/std. dev. EQ = 100, fitted from" in mixture.outside
    # The unified model is continuous where the model of Rettinger et al. diverges.
    unified = table.query("model == 'unified'").set_index("name").n
    assert unified["narrow"] == pytest.approx(unified["one"], abs=1e-3)
    study = table.query("name == 'narrow' and by == 'r22'").iloc[0]
    assert study.model == "single_form" and "below 0.05: taken for one form" in study.outside
    assert study.n == pytest.approx(0.278 + 0.019 / 0.42 + 0.014 / 0.7)


def test_of_our_models_the_one_that_errs_less_is_taken(reference):
    """The mixtures scatter about the truth of the unified model."""
    rows = random_mixtures()
    rows["n"] = 0.30 + 0.02 / rows.mu_EQ + 0.01 / rows.mu_EL + 0.2 * (rows.sigma_EL / rows.mu_EL) ** 2
    committed = pd.read_csv(reference / "form_mixture.csv").assign(n=rows.n)
    committed.to_csv(reference / "form_mixture.csv", index=False)
    wide = Sample("wide", 50, 0.6, 0.15, 0.7, 0.15, 0.42, 0.12)
    table = predict_samples([wide], "U1", fit_reference_models(reference, source="synthetic"))
    assert table[table.preferred].model.tolist() == ["unified"]


def test_a_size_class_is_u1_and_an_unknown_case_is_refused(reference):
    fitted = fit_reference_models(reference)
    one = [sample_of_one_form(0.6, 0.7)]
    pd.testing.assert_frame_equal(predict_samples(one, "one-class", fitted), predict_samples(one, "U1", fitted))
    alone = predict_samples(one, "B50", fitted)
    assert alone.by.tolist() == ["r22"]
    assert alone.n.item() == pytest.approx(0.217 + 0.014 / 0.42 - 0.006 / 0.7)
    wide = Sample("wide", 50, 0.6, 0.15, 0.7, 0.15, 0.42, 0.12)
    both = predict_samples([*one, wide], "B50", fitted)
    pd.testing.assert_frame_equal(both[both.name != "wide"], alone)
    row = both[both.name == "wide"].squeeze()
    assert (row.by, row.model, row.preferred) == ("", "", False) and np.isnan(row.n)
    assert row.refused.startswith("no model was fitted to beds of B50 with a distribution of form, only to beds with")
    lines = describe(both, "B50", fitted).splitlines()
    assert lines[1] == (
        "Only the model of Rettinger et al. is used: ours were fitted to U1, not to B50. For an interval, use predict "
        "--sieve B50, whose model is valid for one form and for distributions."
    )
    assert lines[2].startswith(f"Not predicted: wide; {row.refused}. For these, use predict --sieve B50, ")
    assert lines[3] == "" and not any(line.startswith("- not evaluated") for line in lines)
    models = lines[lines.index("Models") + 1 :]
    assert models[0].startswith("  Rettinger et al. single_form: n =") and models[1] == ""
    with pytest.raises(ValueError, match="case B50: the porosity of sample wide cannot be predicted.*predict --sieve"):
        predict_samples([wide], "B50", fitted)
    far = sample_of_one_form(0.05, 0.7)
    with pytest.raises(ValueError, match=f"For {far.name} no model is evaluated: Rettinger et al. single_form: "):
        predict_samples([wide, far], "B50", fitted)
    with pytest.raises(ValueError, match="case B30: there is no model for it; choose one of B50, U1, U7, one-class"):
        predict_samples(one, "B30", fitted)


def test_what_lies_outside_is_said_of_ours_and_of_r22(reference):
    """Just outside the range a note is given and the interval is wider; far outside nothing is predicted."""
    fitted = fit_reference_models(reference)
    inside, outside = (
        predict_samples([sample_of_one_form(*form)], "U1", fitted) for form in ((0.65, 0.7), (0.28, 0.5))
    )
    assert (inside.outside == "").all() and (inside.distance == 0).all()
    single, unified, study = outside.outside
    assert "L/S = 7.143, fitted from" in single and "1/mean EQ = 7.143" in unified
    assert study == "mean FL = 0.28, fitted from 0.297 to 0.997"
    width = outside.upper - outside.lower
    assert width[0] > 1.1 * (inside.upper - inside.lower)[0]
    with pytest.raises(ValueError, match=r"case U1: the porosity of sample one cannot be predicted. For one no model"):
        predict_samples([sample_of_one_form(0.2, 0.3)], "U1", fitted)


def random_samples(number, seed=0):
    """Return samples over all forms that a table may contain, many of them equal or nearly so."""
    rng = np.random.default_rng(seed)
    samples = []
    for i in range(number):
        grains = int(rng.integers(1, 12))
        centre, spread = rng.uniform(0.03, 1, 2), 10 ** rng.uniform(-6, 0, 2)
        FL, EL = np.clip(centre + spread * rng.normal(size=(grains, 2)), 0.02, 1).T
        statistics = [f(x) for x in (FL, EL, FL * EL) for f in (np.mean, np.std)]
        samples.append(Sample(f"s{i}", grains, *map(float, statistics)))
    return samples


def test_every_number_is_a_porosity_and_every_refusal_has_its_reason(reference):
    fitted = fit_reference_models(reference)
    answers = refusals = not_evaluated = 0
    for sample in random_samples(400):
        try:
            table = predict_samples([sample], "U1", fitted)
        except ValueError as error:
            refusals += 1
            assert f"sample {sample.name} cannot be predicted" in str(error) and "\n" not in str(error)
            continue
        answers += 1
        evaluated = table[table.refused == ""]
        numbers = evaluated[["n", "lower", "upper"]].to_numpy()
        assert np.isfinite(evaluated.n).all() and len(evaluated)
        assert ((numbers > 0) & (numbers < 1) | np.isnan(numbers)).all()
        ours = evaluated[evaluated.by == "ours"]
        assert (ours.lower < ours.n).all() and (ours.n < ours.upper).all()
        assert (evaluated.distance <= 0.5).all()
        refused = table[table.refused != ""]
        not_evaluated += len(refused)
        assert refused[["n", "lower", "upper"]].isna().all(axis=None) and not refused.preferred.any()
        assert ((refused.distance > 0.5) | refused.refused.str.contains("outside (0, 1)", regex=False)).all()
    assert min(answers, refusals, not_evaluated) > 50


def test_an_interval_grows_with_distance_and_by_the_rule_beyond_a_tenth(reference):
    """Points along rays from the middle of the fit are compared with least squares written out."""
    rng = np.random.default_rng(0)
    X = pd.DataFrame({"EQ_inv": rng.uniform(1.5, 5, 40), "EL_inv": rng.uniform(1.1, 2.5, 40)})
    y = 0.3 + 0.02 * X.EQ_inv + 0.01 * X.EL_inv + 0.005 * rng.normal(size=40)
    model = fit(X, y)
    A = np.column_stack([np.ones(40), X])
    residual = y - A @ np.linalg.lstsq(A, y)[0]
    scatter, inverse = np.sqrt(residual @ residual / 37), np.linalg.inv(A.T @ A)
    middle, low, high = X.mean().to_numpy(), X.min().to_numpy(), X.max().to_numpy()
    factors = []
    for angle in np.linspace(0, 2 * np.pi, 16, endpoint=False):
        rays = middle + np.linspace(0, 1, 60)[:, None] * (high - low) * [np.cos(angle), np.sin(angle)]
        n, lower, upper = model.predict_interval(pd.DataFrame(rays, columns=X.columns))
        assert (np.diff(upper - lower) > 0).all()
        B = np.column_stack([np.ones(60), rays])
        leverage = np.einsum("ni,ij,nj->n", B, inverse, B)
        half = student.ppf(0.975, 37) * scatter * np.sqrt(1 + leverage)
        distance = np.maximum(np.maximum(low - rays, rays - high) / (high - low), 0).max(axis=1)
        expected = half * np.where(distance > 0.1, 1 + 1.5 * (distance - 0.1), 1)
        np.testing.assert_allclose(upper - n, expected, rtol=1e-9)
        factors.append((distance > 0.1).sum())
    assert sum(factors) > 100


def test_the_models_of_r22_follow_the_same_rule(reference):
    """The published ranges of FL, EL and deviations are extended by half a width; 1/sigma is not evaluated near 0."""
    fitted = fit_reference_models(reference)

    def refused(mu_FL, sigma_FL, mu_EL, sigma_EL):
        mu_EQ = mu_FL * mu_EL
        sigma_EQ = np.sqrt((mu_FL**2 + sigma_FL**2) * (mu_EL**2 + sigma_EL**2) - mu_EQ**2)
        sample = Sample("s", 0, mu_FL, sigma_FL, mu_EL, sigma_EL, mu_EQ, sigma_EQ)
        return predict_samples([sample], "U1", fitted).set_index("by").loc["r22", "refused"]

    assert refused(0.6, 0.15, 0.6, 0.15) == ""
    assert refused(0.6, 0.051, 0.6, 0.15) == ""
    assert "std. dev. FL = 0.049 is below 0.05" in refused(0.6, 0.049, 0.6, 0.15)
    assert refused(0.6, 0.15, 0.6, 0.249) == ""
    assert "std. dev. EL = 0.251 is above 0.25" in refused(0.6, 0.15, 0.6, 0.251)
    assert refused(0.3, 0.15, 0.6, 0.15) == ""
    # The means of FL and EL are within reach of their ranges, but their product is not; ours have no answer either.
    with pytest.raises(ValueError, match="Rettinger et al. form_mixture: 1/mean EQ = 12.5 is above 8.59, fitted from"):
        refused(0.25, 0.1, 0.32, 0.1)
    # All grains have the same EQ, although FL and EL differ.
    sample = Sample("s", 2, 0.65, 0.15, 0.65, 0.15, 0.4, 0.0)
    table = predict_samples([sample], "U1", fitted).set_index(["by", "model"])
    assert "1/std. dev. EQ = inf is above" in table.loc[("r22", "form_mixture"), "refused"]
    assert table.preferred.sum() == table.preferred[("ours", "unified")] == 1


def test_a_formula_or_an_interval_that_leaves_0_to_1_is_refused(reference):
    fitted = fit_reference_models(reference)
    sample = sample_of_one_form(0.6, 0.7)
    narrow = predict_samples([sample], "U1", fitted)
    assert (narrow.refused == "").all()
    rows = pd.read_csv(reference / "single_form.csv")
    rows.assign(n=rows.n + 0.2 * np.random.default_rng(0).normal(size=len(rows))).to_csv(
        reference / "single_form.csv", index=False
    )
    wide = predict_samples([sample], "U1", fit_reference_models(reference), level=0.99999).set_index("by")
    assert (wide.loc["ours", "refused"] == "its prediction interval reaches outside (0, 1)").all()
    assert wide.loc["ours", "n"].isna().all() and np.isfinite(wide.loc["r22", "n"])
    rows.assign(n=rows.n - 0.37).to_csv(reference / "single_form.csv", index=False)
    table = predict_samples([sample], "U1", fit_reference_models(reference))
    assert table.refused.tolist()[0] == "its formula gives a porosity outside (0, 1)"


def test_table_2_is_that_of_r22_and_gives_its_predictions():
    """The example has the numbers of Table 2, and its first data set the predictions of Table 11.

    The published coefficients have three decimals: an error of 5e-4 in each, times 1, 2.3, 6.2, 1.5 (and 7.2).
    """
    theirs, ours = read_r22_table("table2_form_statistics"), pd.read_csv(TABLE_2)
    names = {"mu_FL": "mean_FL", "sigma_FL": "std_FL", "mu_EL": "mean_EL", "sigma_EL": "std_EL"}
    np.testing.assert_array_equal(ours[list(names.values())], theirs[list(names)])
    samples = read_samples(TABLE_2)
    assert len(samples) == 9 and all(sample.grains == 0 for sample in samples)
    fitted = fit_reference_models()
    predicted = read_r22_table("table11_application").set_index("case").predicted
    for case, rounding in (("U1", 11.0), ("U7", 18.2)):
        table = predict_samples(samples, case, fitted)
        study = table[table.by == "r22"].set_index("name")
        assert len(study) == 9
        assert study.n["Rhine"] == pytest.approx(predicted[case], abs=5e-4 * (rounding + 1))
        assert {name for name, text in study.outside.items() if text} == {"Kall", "rock aggregate"}


def test_the_grains_of_a_bed_give_what_their_statistics_give(reference, tmp_path):
    """The second sample is also given by its means; flatness and elongation are independent, so n is the same."""
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
