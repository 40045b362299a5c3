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
from simcore.reference.r22_tables import read_r22_table, rhine_statistics

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
    # The spread of twenty grains is not that of all forty.
    twenty = axes[:20]
    error = error_of(model, twenty, tmp_path / "twenty.csv")
    assert error == pytest.approx(one_class_scatter(model, twenty, 20), rel=0.2)


def test_the_sampling_error_falls_with_the_root_of_the_number_of_grains(model, tmp_path):
    axes = pd.read_csv(GRAINS).to_numpy(float)
    forty = error_of(model, axes, tmp_path / "grains.csv")
    counted = error_of(model, axes, tmp_path / "counted.csv", count=4)
    assert counted / forty == pytest.approx(np.sqrt(39 / 159), rel=1e-6)
    repeated = error_of(model, np.repeat(axes, 4, axis=0), tmp_path / "repeated.csv")
    assert repeated == pytest.approx(counted, rel=1e-9)
    assert np.isnan(error_of(model, axes, tmp_path / "weighted.csv", number=2.5))


@pytest.mark.parametrize("number, share", [(2, 0.95), (4, 0.95), (5, 0.95), (10, 0.95), (40, 0.93)])
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
    assert share <= inside.mean() <= 0.995


@pytest.mark.parametrize("number", [3, 5, 10])
def test_intervals_of_few_grains_of_a_varied_gravel_contain_its_porosity(model, number):
    """Of grains that differ as the Rhine's, five to ten may be alike by chance, which must not narrow intervals."""
    rng, rhine = np.random.default_rng(2), rhine_statistics()

    def table_of(count, samples):
        FL, EL = (
            np.clip(rng.normal(rhine[f"mu_{name}"], rhine[f"sigma_{name}"], count * samples), 0.1, 1.0)
            for name in ("FL", "EL")
        )
        columns = ["sample", "FL", "EL"]
        cells = pd.DataFrame({0: np.repeat(np.arange(samples), count), 1: FL, 2: EL}).astype(str)
        return samples_of_table(TextTable(GRAINS, columns, cells, []))[0]

    of_all = model.predict(sample_features(table_of(20_000, 1))).item()
    samples = table_of(number, 400)
    half = few_grains_half(samples, few_grains_errors(model, samples), 0.95)
    inside = np.abs(model.predict(sample_features(samples)) - of_all) < half
    assert 0.92 <= inside.mean() <= 0.98


def test_fewer_than_five_grains_have_the_error_of_grains_that_differ_as_much_as_those_of_the_rhine(model, tmp_path):
    axes = pd.read_csv(GRAINS).to_numpy(float)
    alike = np.array([[10.0, 8.0, 5.0], [10.0, 8.1, 5.0]])  # two grains of nearly one form say nothing of their spread
    assert error_of(model, alike, tmp_path / "two.csv") > 2 * error_of(model, axes[:5], tmp_path / "five.csv")
    assert np.isnan(error_of(model, axes[:1], tmp_path / "one.csv"))
    assert error_of(model, axes[[0] * 5], tmp_path / "alike.csv") == 0.0


@pytest.mark.parametrize("grains, stated", [(40, "0.003 to 0.009 for forty"), (10, "0.007 to 0.019 for ten")])
def test_few_grains_of_measured_gravels_have_the_stated_error(model, grains, stated):
    measured = read_r22_table("table2_form_statistics")[["mu_FL", "sigma_FL", "mu_EL", "sigma_EL"]]
    columns = ["mean_FL", "std_FL", "mean_EL", "std_EL", "grains"]
    cells = measured.assign(grains=grains).astype(str).set_axis(range(5), axis=1)
    samples, _ = samples_of_table(TextTable(GRAINS, columns, cells, []))
    errors = few_grains_errors(model, samples)
    assert stated.startswith(f"{errors.min():.3f} to {errors.max():.3f} ")
    for name in ("predict_from_a_sieve_curve.md", "predict.md"):
        text = (ROOT / "docs" / "how_to" / name).read_text(encoding="utf-8")
        assert stated in " ".join(text.split()), name
