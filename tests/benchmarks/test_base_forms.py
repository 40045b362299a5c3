"""Bases of more forms: the model of beds that are a rain, and its comparison with beds on lattices."""

import numpy as np
import pandas as pd
import pytest

from benchmarks.studies.base_forms import (
    SETS,
    compare_beds,
    compare_coefficients,
    evaluated_statistics,
    of_all_forms,
    on_lattices,
    rain_model,
    statistics_by_number,
)
from simcore.grains.statistics import STATISTICS
from simcore.models.fitting import fit_reference_models
from simcore.models.size_and_form.beds import ALL_FORMS

COEFFICIENTS = np.array([0.28, 0.02, 0.01, 0.05, 0.2])


def made_rows(n=24):
    """Return n rows of beds whose porosity follows COEFFICIENTS, half of them of one form each."""
    rng = np.random.default_rng(3)
    EQ, EL = rng.uniform(0.2, 0.8, n), rng.uniform(0.4, 0.9, n)
    deviations = np.where(np.arange(n) % 2, rng.uniform(0.05, 0.2, (2, n)), 0.0)
    rows = pd.DataFrame(dict(zip(STATISTICS, (EQ, deviations[0], EL, deviations[1]), strict=True)))
    widths = (deviations[0] / EQ) ** 2, (deviations[1] / EL) ** 2
    porosity = COEFFICIENTS @ np.vstack([np.ones(n), 1.0 / EQ, 1.0 / EL, *widths])
    names = [f"made_{k}" for k in range(n)]
    rows = rows.add_suffix("_evaluated").assign(n=porosity, n_error=0.002, form=names, grain=None)
    return rows.assign(**dict.fromkeys(SETS, np.nan))


def test_the_model_of_a_rain_has_the_coefficients_of_its_beds():
    rows = made_rows()
    rain = rain_model(rows)
    np.testing.assert_allclose(rain.coefficients, COEFFICIENTS, atol=1e-9)
    beds = compare_beds(rows, rain, rain)
    np.testing.assert_allclose(beds["rain"], 0.0, atol=1e-9)
    assert beds["on_lattices"].isna().all()


def test_a_difference_of_coefficients_is_compared_with_its_standard_error():
    rng = np.random.default_rng(4)
    rows = made_rows(40)
    rain = rain_model(rows.assign(n=rows["n"] + rng.normal(0.0, 0.003, 40)))
    other = rain_model(rows.assign(n=rows["n"] + 0.05 / rows["mu_EL_evaluated"] + rng.normal(0.0, 0.003, 40)))
    table = compare_coefficients(rain, other)
    assert table["ratio"].abs().idxmax() == "mu_EL_inv" and table.loc["mu_EL_inv", "ratio"] < -5.0
    assert table.loc["mu_EL_inv", "difference"] == pytest.approx(-0.05, abs=0.01)
    assert (table["ratio"].drop("mu_EL_inv").abs() < 3.0).all()


def test_beds_on_lattices_have_the_same_grain_or_the_same_distribution():
    rows = made_rows(3)
    rows.loc[0, "grain"] = "G59"
    rows.loc[1, SETS] = [0.8, 0.4, 0.2, 0.1]
    single = pd.read_csv("results/reference/single_form.csv")
    single = single.query("case == 'U1' and grain == 'G59' and representation == 'polyhedron'")
    mixed = pd.read_csv("results/reference/form_mixture.csv").query("case == 'U1'")
    mixed = mixed[(mixed[SETS] == [0.8, 0.4, 0.2, 0.1]).all(axis=1)]
    assert len(single) and len(mixed)
    np.testing.assert_allclose(on_lattices(rows), [single["n"].mean(), mixed["n"].mean(), np.nan])


def test_grains_are_counted_once_where_forms_differ():
    """Long grains of a sieve class are the larger ones, so that by volume the mean elongation is lower."""
    rows = made_rows(4)
    rows.loc[1, SETS] = [0.8, 0.4, 0.2, 0.2]
    rows.loc[2, "form"] = ALL_FORMS
    by_number, by_volume = statistics_by_number(rows), evaluated_statistics(rows)
    pd.testing.assert_frame_equal(by_number.loc[[0, 3]], by_volume.loc[[0, 3]])
    assert by_number.loc[1, "mu_EL"] == pytest.approx(0.42, abs=0.01)
    np.testing.assert_allclose(by_number.loc[2], of_all_forms())
    # The synthetic forms have the statistics of the Rhine's gravel by construction.
    np.testing.assert_allclose(of_all_forms(), [0.441, 0.145, 0.682, 0.139], atol=0.01)


def test_the_model_of_beds_on_lattices_is_that_of_predict():
    assert tuple(fit_reference_models().models["unified", "U1"].features) == rain_model(made_rows()).features
