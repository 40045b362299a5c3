"""Beds of U7 with a distribution of form: their predictions, the rules, and the slope on the one-class porosity."""

import numpy as np
import pandas as pd
import pytest

from benchmarks.studies.mixtures_wide import (
    PROCESSES,
    RHINE,
    SETS,
    comparison,
    is_rhine,
    judgement,
    slopes,
    specified_statistics,
)
from benchmarks.studies.size_and_form_fit import STUDY, read_rows
from simcore.models.size_and_form.sized_model import current_model
from simcore.scene.sizes import all_cases


def made_beds(*sets):
    """Return rows of U7 with these values of SETS, and with the other columns of the bed of all forms."""
    rows = read_rows(STUDY).query("case == 'U7' and representation == 'polyhedron' and seed == 1")
    assert len(rows) == 1
    return pd.concat([rows.assign(**dict(zip(SETS, values, strict=True))) for values in sets], ignore_index=True)


def made_table(errors, sets):
    """Return a table as from `comparison`, of beds whose predictions err by `errors`."""
    table = pd.DataFrame(sets, columns=SETS).assign(seed=1, n=0.3, n_error=0.003)
    return table.assign(**{process: 0.3 + np.array(errors) for process in PROCESSES})


def test_statistics_are_those_of_the_columns():
    """The Rhine's are the means of Table 2 of Rettinger et al., and EQ is the product of FL and EL."""
    columns = {"mu_FL_nominal": 0.647, "mu_EL_nominal": 0.682, "sigma_FL_nominal": 0.175, "sigma_EL_nominal": 0.139}
    rows = pd.DataFrame([columns, columns | {"mu_FL_nominal": 0.5}])
    assert is_rhine(rows).tolist() == [True, False]
    statistics = specified_statistics(rows).iloc[0]
    assert statistics["mu_EQ"] == pytest.approx(0.647 * 0.682) and statistics["mu_EL"] == 0.682
    assert statistics["sigma_EL"] == 0.139 and 0.14 < statistics["sigma_EQ"] < 0.16


def test_flatter_and_longer_grains_are_predicted_looser():
    table = comparison(made_beds((0.7, 0.1, 0.7, 0.1), (0.5, 0.1, 0.7, 0.1), (0.7, 0.1, 0.5, 0.1)))
    for process in PROCESSES:
        round_grains, flat, long = table[process]
        assert flat > round_grains + 0.01 and long > round_grains + 0.005
        assert table[f"one_class_{process}"].between(0.3, 0.45).all()


def test_the_rhines_distribution_is_predicted_as_the_bed_of_all_forms():
    """The 63 forms have these statistics, so that the one-class porosity is that of the bed of all forms."""
    beds = made_beds(RHINE)
    (row,) = comparison(beds).itertuples()
    packed = read_rows(STUDY).query("case == 'U1' and representation == 'polyhedron' and grain.isna() and seed == 1")
    assert row.one_class_rain == pytest.approx(packed["n"].item(), abs=0.005)
    curve = all_cases()["U7"].curve
    expected = current_model().predict(curve, row.one_class_rain, reference=row.one_class_rain)
    assert row.rain == pytest.approx(float(expected), abs=0.005)


@pytest.mark.parametrize("error, confirmed", [(0.004, True), (-0.004, True), (0.006, False), (-0.006, False)])
def test_the_rhines_beds_are_judged_by_their_mean_error(error, confirmed):
    table = made_table([error + 0.02, error - 0.02, 0.0], [RHINE, RHINE, (0.5, 0.1, 0.5, 0.1)])
    rule = judgement(table).loc["Rhine"]
    assert rule["beds"] == 2 and rule["error"] == pytest.approx(error) and rule["confirmed"] == confirmed


@pytest.mark.parametrize("error, confirmed", [(0.009, True), (0.011, False)])
def test_sets_are_judged_by_the_root_mean_square(error, confirmed):
    table = made_table([0.02, error, -error], [RHINE, (0.5, 0.1, 0.5, 0.1), (0.7, 0.1, 0.5, 0.1)])
    rule = judgement(table).loc["sets"]
    assert rule["beds"] == 2 and rule["error"] == pytest.approx(error) and rule["confirmed"] == confirmed


def test_beds_that_are_missing_confirm_nothing():
    rules = judgement(made_table([0.0], [RHINE]))
    assert rules.loc["Rhine", "confirmed"] and not rules.loc["sets", "confirmed"]


def test_slopes_are_those_of_weighted_straight_lines():
    rng = np.random.default_rng(4)
    x, error = rng.uniform(0.3, 0.45, 9), rng.uniform(0.001, 0.004, 9)
    n = 0.05 + 0.7 * x + error * rng.standard_normal(9)
    table = pd.DataFrame({"one_class_rain": x, "rain": 0.04 + 0.8 * x, "n": n, "n_error": error})
    slope = slopes(table)
    line, covariance = np.polyfit(x, n, 1, w=1.0 / error, cov="unscaled")
    scatter = np.sum(((n - np.polyval(line, x)) / error) ** 2) / 7
    assert slope["packed"] == pytest.approx(line[0])
    assert slope["predicted"] == pytest.approx(0.8)
    assert slope["error"] == pytest.approx(np.sqrt(covariance[0, 0] * max(1.0, scatter)))
