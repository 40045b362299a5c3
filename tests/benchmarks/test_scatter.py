"""The table of scatter over seeds: exact for made-up rows, and right for rows whose scatter is the stated error."""

import numpy as np
import pandas as pd
import pytest
from scipy.stats import chi2, f

from benchmarks.studies.scatter import (
    FORM,
    coarsest_classes,
    packed_seeds,
    pooled_ratio,
    read_tables,
    scatter,
    scatter_table,
    with_different_grains,
)


def rows(n, error=0.01, case="U5"):
    return pd.DataFrame({"case": case, "n": n, "n_error": error})


def test_the_scatter_of_three_seeds():
    result = scatter(rows([0.30, 0.31, 0.32], error=[0.01, 0.01, 0.02]))
    assert result["n"] == pytest.approx(0.31) and result["std"] == pytest.approx(0.01)
    assert result["stated"] == pytest.approx(np.sqrt(2.0) * 0.01)
    assert result["chi2"] == pytest.approx(1.0)  # 2 * 0.01² / 0.02 * 0.01
    # Quantiles of chi-squared of 2 degrees of freedom are -2 ln(1 - p).
    assert result["chi2_lower"] == pytest.approx(-2 * np.log(0.975))
    assert result["std_upper"] == pytest.approx(0.01 * np.sqrt(2 / result["chi2_lower"]))


def test_stated_errors_count_from_the_seed_of_their_correction_on():
    before = rows([0.30, 0.31, 0.32], error=[0.05, 0.01, 0.01]).assign(seed=[3, 4, 5])
    after, all_seeds = scatter(before, corrected_from=4), scatter(before)
    assert after["stated"] == pytest.approx(0.01) and all_seeds["stated"] == pytest.approx(0.03)
    assert after["std"] == all_seeds["std"] and after["chi2"] == pytest.approx(2.0)


def test_sets_with_different_porosities_scatter_about_their_own_means():
    first, second = rows([0.30, 0.31, 0.32], error=0.01), rows([0.40, 0.42], error=0.02)
    table = pd.concat([first.assign(mu_FL_nominal=0.4), second.assign(mu_FL_nominal=0.8)])
    result = scatter(table, sets=["mu_FL_nominal"])
    assert result["std"] == pytest.approx(np.sqrt((2e-4 + 2e-4) / 3))
    assert result["chi2"] == pytest.approx(2e-4 / 1e-4 + 2e-4 / 4e-4)
    assert result["stated"] == pytest.approx(np.sqrt((2 * 1e-4 + 4e-4) / 3))
    assert result["chi2_lower"] == pytest.approx(chi2.ppf(0.025, 3))


def test_confidence_limits_contain_the_true_scatter_in_95_of_100():
    rng = np.random.default_rng(3)
    inside = agrees = 0
    for _ in range(2000):
        result = scatter(rows(rng.normal(0.3, 0.01, 8)))
        inside += result["std_lower"] <= 0.01 <= result["std_upper"]
        agrees += result["chi2_lower"] <= result["chi2"] <= result["chi2_upper"]
    assert inside == agrees and inside / 2000 == pytest.approx(0.95, abs=0.02)


def test_variances_are_compared_for_curves_with_both_draws_alone():
    tables = {
        "random": pd.concat([rows([0.30, 0.32, 0.34]), rows([0.2, 0.3], case="B50")]),
        "quota": rows([0.31, 0.32, 0.33]),
    }
    table = scatter_table(tables).set_index(["case", "draw"])
    assert table.loc[("U5", "quota"), "variance_ratio"] == pytest.approx(0.25)
    assert table.loc[("U5", "quota"), "limit"] == pytest.approx(f.ppf(0.05, 2, 2))
    assert table["variance_ratio"].count() == 1


def test_spheres_of_both_draws_are_a_curve_of_their_own(tmp_path):
    rows([0.30, 0.31]).to_csv(tmp_path / "wide_quota.csv", index=False)
    spheres = rows([0.33, 0.34, 0.32, 0.36]).assign(draw=["quota", "quota", "random", "random"])
    spheres.to_csv(tmp_path / "wide_spheres.csv", index=False)
    table = scatter_table(read_tables(tmp_path)).set_index(["case", "draw"])
    assert set(table.index) == {("U5", "quota"), ("U5 spheres", "quota"), ("U5 spheres", "random")}
    assert table.loc[("U5 spheres", "quota"), "variance_ratio"] == pytest.approx(0.0625)


