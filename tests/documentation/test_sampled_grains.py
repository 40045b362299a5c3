"""The error of a prediction that comes from measuring few grains is as large as the how-to pages state."""

import numpy as np
import pandas as pd
import pytest

from simcore.grains.measured_forms import read_measured, samples_of_table
from simcore.grains.table_file import TextTable
from simcore.models.few_grains import few_grains_errors, few_grains_half
from simcore.models.fitting import fit_reference_models
from simcore.models.prediction import sample_features
from simcore.models.scatter import scatter_of
from simcore.models.unified import unified_features
from simcore.paths import ROOT

GRAINS = ROOT / "examples" / "grains.csv"
DRAWS = 1000


@pytest.fixture(scope="module")
def model():
    return fit_reference_models().models["unified", "U1"]


def one_class_scatter(model, axes, grains):
    """Return the standard deviation of the one-class porosity over draws of so many grains from `axes` (n, 3)."""
    L, I, S = np.sort(axes, axis=1).T[::-1]  # noqa: E741
    chosen = np.random.default_rng(0).integers(0, len(axes), (DRAWS, grains))
    columns = {}
    for name, values in (("EQ", S / L), ("EL", I / L)):
        columns[f"mu_{name}"] = values[chosen].mean(axis=1)
        columns[f"sigma_{name}"] = values[chosen].std(axis=1)
    return np.std(model.predict(unified_features(pd.DataFrame(columns))))


def error_of(model, axes, path, **columns):
    pd.DataFrame(axes, columns=["L", "I", "S"]).assign(**columns).to_csv(path, index=False)
    samples, _ = read_measured(path)
    return few_grains_errors(model, samples)[0]


def test_the_sampling_error_is_that_of_drawing_the_grains_again(model, tmp_path):
    axes = pd.read_csv(GRAINS).to_numpy(float)
    assert error_of(model, axes, tmp_path / "grains.csv") == pytest.approx(one_class_scatter(model, axes, 40), rel=0.1)
    # The spread of ten grains is not that of all forty.
    ten = axes[:10]
    assert error_of(model, ten, tmp_path / "ten.csv") == pytest.approx(one_class_scatter(model, ten, 10), rel=0.2)


def test_the_sampling_error_falls_with_the_root_of_the_number_of_grains(model, tmp_path):
    axes = pd.read_csv(GRAINS).to_numpy(float)
    forty = error_of(model, axes, tmp_path / "grains.csv")
    counted = error_of(model, axes, tmp_path / "counted.csv", count=4)
    assert counted / forty == pytest.approx(np.sqrt(39 / 159), rel=1e-6)
    repeated = error_of(model, np.repeat(axes, 4, axis=0), tmp_path / "repeated.csv")
    assert repeated == pytest.approx(counted, rel=1e-9)
    assert np.isnan(error_of(model, axes, tmp_path / "weighted.csv", number=2.5))


@pytest.mark.parametrize("number, share", [(2, 0.95), (3, 0.95), (4, 0.95), (5, 0.93), (10, 0.93), (40, 0.93)])
def test_intervals_of_few_grains_contain_the_porosity_of_all_grains(model, number, share):
    """Draws of so many grains; the porosity of a bed of all forty is inside at least as often as stated."""
    axes = pd.read_csv(GRAINS)
    table = pd.concat([axes.sample(number, replace=True, random_state=draw).assign(sample=draw) for draw in range(400)])
    samples, _ = samples_of_table(
        TextTable(GRAINS, list(table.columns), table.astype(str).set_axis(range(4), axis=1), [])
    )
    of_all = model.design(sample_features(read_measured(GRAINS)[0]))
    scatter = scatter_of(of_all, model.scatter, model.scatter_line)
    beds = of_all @ model.coefficients + scatter * np.random.default_rng(1).normal(size=len(samples))
    n, lower, upper, _ = model.predict_interval_and_outside(
        sample_features(samples), 0.95, few_grains_half(samples, few_grains_errors(model, samples), 0.95)
    )
    inside = (lower < beds) & (beds < upper)
    assert share <= inside.mean() <= 0.99


def test_fewer_than_five_grains_have_the_error_of_grains_that_differ_as_much_as_those_of_the_rhine(model, tmp_path):
    axes = pd.read_csv(GRAINS).to_numpy(float)
    alike = np.array([[10.0, 8.0, 5.0], [10.0, 8.1, 5.0]])  # two grains of nearly one form say nothing of their spread
    assert error_of(model, alike, tmp_path / "two.csv") > 2 * error_of(model, axes[:5], tmp_path / "five.csv")
    assert np.isnan(error_of(model, axes[:1], tmp_path / "one.csv"))
    assert error_of(model, axes[[0] * 5], tmp_path / "alike.csv") == 0.0


@pytest.mark.parametrize("grains, stated", [(40, "0.004"), (10, "0.007")])
def test_few_grains_have_the_stated_error(model, grains, stated):
    samples, _ = read_measured(GRAINS)
    error = few_grains_errors(model, samples)[0] * np.sqrt(39 / (grains - 1))
    assert f"{error:.3f}" == stated
    for name in ("predict_from_a_sieve_curve.md", "predict.md"):
        text = (ROOT / "docs" / "how_to" / name).read_text(encoding="utf-8")
        assert f"{stated} for {'forty' if grains == 40 else 'ten'}" in " ".join(text.split()), name
