"""Comparison of beds that were inserted on lattices and as a rain."""

import numpy as np
import pandas as pd
import pytest

from benchmarks.studies.insertion_rate import (
    bases_as_rain,
    bases_table,
    elongation_coefficients,
    form_slopes,
    measured_steps,
    paired_beds,
)
from simcore.paths import REFERENCE
from simcore.reference.r22_tables import read_r22_table


def test_bases_on_wider_lattices_are_inserted_more_slowly_and_are_denser():
    rows = bases_table()
    rows = rows[(rows["case"] == "U1") & (rows["form"] == "all") & rows["spacing"].notna()].sort_values("spacing")
    assert rows["spacing"].tolist() == [0.009, 0.012, 0.024]
    assert (np.diff(rows["rate"]) < 0).all() and rows["n"].iloc[-1] < rows["n"].iloc[0] - 0.03


def test_a_pair_is_one_bed_by_both_processes_and_steps_begin_at_one_class():
    pairs = paired_beds()
    bases = pairs[pairs["case"] == "U1"]
    assert not pairs.duplicated(["case", "form", "seed"]).any() and len(bases) >= 7
    assert (bases[["step_lattice", "step_rain"]] == 0).all().all()
    wide = pairs[pairs["case"] == "U5"].set_index("form").loc["all"]
    of_one_class = bases.set_index("form").loc["all"]
    for name in ("lattice", "rain"):
        assert wide[f"step_{name}"] == pytest.approx(wide[f"n_{name}"] - of_one_class[f"n_{name}"])
    assert wide["rate_lattice"] < 0.5 * of_one_class["rate_lattice"]
    assert wide["rate_rain"] > 0.8 * of_one_class["rate_rain"]


def test_measured_steps_are_those_of_the_published_table():
    steps = measured_steps().set_index("case")
    measured = read_r22_table("table3_cases").set_index("case")["n_exp"]
    assert set(steps.index) == set(measured.index) - {"U1"}
    assert steps.loc["B30", "measured"] == pytest.approx(measured["B30"] - measured["U1"])
    assert np.isfinite(steps.loc[["U3", "U5", "U7", "B50"], ["lattice", "rain"]]).all().all()
    assert steps.loc[["B30", "B70"], "lattice"].isna().all()
    wide = pd.read_csv(REFERENCE / "wide_both.csv").groupby("case")["n"].mean()
    lattice = pd.read_csv(REFERENCE / "lattice_beds.csv").query(
        "case == 'U1' and grain.isna() and representation != 'sphere'"
    )
    for case in ("U7", "B50"):
        assert steps.loc[case, "lattice"] == pytest.approx(wide[case] - lattice["n"].iloc[0])


def test_slopes_of_form_are_those_of_a_line_through_the_forms():
    one_class = np.array([0.32, 0.35, 0.38])
    beds = pd.DataFrame({"case": "U5", "form": ["a", "b", "c"], "n_lattice": 0.1 + 0.5 * one_class})
    beds = beds.assign(n_rain=0.01 + 0.9 * one_class, step_lattice=beds["n_lattice"] - one_class)
    beds = beds.assign(step_rain=beds["n_rain"] - one_class)
    row = form_slopes(pd.concat([beds, beds.iloc[:2].assign(case="U3")])).set_index("case")
    assert row.index.tolist() == ["U5"]
    assert row.loc["U5", ["slope_lattice", "slope_rain"]].tolist() == pytest.approx([0.5, 0.9])


def test_forms_with_two_seeds_count_once_and_beds_without_a_base_do_not():
    one_class = np.array([0.32, 0.35, 0.38, 0.33])
    beds = pd.DataFrame({"case": "U5", "form": ["a", "b", "c", "a"], "n_lattice": 0.1 + 0.5 * one_class})
    beds = beds.assign(n_rain=beds["n_lattice"], step_lattice=beds["n_lattice"] - one_class)
    beds = beds.assign(step_rain=beds["step_lattice"])
    without_base = beds.iloc[:1].assign(form="d", step_lattice=np.nan)
    (row,) = form_slopes(pd.concat([beds, without_base])).itertuples()
    assert row.forms == 3 and row.slope_lattice == pytest.approx(0.5)
    assert form_slopes(beds.iloc[[0, 1, 3]]).empty


def test_errors_of_coefficients_follow_from_the_sampling_errors():
    pairs = bases_as_rain()
    parts = elongation_coefficients(pairs).loc["its error"]
    # The fit is linear: a change of one difference by its error changes the coefficient by its share of the error.
    shares = [
        elongation_coefficients(pairs.assign(difference=pairs["error"].where(pairs["form"] == form, 0.0)))
        for form in pairs["form"]
    ]
    error = np.sqrt(sum(share.loc["coefficient of 1/EL", "difference"] ** 2 for share in shares))
    assert parts["difference"] == pytest.approx(error)
    assert parts["rest"] == pytest.approx(np.hypot(parts["difference"], parts["explained"]))
