"""What `fit` says and does about repeats, few grains, beds outside its range, unknown cases, and other numbers in n."""

from dataclasses import replace

import numpy as np
import pytest

from simcore.evaluation.confidence import student_quantile
from simcore.grains.measured_beds import MeasuredBed
from simcore.grains.measured_forms import Sample
from simcore.grains.statistics import few_grains_covariance, means_covariance
from simcore.models.fitting import fit_reference_models
from simcore.models.measured_candidates import scatter_of_means
from simcore.models.measured_fit import MeasuredFit, fit_case
from simcore.models.measured_fit_text import describe_fit, expected_factor, sentences
from simcore.models.measured_plausibility import question_beds
from simcore.models.prediction import model_case, predict_preferred, sample_features

WIDTH = 0.13  # standard deviation of FL and EL of the grains of a bed


@pytest.fixture(scope="module")
def committed():
    return fit_reference_models()


def gravel(name, FL, EL, grains=0):
    """Return a Sample with these means; its covariance is that of so many grains."""
    covariance = tuple(map(tuple, means_covariance(FL, WIDTH, EL, WIDTH, grains))) if grains else None
    squares = (FL**2 + WIDTH**2) * (EL**2 + WIDTH**2)
    return Sample(name, grains, FL, WIDTH, EL, WIDTH, FL * EL, np.sqrt(squares - (FL * EL) ** 2), covariance)


def beds_of(committed, forms, added, case="one-class", grains=0):
    samples = [gravel(f"bed {i}", FL, EL, grains) for i, (FL, EL) in enumerate(forms)]
    predicted = [predict_preferred(sample, "U1", committed)["n"] for sample in samples]
    return [
        MeasuredBed(sample, n + more, np.nan, case) for sample, n, more in zip(samples, predicted, added, strict=True)
    ]


FORMS = np.random.default_rng(3).uniform((0.5, 0.62), (0.7, 0.76), (10, 2))


def test_the_interval_of_means_of_repeats_is_for_a_single_bed(committed):
    """The scatter of single beds is that of the means and the part of the repeats that means do not have."""
    rng = np.random.default_rng(2)
    of_means = beds_of(committed, FORMS, 0.012 + 0.003 * rng.normal(size=10))
    repeats = np.array([-0.009, -0.002, 0.011])
    rows = [replace(bed, n=bed.n + more) for bed in of_means for more in repeats]
    means, single = (fit_case(beds, "U1", committed).candidates[0].model for beds in (of_means, rows))
    assert single.scatter == pytest.approx(np.hypot(means.scatter, repeats.std(ddof=1) * np.sqrt(2 / 3)))
    assert scatter_of_means(single, [3] * 10, repeats.std(ddof=1)) == pytest.approx(means.scatter)
    new = gravel("new", 0.6, 0.7)
    half = [np.ptp(of_new(model, new)[1:]) for model in (means, single)]
    ratio = single.scatter / means.scatter * student_quantile(0.95, single.freedom) / student_quantile(0.95, 9)
    assert single.freedom > 9 and half[1] == pytest.approx(half[0] * ratio, rel=0.1)


def drawn_gravel(rng, grains):
    """Return a gravel with all its grains, and as it appears in so many of them."""
    FL = np.clip(rng.normal(rng.uniform(0.45, 0.75), 0.13, 2000), 0.1, 1.0)
    EL = np.clip(rng.normal(rng.uniform(0.5, 0.8), 0.1, 2000), 0.2, 1.0)
    samples = []
    for some in (slice(None), rng.integers(0, 2000, grains)):
        a, b = FL[some], EL[some]
        covariance = tuple(map(tuple, few_grains_covariance(a * b, b)))
        samples.append(
            Sample("", len(a), a.mean(), a.std(), b.mean(), b.std(), (a * b).mean(), (a * b).std(), covariance)
        )
    return samples