def test_beds_with_a_distribution_of_form_are_sets_of_one_curve(tmp_path):
    first, second = rows([0.30, 0.31], case="U1"), rows([0.40, 0.42], case="U1")
    forms = {"mu_FL_nominal": 0.4, "sigma_FL_nominal": 0.1, "mu_EL_nominal": 0.6, "sigma_EL_nominal": 0.2}
    table = pd.concat([first.assign(**forms), second.assign(**forms | {"mu_EL_nominal": 0.8})])
    table.to_csv(tmp_path / "scatter_forms.csv", index=False)
    (row,) = scatter_table(read_tables(tmp_path)).itertuples()
    assert row.case == "U1, distributions of form" and row.draw == "random" and row.seeds == 4
    assert row.chi2 == pytest.approx((0.5e-4 + 2e-4) / 1e-4)


def test_packings_with_other_settings_are_a_curve_of_their_own(tmp_path):
    for study, n in (
        ("wide_random", [0.30, 0.31]),
        ("wide_both_random", [0.30, 0.32]),
        ("wide_both", [0.30, 0.31]),
    ):
        rows(n, case="B50").assign(seed=[4, 5]).to_csv(tmp_path / f"{study}.csv", index=False)
    table = scatter_table(read_tables(tmp_path)).set_index(["case", "draw"])
    assert table.loc[("B50, preset wide", "quota"), "variance_ratio"] == pytest.approx(0.25)
    assert table["variance_ratio"].count() == 1 and len(table) == 3


def test_drawn_sizes_scatter_over_all_seeds_and_over_the_packed_ones():
    drawn = pd.DataFrame(
        {"seed": [1, 2, 3], "required": 0.1, "share": [0.08, 0.1, 0.12], "n": [0.25, 0.27, 0.29]}
    ).assign(case="B50", draw="random")
    tables = {"random": rows([0.3, 0.3], case="B50, preset wide").assign(seed=[2, 3])}
    (row,) = coarsest_classes(drawn, packed_seeds(tables)).itertuples()
    assert (row.seeds, row.least, row.largest) == (3, 0.08, 0.12) and row.std == pytest.approx(0.02)
    assert row.n_std == pytest.approx(0.02) and row.n_std_packed == pytest.approx(0.02 / np.sqrt(2.0))
    (row,) = coarsest_classes(drawn).itertuples()
    assert np.isnan(row.n_std_packed)


def test_packings_of_the_same_grains_in_two_studies_are_drawn_once():
    def packing(case, draw, seed, faces=300):
        return {"sizes": {"case": case, "draw": draw}, "seed": seed, "faces": faces}

    first = [
        packing("U5", "quota", 1),
        packing("U5", "random", 1),
        packing("B50", "quota", 1),
        packing("U5", "quota", 2),
    ]
    assert with_different_grains([*first, packing("U5", "quota", 1, faces=100)]) == first


def test_the_ratio_over_all_curves_is_their_weighted_geometric_mean():
    rng = np.random.default_rng(6)
    ratios = []
    for _ in range(200):
        tables = {
            draw: pd.concat(
                pd.DataFrame({"case": case, "seed": range(8), "n": 0.3 + std * rng.standard_normal(8), "n_error": 0.01})
                for case in "ab"
            )
            for draw, std in (("random", 0.01), ("quota", 0.005))
        }
        ratios.append(pooled_ratio(scatter_table(tables)))
    ratio, low, high = np.array(ratios).T
    assert np.exp(np.log(ratio).mean()) == pytest.approx(0.25, rel=0.1)
    inside = np.mean((low < 0.25) & (high > 0.25))  # of 200, standard error 0.015
    assert inside == pytest.approx(0.95, abs=0.05)


def test_the_limit_of_the_ratio_has_the_degrees_of_freedom_of_the_sets():
    rows = pd.DataFrame(
        {"case": "U1, distributions of form", "n": [0.3, 0.31] * 4, "n_error": 0.01, "seed": [1, 2] * 4}
    )
    rows = rows.assign(**{name: np.repeat(range(4), 2) for name in FORM})
    table = scatter_table({"random": rows, "quota": rows})
    assert table["freedom"].tolist() == [4, 4]
    assert table["limit"].dropna().item() == pytest.approx(0.157, abs=5e-4)
