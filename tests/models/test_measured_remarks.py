"""What `fit` says and does about repeats, few grains, beds outside its range, unknown cases, and other numbers in n."""

from dataclasses import replace

import numpy as np
import pytest

from simcore.grains.measured_beds import MeasuredBed
from simcore.grains.measured_forms import Sample
from simcore.grains.statistics import means_covariance
from simcore.models.fitting import fit_reference_models
from simcore.models.measured_candidates import scatter_of_means
from simcore.models.measured_fit import MeasuredFit, fit_case
from simcore.models.measured_fit_text import describe_fit, sentences
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
    assert half[1] == pytest.approx(half[0] * single.scatter / means.scatter, rel=0.1)


def of_new(model, sample):
    return np.ravel(model.predict_interval(sample_features([sample])))


@pytest.mark.parametrize(
    ("factor", "grains", "said"),
    [
        (0.6, 30, "so these beds do not show a weaker one"),
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