def test_the_factor_that_few_grains_let_expect_is_the_mean_of_fitted_ones(committed):
    """A safe limit of the errors, as intervals have, would let expect 0.56 with eight grains.

    The difference of 100 tables has the standard error 0.018.
    """
    rng, factors, expected = np.random.default_rng(6), [], []
    model = committed.models["unified", "U1"]
    for _ in range(100):
        true, seen = zip(*(drawn_gravel(rng, 8) for _ in range(12)), strict=True)
        n = model.predict(sample_features(true)) + 0.003 * rng.normal(size=12)
        beds = [MeasuredBed(replace(s, name=f"bed {i}"), n[i], np.nan, "one-class") for i, s in enumerate(seen)]
        case = fit_case(beds, "U1", committed)
        factors.append(case.candidates[1].coefficients.value.iloc[1])
        expected.append(expected_factor(case.beds))
    assert np.mean(expected) == pytest.approx(np.mean(factors), abs=3 * 0.018)


def of_new(model, sample):
    return np.ravel(model.predict_interval(sample_features([sample])))


@pytest.mark.parametrize(
    ("factor", "grains", "said"),
    [
        (0.6, 20, "so these beds do not show a weaker one"),
        (0.6, 3000, "form has a weaker effect than in our model."),
        (0.6, 0, "or few grains of each bed were measured"),
        (1.0, 30, "does not differ from 1"),
        (1.6, 30, "form has a stronger effect than"),
    ],
)
def test_a_weak_effect_of_form_may_come_from_few_grains(committed, factor, grains, said):
    beds = beds_of(committed, FORMS, np.zeros(10), grains=grains)
    noise = 0.001 * np.random.default_rng(1).normal(size=10)
    mean = np.mean([bed.n for bed in beds])
    beds = [replace(bed, n=mean + factor * (bed.n - mean) + more) for bed, more in zip(beds, noise, strict=True)]
    (line,) = (text for text in sentences(fit_case(beds, "U1", committed)) if "factor of the rescaling" in text)
    assert said in line


def test_a_bed_outside_the_range_is_listed_first_and_named_in_the_remedy(committed):
    beds = beds_of(committed, FORMS, 0.01 + 0.001 * np.arange(10))
    slate = MeasuredBed(replace(gravel("slate", 0.15, 0.5), sigma_FL=0.05), 0.5, np.nan, "one-class")
    result = fit_case([*beds, slate], "U1", committed)
    text = " ".join(describe_fit(MeasuredFit([result], [], []), "beds.csv").split())
    assert "; remove slate to correct a model to the other 10." in text
    assert "bed measured predicted difference slate 0.5000 - -" in text


@pytest.mark.parametrize("case", ["oneclass", "One-Class", "ONE_CLASS", "one class", "u1"])
def test_a_case_may_be_written_in_other_ways(case):
    assert model_case(case) == "U1"
    assert model_case("bar 3") == "bar 3" and model_case("u7") == "U7"


def test_an_unknown_case_leads_to_one_class_and_to_sieve_curves(committed):
    beds = beds_of(committed, FORMS, 0.01 + 0.001 * np.arange(10))
    texts = {case: " ".join(sentences(fit_case(beds, case, committed))) for case in ("8-16 mm", "U3")}
    assert "for beds of any single sieve class give one-class as their case" in texts["8-16 mm"]
    assert "give --sieve U3 instead of the case" in texts["U3"]


def test_void_ratios_and_solid_fractions_close_to_the_porosity_are_questioned_together():
    sample = gravel("bed", 0.6, 0.7)
    predicted = np.array([0.26, 0.28, 0.30])

    def question(values):
        return question_beds([MeasuredBed(sample, n, np.nan, "U1") for n in values], predicted)

    (line,) = question((predicted + 0.01) / (1 - predicted - 0.01))
    assert "the void ratio e. If it has, give e/(1 + e) instead" in line
    (line,) = question_beds([MeasuredBed(sample, n, np.nan, "U1") for n in (0.54, 0.55)], [0.44, 0.445])
    assert "the solid fraction. If it has, give 1 minus it instead" in line
    assert question(predicted + 0.05) == question(predicted) == []
